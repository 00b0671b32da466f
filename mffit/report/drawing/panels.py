"""Panels in matplotlib axes: every text and data area has a place known in advance, so nothing is laid out while drawing."""

from __future__ import annotations

import warnings
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch, Rectangle
from matplotlib.path import Path
from matplotlib.transforms import Transform

from mffit.report import constants, style
from mffit.report.drawing.content import INCH, SPAN, brush, in_points, marks, pen, show
from mffit.report.drawing.records import Axis, ColourScale, Look, Panel, Sheet
from mffit.report.drawing.texts import shortened, width_of
from mffit.report.drawing.ticks import limits, numbers_at
from mffit.report.drawing.words import Words

GAP = 10.0
"""Between panels side by side [pt]."""
TITLE, LABEL, NUMBER = 8.5, 8.0, 7.5
"""Sizes of letters [pt]."""
TOP, RIGHT = 17.0, 10.0
"""Margins of a data area [pt]."""
SPACE, LINE = 4.0, 11.0
"""Between letters and what they belong to, and height of a line of text [pt]."""
CAPITAL = 0.73
"""Height of capitals and digits over the size of the letters."""
ABOVE = 6.0
"""From the data area to the title [pt]."""
GRID = 0.5
"""Order of drawing of the grid: below everything else."""
SETTINGS: dict[str, Any] = {
    "figure.dpi": float(constants.PICTURE_DPI),
    "font.family": "DejaVu Sans",  # comes with matplotlib, so that pictures are the same on every machine
    "font.size": NUMBER,
    "text.parse_math": False,
    "text.hinting": "no_hinting",
    "mathtext.default": "regular",
    "svg.fonttype": "none",
    "lines.dashed_pattern": (4.4, 2.2),
    "lines.dotted_pattern": (1.2, 1.9),
    "lines.scale_dashes": False,
}


@contextmanager
def settings() -> Iterator[None]:
    """Drawing with these settings, whatever a user's matplotlibrc says; letters that the font lacks become boxes."""
    with matplotlib.style.context(SETTINGS, after_reset=True), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")
        yield


def panels(sheet: Sheet) -> Iterator[Figure]:
    """A figure that shows one panel of the sheet after the other.

    Its axes are used again, because making axes and their numbers takes as long as drawing them.
    """
    columns = max(map(len, sheet.rows))
    share = (constants.PICTURE_WIDTH - (columns - 1) * GAP) / columns
    width = sheet.panel_width or min(max(share, constants.NARROWEST_PANEL), constants.WIDEST_PANEL)
    height = sheet.height * INCH
    lefts = [_beside(panel, height) for panel in sheet.panels]
    # Panels with numbers at the vertical axis begin at the same place, so that columns are aligned.
    numbered = [left for left, panel in zip(lefts, sheet.panels, strict=True) if panel.y.words is None]
    figure = Figure()
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    axes.set_axis_off()
    for panel, left in zip(sheet.panels, lefts, strict=True):
        _arrange(figure, axes, panel, width, height, max(numbered) if panel.y.words is None else left)
        show(axes, in_points(figure), panel)
        yield figure
        for artist in (*axes.lines, *axes.patches, *axes.texts):
            artist.remove()


def _ends(panel: Panel, name: str) -> tuple[float, float]:
    """Both ends of an axis, which holds all series and guides."""
    values = [np.asarray(series.extent()["xy".index(name)]) for series in panel.series]
    guided = np.array([guide.at for guide in panel.guides if guide.axis == name])
    return limits(getattr(panel, name), [*values, guided])


def _y_numbers(panel: Panel, height: float) -> dict[float, str]:
    return numbers_at(panel.y, *_ends(panel, "y"), min(panel.y.ticks, max(2, int(height / (1.6 * LINE)))))


def _x_numbers(panel: Panel, width: float) -> dict[float, str]:
    """As many numbers as fit side by side."""
    for intervals in range(panel.x.ticks, 0, -1):
        numbers = numbers_at(panel.x, *_ends(panel, "x"), intervals)
        if len(numbers) * (max(width_of(text, NUMBER) for text in numbers.values()) + 2.0 * SPACE) < width:
            break
    return numbers


def _beside(panel: Panel, height: float) -> float:
    """Room for label and numbers of the vertical axis [pt]."""
    written = _y_numbers(panel, height).values() if panel.y.numbered else ()
    widest = max((width_of(text, NUMBER, text == panel.y.bold) for text in written), default=0.0)
    return SPACE + widest + (LINE + SPACE if panel.y.label else 0.0) + 1.0


def _arrange(figure: Figure, axes: Axes, panel: Panel, width: float, height: float, left: float) -> None:
    """Sizes, scales, numbers and labels of a panel whose data area of this height begins at ``left`` [pt]."""
    inside = width - left - RIGHT
    labelled = panel.x.numbered and panel.x.label != ""
    bottom = SPACE + (LINE if panel.x.numbered else 0.0) + (LINE if labelled else 0.0)
    total = bottom + height + TOP
    figure.set_size_inches(width / INCH, total / INCH)
    axes.set_position((left / width, bottom / total, inside / width, height / total))
    for name in ("x", "y"):
        scale = "log" if getattr(panel, name).logarithmic else "linear"
        if getattr(axes, f"get_{name}scale")() != scale:
            axes.set(**{f"{name}scale": scale})
        axes.set(**{f"{name}lim": _ends(panel, name)})
    _draw_axes(axes, panel, (left, bottom), (inside, height), width)


def _draw_axes(
    axes: Axes, panel: Panel, corner: tuple[float, float], size: tuple[float, float], width: float
) -> None:
    """Grid, axes, numbers and labels of a data area with this lower left corner and size [pt].

    They are plain lines and texts: axes of matplotlib lay out their numbers anew whenever they are drawn.
    """
    (left, bottom), (inside, height) = corner, size
    right, top = left + inside, bottom + height
    points = in_points(axes.get_figure())  # type: ignore[arg-type]
    label = panel.x.label if panel.x.numbered else ""
    across, up = _x_numbers(panel, inside), _y_numbers(panel, height)
    places_x = _on_axis(axes, "x", across) * inside + left
    places_y = _on_axis(axes, "y", up) * height + bottom
    grid = [((x, bottom), (x, top)) for x in places_x]
    grid += [((left, y), (right, y)) for y in places_y if panel.y.words is None]
    axes.add_artist(_strokes(grid, points, style.GRID, 0.7, GRID))
    edges = [((left, bottom), (left, top)), ((left, bottom), (right, bottom))]
    axes.add_artist(_strokes(edges, points, style.FAINT, 0.8, SPAN))

    def write(x: float, y: float, text: str, size: float, colour: str, **look: Any) -> None:
        axes.add_artist(Words(x, y, text, size=size, colour=colour, transform=points, **look))

    if panel.x.numbered:
        below = bottom - SPACE
        for x, text in zip(places_x, across.values(), strict=True):
            write(x, below - CAPITAL * NUMBER, text, NUMBER, style.MUTED, align="center")
    if panel.y.numbered:
        for y, text in zip(places_y, up.values(), strict=True):
            stressed = panel.y.bold != "" and text == panel.y.bold
            colour = style.ACCENT if stressed else style.MUTED
            middle = y - 0.5 * CAPITAL * NUMBER
            write(left - SPACE, middle, text, NUMBER, colour, align="right", bold=stressed)
    title = shortened(panel.title, width - 1.0, TITLE)
    if title:
        begin = max(0.0, min(left, width - 1.0 - width_of(title, TITLE)))
        write(begin, top + ABOVE, title, TITLE, style.INK)
    if label:
        half = 0.5 * width_of(label, LABEL)
        middle = min(max(left + 0.5 * inside, half), width - half)
        write(middle, SPACE, label, LABEL, style.INK, align="center")
    if panel.y.label:
        middle = bottom + 0.5 * height
        write(LABEL, middle, panel.y.label, LABEL, style.INK, align="center", turned=True)


def _on_axis(axes: Axes, name: str, numbers: Mapping[float, str]) -> np.ndarray:
    """Places of numbers along an axis, 0 to 1."""
    low, high = getattr(axes, f"get_{name}lim")()
    places = np.array([*numbers], dtype=float)
    if getattr(axes, f"get_{name}scale")() == "log":
        low, high, places = np.log(low), np.log(high), np.log(places)
    shares: np.ndarray = (places - low) / (high - low)
    return shares


def _strokes(
    lines: Sequence[tuple[tuple[float, float], tuple[float, float]]],
    points: Transform,
    colour: str,
    width: float,
    order: float,
) -> PathPatch:
    """Straight lines between places [pt] as a single path."""
    path = Path(np.reshape(lines, (-1, 2)), [Path.MOVETO, Path.LINETO] * len(lines))
    return PathPatch(
        path,
        fill=False,
        edgecolor=colour,
        linewidth=width,
        capstyle="butt",
        transform=points,
        clip_on=False,
        zorder=order,
    )


def key(sheet: Sheet) -> Iterator[Figure]:
    """A figure per entry of the key: a piece of what it names, and the name."""
    for label, look in sheet.key.items():
        yield _entry(label, look)
    if sheet.scale:
        yield _colour_scale(sheet.scale)


def _entry(label: str, look: Look) -> Figure:
    sample, middle = 16.0, 0.5 * LINE
    figure = _small_figure(sample + 6.0 + width_of(label, LABEL), LINE)
    points = in_points(figure)
    if look.opacity:
        shade = brush(look.colour, min(1.0, 2.0 * look.opacity))
        figure.add_artist(Rectangle((0.0, 1.5), sample, LINE - 3.0, transform=points, **shade))
    if look.line:
        figure.add_artist(Line2D([0.0, sample], [middle, middle], transform=points, **pen(look)))
    if look.marker:
        figure.add_artist(marks(points, np.array([[0.5 * sample, middle]]), look))
    down = middle - 0.36 * LABEL
    figure.add_artist(Words(sample + 5.0, down, label, size=LABEL, colour=style.INK, transform=points))
    return figure


def _colour_scale(scale: ColourScale) -> Figure:
    """The colours of a map from one end of their scale to the other, with numbers and label."""
    begin, width, high, count = 10.0, 180.0, 7.0, constants.MOST_COLOUR_STEPS
    figure = _small_figure(begin + width + 9.0 + width_of(scale.label, LABEL), high + 12.0)
    points = in_points(figure)
    for k in range(count):
        shade = brush(style.between(style.DIVERGING, k / (count - 1)))
        corner = (begin + width * k / count, 11.0)
        figure.add_artist(Rectangle(corner, width / count + 0.3, high, transform=points, **shade))
    for value, text in numbers_at(Axis(), -scale.limit, scale.limit, 8).items():
        at = begin + width * (0.5 + 0.5 * value / scale.limit)
        figure.add_artist(
            Words(at, 2.0, text, size=NUMBER, colour=style.MUTED, transform=points, align="center")
        )
    behind = begin + width + 8.0
    figure.add_artist(Words(behind, 12.0, scale.label, size=LABEL, colour=style.INK, transform=points))
    return figure


def _small_figure(width: float, height: float) -> Figure:
    """An empty figure of a size [pt]."""
    figure = Figure(figsize=(width / INCH, height / INCH))
    FigureCanvasAgg(figure)
    return figure
