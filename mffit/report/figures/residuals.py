"""Where the model misses: measured minus model over sideslip and camber, one panel per load and pressure."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mffit.points import Points
from mffit.report import labels, style
from mffit.report.curves import Condition

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

STEP = 0.026
"""Distance at which points with equal angles are drawn beside each other, as a share of the camber range."""


def most_populated(conditions: Sequence[Condition], most: int) -> list[Condition]:
    """At most ``most`` conditions: those with most points, in their order."""
    kept = sorted(conditions, key=lambda c: -len(c.index))[:most]
    return [c for c in conditions if c in kept]


def residual_maps(
    points: Points,
    residuals: Sequence[tuple[str, np.ndarray]],
    conditions: Sequence[Condition],
    limit: float,
    unit: str,
) -> Figure:
    """A row of maps per residual (title, (n,) array), a column per condition; one colour scale for all."""
    shown = most_populated(conditions, 6)
    figure, rows = style.panel_grid(
        [len(shown)] * len(residuals), 6, height=1.45, gap=(0.25, 0.38),
        share_x=True, share_y=True,
    )  # fmt: skip
    set_limits(rows[0][0], points)
    for row, (name, values) in zip(rows, residuals, strict=True):
        for ax, condition in zip(row, shown, strict=True):
            drawn = residual_map(ax, points, values, condition.index, limit)
            ax.set_title(f"{name}: {condition.title}")
    style.label_below(rows, labels.ANGLES["alpha"].axis)
    style.label_left(rows, labels.ANGLES["gamma"].axis)
    colour_bar(figure, drawn, f"measured − model [{unit}]")
    return figure


def residual_map(ax: Axes, points: Points, values: np.ndarray, rows: np.ndarray, limit: float) -> Any:
    """One map; rings are points that were run backward."""
    rows = rows[np.isfinite(values[rows])]
    alpha, gamma = np.degrees(points.alpha[rows]), np.degrees(points.gamma[rows])
    gamma = gamma + STEP * _camber_range(points) * beside(alpha, gamma)
    size = 20 if len(rows) < 300 else 7
    drawn = ax.scatter(
        alpha,
        gamma,
        s=size,
        c=np.clip(values[rows], -limit, limit),
        cmap=style.DIVERGING,
        vmin=-limit,
        vmax=limit,
        marker="s",
        linewidths=0.4,
        edgecolors=style.FAINT,
    )
    backward = points.direction[rows] < 0
    if backward.any():
        ax.scatter(alpha[backward], gamma[backward], s=3, c=style.INK, linewidths=0)
    style.few_ticks(ax, x=4, y=4)
    return drawn


def beside(alpha: np.ndarray, gamma: np.ndarray) -> np.ndarray:
    """Shift (n,), in steps, that keeps points with equal angles from covering each other: 0, +1, -1, +2..."""
    key = np.round(alpha, 1) * 1000.0 + np.round(gamma, 1)
    order = np.argsort(key, kind="stable")
    first = np.r_[True, np.diff(key[order]) != 0]
    start = np.maximum.accumulate(np.where(first, np.arange(len(order)), 0))
    rank = np.empty(len(order))
    rank[order] = np.arange(len(order)) - start
    return np.where(rank % 2 == 1, 1.0, -1.0) * np.ceil(rank / 2.0)


def set_limits(ax: Axes, points: Points) -> None:
    """Axes that hold all points; the panels share them."""
    for angle, limits in ((points.alpha, ax.set_xlim), (points.gamma, ax.set_ylim)):
        low, high = np.degrees(angle.min()), np.degrees(angle.max())
        room = 0.08 * max(high - low, 2.0)
        limits(low - room, high + room)


def _camber_range(points: Points) -> float:
    """Extent of all points [deg]; at least 1, so that a sweep without camber has a height."""
    return max(float(np.degrees(np.ptp(points.gamma))), 1.0)


def colour_bar(figure: Figure, drawn: Any, label: str) -> None:
    """The scale of the maps, where other figures have their legend."""
    width, height = figure.get_size_inches()
    box = figure.add_axes((0.70 / width, 1.0 - 0.19 / height, 2.6 / width, 0.11 / height), label=style.SCALE)
    bar = figure.colorbar(drawn, cax=box, orientation="horizontal")
    bar.outline.set_linewidth(0.5)
    box.tick_params(pad=1.5)
    box.text(1.04, 0.5, label, transform=box.transAxes, va="center", fontsize=8.0)
