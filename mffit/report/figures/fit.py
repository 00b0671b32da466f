"""The model against the points, at every load, pressure and camber."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np

from mffit.points import Points
from mffit.report import labels, style
from mffit.report.build_view import Channel
from mffit.report.curves import Curve
from mffit.report.lines import Line
from mffit.report.rounding import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


class Overlaid(Protocol):
    """What this figure needs to know."""

    @property
    def points(self) -> Points: ...
    @property
    def curves(self) -> Sequence[Curve]: ...
    @property
    def lines(self) -> Mapping[tuple, Line]: ...
    def marked(self, channel: str) -> tuple[np.ndarray, np.ndarray]:
        """Rows of readings without weight, and of the points of doubtful sweeps."""


MOST_PANELS = 15
DENSE = 60
"""Points on one curve above which they are drawn as dots."""


def model_against_points(view: Overlaid, channel: Channel) -> Figure:
    """One panel per load and pressure: first over sideslip, coloured by camber, then over camber."""
    panels = _panels(view.curves)[:MOST_PANELS]
    groups = [n for n in (sum(p[0] == over for p in panels) for over in ("alpha", "gamma")) if n]
    colours = style.ramp(sorted({c.held for c in view.curves if c.over == "alpha"}))
    figure, rows = style.panel_grid(groups, 5 if max(groups) > 4 else 4, height=1.75)
    for ax, (over, load, pressure, members) in zip((ax for row in rows for ax in row), panels, strict=True):
        ax.axhline(0.0, color=style.FAINT, lw=0.8)
        for curve in members:
            colour = colours.get(curve.held, style.INK) if over == "alpha" else style.ACCENT
            _draw(ax, view, channel, curve, colour)
        ax.set_title(labels.condition(load, pressure))
        ax.set_xlabel(labels.ANGLES[over].axis, labelpad=1.5)
        style.few_ticks(ax, x=4)
    style.label_left(rows, channel.label)
    style.legend_above(figure, _legend(view, channel, colours, any(not c.forward for c in view.curves)))
    return figure


def _panels(curves: Iterable[Curve]) -> list[tuple[str, float, float, list[Curve]]]:
    grouped: dict[tuple[str, float, float], list[Curve]] = {}
    for curve in curves:
        grouped.setdefault((curve.over, curve.load, curve.pressure), []).append(curve)
    return [(*key, members) for key, members in sorted(grouped.items())]


def _draw(ax: Axes, view: Overlaid, channel: Channel, curve: Curve, colour: Any) -> None:
    x, line = np.degrees(getattr(view.points, curve.over)[curve.index]), view.lines[curve.key]
    marker, size = (".", 2.0) if len(x) > DENSE else ("o" if curve.forward else "v", 3.2)
    filled = {"mfc": colour, "mew": 0.0} if curve.forward else {"mfc": "white", "mew": 0.8}
    ax.plot(
        x, channel.measured[curve.index], ls="none", marker=marker, ms=size, color=colour, label=f"{curve.sweep}, {held(curve)}",
        **filled,
    )  # fmt: skip
    _mark(ax, view, channel, curve)
    dashes = "-" if curve.forward else "--"
    ax.plot(line.x, line.raw[channel.name], dashes, color=colour, lw=1.0, label=f"model, {held(curve)}")


def _mark(ax: Axes, view: Overlaid, channel: Channel, curve: Curve) -> None:
    """A cross over every reading without weight, a ring around the points of doubtful sweeps."""
    angle = np.degrees(getattr(view.points, curve.over))
    for rows, (marker, size) in zip(view.marked(channel.name), MARKS.values(), strict=True):
        here = np.intersect1d(curve.index, rows)
        ax.plot(
            angle[here],
            channel.measured[here],
            ls="none",
            marker=marker,
            ms=size,
            mfc="none",
            color=style.CONTRAST,
        )


def held(curve: Curve) -> str:
    """The angle that a curve holds."""
    other = labels.ANGLES["gamma" if curve.over == "alpha" else "alpha"]
    return f"{other.symbol} = {number(curve.held, 0)}°"


MARKS = {"no weight": ("x", 5.0), "doubtful sweep": ("o", 5.5)}
"""Marker and size of what does not fit."""


def _legend(view: Overlaid, channel: Channel, colours: dict[float, Any], backward: bool) -> list[Any]:
    from matplotlib.lines import Line2D

    handles = [
        Line2D([], [], ls="none", marker="o", ms=3.5, color=style.MUTED, label="measured"),
        Line2D([], [], color=style.MUTED, label="model"),
    ]
    if backward:
        handles.append(
            Line2D([], [], ls="--", marker="v", mfc="white", ms=3.5, color=style.MUTED, label="backward")
        )
    for rows, (word, (marker, size)) in zip(view.marked(channel.name), MARKS.items(), strict=True):
        if len(rows):
            handles.append(
                Line2D(
                    [], [], ls="none", marker=marker, ms=size, mfc="none", color=style.CONTRAST, label=word
                )
            )
    places = 0 if all(abs(g - round(g)) < 0.15 for g in colours) else 1
    camber = labels.ANGLES["gamma"].symbol
    if len(colours) > 1:
        handles += [
            Line2D([], [], lw=3, color=c, label=f"{camber} = {number(g, places)}°")
            for g, c in colours.items()
        ]
    return handles
