"""The model against the points: at a glance, and at every load, pressure and camber."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from mffit.points import Points
from mffit.report import labels, style
from mffit.report.build_view import BuildView, ChannelRow
from mffit.report.curves import Curve, CurveLine
from mffit.report.drawing.records import ZERO, Axis, Look, Panel, Sheet, Trace, in_rows
from mffit.rounding import number


class Overlaid(Protocol):
    """Points with the curves and lines through them."""

    @property
    def points(self) -> Points: ...
    @property
    def curves(self) -> Sequence[Curve]: ...
    @property
    def lines(self) -> Mapping[Curve, CurveLine]: ...
    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        """Rows of readings without weight, and of the points of doubtful sweeps."""


MARKS = {
    "no weight": Look(colour=style.CONTRAST, marker="x", size=5.0),
    "doubtful sweep": Look(colour=style.CONTRAST, marker="o", size=5.5, hollow=True),
}
READINGS = Look(colour=style.MUTED, marker="o", size=3.2)
BACKWARD = Look(colour=style.MUTED, marker="v", size=3.6, hollow=True)
MODEL = Look(colour=style.MUTED, line="-", width=1.0)
ANGLES, SLIP = tuple(labels.ANGLES), ("kappa",)
"""What is varied in the two pictures of a channel."""


def varied(curves: Iterable[Curve], over: Collection[str]) -> list[Curve]:
    """The curves over these angles, or over longitudinal slip."""
    return [curve for curve in curves if curve.over in over]


def model_against_points(view: Overlaid, channel: ChannelRow, over: Sequence[str] = ANGLES) -> Sheet:
    """One panel per load, pressure and varied angle (over slip also per camber), coloured by the angle that is held."""
    conditions: dict[tuple[str, float, float, float], list[Curve]] = {}
    for curve in varied(view.curves, over):
        if np.isfinite(channel.measured[curve.index]).any():
            conditions.setdefault((curve.over, curve.load, curve.pressure, curve.camber), []).append(curve)
    drawn = [curve for members in conditions.values() for curve in members]
    colours = {name: style.ramp({c.held for c in drawn if c.over == name}) for name in over}
    cambers = len({camber for *_, camber in conditions}) > 1
    groups = [
        [_panel(view, channel, members, colours[name], cambers) for key, members in sorted(conditions.items()) if key[0] == name]
        for name in over
    ]  # fmt: skip
    key = {"measured": READINGS, "model": MODEL}
    if any(not curve.forward for curve in drawn):
        key["backward"] = replace(BACKWARD, line="--", width=1.0)
    marked = zip(view.marked(channel.name), MARKS.items(), strict=True)
    key |= {name: mark for rows, (name, mark) in marked if len(rows)}
    for name in over:
        if len(colours[name]) > 1:
            key |= held_key(labels.OTHER[name], colours[name])
    remark = "Hollow triangles and dashed lines are runs backwards." if "backward" in key else ""
    return Sheet(rows=in_rows(*groups), height=1.6, key=key, remark=remark)


def held_key(held: str, colours: Mapping[float, str]) -> dict[str, Look]:
    """A colour for every angle that is held."""
    symbol, places = labels.ANGLES[held].symbol, labels.places_of(colours)
    return {
        f"{symbol} = {number(angle, places)}°": Look(colour=colour, line="-", width=3.0)
        for angle, colour in colours.items()
    }


def _panel(
    view: Overlaid, channel: ChannelRow, members: Sequence[Curve], colours: Mapping[float, str], cambers: bool
) -> Panel:
    at = f", {labels.ANGLES['gamma'].symbol} = {number(members[0].camber, 0)}°" if cambers else ""
    return Panel(
        title=f"{members[0].condition}{at}",
        x=labels.angle_axis(members[0].over),
        y=Axis(label=channel.label),
        series=[s for curve in members for s in curve_traces(view, channel, curve, colours[curve.held])],
        guides=[ZERO],
    )


def curve_traces(view: Overlaid, channel: ChannelRow, curve: Curve, colour: str) -> list[Trace]:
    """Readings, marks on those that do not fit, and the model's line."""
    x, read = curve.varied(view.points), channel.measured[curve.index]
    line, held = view.lines[curve], labels.held(curve)
    look = replace(READINGS if curve.forward else BACKWARD, colour=colour)
    found = [Trace(name=f"{curve.sweep}, {held}", x=x, y=read, look=look)]
    for rows, (name, mark) in zip(view.marked(channel.name), MARKS.items(), strict=True):
        here = np.isin(curve.index, rows)
        if here.any():
            found.append(Trace(name=name, x=x[here], y=read[here], look=mark))
    drawn = replace(MODEL, colour=colour, line="-" if curve.forward else "--")
    return [*found, Trace(name=f"model, {held}", x=line.x, y=line.raw[channel.name], look=drawn)]


def overview(view: BuildView) -> Sheet:
    """Readings and model of each channel over what was varied most, coloured by the angle that is held."""
    chosen = {over: _nearest(view, over) for over in (*labels.ANGLES, "kappa")}
    panels = []
    for channel in view.channels:
        first = ("kappa", "alpha", "gamma") if channel.name == "Fx" else ("alpha", "gamma", "kappa")
        panels += [_glance(view, channel, chosen[over]) for over in first if chosen[over]][:1]
    if len(panels) < len(chosen) and chosen["gamma"] and chosen["alpha"]:
        panels += [_glance(view, channel, chosen["gamma"]) for channel in view.channels[:1]]
    return Sheet(rows=in_rows(panels, columns=4), height=2.2, key={"measured": READINGS, "model": MODEL})


def _nearest(view: BuildView, over: str) -> list[Curve]:
    """Forward curves over an angle or slip at the load and pressure nearest to the nominal ones."""
    tyre, upright = (
        view.config.tyre,
        [c for c in view.curves if c.over == over and c.forward and not c.camber],
    )
    for name, nominal in (("load", tyre.nominal_load), ("pressure", tyre.nominal_pressure)):
        nearest: Mapping[Curve, float] = {c: abs(getattr(c, name) - nominal) for c in upright}
        upright = [c for c in upright if nearest[c] == min(nearest.values())]
    return upright


def _glance(view: BuildView, channel: ChannelRow, members: list[Curve]) -> Panel:
    return _panel(view, channel, members, style.ramp({curve.held for curve in members}), False)
