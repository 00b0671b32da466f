"""The gap between simulation and measurement, before and after what the diagnosis added."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from mffit.report import style
from mffit.report.diagnosis_view import FLOOR_KEYS, GAP_KEYS, DiagnosisView, GapChannel
from mffit.report.figures.residuals import colour_bar, most_populated, residual_map

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_CONDITIONS = 6
SMALLEST_LIMIT, LARGEST_LIMIT = 4.0, 15.0
"""Ends of the maps' scale, in units of noise: never so small that noise looks like structure."""


def gap_bars(view: DiagnosisView) -> Figure:
    """Rms of every channel and chi2 per degree of freedom, before and after, fitted and held out."""
    from matplotlib.figure import Figure

    panels = len(view.channels) + 1
    figure = Figure(figsize=(style.WIDTH, 1.95))
    axes = figure.subplots(1, panels, gridspec_kw=dict(left=0.10, right=0.985, top=0.86, bottom=0.23, wspace=0.22))
    for ax, channel in zip(axes, view.channels, strict=False):
        key = GAP_KEYS[channel.name]
        _bars(ax, _rows(view, key), view.noise_floor.get(FLOOR_KEYS[channel.name]), "noise")
        ax.set_title(f"{channel.name}: rms gap")
        ax.set_xlabel(f"measured − simulated [{channel.unit}]")
    _bars(axes[-1], _rows(view, "chi2_per_dof"), 1.0, "noise alone")
    axes[-1].set_title("χ² per degree of freedom")
    axes[-1].set_xlabel("1 = nothing but noise")
    for ax in axes[1:]:
        ax.tick_params(labelleft=False)
    return figure


def residuals_before_after(view: DiagnosisView, regions: Sequence[Mapping[str, Any]]) -> Figure:
    """Maps side by side: a row per load and pressure, per channel before and after, one colour scale for all.

    Parameters
    ----------
    view : what to show
    regions : those of ``where`` or ``unexplained_where``, framed in the maps they lie in
    """
    shown = most_populated(view.conditions, MOST_CONDITIONS)
    columns = [(channel, when) for channel in view.channels for when in ("before", "after")]
    limit = colour_limit(view.channels)
    figure, rows = style.panel_grid(
        [len(columns)] * len(shown), 4, height=1.40, legend=False, margins=(0.70, 0.95), gap=(0.22, 0.36),
        share_x=True, share_y=True,
    )  # fmt: skip
    for row, condition in zip(rows, shown, strict=True):
        for ax, (channel, when) in zip(row, columns, strict=True):
            drawn = residual_map(ax, view.points, getattr(channel, when), condition.index, limit)
            ax.set_title(f"{channel.name} {when}, {condition.title}")
            if when == "before":
                _frames(ax, regions, channel, condition.load)
    for ax in rows[-1]:
        ax.set_xlabel("sideslip α [deg]")
    style.label_left(rows, "camber γ [deg]")
    colour_bar(figure, drawn, "measured − simulated\n[noise of a point]")
    return figure


def colour_limit(channels: Sequence[GapChannel]) -> float:
    """The scale's end: what 98 % of the residuals before stay within, between the fixed limits."""
    sizes = np.concatenate([np.abs(c.before[np.isfinite(c.before)]) for c in channels])
    wanted = float(np.percentile(sizes, 98.0)) if len(sizes) else SMALLEST_LIMIT
    return float(np.clip(np.ceil(wanted), SMALLEST_LIMIT, LARGEST_LIMIT))


def _rows(view: DiagnosisView, key: str) -> list[tuple[str, float, float]]:
    rows = [("all points", view.gap_before.get(key), view.gap_after.get(key))]
    if view.validation:
        held = view.validation
        rows.append(("held out", held["gap_before"].get(key), held["gap_after"].get(key)))
    return [(name, before, after) for name, before, after in rows if before is not None and after is not None]


def _bars(ax: Axes, rows: list[tuple[str, float, float]], floor: float | None, floor_name: str) -> None:
    place = np.arange(len(rows))[::-1] * 1.0
    for offset, column, colour in ((0.19, 1, style.FAINT), (-0.19, 2, style.ACCENT)):
        values = [row[column] for row in rows]
        ax.barh(place + offset, values, height=0.34, color=colour)
        for y, value in zip(place + offset, values, strict=True):
            ax.annotate(f"{value:.3g}", (value, y), xytext=(3, 0), textcoords="offset points", va="center", fontsize=7.5)
    if floor is not None and np.isfinite(floor):
        ax.axvline(floor, color=style.CONTRAST, lw=1.2, ls="--")
    largest = max([row[1] for row in rows] + [row[2] for row in rows] + [floor or 0.0])
    ax.set_xlim(0.0, 1.18 * largest)
    ax.set_ylim(-0.55, len(rows) - 0.45)
    ax.set_yticks(place, [row[0] for row in rows])
    ax.grid(axis="y", visible=False)


def _frames(ax: Axes, regions: Sequence[Mapping[str, Any]], channel: GapChannel, load: float) -> None:
    """A frame around every region of the channel that lies at this load."""
    from matplotlib.patches import Rectangle

    for item in regions:
        region = item["region"]
        low, high = region.get("Fz_N", (-np.inf, np.inf))
        if item["channel"] != channel.name or not low * 0.95 <= load <= high * 1.05:
            continue
        (a0, a1), (g0, g1) = (_side(ax, region.get(key), axis) for key, axis in (("alpha_deg", "x"), ("gamma_deg", "y")))
        ax.add_patch(Rectangle((a0, g0), a1 - a0, g1 - g0, fill=False, ec=style.INK, lw=1.0, ls=(0, (3, 2)), zorder=5))


def _side(ax: Axes, bounds: Sequence[float] | None, axis: str) -> tuple[float, float]:
    """Bounds of a region, widened so that a frame around one value has a width; the whole axis if there are none."""
    low, high = ax.get_xlim() if axis == "x" else ax.get_ylim()
    if bounds is None:
        return low, high
    pad = 0.03 * (high - low)
    return max(bounds[0] - pad, low), min(bounds[1] + pad, high)
