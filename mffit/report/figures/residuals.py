"""Where the model misses: measured minus model over sideslip and camber, one map per load and pressure."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.points import Points
from mffit.report import constants, labels, style
from mffit.report.build_view import BuildView
from mffit.report.curves import CurveCondition, shown_values
from mffit.report.drawing.records import Axis, ColourScale, Look, Panel, Sheet, Trace, in_rows

SLIPS = ("kappa", "alpha")
Framed = tuple[tuple[float, float] | None, tuple[float, float] | None]
"""A region of a map by its ranges along both axes; None reaches to the ends of the axis."""
FRAME = Look(line="--", width=1.0)
READING = Look(marker="s", size=4.0)
BACKWARD = Look(colour=style.INK, marker=".", size=1.8)


def of_wheel(
    points: Points, conditions: Sequence[CurveCondition], over: tuple[str, str]
) -> list[CurveCondition]:
    """The points of each condition where the wheel rolls freely, for maps over both angles, or else is driven or braked."""
    which = points.free_rolling if over == labels.ANGLES else ~points.free_rolling
    found = [replace(c, index=c.index[which[c.index]]) for c in conditions]
    return [c for c in found if len(c.index)]


def residual_maps(view: BuildView) -> Sheet:
    """A map of every channel and condition, of the freely rolling and of the driven wheel; one colour scale for all."""
    groups = [
        [
            residual_map(view.points, values, condition, f"{name}: {condition.title}", over=over)
            for condition in of_wheel(view.points, view.conditions, over)
        ]
        for over in (labels.ANGLES, SLIPS)
        for name, values in view.scaled
    ]
    return Sheet(
        rows=in_rows(*groups),
        height=1.45,
        scale=ColourScale(limit=constants.RESIDUAL_SCALE, label=f"measured − model [{view.residual_unit}]"),
    )


def residual_map(
    points: Points,
    values: np.ndarray,
    condition: CurveCondition,
    title: str,
    frames: Sequence[Framed] = (),
    over: tuple[str, str] = labels.ANGLES,
) -> Panel:
    """One map with the axes of all points; a dot marks a point that was run backwards."""
    rows = condition.index[np.isfinite(values[condition.index])]
    rows = rows[
        np.argsort(np.abs(values[rows]), kind="stable")
    ]  # of readings at one place the worst is on top
    x, y = (shown_values(points, name)[rows] for name in over)
    (left, right), (low, high) = (_all_points(points, name) for name in over)
    series = [Trace(name="measured − model", x=x, y=y, shade=values[rows], look=READING)]
    backward = points.direction[rows] < 0
    if backward.any():
        series.append(Trace(name="run backwards", x=x[backward], y=y[backward], look=BACKWARD))
    for region in frames:
        (a, b), (c, d) = map(_within, region, ((left, right), (low, high)))
        series.append(
            Trace(name="region", x=np.array([a, b, b, a, a]), y=np.array([c, c, d, d, c]), look=FRAME)
        )
    x_axis, y_axis = (labels.angle_axis(name).label for name in over)
    return Panel(
        title=title,
        x=Axis(label=x_axis, low=left, high=right),
        y=Axis(label=y_axis, low=low, high=high),
        series=series,
    )


def _within(bounds: tuple[float, float] | None, ends: tuple[float, float]) -> tuple[float, float]:
    """The part of a range that lies within the ends of its axis, widened so that a single value has a width."""
    low, high = ends
    pad = 0.03 * (high - low)
    return ends if bounds is None else (max(bounds[0] - pad, low), min(bounds[1] + pad, high))


def _all_points(points: Points, over: str) -> tuple[float, float]:
    """Ends of an axis [deg, -] that holds all points, so that maps can be compared."""
    values = shown_values(points, over)
    low, high = float(values.min()), float(values.max())
    room = 0.08 * (high - low if over == "kappa" else max(high - low, 2.0))
    return low - room, high + room
