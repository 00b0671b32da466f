"""Where the model misses: measured minus model over sideslip and camber, one map per load and pressure."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.points import Points
from mffit.report import constants, labels, left_undrawn, style
from mffit.report.curves import CurveCondition, shown_values
from mffit.report.drawing.records import Axis, ColourScale, Frame, Look, Map, Panel, Sheet, Trace, in_rows

ANGLES = ("alpha", "gamma")
SLIPS = ("kappa", "alpha")
BACKWARD = Look(colour=style.INK, marker=".", size=1.8)


def most_populated(conditions: Sequence[CurveCondition], most: int | None = None) -> list[CurveCondition]:
    """The conditions with most points, in their order; ``most`` of them, by default as many as fit side by side."""
    kept = sorted(conditions, key=lambda c: -len(c.index))[: most or constants.MOST_MAPS_PER_CHANNEL]
    return [c for c in conditions if c in kept]


def rolling(points: Points, conditions: Sequence[CurveCondition]) -> list[CurveCondition]:
    """The points of each condition at which the wheel rolls freely, for maps over sideslip and camber."""
    return _kept(conditions, points.free_rolling)


def driven(points: Points, conditions: Sequence[CurveCondition]) -> list[CurveCondition]:
    """The points of each condition at which the wheel is driven or braked, for maps over slip and sideslip."""
    return _kept(conditions, ~points.free_rolling)


def _kept(conditions: Sequence[CurveCondition], which: np.ndarray) -> list[CurveCondition]:
    found = [replace(c, index=c.index[which[c.index]]) for c in conditions]
    return [c for c in found if len(c.index)]


def residual_maps(
    points: Points,
    residuals: Sequence[tuple[str, np.ndarray]],
    conditions: Sequence[CurveCondition],
    unit: str,
    over: tuple[str, str] = ANGLES,
) -> Sheet:
    """Maps of each residual (title, (n,) array), one per condition; one colour scale for all.

    ``over`` names what lies at the axes, ``("alpha", "gamma")`` or ``("kappa", "alpha")``.
    """
    limit, shown = constants.RESIDUAL_SCALE, most_populated(conditions, constants.MOST_MAPS_OF_BUILD)
    groups = [
        [
            residual_map(points, values, condition, limit, f"{name}: {condition.title}", over=over)
            for condition in shown
        ]
        for name, values in residuals
    ]
    return Sheet(
        rows=in_rows(*groups, columns=min(len(shown), constants.MAPS_PER_ROW)),
        height=1.45,
        scale=ColourScale(limit=limit, label=f"measured − model [{unit}]"),
        left_out=left_undrawn.panels(len(residuals) * (len(conditions) - len(shown))),
    )


def residual_map(
    points: Points,
    values: np.ndarray,
    condition: CurveCondition,
    limit: float,
    title: str,
    frames: Sequence[Frame] = (),
    over: tuple[str, str] = ANGLES,
) -> Panel:
    """One map with the axes of all points; a dot marks a point that was run backwards."""
    rows = condition.index[np.isfinite(values[condition.index])]
    x, y = (shown_values(points, name)[rows] for name in over)
    (left, right), (low, high) = (_all_points(points, name) for name in over)
    y = y + _apart(points, over, x, y, low, high)
    size = 4.5 if len(rows) < constants.CROWDED_MAP else 2.6
    series: list[Map | Trace] = [
        Map(name="measured − model", x=x, y=y, values=np.clip(values[rows], -limit, limit), limit=limit, size=size)
    ]  # fmt: skip
    backward = points.direction[rows] < 0
    if backward.any():
        series.append(Trace(name="run backwards", x=x[backward], y=y[backward], look=BACKWARD))
    x_axis, y_axis = (labels.angle_axis(name).label for name in over)
    return Panel(
        title=title,
        x=Axis(label=x_axis, low=left, high=right),
        y=Axis(label=y_axis, low=low, high=high, ticks=4),
        series=series,
        frames=frames,
    )


def _apart(
    points: Points, over: tuple[str, str], x: np.ndarray, y: np.ndarray, low: float, high: float
) -> np.ndarray:
    """Shift upwards (k,) that keeps points at one place from covering each other, within the axis and away from its ends."""
    steps = beside(x / (constants.SLIP_SHOWN_APART if over[0] == "kappa" else 1.0), y)
    step = constants.NEIGHBOUR_SHIFT * max(float(np.ptp(shown_values(points, over[1]))), 1.0)
    room = np.where(steps > 0.0, high - y, y - low)
    needed = np.abs(steps) * step
    crowded = needed > room
    if crowded.any():
        step *= constants.SHARE_OF_ROOM * float(np.min((room / np.maximum(needed, 1e-9))[crowded]))
    return steps * step


def beside(alpha: np.ndarray, gamma: np.ndarray) -> np.ndarray:
    """Shift (n,), in steps, that keeps points with equal angles from covering each other: 0, +1, -1, +2..."""
    key = np.round(alpha, 1) * 1000.0 + np.round(gamma, 1)
    order = np.argsort(key, kind="stable")
    first = np.r_[True, np.diff(key[order]) != 0]
    start = np.maximum.accumulate(np.where(first, np.arange(len(order)), 0))
    rank = np.empty(len(order))
    rank[order] = np.arange(len(order)) - start
    return np.where(rank % 2 == 1, 1.0, -1.0) * np.ceil(rank / 2.0)


def _all_points(points: Points, over: str) -> tuple[float, float]:
    """Ends of an axis [deg, -] that holds all points, so that maps can be compared."""
    values = shown_values(points, over)
    low, high = float(values.min()), float(values.max())
    room = 0.08 * (high - low if over == "kappa" else max(high - low, 2.0))
    return low - room, high + room
