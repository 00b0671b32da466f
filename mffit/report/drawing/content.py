"""What a panel shows, drawn into its axes."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.markers import MarkerStyle
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.transforms import Affine2D, Transform

from mffit.report import constants, style
from mffit.report.drawing.records import (
    Band,
    Bars,
    DataSeries,
    ErrorBars,
    Frame,
    Look,
    Map,
    Note,
    Panel,
    Ribbon,
    Trace,
)

INCH = 72.0
SPAN, AREA, GUIDE, SERIES, FRAME = 0.7, 1.0, 1.5, 2.0, 3.0
"""Order of drawing, from below."""


def in_points(figure: Figure) -> Transform:
    """From points [pt] right and up of the lower left corner to the figure."""
    return Affine2D().scale(1.0 / INCH) + figure.dpi_scale_trans


def pen(look: Look) -> dict[str, Any]:
    """Arguments of a line."""
    return {
        "color": look.colour,
        "linestyle": look.line,
        "linewidth": look.width,
        "solid_capstyle": "butt",
        "clip_on": False,
    }


def brush(colour: str, opacity: float = 1.0) -> dict[str, Any]:
    """Arguments of an area without an edge."""
    return {"color": colour, "alpha": opacity, "linewidth": 0.0}


def show(axes: Axes, points: Transform, panel: Panel) -> None:
    """Draw everything in the data area of a panel; ``points`` leads from points [pt] to the figure."""
    for span in panel.spans:
        axes.axvspan(span.first, span.last, zorder=SPAN, **brush(span.look.colour, span.look.opacity))
    for guide in panel.guides:
        across = axes.axvline if guide.axis == "x" else axes.axhline
        across(guide.at, zorder=GUIDE, **pen(guide.look))
    for series in panel.series:
        _series(axes, points, series)
    for frame in panel.frames:
        _frame(axes, frame)
    for note in panel.notes:
        _note(axes, note)


def _series(axes: Axes, points: Transform, series: DataSeries) -> None:
    match series:
        case Trace(x=x, y=y, look=look):
            if look.line:
                axes.plot(x, y, zorder=SERIES, **pen(look))
            if look.marker:
                axes.add_artist(marks(points, _places(axes, points, x, y), look))
        case Band(x=x, low=low, high=high, look=look):
            around = np.concatenate([x, x[::-1]]), np.concatenate([low, high[::-1]])
            axes.fill(*around, zorder=AREA, **brush(look.colour, look.opacity))
        case Ribbon(look=look):
            (left, low), (right, high) = series.sides()
            around = np.concatenate([left, right[::-1]]), np.concatenate([low, high[::-1]])
            axes.fill(*around, zorder=AREA, **brush(look.colour, look.opacity))
        case ErrorBars():
            _error_bars(axes, points, series)
        case Bars():
            begin = axes.get_xlim()[0] if axes.get_xscale() == "log" else 0.0
            for length, place, colour in zip(series.lengths, series.places, series.colours, strict=True):
                axes.barh(place, length - begin, series.height, begin, zorder=AREA, **brush(colour))
        case Map():
            places, last = _places(axes, points, series.x, series.y), constants.MOST_COLOUR_STEPS - 1
            steps = np.round((0.5 + 0.5 * np.clip(series.values / series.limit, -1.0, 1.0)) * last)
            for step in np.unique(steps):
                look = Look(marker="s", size=series.size, colour=style.between(style.DIVERGING, step / last))
                axes.add_artist(marks(points, places[steps == step], look, edge=style.FAINT, width=0.4))


def _error_bars(axes: Axes, points: Transform, series: ErrorBars) -> None:
    low, high = series.ends()
    ends = np.column_stack([low, high, np.full(len(low), np.nan)]).ravel()  # NaN ends every bar
    x, y = (ends, np.repeat(series.y, 3)) if series.along == "x" else (np.repeat(series.x, 3), ends)
    look = series.look
    axes.plot(x, y, zorder=SERIES, **pen(replace(look, line="-")))
    if series.cap:
        cap = Look(colour=look.colour, marker="|" if series.along == "x" else "_", size=2.0 * series.cap)
        axes.add_artist(marks(points, _places(axes, points, x, y), cap, width=look.width))
    axes.add_artist(marks(points, _places(axes, points, series.x, series.y), look))


def marks(points: Transform, places: np.ndarray, look: Look, edge: str = "", width: float = 0.8) -> PathPatch:
    """Markers at places (n, 2) [pt] as a single path, so that ten thousand of them do not slow the page."""
    shape = MarkerStyle("o" if look.marker == "." else look.marker)
    filled = shape.is_filled() and not look.hollow
    if look.marker in "o." and filled:
        # The round ends of a line with hardly any length are a disc; a circle would take ten times the text.
        outline = Path([[0.0, 0.0], [0.01, 0.0]], [Path.MOVETO, Path.LINETO])
        filled, edge, width = False, look.colour, look.size
    else:
        to_points = shape.get_transform() + Affine2D().scale(look.size)
        outline = Path.make_compound_path(shape.get_path().transformed(to_points))
        width = 0.0 if filled and not edge else width
    known = places[np.isfinite(places).all(axis=1)]
    corners = (known[:, None] + np.asarray(outline.vertices)).reshape(-1, 2)
    path = Path(corners, np.tile(np.asarray(outline.codes), len(known)))
    path.should_simplify = False
    return PathPatch(
        path,
        fill=filled,
        facecolor=look.colour,
        edgecolor=edge or look.colour,
        linewidth=width,
        capstyle="round",
        snap=False,
        transform=points,
        clip_on=False,
        zorder=SERIES,
    )


def _places(axes: Axes, points: Transform, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Data as places (n, 2) in the figure [pt]."""
    return (axes.transData - points).transform(np.column_stack([x, y]))


def _frame(axes: Axes, frame: Frame) -> None:
    left, right = _side(axes.get_xlim(), frame.x)
    low, high = _side(axes.get_ylim(), frame.y)
    corners = [left, right, right, left, left], [low, low, high, high, low]
    axes.plot(*corners, zorder=FRAME, **pen(Look(line="--", width=1.0)))


def _side(ends: tuple[float, float], bounds: tuple[float, float] | None) -> tuple[float, float]:
    """Ends of a frame on an axis, widened so that a single value has a width, and within the data area."""
    low, high = sorted(ends)
    pad = 0.03 * (high - low)
    if bounds is None:
        return low + 0.5 * pad, high - 0.5 * pad
    return max(min(bounds) - pad, low), min(max(bounds) + pad, high)


def _note(axes: Axes, note: Note) -> None:
    text = axes.annotate(
        note.text,
        (note.x, note.y),
        xytext=(-2.5, 0.0) if note.turned else (2.5, 0.0),
        textcoords="offset points",
        color=note.colour,
        size=note.size,
        va="center",
    )
    if note.turned:
        text.set(rotation=90.0, ha="right", va="bottom")
