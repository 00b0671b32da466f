"""How certain the fitted curves are, over the ranges of the file."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mffit.points import make_points
from mffit.quantities import CHANNELS
from mffit.report import labels, style
from mffit.report.build_view import BuildView
from mffit.rig import Simulation

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEPS = 81


def bands(view: BuildView) -> Figure:
    """Fy and Mz with 95 % bands over sideslip and over camber, the other angle 0, at three loads, on a straight path."""
    from matplotlib.lines import Line2D

    files = view.files
    assert files is not None
    written, tested = files.written, files.tested
    loads = [written["FZMIN"], float(view.model["FNOMIN"]), written["FZMAX"]]
    colours = style.ramp(loads)
    figure, rows = style.panel_grid([4], 4, height=2.3)
    tyre = Simulation.of(view.model, turn_slip=view.on_disc)
    for pair, over in ((rows[0][0::2], "gamma"), (rows[0][1::2], "alpha")):
        end = "CAMMAX" if over == "gamma" else "ALPMAX"
        x = np.linspace(-written[end], written[end], STEPS)
        for load in loads:
            alpha, gamma = (np.zeros(STEPS), x) if over == "gamma" else (x, np.zeros(STEPS))
            where = make_points(alpha, gamma, load, p=float(view.model["NOMPRES"]), V=10.0, phi_t=0.0)
            lines, halves = tyre.readings(where), view.posterior.band(tyre, where)
            for ax, line, half in zip(pair, lines, halves, strict=True):
                ax.fill_between(
                    np.degrees(x), line - half, line + half, color=colours[load], alpha=0.25, lw=0
                )
                ax.plot(np.degrees(x), line, color=colours[load], lw=1.0)
        for ax, channel in zip(pair, CHANNELS, strict=True):
            for edge in (-1.0, 1.0):
                ax.axvline(np.degrees(edge * tested[end]), color=style.FAINT, lw=0.8, ls=":")
            ax.set_title(CHANNELS[channel].short_axis)
            ax.set_xlabel(labels.ANGLES[over].axis, labelpad=1.5)
            style.few_ticks(ax, x=4)
    handles = [Line2D([], [], color=colours[load], label=labels.LOAD.of(load)) for load in loads]
    style.legend_above(figure, handles)
    return figure
