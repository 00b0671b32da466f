"""How every picture looks: colours, type, panel grids. The only place that knows matplotlib's settings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK = "#1c2833"
MUTED = "#5d6d7b"
FAINT = "#a9b4be"
GRID = "#e3e8ec"
ACCENT = "#0b62a4"
CONTRAST = "#c4501b"
CALM = "#2b8a6e"

DIVERGING = "RdBu_r"
"""Blue and red, which deuteranopes and protanopes tell apart; white is "within the noise"."""

SCALE = "scale of colours"
"""Label of the axes that show what colours mean."""

DPI = 110
WIDTH = 11.0  # inch; the page scales pictures down, never up

SETTINGS: Any = {
    "font.family": ["DejaVu Sans"],  # comes with matplotlib, so pictures are the same on every machine
    "font.size": 8.0,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.titlepad": 4.0,
    "axes.labelsize": 8.0,
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": GRID,
    "grid.linewidth": 0.7,
    "text.color": INK,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "xtick.labelsize": 7.5,
    "ytick.labelsize": 7.5,
    "xtick.major.size": 2.5,
    "ytick.major.size": 2.5,
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "lines.linewidth": 1.3,
    "lines.markersize": 3.6,
    "figure.facecolor": "white",
    "savefig.dpi": DPI,
}


@contextmanager
def applied() -> Iterator[None]:
    """Draw with the report's settings and leave the caller's untouched."""
    import matplotlib

    with matplotlib.rc_context(SETTINGS):
        yield


def panel_grid(
    groups: Sequence[int],
    columns: int,
    *,
    height: float = 1.75,
    share_x: Any = False,
    share_y: Any = False,
    legend: bool = True,
    gap: tuple[float, float] = (0.45, 0.62),
    margins: tuple[float, float] = (0.70, 0.12),
) -> tuple[Figure, list[list[Axes]]]:
    """A figure with rows of at most ``columns`` panels; every group starts a new row.

    Sizes are in inches. The margins are fixed because a layout engine would draw every panel twice.
    """
    from matplotlib.figure import Figure

    columns = max(1, min(columns, max(groups)))
    filled = [min(columns, count - start) for count in groups for start in range(0, count, columns)]
    top, bottom = 0.30 + (0.28 if legend else 0.0), 0.44
    tall = top + bottom + len(filled) * height + (len(filled) - 1) * gap[1]
    figure = Figure(figsize=(WIDTH, tall))
    panel = (WIDTH - margins[0] - margins[1] - (columns - 1) * gap[0]) / columns
    grid = figure.add_gridspec(
        len(filled),
        columns,
        left=margins[0] / WIDTH,
        right=1.0 - margins[1] / WIDTH,
        top=1.0 - top / tall,
        bottom=bottom / tall,
        wspace=gap[0] / panel,
        hspace=gap[1] / height,
    )
    axes = grid.subplots(sharex=share_x, sharey=share_y, squeeze=False)
    for row, used in zip(axes, filled, strict=True):
        for unused in row[used:]:
            unused.remove()
    return figure, [list(row[:used]) for row, used in zip(axes, filled, strict=True)]


def label_left(rows: list[list[Axes]], label: str) -> None:
    """The vertical label, shown at the left edge only, in line however wide the numbers are."""
    for row in rows:
        for ax in row:
            wide = ax.get_position().width * WIDTH
            ax.set_ylabel(label)
            ax.yaxis.set_label_coords(-0.50 / wide, 0.5)
            ax.yaxis.label.set_visible(ax is row[0])
            ax.yaxis.label.set_gid(IN_LINE)


def label_below(rows: list[list[Axes]], label: str) -> None:
    """The horizontal label of every panel, shown below the last row only."""
    for row in rows:
        for ax in row:
            ax.set_xlabel(label)
            ax.xaxis.label.set_visible(row is rows[-1])


IN_LINE = "in-line"
"""Marks a label with a place of its own."""


def narrowed(figure: Figure, factor: float) -> None:
    """Draw the figure less wide with letters of the same size."""
    figure.set_size_inches(factor * figure.get_figwidth(), figure.get_figheight())
    for ax in figure.axes:
        if ax.yaxis.label.get_gid() == IN_LINE:
            x, y = ax.yaxis.label.get_position()
            ax.yaxis.set_label_coords(x / factor, y)


def stand_alone(figure: Figure) -> None:
    """Show the labels and numbers that panels share with their neighbours at every one of them."""
    for ax in figure.axes:
        ax.xaxis.label.set_visible(True)
        ax.yaxis.label.set_visible(True)
        if len(ax.get_shared_x_axes().get_siblings(ax)) > 1:
            ax.tick_params(labelbottom=True)
        if len(ax.get_shared_y_axes().get_siblings(ax)) > 1:
            ax.tick_params(labelleft=True)


def legend_above(figure: Figure, handles: list[Any]) -> None:
    """One legend for the whole figure, at its top left."""
    figure.legend(
        handles=handles,
        loc="upper left",
        bbox_to_anchor=(0.055, 1.0),
        ncols=min(len(handles), 11),
        handlelength=1.6,
        columnspacing=1.6,
        borderaxespad=0.3,
    )


def few_ticks(ax: Axes, *, x: int = 5, y: int = 5) -> None:
    """Round numbers, few of them: ticks are most of the time a panel takes to draw."""
    from matplotlib.ticker import MaxNLocator

    ax.xaxis.set_major_locator(MaxNLocator(x, steps=[1, 2, 4, 5, 10]))
    ax.yaxis.set_major_locator(MaxNLocator(y, steps=[1, 2, 2.5, 5, 10]))


def ramp(levels: list[float]) -> dict[float, Any]:
    """A colour per level, dark to light in order; readable in grey and with any colour vision."""
    import matplotlib

    shades = matplotlib.colormaps["viridis"](np.linspace(0.0, 0.80, max(len(levels), 1)))
    return {level: tuple(shade) for level, shade in zip(sorted(levels), shades, strict=False)}


def save(figure: Figure, path: Path) -> None:
    """Write a PNG without time stamp, so that the same data give the same file."""
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
