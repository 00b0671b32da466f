"""The fit at a glance: every channel at the load and pressure nearest to the nominal ones."""

from __future__ import annotations

from collections.abc import Mapping

from mffit.report import labels
from mffit.report.build_view import BuildView, ChannelRow
from mffit.report.curves import Curve
from mffit.report.drawing.records import ZERO, Axis, Panel, Sheet, in_rows
from mffit.report.figures.fit import MODEL, READINGS, curve_traces
from mffit.report.style import ramp


def overview(view: BuildView) -> Sheet:
    """Readings and model of each channel over what was varied most, coloured by the angle that is held."""
    chosen = {over: _nearest(view, over) for over in (*labels.ANGLES, "kappa")}
    panels = []
    for channel in view.channels:
        first = ("kappa", "alpha", "gamma") if channel.name == "Fx" else ("alpha", "gamma", "kappa")
        panels += [_panel(view, channel, chosen[over]) for over in first if chosen[over]][:1]
    if len(panels) < len(chosen) and chosen["gamma"] and chosen["alpha"]:
        panels += [_panel(view, channel, chosen["gamma"]) for channel in view.channels[:1]]
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


def _panel(view: BuildView, channel: ChannelRow, members: list[Curve]) -> Panel:
    colours = ramp({curve.held for curve in members})
    return Panel(
        title=members[0].condition,
        x=labels.angle_axis(members[0].over),
        y=Axis(label=channel.label),
        series=[s for curve in members for s in curve_traces(view, channel, curve, colours[curve.held])],
        guides=[ZERO],
    )
