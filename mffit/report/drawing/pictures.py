"""A sheet drawn once by matplotlib: the whole as a PNG, and its panels cut out of it for a page to arrange."""

import base64
import io
import re
import textwrap
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
from PIL import Image

from mffit.report import constants, style
from mffit.report.drawing.records import Axis, Bars, ColourScale, Look, Panel, Sheet, Trace

INCH = 72.0
NUMBER_OFF = 7.0
"""Distance of a number from its axis [pt]."""
KEY_LINE = 13.0
"""Height of a line of the key [pt]."""
SCALE = (14.0, 17.0, 180.0, 7.0)
"""Left, bottom, width and height of the scale of maps, in what is above the panels [pt]."""
UNIT = re.compile(r"(?<=\d) (?=\S+$)")
"""Between a number and its unit at the end of a name."""
NO_FORMULA = re.compile(r"\$(?!_\{\w+\}\$)(?<!\}\$)")
"""A dollar sign that does not belong to a subscript such as that of ``QuantityName.mathtext``."""
COLOURS = 128
"""Colours of a PNG: a third of the bytes without a visible difference."""


class Drawing(NamedTuple):
    """A sheet as PNG, and as HTML whose panels a page arranges to its width."""

    png: bytes
    markup: str


def draw(sheet: Sheet) -> Drawing:
    """Draw the sheet; the same sheet gives the same bytes."""
    whole = _image(sheet)
    return Drawing(png=_png(whole), markup=_markup(whole, sheet))


def save(sheet: Sheet, path: Path) -> None:
    """Draw the sheet as a PNG alone."""
    path.write_bytes(_png(_image(sheet)))


def _image(sheet: Sheet) -> Image.Image:
    with _settings():
        canvas = FigureCanvasAgg(figure_of(sheet))
        canvas.draw()  # type: ignore[no-untyped-call]
        pixels = Image.fromarray(np.asarray(canvas.buffer_rgba())).convert("RGB")  # type: ignore[no-untyped-call]
    return pixels.quantize(COLOURS, Image.Quantize.FASTOCTREE)


@contextmanager
def _settings() -> Iterator[None]:
    """Drawing in our style, whatever a user's matplotlibrc says; letters that the font lacks become boxes."""
    with matplotlib.style.context(style.SETTINGS, after_reset=True), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph")
        yield


def figure_of(sheet: Sheet) -> Figure:
    """The sheet as a figure: a key, and below it panels of one size in rows, each with its axes."""
    entries = _columns_of_key(sheet)
    above = _above(sheet)
    width, height, top = _size_of_panel(sheet)
    whole = above + height * len(sheet.rows)
    figure = Figure(figsize=(style.WIDTH / INCH, whole / INCH))

    def added(left: float, bottom: float, wide: float, high: float) -> Axes:
        """Axes at a place [pt]."""
        return figure.add_axes((left / style.WIDTH, bottom / whole, wide / style.WIDTH, high / whole))

    if sheet.key:
        handles = [_sample(look) for look in sheet.key.values()]
        figure.legend(handles, [_text(label) for label in sheet.key], loc="upper left", ncols=entries)
    if sheet.scale:
        left, bottom, *size = SCALE
        _draw_scale(added(left, whole - above + bottom, *size), sheet.scale)
    for row, panels in enumerate(sheet.rows):
        for column, panel in enumerate(panels):
            lines = "\n".join(_words_of(panel.y, width)).split("\n")
            left = max(style.LEFT, style.LETTER * max(map(len, lines)) + NUMBER_OFF + 3.0)
            wide, high = width - left - style.RIGHT, height - style.BOTTOM - top
            axes = added(width * column + left, whole - above - height * (row + 1) + style.BOTTOM, wide, high)
            axes.set_title("\n".join(_title_of(panel, width)), x=(4.0 - left) / wide)
            _draw_panel(axes, panel, width, sheet.scale)
            _draw_axis(axes, "x", panel.x, [_text(word) for word in (panel.x.words or {}).values()])
            _draw_axis(axes, "y", panel.y, _words_of(panel.y, width))
            # places that depend on the numbers at the axes cost a third of the time, a text that axes clip a tenth
            lie = {"transform": axes.transAxes, "ha": "center", "size": style.SETTINGS["axes.labelsize"]}
            figure.text(0.5, -19.0 / high, _text(panel.x.label), va="top", **lie)
            figure.text(
                (12.0 - left) / wide,
                0.5,
                _text(panel.y.label),
                va="bottom",
                rotation="vertical",
                rotation_mode="anchor",
                **lie,
            )
    return figure


def _above(sheet: Sheet) -> float:
    """Height of key and scale above the panels [pt]."""
    lines = -(-len(sheet.key) // _columns_of_key(sheet))
    return KEY_LINE * lines + (2.5 * KEY_LINE if sheet.scale else 0.0) + 3.0


def _size_of_panel(sheet: Sheet) -> tuple[float, float, float]:
    """Width and height of a panel with its margins, and the margin above it [pt]: room for titles and names of several lines."""
    width = style.WIDTH / sheet.columns
    title = max((len(_title_of(panel, width)) for panel in sheet.panels), default=1)
    top = style.TOP + (max(title, 1) - 1) * style.LINE
    names = [_words_of(panel.y, width) for panel in sheet.panels]
    lines = (len(words) * (word.count("\n") + 1) for words in names for word in words)
    return width, max(INCH * sheet.height, max(lines, default=0) * style.LINE) + style.BOTTOM + top, top


def _title_of(panel: Panel, width: float) -> list[str]:
    """The lines of a title."""
    longest, most = int((width - style.RIGHT) / style.LETTER), style.TITLE_LINES
    return [_text(line) for line in textwrap.wrap(panel.title, longest, max_lines=most, placeholder="…")]


def _columns_of_key(sheet: Sheet) -> int:
    """Largest number of columns of the key that fit a telephone."""
    longest = max(map(len, sheet.key), default=1)
    return max(1, int(0.5 * style.WIDTH / (style.LETTER * (longest + 6))))


def _sample(look: Look) -> Line2D | Patch:
    """A piece of what an entry of the key names."""
    if look.opacity:
        return Patch(color=look.colour, alpha=look.opacity, linewidth=0.0)
    return Line2D([], [], **_line(look))


def _draw_scale(axes: Axes, scale: ColourScale) -> None:
    shades = np.linspace(-scale.limit, scale.limit, 256)[None]
    axes.imshow(
        shades,
        cmap=style.colour_map(style.DIVERGING),
        extent=(-scale.limit, scale.limit, 0.0, 1.0),
        aspect="auto",
    )
    axes.set(yticks=[])
    axes.spines[:].set_visible(False)
    axes.tick_params(length=0.0, pad=NUMBER_OFF, labelcolor=style.MUTED)
    axes.text(1.04, 0.5, _text(scale.label), transform=axes.transAxes, va="center", size=8)


def _text(text: str) -> str:
    """Text in which only subscripts are set: names may hold any sign."""
    return NO_FORMULA.sub(r"\\$", text)


def _draw_panel(axes: Axes, panel: Panel, width: float, scale: ColourScale | None) -> None:
    for name in "xy":
        along = getattr(panel, name)
        if along.logarithmic:
            axes.set(**{f"{name}scale": "log", f"{name}lim": (along.low, along.high)})
    for span in panel.spans:
        axes.axvspan(
            span.first, span.last, color=span.look.colour, alpha=span.look.opacity, linewidth=0.0, zorder=0.7
        )
    for guide in panel.guides:
        across = axes.axvline if guide.axis == "x" else axes.axhline
        across(guide.at, zorder=1.5, **_line(guide.look))
    marked = (len(s) for s in panel.series if isinstance(s, Trace) and s.look.marker)
    size = 0.6 if sum(marked) > constants.MOST_MARKS else 1.0
    for series in panel.series:
        if isinstance(series, Bars):
            begin = axes.get_xlim()[0] if axes.get_xscale() == "log" else 0.0
            axes.barh(series.columns()["y"], series.lengths - begin, 0.62, begin, color=series.colours)
        else:
            _draw_trace(axes, series, size, scale)
    for name in "xy":
        axis: Axis = getattr(panel, name)
        axes.set(**{f"{name}lim": (axis.low, axis.high)})
    for note in panel.notes:
        axes.annotate(
            note.text,
            (note.x, note.y),
            (2.5, 0.0),
            textcoords="offset points",
            color=note.colour,
            va="center",
        )


def _draw_axis(axes: Axes, name: str, axis: Axis, words: Sequence[str]) -> None:
    """Numbers or words at an axis, and the lines of its grid: half the time of matplotlib's own, which are five artists each."""
    own, (low, high) = {"x": (axes.xaxis, axes.get_xlim()), "y": (axes.yaxis, axes.get_ylim())}[name]
    if name == "y" and not axis.logarithmic:
        axes.locator_params("y", nbins=5)
    if name == "x" and axis.words is None and not axis.logarithmic:
        _space_out(axes)
    own.set_visible(False)
    places = np.array([*axis.words] if axis.words is not None else own.get_majorticklocs())
    shown = (places >= min(low, high)) & (places <= max(low, high))
    labels = words if axis.words is not None else own.get_major_formatter().format_ticks(places.tolist())
    if name == "x" and axis.words is None:
        labels = [
            "" if _runs_out(axes, place, label) else label
            for place, label in zip(places, labels, strict=True)
        ]
    along = axes.get_xaxis_text1_transform if name == "x" else axes.get_yaxis_text1_transform
    transform, up, side = along(NUMBER_OFF)
    for place, label in zip(places[shown], np.array(labels, dtype=object)[shown], strict=True):
        x, y = (place, 0.0) if name == "x" else (0.0, place)
        axes.figure.text(x, y, label, transform=transform, va=up, ha=side, color=style.MUTED)
    if axis.words is None:
        across = np.tile([0.0, 1.0, np.nan], int(shown.sum())), np.repeat(places[shown], 3)
        x, y = across[::-1] if name == "x" else across
        grid = axes.get_xaxis_transform("grid") if name == "x" else axes.get_yaxis_transform("grid")
        axes.add_artist(Line2D(x, y, transform=grid, zorder=0.5, color=style.GRID, linewidth=0.7))


def _runs_out(axes: Axes, place: float, label: str) -> bool:
    """Whether the number at a place of the horizontal axis ends beyond the margin of its panel, where it is cut."""
    share = axes.transLimits.transform(axes.transScale.transform((place, axes.get_ylim()[0])))[0]
    left = (1.0 - share) * axes.get_position().width * style.WIDTH + style.RIGHT
    return bool(0.5 * style.LETTER * len(label) > left)


def _space_out(axes: Axes) -> None:
    """Fewer ticks across, where their numbers would run into each other."""
    own, (low, high) = axes.xaxis, sorted(axes.get_xlim())
    places = [float(x) for x in own.get_majorticklocs() if low <= x <= high]
    longest = max(map(len, own.get_major_formatter().format_ticks(places)), default=0)
    most = int(axes.get_position().width * style.WIDTH / (style.LETTER * (longest + 1)))
    if most < len(places):
        axes.locator_params("x", nbins=max(most, 2))


def _words_of(axis: Axis, width: float) -> list[str]:
    """The names at a vertical axis, in lines that leave room for the data."""
    half = int(0.58 * width / style.LETTER)
    return [
        textwrap.fill(_text(UNIT.sub("\N{NO-BREAK SPACE}", word)), half)
        for word in (axis.words or {}).values()
    ]


def _line(look: Look) -> dict[str, Any]:
    """Arguments of a line with markers."""
    return {
        "color": look.colour,
        "linestyle": look.line or "none",
        "linewidth": look.width,
        "marker": look.marker or "none",
        "markersize": 2.0 * look.size if look.marker == "." else look.size,
        "markerfacecolor": "none" if look.hollow else look.colour,
        "markeredgewidth": 0.8 if look.hollow or look.marker == "x" else 0.0,
    }


def _draw_trace(axes: Axes, series: Trace, size: float, scale: ColourScale | None) -> None:
    """Draw a series with its uncertainty; ``size`` is that of its marks over the usual one."""
    x, y, look = series.x, series.y, replace(series.look, size=size * series.look.size)
    if series.half is not None and look.line:
        low, high = y - series.half, y + series.half
        axes.fill_between(x, low, high, color=look.colour, alpha=style.SHADE, linewidth=0.0)
    elif series.half is not None or series.half_x is not None:
        bars = {"ecolor": look.colour, "elinewidth": look.width, "capthick": look.width}
        axes.errorbar(x, y, series.half, series.half_x, "none", **bars)  # type: ignore[arg-type]
    if series.shade is None or scale is None:
        axes.plot(x, y, **_line(look), zorder=1.8 if look.marker else 2.0)
        return
    axes.scatter(
        x,
        y,
        look.size**2,
        series.shade,
        marker=look.marker,
        cmap=style.colour_map(style.DIVERGING),
        vmin=-scale.limit,
        vmax=scale.limit,
        edgecolors=style.FAINT,
        linewidths=0.4,
        zorder=1.8,
    )


def _png(image: Image.Image) -> bytes:
    stream = io.BytesIO()
    dpi = style.SETTINGS["figure.dpi"]
    image.save(stream, "png", dpi=(dpi, dpi))
    return stream.getvalue()


def _markup(whole: Image.Image, sheet: Sheet) -> str:
    """The key and rows of panels, each an image of its own with the colours of the whole."""
    width, height, _ = _size_of_panel(sheet)
    above, point = _above(sheet), style.SETTINGS["figure.dpi"] / INCH

    def image(left: float, top: float, wide: float, high: float) -> str:
        first, last = round(point * top), min(round(point * (top + high)), whole.height)
        cut = whole.crop((round(point * left), first, round(point * (left + wide)), last))
        data = base64.b64encode(_png(cut)).decode("ascii")
        return f'<img alt="" style="--w:{wide:.5g}" src="data:image/png;base64,{data}">'

    out = [f'<div class="panels" style="--widest:{width:.5g};--abreast:{sheet.columns}">']
    key = np.asarray(whole.crop((0, 0, whole.width, int(point * above))).convert("L"))
    inked = np.flatnonzero((key < 250).any(axis=0))
    if inked.size:
        out.append(f'<div class="key">{image(0.0, 0.0, inked[-1] / point + 3.0, above)}</div>')
    for row, panels in enumerate(sheet.rows):
        top = above + height * row
        alone = (image(width * column, top, width, height) for column in range(len(panels)))
        out.append(f'<div class="row">{"".join(alone)}</div>')
    return "\n".join([*out, "</div>"])
