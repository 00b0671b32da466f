"""How certain the fitted curves are, over the ranges of the file."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from mffit.fit.files import Files
from mffit.points import make_points
from mffit.quantities import CHANNELS, SIDEWAYS
from mffit.report import constants, labels, style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import Axis, Band, Guide, Look, Panel, Sheet, Trace
from mffit.rig import Simulation

LIMITS = {"gamma": "CAMMAX", "alpha": "ALPMAX"}
"""The file's key for the end of an angle's range."""
SLIP_LIMITS = ("KPUMIN", "KPUMAX")
DOTTED = Look(colour=style.FAINT, line=":", width=0.8)


def tested_edges(tested: float) -> list[Guide]:
    """Dotted lines at both ends of the tested range [rad]."""
    return [Guide(axis="x", at=side * float(np.degrees(tested)), look=DOTTED) for side in (-1.0, 1.0)]


def bands(view: BuildView) -> Sheet:
    """The channels with 95 % bands over camber, over sideslip and over slip if it was run, at three loads on a straight path."""
    files = view.files
    assert files is not None
    written = files.written
    loads = [written["FZMIN"], float(view.model["FNOMIN"]), written["FZMAX"]]
    colours = style.ramp(loads)
    sideways = [
        name for name in CHANNELS if name in SIDEWAYS or (name == "Mx" and name in view.points.measured)
    ]
    rows = [[_panel(view, over, name, colours) for name in sideways] for over in LIMITS]
    if len(sideways) == len(SIDEWAYS):  # both angles beside each other
        rows = [[panel for row in rows for panel in row]]
    if "KPUMAX" in files.tested and "Fx" in view.points.measured:
        driven = [name for name in ("Fx", "Mz") if name in view.points.measured]
        rows.append([_panel(view, "kappa", name, colours) for name in driven])
    key = {labels.LOAD.of(load): Look(colour=colours[load], line="-") for load in loads}
    return Sheet(rows=rows, height=2.1, key=key)


def _panel(view: BuildView, over: str, name: str, colours: Mapping[float, str]) -> Panel:
    files = view.files
    assert files is not None
    x, guides = _ends(files, over)
    at = x if over == "kappa" else np.degrees(x)
    series: list[Band | Trace] = []
    for load, colour in colours.items():
        lines, halves = _with_halves(view, over, x, load, name)
        line, half, said = lines[name], halves[name], labels.LOAD.of(load)
        series += [
            Band(name=said, x=at, low=line - half, high=line + half, look=Look(colour=colour, opacity=0.25)),
            Trace(name=said, x=at, y=line, look=Look(colour=colour, line="-", width=1.0)),
        ]
    return Panel(
        title=CHANNELS[name].short_axis, x=labels.angle_axis(over), y=Axis(), series=series, guides=guides
    )


def _ends(files: Files, over: str) -> tuple[np.ndarray, list[Guide]]:
    """Values [rad, -] (m,) over the range of the file, and the ends of the tested range."""
    if over != "kappa":
        end = files.written[LIMITS[over]]
        return np.linspace(-end, end, constants.STEPS_OF_FILE_CURVE), tested_edges(files.tested[LIMITS[over]])
    low, high = (files.written.get(key, files.tested[key]) for key in SLIP_LIMITS)
    guides = [Guide(axis="x", at=files.tested[key], look=DOTTED) for key in SLIP_LIMITS]
    return np.linspace(low, high, constants.STEPS_OF_FILE_CURVE), guides


def _with_halves(view: BuildView, over: str, x: np.ndarray, load: float, name: str) -> tuple:
    """The model's curve of a channel, and half the width of its band."""
    tyre = Simulation.of(view.model, turn_slip=view.on_disc)
    none = np.zeros_like(x)
    alpha, gamma, kappa = (x if over == varied else none for varied in ("alpha", "gamma", "kappa"))
    nominal = float(view.model["NOMPRES"])
    where = make_points(alpha, gamma, load, kappa=kappa, p=nominal, V=10.0, phi_t=0.0)
    return tyre.readings(where, (name,)), view.posterior.band(tyre, where, (name,))
