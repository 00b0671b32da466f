"""Many tyres side by side: eps_gamma three ways, and each stiffness and peak with its uncertainty."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from mffit.fleet import EPSILON, Fleet
from mffit.quantities import COMPARED
from mffit.report import labels, style

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from tir import Quantity

LOOKS = {"direct": (style.FAINT, "s"), "alone": (style.CALM, "D"), "together": (style.ACCENT, "o")}
APART = 0.22
"""Distance of the estimates of one tyre, in distances of two tyres."""


def epsilon_of_all(found: Fleet) -> Figure:
    """Camber reduction factor of every specimen, by each estimate; every bar is one standard uncertainty."""
    figure, rows = style.panel_grid([1], 1, height=2.8)
    ax = rows[0][0]
    for k, (key, words) in enumerate(EPSILON.items()):
        colour, marker = LOOKS[key]
        _bars(ax, found.numbers(key), APART * (k - 1), colour, marker, words)
    ax.set_ylabel(labels.EPSILON.axis)
    _names(ax, found)
    style.legend_above(figure, ax.get_legend_handles_labels()[0])
    return figure


def numbers_of_all(found: Fleet) -> Figure:
    """Stiffnesses and peaks of every specimen."""
    figure, rows = style.panel_grid([len(COMPARED)], 3, height=1.9, legend=False, gap=(0.62, 0.95))
    panels = [ax for row in rows for ax in row]
    for ax, (key, quantity) in zip(panels, COMPARED.items(), strict=True):
        _bars(ax, found.numbers(key), 0.0, style.ACCENT, "o", "")
        ax.set_title(quantity.column(f"{quantity.word} {quantity.mathtext}"))
        _names(ax, found)
    return figure


def _bars(
    ax: Axes, numbers: list[Quantity | None], shift: float, colour: str, marker: str, words: str
) -> None:
    known = [(i, q) for i, q in enumerate(numbers) if q is not None]
    ax.errorbar(
        [i + shift for i, _ in known],
        [q.value for _, q in known],
        yerr=[q.u for _, q in known],
        ls="none",
        marker=marker,
        color=colour,
        ms=4.0,
        lw=1.2,
        label=words,
    )


def _names(ax: Axes, found: Fleet) -> None:
    """Numbers of the table's rows: names would not fit beside each other."""
    n = len(found.rows)
    step = max(1, n // 16)
    ax.set_xticks(np.arange(0, n, step), [str(i + 1) for i in range(0, n, step)])
    ax.set_xlim(-0.6, n - 0.4)
