"""Longitudinal force that a sister tyre gives to a tyre measured only sideways, and how certain it is."""

from __future__ import annotations

import numpy as np

from mffit.points import make_points
from mffit.quantities import CHANNELS, CONDITIONS, MODEL
from mffit.report import constants, labels, style
from mffit.report.build_view import BuildView
from mffit.report.drawing.records import Axis, Band, Look, Panel, Sheet, Trace
from mffit.rig import Simulation


def borrowed_force(view: BuildView) -> Sheet:
    """Fx over longitudinal slip with 95 % bands at three loads, with and without sideslip, on a straight path."""
    files = view.files
    assert files is not None
    written = files.written
    loads = [written["FZMIN"], float(view.model["FNOMIN"]), written["FZMAX"]]
    colours = style.ramp(loads)
    tyre = Simulation.of(view.model, turn_slip=view.on_disc)
    kappa = np.linspace(-1.0, 1.0, constants.STEPS_OF_FILE_CURVE) * constants.LARGEST_SLIP_TO_DRAW
    panels = []
    for alpha in constants.SIDESLIPS_OF_BORROWED_FORCE:
        series: list[Band | Trace] = []
        for load in loads:
            where = make_points(
                np.full_like(kappa, np.radians(alpha)), 0.0, load, kappa=kappa, p=float(view.model["NOMPRES"]),
                V=10.0, phi_t=0.0,
            )  # fmt: skip
            line = tyre.readings(where, ("Fx",))["Fx"]
            half = view.posterior.band(tyre, where, ("Fx",))["Fx"]
            said, colour = labels.LOAD.of(load), colours[load]
            series += [
                Band(name=said, x=kappa, low=line - half, high=line + half, look=Look(colour=colour, opacity=0.25)),
                Trace(name=said, x=kappa, y=line, look=Look(colour=colour, line="-", width=1.0)),
            ]  # fmt: skip
        panels.append(
            Panel(
                title=f"{CHANNELS['Fx'].short_axis}, {CONDITIONS['alpha_deg'].symbol} = {alpha:.0f}°",
                x=Axis(label=MODEL["kappa"].axis),
                y=Axis(),
                series=series,
            )
        )
    key = {labels.LOAD.of(load): Look(colour=colours[load], line="-") for load in loads}
    return Sheet(rows=[panels], height=2.1, key=key)
