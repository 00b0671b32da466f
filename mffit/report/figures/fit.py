"""The model against the points, at every load, pressure and camber."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from mffit.points import Points
from mffit.report import constants, labels, left_undrawn, style
from mffit.report.build_view import ChannelRow
from mffit.report.curves import Curve
from mffit.report.drawing.records import Axis, Guide, Look, Panel, Sheet, Trace, in_rows
from mffit.report.lines import CurveLine
from mffit.rounding import number


class Overlaid(Protocol):
    """Points with the curves and lines through them."""

    @property
    def points(self) -> Points: ...
    @property
    def curves(self) -> Sequence[Curve]: ...
    @property
    def lines(self) -> Mapping[tuple, CurveLine]: ...
    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        """Rows of readings without weight, and of the points of doubtful sweeps."""


MARKS = {
    "no weight": Look(colour=style.CONTRAST, marker="x", size=5.0),
    "doubtful sweep": Look(colour=style.CONTRAST, marker="o", size=5.5, hollow=True),
}
READINGS = Look(colour=style.MUTED, marker="o", size=3.2)
BACKWARD = Look(colour=style.MUTED, marker="v", size=3.6, hollow=True)
MODEL = Look(colour=style.MUTED, line="-", width=1.0)


def model_against_points(view: Overlaid, channel: ChannelRow) -> Sheet:
    """One panel per load and pressure: first over sideslip, coloured by camber, then over camber."""
    colours = style.ramp({c.held for c in view.curves if c.over == "alpha"})
    conditions = drawn_conditions(view.curves)
    groups = [
        [
            _panel(view, channel, members, colours)
            for (varied, *_), members in conditions.items()
            if varied == over and _has_readings(channel, members)
        ]
        for over in labels.ANGLES
    ]
    small = len(conditions) > constants.PANELS_OF_FULL_SIZE
    columns = 6 if small else 5 if max(map(len, groups)) > 4 else 4
    return Sheet(
        rows=in_rows(*groups, columns=columns),
        height=1.4 if small else 1.75,
        key=_key(view, channel, colours),
        left_out=left_undrawn.points(
            len(view.points), view.curves, [c for members in conditions.values() for c in members]
        ),
    )


def drawn_conditions(curves: Iterable[Curve]) -> dict[tuple[str, float, float], list[Curve]]:
    """The conditions that have a panel, by varied angle, load and pressure; of too many, those with the most points."""
    every = _conditions(curves)
    most = sorted(every, key=lambda key: -sum(len(c.index) for c in every[key]))[
        : constants.MOST_PANELS_OF_FIT
    ]
    return {key: members for key, members in every.items() if key in most}


def _has_readings(channel: ChannelRow, members: Iterable[Curve]) -> bool:
    return any(np.isfinite(channel.measured[curve.index]).any() for curve in members)


def _conditions(curves: Iterable[Curve]) -> dict[tuple[str, float, float], list[Curve]]:
    """The curves by varied angle, load and pressure, in that order."""
    grouped: dict[tuple[str, float, float], list[Curve]] = {}
    for curve in sorted(curves, key=lambda c: (c.over, c.load, c.pressure)):
        grouped.setdefault((curve.over, curve.load, curve.pressure), []).append(curve)
    return grouped


def _panel(
    view: Overlaid, channel: ChannelRow, members: Sequence[Curve], colours: Mapping[float, str]
) -> Panel:
    series = [
        series
        for curve in members
        for series in curve_traces(view, channel, curve, colours[curve.held] if curve.over == "alpha" else style.ACCENT)
    ]  # fmt: skip
    return Panel(
        title=members[0].condition,
        x=labels.angle_axis(members[0].over),
        y=Axis(label=channel.label),
        series=series,
        guides=[Guide(axis="y", at=0.0)],
    )


def curve_traces(view: Overlaid, channel: ChannelRow, curve: Curve, colour: str) -> list[Trace]:
    """Readings, marks on those that do not fit, and the model's line."""
    angle, line = curve.varied(view.points), view.lines[curve.key]
    look = READINGS if curve.forward else BACKWARD
    if len(angle) > constants.DENSE_CURVE:
        look = replace(look, marker=".", size=1.4, hollow=False)
    held = labels.held(curve)
    found = [
        Trace(
            name=f"{curve.sweep}, {held}",
            x=angle,
            y=channel.measured[curve.index],
            look=replace(look, colour=colour),
        )
    ]
    for rows, (name, mark) in zip(view.marked(channel.name), MARKS.items(), strict=True):
        here = np.isin(curve.index, rows)
        if here.any():
            read = channel.measured[curve.index]
            found.append(Trace(name=name, x=angle[here], y=read[here], look=mark))
    drawn = replace(MODEL, colour=colour, line="-" if curve.forward else "--")
    return [*found, Trace(name=f"model, {held}", x=line.x, y=line.raw[channel.name], look=drawn)]


def _key(view: Overlaid, channel: ChannelRow, colours: Mapping[float, str]) -> dict[str, Look]:
    key = {"measured": READINGS, "model": MODEL}
    if any(not c.forward for c in view.curves):
        key["backward"] = replace(BACKWARD, line="--", width=1.0)
    key |= mark_key(view, channel)
    places = labels.places_of(colours)
    symbol = labels.ANGLES["gamma"].symbol
    if len(colours) > 1:
        for camber, colour in colours.items():
            key[f"{symbol} = {number(camber, places)}°"] = Look(colour=colour, line="-", width=3.0)
    return key


def mark_key(view: Overlaid, channel: ChannelRow) -> dict[str, Look]:
    """The marks on readings that do not fit, as far as there are any."""
    marked = zip(view.marked(channel.name), MARKS.items(), strict=True)
    return {name: mark for rows, (name, mark) in marked if len(rows)}
