"""A sheet drawn once by matplotlib, as a PNG and as SVG that a page arranges panel by panel."""

from __future__ import annotations

import gc
import re
import textwrap
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from xml.sax.saxutils import escape

import matplotlib.style
import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from mffit.report import constants, style
from mffit.report.drawing.ink import FINE, Ink
from mffit.report.drawing.records import (
    Axis,
    Bars,
    ColourScale,
    Look,
    Panel,
    Sheet,
    Trace,
)

INCH = 72.0
KEY_LINE = 13.0
"""Height of a line of the key [pt]."""
SCALE = (14.0, 17.0, 180.0, 7.0)
"""Left, bottom, width and height of the scale of maps, in what is above the panels [pt]."""
NO_FORMULA = re.compile(r"\$(?!_\{\w+\}\$)(?<!\}\$)")
"""A dollar sign that does not belong to a subscript such as that of ``QuantityName.mathtext``."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A sheet as PNG, and as HTML whose panels a page arranges to its width."""

    png: bytes
    markup: str


def draw(sheet: Sheet, name: str) -> Drawing:
    """Draw the sheet; the same sheet and name give the same bytes. Names of the page's other pictures must differ."""
    with _settings():
        figure = figure_of(sheet)
        ink = Ink(figure.bbox.width, figure.bbox.height, figure.dpi, name)
        figure.draw(ink)
        return Drawing(png=ink.png(), markup=_markup(ink, figure, sheet))


def save(sheet: Sheet, path: Path) -> None:
    """Draw the sheet as a PNG alone."""
    path.write_bytes(draw(sheet, path.stem).png)


@contextmanager
def _settings() -> Iterator[None]:
    """Drawing in our style, whatever a user's matplotlibrc says; letters that the font lacks become boxes."""
    collected = gc.isenabled()
    gc.disable()  # a figure is thousands of small objects that all live; to look for dead ones takes a sixth of the time
    try:
        with matplotlib.style.context(style.SETTINGS, after_reset=True), warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph")
            yield
    finally:
        if collected:
            gc.enable()


def figure_of(sheet: Sheet) -> Figure:
    """The sheet as a figure: a key, and below it panels of one size in rows, each with its axes."""
    entries = _columns_of_key(sheet)
    above = KEY_LINE * -(-len(sheet.key) // entries) + (2.5 * KEY_LINE if sheet.scale else 0.0) + 3.0
    width, height = _size_of_panel(sheet)
    whole = above + height * len(sheet.rows)
    figure = Figure(figsize=(style.WIDTH / INCH, whole / INCH))
    if sheet.key:
        handles = [_sample(look) for look in sheet.key.values()]
        key = figure.legend(handles, [_text(label) for label in sheet.key], loc="upper left", ncols=entries)
        key.set_gid("key")
    if sheet.scale:
        left, bottom, wide, high = SCALE
        place = left / style.WIDTH, (whole - above + bottom) / whole, wide / style.WIDTH, high / whole
        _draw_scale(figure.add_axes(place, gid="scale"), sheet.scale)
    longest = int((width - style.RIGHT) / style.LETTER)
    for row, panels in enumerate(sheet.rows):
        for column, panel in enumerate(panels):
            lines = "\n".join(_words_of(panel.y, width)).split("\n")
            left = max(style.LEFT, style.LETTER * max(map(len, lines)) + 6.0)
            bottom = whole - above - height * (row + 1) + style.BOTTOM
            size = width - left - style.RIGHT, height - style.BOTTOM - style.TOP
            place = (
                (width * column + left) / style.WIDTH,
                bottom / whole,
                size[0] / style.WIDTH,
                size[1] / whole,
            )
            axes = figure.add_axes(place, gid=f"panel-{len(figure.axes)}")
            axes.patch.set_visible(False)
            axes.xaxis.set_label_coords(
                0.5, -19.0 / size[1]
            )  # a place that depends on the numbers costs a third
            axes.yaxis.set_label_coords((12.0 - left) / size[0], 0.5)
            title = panel.title
            if len(title) > longest + 4:
                title = textwrap.shorten(title, longest, placeholder="…")
            start = max(
                4.0, min(style.LEFT, width - style.LETTER * len(title))
            )  # a long one begins further left
            axes.set_title(_text(title), x=(start - left) / size[0])
            _draw_panel(axes, panel, width, sheet.scale)
    return figure


def _size_of_panel(sheet: Sheet) -> tuple[float, float]:
    """Width and height of a panel with its margins [pt]."""
    return style.WIDTH / sheet.columns, INCH * sheet.height + style.BOTTOM + style.TOP


def _columns_of_key(sheet: Sheet) -> int:
    """Columns in which the key is no wider than a telephone shows."""
    longest = max(map(len, sheet.key), default=1)
    return max(1, int(0.5 * style.WIDTH / (style.LETTER * (longest + 6))))


def _sample(look: Look) -> Line2D | Patch:
    """A piece of what an entry of the key names."""
    if look.opacity:
        return Patch(color=look.colour, alpha=look.opacity, linewidth=0.0)
    return Line2D([], [], **_line(look))


def _draw_scale(axes: Axes, scale: ColourScale) -> None:
    edges, colours = _shades(scale)
    axes.bar(edges[:-1], 1.0, np.diff(edges), align="edge", color=colours)
    axes.set(xlim=(-scale.limit, scale.limit), ylim=(0.0, 1.0), yticks=[])
    axes.spines[:].set_visible(False)
    axes.grid(False)
    axes.text(1.04, 0.5, _text(scale.label), transform=axes.transAxes, va="center", size=8)


def _shades(scale: ColourScale) -> tuple[np.ndarray, list[str]]:
    """Edges (n + 1,) of the steps of a scale, and their n colours."""
    n = int(constants.COLOURS_OF_MAP)
    colours = [to_hex(shade) for shade in colormaps[style.DIVERGING].resampled(n)(np.arange(n))]
    return np.linspace(-scale.limit, scale.limit, n + 1), colours


def _text(text: str) -> str:
    """Text in which only subscripts are set: names may hold any sign."""
    return NO_FORMULA.sub(r"\\$", text)


def _draw_panel(axes: Axes, panel: Panel, width: float, scale: ColourScale | None) -> None:
    for name in "xy":
        _set_axis(axes, name, getattr(panel, name), width)
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
            axes.barh(series.places, series.lengths - begin, series.height, begin, color=series.colours)
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


def _set_axis(axes: Axes, name: str, axis: Axis, width: float) -> None:
    axes.set(**{f"{name}label": _text(axis.label)})
    if name == "y" and not axis.logarithmic:
        axes.locator_params("y", nbins=5)
    if axis.logarithmic:
        axes.set(**{f"{name}scale": "log", f"{name}lim": (axis.low, axis.high)})
        getattr(axes, f"{name}axis").set_major_formatter(_power)
    if axis.words is not None:
        words = _words_of(axis, width) if name == "y" else [_text(word) for word in axis.words.values()]
        axes.set(**{f"{name}ticks": [*axis.words], f"{name}ticklabels": words})
        axes.grid(False, axis=name)  # type: ignore[arg-type]


def _power(x: float, _: object) -> str:
    """A power of ten, without the formula of matplotlib."""
    return "10" + f"{np.log10(x):.0f}".translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))


def _words_of(axis: Axis, width: float) -> list[str]:
    """The names at a vertical axis, in lines that leave room for the data."""
    half = int(0.58 * width / style.LETTER)
    return [textwrap.fill(_text(word), half) for word in (axis.words or {}).values()]


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
    """Draw a series; ``size`` is that of its marks over the usual one."""
    _draw_uncertainty(axes, series)
    look = replace(series.look, size=size * series.look.size)
    place: dict[str, Any] = {"zorder": 1.8 if look.marker else 2.0}
    if series.shade is None or scale is None:
        axes.plot(series.x, series.y, **_line(look), **place)
        return
    edges, colours = _shades(scale)
    step = np.searchsorted(edges[1:-1], series.shade)
    for k in np.unique(step):
        drawn = {
            **_line(replace(look, colour=colours[k])),
            "markeredgewidth": 0.4,
            "markeredgecolor": style.FAINT,
        }
        axes.plot(series.x[step == k], series.y[step == k], **drawn, **place)


def _draw_uncertainty(axes: Axes, series: Trace) -> None:
    """A band in the colour of a line, or bars at the points."""
    if series.half is None and series.half_x is None:
        return
    none, look = np.zeros(len(series)), series.look
    along_x, along_y = (
        none if series.half_x is None else series.half_x,
        none if series.half is None else series.half,
    )
    (left, right), (low, high) = (
        (series.x - along_x, series.x + along_x),
        (series.y - along_y, series.y + along_y),
    )
    if look.line:
        around = np.concatenate([left, right[::-1]]), np.concatenate([low, high[::-1]])
        axes.fill(*around, color=look.colour, alpha=style.SHADE, linewidth=0.0)
    else:
        bars = [np.column_stack([*ends, none + np.nan]).ravel() for ends in ((left, right), (low, high))]
        cap = "_" if series.half_x is None else "|"
        axes.plot(
            *bars,
            color=look.colour,
            linewidth=look.width,
            marker=cap,
            markersize=5.0,
            markeredgewidth=look.width,
        )


def _markup(ink: Ink, figure: Figure, sheet: Sheet) -> str:
    """The key and rows of panels, each a drawing of its own with the part of the figure that it shows."""
    scale, high = figure.dpi / INCH, figure.bbox.height
    width, height = _size_of_panel(sheet)
    above = high / scale - height * len(sheet.rows)

    def drawing(name: str, left: float, top: float, width: float, height: float, title: str = "") -> str:
        box = " ".join(str(round(FINE * scale * x)) for x in (left, top, width, height))
        said = f"<title>{escape(title)}</title>" if title else ""
        return f'<svg viewBox="{box}" style="--w:{width:.5g}">{said}{ink.parts[name]}</svg>'

    keys = [*figure.legends, *(axes for axes in figure.axes if axes.get_gid() == "scale")]
    boxes = {key.get_gid(): key.get_tightbbox(ink) for key in keys}
    shown = [
        drawing(
            name or "", 0.0, (high - box.y1) / scale - 2.0, box.x1 / scale + 9.0, box.height / scale + 4.0
        )
        for name, box in boxes.items()
        if box is not None
    ]
    names = (axes.get_gid() for axes in figure.axes if axes.get_gid() != "scale")
    out = [f'<div class="panels" style="--widest:{width:.5g};--abreast:{sheet.columns}">']
    if shown:
        out.append(f'<div class="key">{"".join(shown)}</div>')
    for row, panels in enumerate(sheet.rows):
        places = ((width * column, above + height * row, width, height) for column in range(len(panels)))
        alone = (
            drawing(str(name), *place, panel.title)
            for place, panel, name in zip(places, panels, names, strict=False)
        )
        out.append(f'<div class="row">{"".join(alone)}</div>')
    return "\n".join([*out, "</div>"])
