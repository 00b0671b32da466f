"""Series, guides, frames and notes as matplotlib artists."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.markers import MarkerStyle
from matplotlib.patches import Patch, PathPatch, Polygon, Rectangle
from matplotlib.path import Path
from matplotlib.text import Annotation
from matplotlib.transforms import Affine2D, Transform

from mffit.report import constants, style
from mffit.report.drawing.records import (
    Band,
    Bars,
    DataSeries,
    ErrorBars,
    Frame,
    Guide,
    Look,
    Map,
    Note,
    Panel,
    Span,
    Trace,
)  # fmt: skip

INCH = 72.0
SPAN, AREA, GUIDE, SERIES, FRAME = 0.7, 1.0, 1.5, 2.0, 3.0
"""Order of drawing."""


def in_points(figure: Figure) -> Transform:
    """From points [pt] right and up of the lower left corner to the figure."""
    return Affine2D().scale(1.0 / INCH) + figure.dpi_scale_trans


def of_panel(axes: Axes, panel: Panel) -> Iterator[Artist]:
    """Everything in the data area of a panel."""
    yield from (_span(axes, span) for span in panel.spans)
    yield from (_guide(axes, guide) for guide in panel.guides)
    for series in panel.series:
        yield from _series(axes, series)
    yield from (_frame(axes, frame) for frame in panel.frames)
    yield from map(_note, panel.notes)


def line(
    x: Sequence[float] | np.ndarray, y: Sequence[float] | np.ndarray, look: Look, to_figure: Transform
) -> Line2D:
    """A line, broken where a value is unknown."""
    return Line2D(
        x, y, color=look.colour, linestyle=look.line, linewidth=look.width, solid_capstyle="butt",
        transform=to_figure, clip_on=False, zorder=SERIES,
    )  # fmt: skip


def marks(figure: Figure, places: np.ndarray, look: Look, edge: str = "", width: float = 0.8) -> PathPatch:
    """Markers at places (n, 2) [pt] as a single path, so that ten thousand of them do not slow the page."""
    shape = MarkerStyle("o" if look.marker == "." else look.marker)
    filled = shape.is_filled() and not look.hollow
    if look.marker in "o." and filled:
        # The round ends of a line with hardly any length are a disc; a circle would take ten times the text.
        vertices, codes = np.array([[0.0, 0.0], [0.01, 0.0]]), [Path.MOVETO, Path.LINETO]
        filled, edge, width = False, look.colour, look.size
    else:
        to_points = shape.get_transform() + Affine2D().scale(look.size)
        outline = Path.make_compound_path(shape.get_path().transformed(to_points))
        vertices, codes = outline.vertices, outline.codes
        width = 0.0 if filled and not edge else width
    known = places[np.isfinite(places).all(axis=1)]
    path = Path((known[:, None] + vertices).reshape(-1, 2), np.tile(codes, len(known)))
    path.should_simplify = False
    return PathPatch(
        path, fill=filled, facecolor=look.colour, edgecolor=edge or look.colour, linewidth=width, capstyle="round", snap=False,
        transform=in_points(figure), clip_on=False, zorder=SERIES,
    )  # fmt: skip


def area(patch: Patch, colour: str, opacity: float = 1.0, order: float = AREA) -> Patch:
    """The patch filled, without an edge."""
    patch.set(facecolor=colour, alpha=opacity, linewidth=0.0, clip_on=False, zorder=order)
    return patch


def _series(axes: Axes, series: DataSeries) -> Iterator[Artist]:
    match series:
        case Trace(x=x, y=y, look=look):
            if look.line:
                yield line(x, y, look, axes.transData)
            if look.marker:
                yield marks(axes.figure, _places(axes, x, y), look)
        case Band(x=x, low=low, high=high, look=look):
            corners = np.vstack([np.column_stack([x, low]), np.column_stack([x, high])[::-1]])
            yield area(Polygon(corners, transform=axes.transData), look.colour, look.opacity)
        case ErrorBars():
            yield from _error_bars(axes, series)
        case Bars():
            begin = axes.get_xlim()[0] if axes.get_xscale() == "log" else 0.0
            for length, place, colour in zip(series.lengths, series.places, series.colours, strict=True):
                corner = (begin, place - 0.5 * series.height)
                yield area(Rectangle(corner, length - begin, series.height, transform=axes.transData), colour)
        case Map():
            yield from _map(axes, series)


def _error_bars(axes: Axes, series: ErrorBars) -> Iterator[Artist]:
    low, high = series.ends()
    ends = np.column_stack([low, high, np.full(len(low), np.nan)]).ravel()  # NaN ends every bar
    x, y = (ends, np.repeat(series.y, 3)) if series.along == "x" else (np.repeat(series.x, 3), ends)
    look = series.look
    yield line(x, y, Look(colour=look.colour, line="-", width=look.width), axes.transData)
    if series.cap:
        cap = Look(colour=look.colour, marker="|" if series.along == "x" else "_", size=2.0 * series.cap)
        yield marks(axes.figure, _places(axes, x, y), cap, width=look.width)
    yield marks(axes.figure, _places(axes, series.x, series.y), look)


def _map(axes: Axes, series: Map) -> Iterator[Artist]:
    """The squares of each colour."""
    places, last = _places(axes, series.x, series.y), constants.MOST_COLOUR_STEPS - 1
    steps = np.round((0.5 + 0.5 * np.clip(series.values / series.limit, -1.0, 1.0)) * last)
    for step in np.unique(steps):
        look = Look(marker="s", size=series.size, colour=style.between(style.DIVERGING, step / last))
        yield marks(axes.figure, places[steps == step], look, edge=style.FAINT, width=0.4)


def _places(axes: Axes, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Data as places (n, 2) in the figure [pt]."""
    return (axes.transData - in_points(axes.figure)).transform(np.column_stack([x, y]))


def _span(axes: Axes, span: Span) -> Patch:
    stretch = Rectangle((span.first, 0.0), span.last - span.first, 1.0, transform=axes.get_xaxis_transform())
    return area(stretch, span.look.colour, span.look.opacity, SPAN)


def _guide(axes: Axes, guide: Guide) -> Line2D:
    if guide.axis == "x":
        found = line([guide.at] * 2, [0.0, 1.0], guide.look, axes.get_xaxis_transform())
    else:
        found = line([0.0, 1.0], [guide.at] * 2, guide.look, axes.get_yaxis_transform())
    found.set_zorder(GUIDE)
    return found


def _frame(axes: Axes, frame: Frame) -> Patch:
    """Widened, so that a single value has a width, and within the data area."""
    pad, ends = 0.03, []
    for k, bounds in enumerate((frame.x, frame.y)):
        if bounds is None:
            ends.append((0.5 * pad, 1.0 - 0.5 * pad))
        else:
            share = (axes.transData - axes.transAxes).transform(np.column_stack([bounds, bounds]))[:, k]
            ends.append(np.clip([share.min() - pad, share.max() + pad], 0.0, 1.0))
    (left, right), (low, high) = ends
    return Rectangle(
        (left, low), right - left, high - low, fill=False, edgecolor=style.INK, linewidth=1.0, linestyle=(0, (3.0, 2.0)),
        transform=axes.transAxes, clip_on=False, zorder=FRAME,
    )  # fmt: skip


def _note(note: Note) -> Annotation:
    offset, across = ((-2.5, 0.0), "right") if note.turned else ((2.5, 0.0), "left")
    return Annotation(
        note.text, (note.x, note.y), xytext=offset, textcoords="offset points", ha=across, va="bottom" if note.turned else "center",
        rotation=90.0 if note.turned else 0.0, color=note.colour, size=note.size, zorder=FRAME,
    )  # fmt: skip
