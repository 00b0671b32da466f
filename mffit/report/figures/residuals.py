"""Where the model misses: measured minus model over sideslip and camber, one map per load and pressure."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.points import Points
from mffit.report import constants, labels, style
from mffit.report.curves import CurveCondition
from mffit.report.drawing.records import Axis, ColourScale, Frame, Look, Map, Panel, Sheet, Trace, in_rows

BACKWARD = Look(colour=style.INK, marker=".", size=1.8)


MAPS_IN_A_ROW = 6


def most_populated(conditions: Sequence[CurveCondition], most: int | None = None) -> list[CurveCondition]:
    """The conditions with most points, in their order; ``most`` of them, by default as many as fit side by side."""
    kept = sorted(conditions, key=lambda c: -len(c.index))[: most or constants.MOST_MAPS_PER_CHANNEL]
    return [c for c in conditions if c in kept]


def residual_maps(
    points: Points,
    residuals: Sequence[tuple[str, np.ndarray]],
    conditions: Sequence[CurveCondition],
    unit: str,
) -> Sheet:
    """Rows of maps per residual (title, (n,) array), one map per condition; one colour scale for all."""
    limit = constants.RESIDUAL_SCALE
    groups = [
        [
            residual_map(points, values, condition, limit, f"{name}: {condition.title}")
            for condition in most_populated(conditions, constants.MOST_MAPS_OF_BUILD)
        ]
        for name, values in residuals
    ]
    return Sheet(
        rows=in_rows(*groups, columns=MAPS_IN_A_ROW),
        height=1.45,
        scale=ColourScale(limit=limit, label=f"measured − model [{unit}]"),
    )


def residual_map(
    points: Points,
    values: np.ndarray,
    condition: CurveCondition,
    limit: float,
    title: str,
    frames: Sequence[Frame] = (),
) -> Panel:
    """One map with the axes of all points; a dot marks a point that was run backwards."""
    rows = condition.index[np.isfinite(values[condition.index])]
    alpha, gamma = np.degrees(points.alpha[rows]), np.degrees(points.gamma[rows])
    gamma = gamma + constants.NEIGHBOUR_SHIFT * _camber_range(points) * beside(alpha, gamma)
    size = 4.5 if len(rows) < constants.CROWDED_MAP else 2.6
    series: list[Map | Trace] = [
        Map(name="measured − model", x=alpha, y=gamma, values=np.clip(values[rows], -limit, limit), limit=limit, size=size)
    ]  # fmt: skip
    backward = points.direction[rows] < 0
    if backward.any():
        series.append(Trace(name="run backwards", x=alpha[backward], y=gamma[backward], look=BACKWARD))
    (left, right), (low, high) = (_all_points(angle) for angle in (points.alpha, points.gamma))
    return Panel(
        title=title,
        x=Axis(label=labels.ANGLES["alpha"].axis, low=left, high=right),
        y=Axis(label=labels.ANGLES["gamma"].axis, low=low, high=high, ticks=4),
        series=series,
        frames=frames,
    )


def beside(alpha: np.ndarray, gamma: np.ndarray) -> np.ndarray:
    """Shift (n,), in steps, that keeps points with equal angles from covering each other: 0, +1, -1, +2..."""
    key = np.round(alpha, 1) * 1000.0 + np.round(gamma, 1)
    order = np.argsort(key, kind="stable")
    first = np.r_[True, np.diff(key[order]) != 0]
    start = np.maximum.accumulate(np.where(first, np.arange(len(order)), 0))
    rank = np.empty(len(order))
    rank[order] = np.arange(len(order)) - start
    return np.where(rank % 2 == 1, 1.0, -1.0) * np.ceil(rank / 2.0)


def _all_points(angle: np.ndarray) -> tuple[float, float]:
    """Ends of an axis [deg] that holds all points, so that maps can be compared."""
    low, high = np.degrees(angle.min()), np.degrees(angle.max())
    room = 0.08 * max(high - low, 2.0)
    return float(low - room), float(high + room)


def _camber_range(points: Points) -> float:
    """Extent of all points [deg]; at least 1, so that points without camber are drawn apart, too."""
    return max(float(np.degrees(np.ptp(points.gamma))), 1.0)
