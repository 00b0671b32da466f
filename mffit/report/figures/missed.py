"""The model error: smooth and alike in all sweeps."""

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from mffit.constants import COVERAGE_FACTOR_95, STEPS_OF_LINE
from mffit.linearised import LinearisedChannel
from mffit.linearised.inputs import LEVELS, swept_of
from mffit.points import Points
from mffit.prediction.conditions import UNITS
from mffit.quantities import CHANNELS, COLUMNS, CONDITIONS, column
from mffit.report import style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import NOTHING, ZERO, Axis, Look, Note, Panel, Sheet, Trace, both_sides
from mffit.results import BuildResult

SHARES = (0.1, 0.5, 0.9)
"""Quantiles of a condition, in the sweeps over another, for which lines are drawn."""
NOISE = Look(colour=style.FAINT, line=":", width=0.8)
"""Of the lines that show the noise of a reading."""
ROOM = 0.35
"""Room for their names, over the range of the axis."""
LINE_OF_TEXT = 0.11
"""Height of a line of text over that of a panel."""


def missed(view: BuildView) -> Sheet:
    """A row for every channel that the formula is proven to miss: over what misses most, a panel per other condition."""
    linear = view.build.remains.linear
    rows = [
        [
            _panel(view.build, channel, over, by, levels, is_first=not k)
            for k, (by, levels) in enumerate(lines)
        ]
        for channel in (linear.channels.values() if linear else ())
        if channel.is_proven
        for over, lines in [_lines(view.points, channel)]
    ]
    return Sheet(rows=rows, height=1.6) if any(rows) else NOTHING


def _lines(points: Points, channel: LinearisedChannel) -> tuple[str, list[tuple[str, list[float]]]]:
    """Column of the swept condition over which the model error changes most, and those that surely change it, or most.

    The latter with the values of their lines, which sweeps over the former held; first those with more than one.
    """
    by_name = {one.name: one for one in channel.smooth.inputs}
    found = [by_name[name] for name in channel.missed_over if COLUMNS.get(name) in UNITS]
    found = found[: max(2, sum(one.name in channel.proven_over for one in found))]
    over, *others = sorted(found, key=lambda one: one.is_held or one.name not in LEVELS)
    points = points.select(channel.rows)
    moved = swept_of(points, channel.smooth.inputs)
    rows = np.flatnonzero([moved[sweep] == over.name for sweep in points.sweep])
    lines = []
    for by in (COLUMNS[one.name] for one in others):
        held = points.condition(by)[rows if len(rows) else slice(None)]
        values = np.nanquantile(held, SHARES, method="nearest").tolist()
        lines.append((by, [*{CONDITIONS[by].of(value): value for value in values}.values()]))
    several = [one for one in lines if len(one[1]) > 1]
    return COLUMNS[over.name], several or lines[:1]


def _panel(
    build: BuildResult,
    channel: LinearisedChannel,
    over: str,
    by: str,
    levels: Sequence[float],
    *,
    is_first: bool,
) -> Panel:
    """Lines over one condition at some values of another, everything else in the middle."""
    points, name = build.points.select(channel.rows), channel.name
    values = {known: points.condition(known) for known in COLUMNS.values() if known in UNITS}
    usual = {known: float(np.nanmedian(x)) for known, x in values.items() if np.any(np.isfinite(x))}
    along = np.linspace(np.nanmin(values[over]), np.nanmax(values[over]), STEPS_OF_LINE)
    unit, series = CHANNELS[name].unit, list[Trace]()
    for value, colour in style.ramp(levels).items():
        at = pd.DataFrame({**usual, over: along, by: value}, index=range(len(along)))
        assert build.prediction is not None
        found = build.prediction.predict(build.fit.tyre, build.fit.tyre, at, [name])
        series.append(
            Trace(
                name=CONDITIONS[by].of(value),
                x=along,
                y=(found[column(name, "best")] - found[column(name)]).to_numpy(),
                half=COVERAGE_FACTOR_95 * found[f"u_{column(name, 'best')}"].to_numpy(),
                look=Look(colour=colour, line="-", opacity=style.SHADE),
            )
        )
    size = f"missed [{unit}], noise {float(f'{channel.noise:.2g}'):g}"
    return Panel(
        title=f"{name}, by {CONDITIONS[by].word}",
        x=Axis(label=CONDITIONS[over].axis, low=float(along[0]), high=_beyond(along, ROOM)),
        y=Axis(label=size if is_first else ""),
        series=series,
        guides=[ZERO, *both_sides("y", channel.noise, NOISE)],
        notes=list(_names(series)),
    )


def _names(series: Sequence[Trace]) -> Iterator[Note]:
    """The name of every line behind its end, none over another."""
    low = min(float(np.min(one.y - one.half)) for one in series if one.half is not None)
    high = max(float(np.max(one.y + one.half)) for one in series if one.half is not None)
    place = low
    for one in sorted(series, key=lambda one: float(one.y[-1])):
        place = max(place + LINE_OF_TEXT * (high - low), float(one.y[-1]))
        yield Note(x=_beyond(one.x, 0.02), y=place, text=one.name, colour=one.look.colour)


def _beyond(x: np.ndarray, share: float) -> float:
    return float(x[-1] + share * (x[-1] - x[0]))
