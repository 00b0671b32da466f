"""Two files' curves over each other, and what differs in units of its uncertainty."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mffit.comparison import Comparison, wording
from mffit.comparison.constants import SIGNIFICANT_DIFFERENCE
from mffit.quantities import CHANNELS
from mffit.report import labels, style

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST = 18
"""Differences drawn at most."""


def curves(found: Comparison, channel: str) -> Figure:
    """Both curves with their 95 % bands over sideslip and over camber, a panel per load."""
    from matplotlib.lines import Line2D

    gaps = sorted((g for g in found.curves if g.channel == channel), key=lambda g: (g.over, g.load))
    groups = [n for n in (sum(g.over == over for g in gaps) for over in labels.ANGLES) if n]
    figure, rows = style.panel_grid(groups, max(groups), height=1.9)
    for ax, gap in zip((ax for row in rows for ax in row), gaps, strict=True):
        x = np.degrees(gap.x)
        ax.axhline(0.0, color=style.FAINT, lw=0.8)
        sides = (
            (gap.first, gap.half_first, style.ACCENT, "-"),
            (gap.second, gap.half_second, style.CONTRAST, "--"),
        )
        for line, half, colour, dashes in sides:
            if half is not None:
                ax.fill_between(x, line - half, line + half, color=colour, alpha=0.2, lw=0)
            ax.plot(x, line, dashes, color=colour, lw=1.2)
        ax.set_title(f"{labels.LOAD.of(gap.load)}, apart by {gap.rms:.3g} {CHANNELS[channel].unit} rms")
        ax.set_xlabel(labels.ANGLES[gap.over].axis, labelpad=1.5)
        style.few_ticks(ax, x=4)
    style.label_left(rows, CHANNELS[channel].short_axis)
    handles = [
        Line2D([], [], color=style.ACCENT, label=found.first),
        Line2D([], [], color=style.CONTRAST, ls="--", label=found.second),
    ]
    style.legend_above(figure, handles)
    return figure


def differences(found: Comparison) -> Figure:
    """The ranked differences over their uncertainties."""
    rows = [row for row in found.numbers if row.z is not None][:MOST][::-1]
    height = 0.20 * len(rows) + 0.3
    figure, panels = style.panel_grid([1], 1, height=height, legend=False, margins=(3.3, 0.30))
    ax = panels[0][0]
    z = [float(row.z or 0.0) for row in rows]
    far = [abs(value) > SIGNIFICANT_DIFFERENCE for value in z]
    ax.barh(range(len(rows)), z, height=0.6, color=[style.CONTRAST if f else style.FAINT for f in far])
    for edge in (-SIGNIFICANT_DIFFERENCE, SIGNIFICANT_DIFFERENCE):
        ax.axvline(edge, color=style.MUTED, lw=0.8, ls="--")
    ax.set_yticks(range(len(rows)), [f"{wording.quantity(row).word}, {wording.place(row)}" for row in rows])
    ax.set_ylim(-0.6, len(rows) - 0.4)
    ax.grid(axis="y", visible=False)
    ax.set_xlabel(f"{found.second} less {found.first}, in standard uncertainties", labelpad=1.5)
    return figure
