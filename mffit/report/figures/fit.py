"""The model against the points: at a glance, and at every load, pressure and camber."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from mffit.quantities import CHANNELS
from mffit.report import labels, style
from mffit.report.build_view import BuildView, ChannelRow, Overlay
from mffit.report.curves import Curve
from mffit.report.drawing.records import NOTHING, Look, Panel, Sheet, Trace, in_rows

MARKS = {
    "no weight": Look(colour=style.CONTRAST, marker="x", size=5.0),
    "doubtful sweep": Look(colour=style.CONTRAST, marker="o", size=5.5, hollow=True),
}
READINGS = Look(colour=style.MUTED, marker="o", size=3.2)
BACKWARD = Look(colour=style.MUTED, marker="v", size=3.6, hollow=True)
MODEL = Look(colour=style.MUTED, line="-", width=1.0)


def model_against_points(view: Overlay, channel: ChannelRow) -> Sheet:
    """One panel per load, pressure and what is varied (over slip also per camber), coloured by the angle that is held."""
    conditions: dict[tuple[str, float, float, float], list[Curve]] = {}
    for curve in view.curves:
        if np.isfinite(channel.measured[curve.index]).any():
            conditions.setdefault((curve.over, curve.load, curve.pressure, curve.camber), []).append(curve)
    drawn = [curve for members in conditions.values() for curve in members]
    colours = _ramps(drawn)
    cambers = {over: len({key[3] for key in conditions if key[0] == over}) > 1 for over in labels.OTHER}
    groups = [
        [
            _panel(view, channel, members, colours[labels.OTHER[over]], cambers[over])
            for key, members in sorted(conditions.items())
            if key[0] == over
        ]
        for over in labels.OTHER
    ]
    key = {"measured": READINGS, "model": MODEL}
    if any(not curve.forward for curve in drawn):
        key["backward"] = replace(BACKWARD, line="--", width=1.0)
    marked = zip(view.marked(channel.name), MARKS.items(), strict=True)
    key |= {name: mark for rows, (name, mark) in marked if len(rows)}
    key |= _keys(colours)
    remark = "Hollow triangles and dashed lines are runs backwards." if "backward" in key else ""
    return Sheet(rows=in_rows(*groups), height=1.6, key=key, remark=remark)


def _of_channel(view: Overlay, *, name: str) -> Sheet:
    return next((model_against_points(view, c) for c in view.channels if c.name == name), NOTHING)


OF_CHANNELS: Mapping[str, Callable[[Overlay], Sheet]] = {
    f"fit_{name}": partial(_of_channel, name=name) for name in CHANNELS
}
"""Pictures of a fit, and of a file over readings."""


def held_key(held: str, colours: Mapping[float, str]) -> dict[str, Look]:
    """A colour for every angle that is held."""
    digits = 0 if all(round(x, 1) == round(x) for x in colours) else 1
    return {
        labels.angle(held, angle, digits): Look(colour=colour, line="-", width=3.0)
        for angle, colour in colours.items()
    }


def _panel(
    view: Overlay, channel: ChannelRow, members: Sequence[Curve], colours: Mapping[float, str], cambers: bool
) -> Panel:
    at = f", {labels.angle('gamma', members[0].camber)}" if cambers else ""
    series = [s for curve in members for s in curve_traces(view, channel, curve, colours[curve.held])]
    return labels.over_angle(members[0].over, channel.name, f"{members[0].condition}{at}", series)


def curve_traces(view: Overlay, channel: ChannelRow, curve: Curve, colour: str) -> list[Trace]:
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
    forward = [c for c in view.curves if c.forward and not c.camber]
    chosen = {
        over: view.nearest((c for c in forward if c.over == over), "load", "pressure")
        for over in labels.OTHER
    }
    found = []
    for channel in view.channels:
        first = ("kappa", "alpha", "gamma") if channel.name == "Fx" else ("alpha", "gamma", "kappa")
        found += [(channel, chosen[over]) for over in first if chosen[over]][:1]
    if len(found) < len(chosen) and chosen["gamma"] and chosen["alpha"]:
        found += [(channel, chosen["gamma"]) for channel in view.channels[:1]]
    ramps = _ramps([curve for _, members in found for curve in members])
    panels = [_panel(view, channel, members, ramps[_held(members[0])], False) for channel, members in found]
    key = {"measured": READINGS, "model": MODEL, **_keys(ramps)}
    return Sheet(rows=in_rows(panels, columns=4), height=2.2, key=key)


def _held(curve: Curve) -> str:
    """The angle that a curve holds."""
    return labels.OTHER[curve.over]


def _ramps(drawn: Sequence[Curve]) -> dict[str, dict[float, str]]:
    """By angle that is held, the colour of each of its values; a single one needs no colour of its own, nor a key."""
    found = {}
    for name, colours in {"gamma": style.COLD, "alpha": style.WARM}.items():
        values = {c.held for c in drawn if _held(c) == name}
        found[name] = style.ramp(values, colours) if len(values) > 1 else dict.fromkeys(values, style.MUTED)
    return found


def _keys(ramps: Mapping[str, Mapping[float, str]]) -> dict[str, Look]:
    """What the colours of angles mean, if they differ."""
    return {
        name: look
        for held, ramp in ramps.items()
        if len(ramp) > 1
        for name, look in held_key(held, ramp).items()
    }
