"""A recording over time: settings and forces, with the stretches that give points and those that do not."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mffit.points.steady import gaps
from mffit.points.stretch import MOVE, StretchNote
from mffit.report import style
from mffit.sweeps import Sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_SAMPLES = 6000
"""Drawn of a recording; more would only thicken the lines."""
GAP_DRAWN = 0.004
"""Width of a gap in time, per width of the picture."""


def recording(sweep: Sweep, notes: list[StretchNote]) -> Figure:
    """One panel per channel, gaps in time closed up and marked.

    Parameters
    ----------
    sweep : a series in ISO-W and SI
    notes : its stretches
    """
    channels = (
        ("sideslip [deg]", np.degrees(sweep.alpha)),
        ("camber [deg]", np.degrees(sweep.gamma)),
        ("load [N]", sweep.Fz),
        ("pressure [kPa]", sweep.p / 1e3),
        ("tread [degC]", sweep.T),
        ("side force [N]", sweep.Fy),
        ("moment [Nm]", sweep.Mz),
    )
    rows = tuple((name, x) for name, x in channels if np.any(np.isfinite(x)))
    figure, grid = style.panel_grid([1] * len(rows), 1, height=0.85, legend=True)
    panels = [row[0] for row in grid]
    drawn = _clock(sweep.time)
    some = np.linspace(0, len(sweep) - 1, min(len(sweep), MOST_SAMPLES)).astype(int)
    breaks = gaps(sweep.time)
    for ax, (name, values) in zip(panels, rows, strict=True):
        for note in notes:
            first, last = np.searchsorted(sweep.time, [note.begin_s, note.end_s])
            if note.kind == MOVE and not note.dropped:
                continue
            colour = style.CALM if note.points else style.CONTRAST
            ax.axvspan(drawn[first], drawn[min(last, len(drawn) - 1)], color=colour, alpha=0.13, lw=0)
        shown = values[some].astype(float)
        broken = np.searchsorted(some, breaks)
        ax.plot(
            np.insert(drawn[some], broken, drawn[some][broken.clip(max=len(some) - 1)]),
            np.insert(shown, broken, np.nan),
            color=style.INK,
            lw=0.6,
        )
        ax.set_ylabel(name)
        ax.margins(x=0.005)
        if ax is not panels[-1]:
            ax.set_xticklabels([])
    panels[-1].set_xlabel("time, gaps closed up [s]")
    style.legend_above(figure, _legend(notes))
    return figure


def _clock(time: np.ndarray) -> np.ndarray:
    """Time (n,) from zero with every gap shrunk to a sliver."""
    steps = np.diff(time)
    at = gaps(time) - 1
    held = float(np.sum(steps) - np.sum(steps[at]))
    steps[at] = GAP_DRAWN * held
    return np.r_[0.0, np.cumsum(steps)]


def _legend(notes: list[StretchNote]) -> list:
    from matplotlib.patches import Patch

    kept, dropped = sum(note.points > 0 for note in notes), sum(note.points == 0 for note in notes)
    return [
        Patch(color=style.CALM, alpha=0.3, label=f"{kept} stretches give points"),
        Patch(color=style.CONTRAST, alpha=0.3, label=f"{dropped} stretches give none"),
    ]
