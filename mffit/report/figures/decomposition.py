"""Raw readings, their odd part and their even part; and the even part beside the model's."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from mffit.report import labels, style
from mffit.report.build_view import BuildView, Channel
from mffit.report.curves import Curve
from mffit.report.figures.fit import held

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_PANELS = 18


def decomposition(view: BuildView, channel: Channel) -> Figure:
    """Raw, odd and even curve of every sweep; of opposite cambers only the positive one."""
    from matplotlib.lines import Line2D

    chosen = worth_drawing(view.curves, channel)
    groups = [n for n in (sum(c.over == over for c in chosen) for over in ("alpha", "gamma")) if n]
    figure, rows = style.panel_grid(groups, 5 if max(groups) > 4 else 4, height=1.40)
    for ax, curve in zip((ax for row in rows for ax in row), chosen, strict=True):
        x = _angle(view, curve)
        ax.axhline(0.0, color=style.FAINT, lw=0.8)
        ax.plot(x, channel.measured[curve.index], ":", marker="o", ms=3, color=style.MUTED, mec="none")
        ax.plot(x, channel.odd[curve.index], "-", color=style.ACCENT)
        ax.plot(x, channel.even[curve.index], "--", color=style.CONTRAST)
        ax.set_title(_title(curve))
        ax.set_xlabel(labels.ANGLES[curve.over].axis, labelpad=1.5)
        style.few_ticks(ax, x=4)
    style.label_left(rows, channel.label)
    handles = [
        Line2D([], [], ls=":", marker="o", ms=3, color=style.MUTED, label="raw reading"),
        Line2D([], [], color=style.ACCENT, label="odd part: response to sideslip and camber"),
        Line2D([], [], ls="--", color=style.CONTRAST, label="even part: turn slip, offsets, misalignment"),
    ]
    style.legend_above(figure, handles)
    return figure


def even_parts(view: BuildView) -> Figure:
    """Even part of the pure sweeps at nominal pressure, measured and of the model, one column per load."""
    from matplotlib.lines import Line2D

    pure = pure_curves(view)
    loads = sorted({c.load for c in pure})[:4]
    kinds = [
        (ch, over) for ch in view.channels for over in ("alpha", "gamma") if any(c.over == over for c in pure)
    ]
    figure, rows = style.panel_grid([len(loads)] * len(kinds), len(loads), height=1.25, share_y="row")
    for row, (channel, over) in zip(rows, kinds, strict=True):
        for ax, load in zip(row, loads, strict=True):
            ax.axhline(0.0, color=style.FAINT, lw=0.8)
            for curve in (c for c in pure if c.over == over and c.load == load):
                _even_curve(ax, view, channel, curve)
            ax.set_title(f"{channel.symbol}, {labels.LOAD.of(load)}")
            ax.set_xlabel(labels.ANGLES[over].axis, labelpad=1.5)
            style.few_ticks(ax, y=4)
        style.label_left([row], f"even {channel.label}")
    handles = [
        Line2D([], [], ls="none", marker="o", ms=4, color=style.CONTRAST, label="measured, ± 1 u"),
        Line2D([], [], color=style.INK, label="model"),
    ]
    style.legend_above(figure, handles)
    return figure


def _even_curve(ax: Axes, view: BuildView, channel: Channel, curve: Curve) -> None:
    x, rows, line = _angle(view, curve), curve.index, view.lines[curve.key]
    ax.errorbar(
        x,
        channel.even[rows],
        channel.u_odd[rows],
        fmt="o",
        ms=3,
        color=style.CONTRAST,
        elinewidth=0.8,
        mec="none",
    )
    ax.plot(line.x, line.even[channel.name], color=style.INK)


def pure_curves(view: BuildView) -> list[Curve]:
    """Forward sweeps over one angle, the other zero, at the pressure nearest the nominal one."""
    if not view.curves:
        return []
    nominal = view.config.tyre.nominal_pressure
    pressure = min((c.pressure for c in view.curves), key=lambda value: abs(value - nominal))
    return [c for c in view.curves if c.forward and abs(c.held) < 0.5 and c.pressure == pressure]


def worth_drawing(curves: Sequence[Curve], channel: Channel) -> list[Curve]:
    """Forward curves that have mirrors, at most as many as a page can bear."""
    chosen = [
        c for c in curves if c.forward and c.held > -0.5 and np.isfinite(channel.odd[c.index]).sum() > 1
    ]
    long_ones = [c for c in chosen if len(c.index) > 6] or chosen
    if len(long_ones) <= MOST_PANELS:
        return long_ones
    spread = np.linspace(0, len(long_ones) - 1, MOST_PANELS).round().astype(int)
    return [long_ones[i] for i in spread]


def _title(curve: Curve) -> str:
    condition = labels.condition(curve.load, curve.pressure)
    if abs(curve.held) < 0.5:
        return condition
    return f"{condition}, {held(curve)}"


def _angle(view: BuildView, curve: Curve) -> np.ndarray:
    return np.degrees(getattr(view.points, curve.over)[curve.index])
