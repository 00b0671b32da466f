"""How certain the fitted curves are, over the ranges of the file."""

from __future__ import annotations

import numpy as np

from mffit.points import make_points
from mffit.quantities import CHANNELS, SIDEWAYS
from mffit.report import constants, labels, style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import Axis, Band, Guide, Look, Panel, Sheet, Trace
from mffit.rig import Simulation

LIMITS = {"gamma": "CAMMAX", "alpha": "ALPMAX"}
"""The file's key for the end of an angle's range."""


def tested_edges(tested: float) -> list[Guide]:
    """Dotted lines at both ends of the tested range [rad]."""
    dotted = Look(colour=style.FAINT, line=":", width=0.8)
    return [Guide(axis="x", at=side * float(np.degrees(tested)), look=dotted) for side in (-1.0, 1.0)]


def bands(view: BuildView) -> Sheet:
    """Fy and Mz with 95 % bands over camber and over sideslip, the other angle zero, at three loads, on a straight path."""
    files = view.files
    assert files is not None
    written = files.written
    loads = [written["FZMIN"], float(view.model["FNOMIN"]), written["FZMAX"]]
    colours = style.ramp(loads)
    panels = []
    for over, end in LIMITS.items():
        x = np.linspace(-written[end], written[end], constants.STEPS_OF_FILE_CURVE)
        found = {load: _with_halves(view, over, x, load) for load in loads}
        for name in SIDEWAYS:
            series: list[Band | Trace] = []
            for load, (lines, halves) in found.items():
                line, half, colour = lines[name], halves[name], colours[load]
                at, said = np.degrees(x), labels.LOAD.of(load)
                series += [
                    Band(name=said, x=at, low=line - half, high=line + half, look=Look(colour=colour, opacity=0.25)),
                    Trace(name=said, x=at, y=line, look=Look(colour=colour, line="-", width=1.0)),
                ]  # fmt: skip
            panels.append(
                Panel(
                    title=CHANNELS[name].short_axis,
                    x=labels.angle_axis(over),
                    y=Axis(),
                    series=series,
                    guides=tested_edges(files.tested[end]),
                )
            )
    key = {labels.LOAD.of(load): Look(colour=colours[load], line="-") for load in loads}
    return Sheet(rows=[panels], height=2.1, key=key)


def _with_halves(view: BuildView, over: str, x: np.ndarray, load: float) -> tuple:
    """By channel the model's curve, and half the width of its band."""
    tyre = Simulation.of(view.model, turn_slip=view.on_disc)
    none = np.zeros_like(x)
    alpha, gamma = (none, x) if over == "gamma" else (x, none)
    where = make_points(alpha, gamma, load, p=float(view.model["NOMPRES"]), V=10.0, phi_t=0.0)
    return tyre.readings(where), view.posterior.band(tyre, where)
