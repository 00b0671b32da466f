"""Panels in matplotlib axes: every text and data area has a place known in advance, so nothing is laid out while drawing."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Rectangle

from mffit.report import constants, style
from mffit.report.drawing.content import INCH, SPAN, brush, in_points, marks, pen, show
from mffit.report.drawing.records import Axis, ColourScale, Look, Panel, Sheet
from mffit.report.drawing.texts import shortened, width_of
from mffit.report.drawing.ticks import limits, numbers_at

GAP = 10.0
"""Between panels side by side [pt]."""
TITLE, LABEL, NUMBER = 8.5, 8.0, 7.5
"""Sizes of letters [pt]."""
TOP, RIGHT = 17.0, 10.0
"""Margins of a data area [pt]."""
SPACE, LINE = 4.0, 11.0
"""Between letters and what they belong to, and height of a line of text [pt]."""
SETTINGS: dict[str, Any] = {
    "figure.dpi": float(constants.PICTURE_DPI),
    "font.family": "DejaVu Sans",  # comes with matplotlib, so that pictures are the same on every machine
    "font.size": NUMBER,
    "text.parse_math": False,
    "text.hinting": "no_hinting",
    "mathtext.default": "regular",
    "svg.fonttype": "none",
    "axes.axisbelow": True,
    "axes.facecolor": "none",
    "axes.edgecolor": style.FAINT,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.labelcolor": style.INK,
    "axes.labelsize": LABEL,
    "axes.titlecolor": style.INK,
    "axes.titlelocation": "left",
    "axes.titlesize": TITLE,
    "grid.color": style.GRID,
    "grid.linewidth": 0.7,
    "lines.dashed_pattern": (4.4, 2.2),
    "lines.dotted_pattern": (1.2, 1.9),
    "lines.scale_dashes": False,
    "xtick.bottom": False,
    "xtick.labelcolor": style.MUTED,
    "xtick.major.pad": SPACE,
    "xtick.major.size": 0.0,
    "ytick.left": False,
    "ytick.labelcolor": style.MUTED,
    "ytick.major.pad": SPACE,
    "ytick.major.size": 0.0,
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
    axes.spines[:].set_zorder(SPAN)
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
    label = panel.x.label if panel.x.numbered else ""
    bottom = SPACE + (LINE if panel.x.numbered else 0.0) + (LINE if label else 0.0)
    total = bottom + height + TOP
    figure.set_size_inches(width / INCH, total / INCH)
    axes.set_position((left / width, bottom / total, inside / width, height / total))
    x, y = panel.x, panel.y
    for axis, record, numbers in (
        (axes.xaxis, x, _x_numbers(panel, inside)),
        (axes.yaxis, y, _y_numbers(panel, height)),
    ):
        name = axis.axis_name
        axes.set(**{f"{name}scale": "log" if record.logarithmic else "linear"})
        axis.set_ticks([*numbers], [*numbers.values()] if record.numbered else [""] * len(numbers))
        axes.set(**{f"{name}lim": _ends(panel, name)})
    axes.minorticks_off()
    axes.xaxis.grid(True)
    axes.yaxis.grid(y.words is None)
    for text in axes.get_yticklabels():
        stressed = y.bold != "" and text.get_text() == y.bold
        text.set_color(style.ACCENT if stressed else style.MUTED)
        text.set_fontweight("bold" if stressed else "normal")
    title = shortened(panel.title, width - 1.0, TITLE)
    axes.set_title(
        title, x=(max(0.0, min(left, width - 1.0 - width_of(title, TITLE))) - left) / inside, y=1.0
    )
    half = 0.5 * width_of(label, LABEL)
    middle = min(max(left + 0.5 * inside, half), width - half)
    axes.set_xlabel(label, va="baseline")
    axes.set_ylabel(y.label, va="baseline")
    axes.xaxis.set_label_coords(middle, SPACE, in_points(figure))
    axes.yaxis.set_label_coords(LABEL, bottom + 0.5 * height, in_points(figure))


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
    figure.text(sample + 5.0, middle - 0.36 * LABEL, label, size=LABEL, color=style.INK, transform=points)
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
        figure.text(at, 2.0, text, color=style.MUTED, ha="center", transform=points)
    figure.text(begin + width + 8.0, 12.0, scale.label, size=LABEL, color=style.INK, transform=points)
    return figure


def _small_figure(width: float, height: float) -> Figure:
    """An empty figure of a size [pt]."""
    figure = Figure(figsize=(width / INCH, height / INCH))
    FigureCanvasAgg(figure)
    return figure
