"""The gap between simulation and measurement, before and after what the diagnosis added."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Sequence
from operator import attrgetter, methodcaller
from typing import TYPE_CHECKING

import numpy as np

from mffit.diagnosis import Gap
from mffit.diagnosis.constants import TIED_EVIDENCE
from mffit.diagnosis.where import Region
from mffit.report import labels, style
from mffit.report.diagnosis_view import (
    Candidate,
    DiagnosisView,
    GapChannel,
    RankedStep,
    shown_steps,
)
from mffit.report.figures.residuals import colour_bar, most_populated, residual_map, set_limits
from mffit.report.rounding import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_CONDITIONS = 6
MOST_CANDIDATES = 12
SMALLEST_GAIN = 1.0
"""Left end of the evidence scale: what gains less is not worth a bar."""
KIND_COLOURS = {"tyre": style.ACCENT, "rig": style.CONTRAST, "environment": style.CALM}
SMALLEST_LIMIT, LARGEST_LIMIT = 4.0, 20.0
"""Ends of the maps' scale, in units of noise: never so small that noise looks like structure."""


def gap_bars(view: DiagnosisView) -> Figure:
    """Rms of every channel and chi2 per degree of freedom, before and after, fitted and held out."""
    from matplotlib.figure import Figure

    panels = len(view.channels) + 1
    figure = Figure(figsize=(style.WIDTH, 1.95 if view.changed else 1.35))
    place = {
        "left": 0.10,
        "right": 0.985,
        "top": 1.0 - 0.27 / figure.get_figheight(),
        "bottom": 0.45 / figure.get_figheight(),
        "wspace": 0.22,
    }
    axes = figure.subplots(1, panels, sharey=True, gridspec_kw=place)
    for ax, channel in zip(axes, view.channels, strict=False):
        rows = _rows(view, methodcaller("rms", channel.name))
        _bars(ax, rows, channel.noise, view.changed)
        ax.set_title(f"{channel.symbol}: rms gap")
        ax.set_xlabel(f"measured − simulated [{channel.unit}]")
    _bars(axes[-1], _rows(view, attrgetter("chi2_per_dof")), 1.0, view.changed)
    axes[-1].set_title("χ² per degree of freedom")
    axes[-1].set_xlabel("1 = nothing but noise")
    return figure


def curves_before_after(view: DiagnosisView) -> Figure:
    """The worst and the typical sweep: readings, the simulation as given and with what was added, a panel per channel."""
    from matplotlib.lines import Line2D

    figure, rows = style.panel_grid([len(view.shown) * len(view.channels)], 4, height=2.1)
    panels = [(shown, channel) for shown in view.shown for channel in view.channels]
    for ax, (shown, channel) in zip(rows[0], panels, strict=True):
        index, over = shown.curve.index, shown.curve.over
        x = np.degrees(getattr(view.points, over)[index])
        ax.axhline(0.0, color=style.FAINT, lw=0.8)
        ax.plot(x, getattr(view.points, channel.name)[index], "o", ms=3.2, mew=0.0, color=style.INK)
        ax.plot(shown.before.x, shown.before.raw[channel.name], color=style.CONTRAST, lw=1.2, ls="--")
        if view.changed:
            ax.plot(shown.after.x, shown.after.raw[channel.name], color=style.ACCENT, lw=1.2)
        other = labels.ANGLES["gamma" if over == "alpha" else "alpha"]
        held = f", {other.symbol} {shown.curve.held:.0f}°" if abs(shown.curve.held) >= 0.5 else ""
        title = f"{shown.word}: {labels.LOAD.of(shown.curve.load)}{held}{'' if shown.curve.forward else ', backward'}"
        ax.set_title(title)
        ax.set_xlabel(labels.ANGLES[over].axis, labelpad=1.5)
        ax.set_ylabel(f"{channel.symbol} [{channel.unit}]", labelpad=1.0)
        style.few_ticks(ax)
    handles = [
        Line2D([], [], ls="none", marker="o", ms=3.5, color=style.INK, label="measured"),
        Line2D([], [], ls="--", color=style.CONTRAST, label="simulated as given"),
    ]
    if view.changed:
        handles.append(Line2D([], [], color=style.ACCENT, label="with what was found"))
    style.legend_above(figure, handles)
    return figure


def residuals_before_after(view: DiagnosisView) -> Figure:
    """Maps side by side: a row per load and pressure, channels before and after, one colour scale for all."""
    shown = most_populated(view.conditions, MOST_CONDITIONS)
    whens = ("before", "after") if view.changed else ("before",)
    columns = [(channel, when) for channel in view.channels for when in whens]
    limit = colour_limit(view.channels)
    figure, rows = style.panel_grid(
        [len(columns)] * len(shown), 4, height=1.40, gap=(0.22, 0.36),
        share_x=True, share_y=True,
    )  # fmt: skip
    set_limits(rows[0][0], view.points)
    for row, condition in zip(rows, shown, strict=True):
        for ax, (channel, when) in zip(row, columns, strict=True):
            drawn = residual_map(ax, view.points, getattr(channel, when), condition.index, limit)
            ax.set_title(f"{channel.symbol}{' ' + when if view.changed else ''}, {condition.title}")
            if when == "before":
                _frames(ax, view.frames(channel.name), condition.load)
    style.label_below(rows, labels.ANGLES["alpha"].axis)
    style.label_left(rows, labels.ANGLES["gamma"].axis)
    colour_bar(figure, drawn, "measured − simulated [noise of a point]")
    return figure


def colour_limit(channels: Sequence[GapChannel]) -> float:
    """The scale's end: what 98 % of the residuals before stay within, between the fixed limits."""
    sizes = np.concatenate([np.abs(c.before[np.isfinite(c.before)]) for c in channels])
    wanted = float(np.percentile(sizes, 98.0)) if len(sizes) else SMALLEST_LIMIT
    return float(np.clip(np.ceil(wanted), SMALLEST_LIMIT, LARGEST_LIMIT))


def evidence(view: DiagnosisView) -> Figure:
    """How every candidate did, a panel per forward step: gain in log evidence, coloured by kind."""
    from matplotlib.figure import Figure
    from matplotlib.patches import Patch

    steps = shown_steps(view)
    count = max(min(len(step.candidates), MOST_CANDIDATES) for step in steps)
    tall = 0.85 + 0.185 * count
    figure = Figure(figsize=(style.WIDTH, tall))
    for i, step in enumerate(steps):
        ax = figure.add_axes((0.165 + 0.335 * i, 0.42 / tall, 0.15, 0.185 * count / tall))
        _candidates(ax, step)
        after = f"beside {' and '.join(step.beside)}" if step.beside else "one effect alone"
        title = f"Step {i + 1}{'' if step.passed else ', nothing passes'}: {after}"
        ax.set_title(labels.typeset(textwrap.shorten(title, 52, placeholder="…")), x=-0.9)
    present = {c.kind for step in steps for c in step.candidates}
    style.legend_above(
        figure, [Patch(color=c, label=kind) for kind, c in KIND_COLOURS.items() if kind in present]
    )
    return figure


def _candidates(ax: Axes, step: RankedStep) -> None:
    rows = step.candidates[:MOST_CANDIDATES]
    gains = [max(c.gain, SMALLEST_GAIN) for c in rows]
    ax.barh(
        range(len(rows)),
        gains,
        left=0.0,
        height=0.66,
        color=[KIND_COLOURS.get(c.kind, style.MUTED) for c in rows],
    )
    if step.passed:
        _distances(ax, rows, gains)
    ax.axvline(step.threshold, color=style.INK, lw=1.0, ls="--")
    ax.set_xscale("log")
    ax.set_xlim(SMALLEST_GAIN, 8.0 * max(10.0, *gains))
    names = [labels.typeset(textwrap.shorten(c.name, 31, placeholder="…")) for c in rows]
    ax.set_yticks(range(len(rows)), names)
    ax.set_ylim(len(rows) - 0.4, -0.6)
    ax.grid(axis="y", visible=False)
    ax.minorticks_off()
    ax.set_xlabel("gain in log evidence")


def _distances(ax: Axes, rows: Sequence[Candidate], gains: Sequence[float]) -> None:
    """How far each candidate is behind the best, at the end of its bar; dark where it may be a tie."""
    for i, (candidate, gain) in enumerate(zip(rows, gains, strict=True)):
        behind = rows[0].gain - candidate.gain
        said = "best" if i == 0 else number(-behind, 0 if behind >= 10.0 else None, digits=2)
        colour = style.INK if behind < TIED_EVIDENCE else style.MUTED
        ax.annotate(f" {said}", (gain, i), va="center", fontsize=7.0, color=colour)


def _rows(view: DiagnosisView, size: Callable[[Gap], float]) -> list[tuple[str, float, float]]:
    found, checked = view.diagnosis, view.diagnosis.validation
    rows = [("all points", size(found.gap_before), size(found.gap_after))]
    if view.changed:
        rows.append(("held out", size(checked.gap_before), size(checked.gap_after)))
    return rows


def _bars(ax: Axes, rows: list[tuple[str, float, float]], floor: float, changed: bool) -> None:
    place = np.arange(len(rows))[::-1] * 1.0
    sides = ((0.19, 1, style.FAINT), (-0.19, 2, style.ACCENT)) if changed else ((0.0, 1, style.FAINT),)
    for offset, column, colour in sides:
        values = [row[column] for row in rows]
        ax.barh(place + offset, values, height=0.34, color=colour)
        for y, value in zip(place + offset, values, strict=True):
            ax.annotate(f" {value:.3g}", (value, y), va="center", fontsize=7.5)
    if np.isfinite(floor):
        ax.axvline(floor, color=style.CONTRAST, lw=1.2, ls="--")
    largest = max([*(row[1] for row in rows), *(row[2] for row in rows), np.nan_to_num(floor)])
    ax.set_xlim(0.0, 1.18 * largest)
    ax.set_ylim(-0.55, len(rows) - 0.45)
    ax.set_yticks(place, [row[0] for row in rows])
    ax.grid(axis="y", visible=False)


def _frames(ax: Axes, regions: Sequence[Region], load: float) -> None:
    """A frame around every region that lies at this load."""
    from matplotlib.patches import Rectangle

    for item in regions:
        region = item.region
        low, high = region.get("Fz_N", (-np.inf, np.inf))
        if not {"alpha_deg", "gamma_deg"} & region.keys():
            continue
        if not low * 0.95 <= load <= high * 1.05:
            continue
        left, right = _side(region.get("alpha_deg"), ax.get_xlim())
        bottom, top = _side(region.get("gamma_deg"), ax.get_ylim())
        frame = Rectangle((left, bottom), right - left, top - bottom, fill=False, ec=style.INK, lw=1.0)
        frame.set(linestyle=(0, (3, 2)), zorder=5)
        ax.add_patch(frame)


def _side(bounds: Sequence[float] | None, axis: tuple[float, float]) -> tuple[float, float]:
    """Bounds of a region, widened so that one value has a width; nearly the whole axis without bounds."""
    low, high = axis
    pad = 0.03 * (high - low)
    if bounds is None:
        return low + 0.5 * pad, high - 0.5 * pad
    return max(bounds[0] - pad, low), min(bounds[1] + pad, high)
