"""The written files against the fitted model on a straight path."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mffit.quantities import CHANNELS
from mffit.report import labels, style
from mffit.report.build_view import BuildView
from mffit.report.rounding import number

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEPS = 81
CAMBERS, SIDESLIPS = (0.0, 0.4, 0.8), (0.0, 0.4)
"""Shares of the tested range at which the other angle is held."""


def files_on_a_straight_path(view: BuildView) -> Figure:
    """Fy and Mz of both files over camber and over sideslip at nominal load, the model dotted; bands end where data do."""
    from matplotlib.lines import Line2D

    files = view.files
    assert files is not None
    tested, written = files.tested, files.written
    figure, rows = style.panel_grid([4], 4, height=2.3)
    colours = {"turn-slip": style.ACCENT, "normal": style.CONTRAST, "both": style.MUTED}
    dashes = {"turn-slip": "-", "normal": "--", "both": ":"}
    panels = [(channel, over) for channel in CHANNELS for over in ("gamma", "alpha")]
    load = float(files.by_use["normal"].tyre["FNOMIN"])
    for ax, (channel, over) in zip(rows[0], panels, strict=True):
        end, held_end = ("CAMMAX", "ALPMAX") if over == "gamma" else ("ALPMAX", "CAMMAX")
        other = labels.ANGLES["alpha" if over == "gamma" else "gamma"].symbol
        x = np.linspace(-written[end], written[end], STEPS)
        for share in SIDESLIPS if over == "gamma" else CAMBERS:
            held = np.full(STEPS, share * tested[held_end])
            alpha, gamma = (held, x) if over == "gamma" else (x, held)
            for use, file in files.by_use.items():
                force = getattr(file.tyre(load, alpha, gamma, turn_slip=use == "turn-slip"), channel)
                said = f"{view.file_names[use]}, {other} = {number(np.degrees(held[0]), 1)}°"
                ax.plot(np.degrees(x), force, color=colours[use], lw=1.2, ls=dashes[use], label=said)
            model = getattr(view.model(load, alpha, gamma, turn_slip=True), channel)
            ax.plot(np.degrees(x)[::5], model[::5], ls="none", marker=".", ms=3.0, color=style.INK)
        for edge in (-1.0, 1.0):
            ax.axvline(np.degrees(edge * tested[end]), color=style.FAINT, lw=0.8, ls=":")
        ax.set_title(f"{CHANNELS[channel].short_axis}, {labels.LOAD.of(load)}")
        ax.set_xlabel(labels.ANGLES[over].axis, labelpad=1.5)
        style.few_ticks(ax, x=4)
    handles = [Line2D([], [], ls="none", marker=".", color=style.INK, label="fitted model")]
    handles += [
        Line2D([], [], color=colours[use], ls=dashes[use], label=view.file_names[use]) for use in files.by_use
    ]
    style.legend_above(figure, handles)
    return figure
