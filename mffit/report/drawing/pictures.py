"""A sheet drawn once by matplotlib, as a PNG and as SVG that a page arranges panel by panel."""

from __future__ import annotations

import gc
import io
import re
import textwrap
import warnings
import xml.etree.ElementTree as ET
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import matplotlib.style
import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure, SubFigure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, Rectangle

from mffit.report import constants, style
from mffit.report.drawing.records import (
    Axis,
    Band,
    Bars,
    ColourScale,
    DataSeries,
    ErrorBars,
    Frame,
    Look,
    Map,
    Panel,
    Sheet,
    Trace,
)

INCH = 72.0
KEY_LINE = 13.0
"""Height of a line of the key [pt]."""
MARKS, LINES = 1.8, 2.0
"""Order of drawing; where marks are many, a page has them and what is below them as pixels."""
KEY, PANEL = "key", "panel-{}"
"""Names of the parts of a drawing."""
SVG = "{http://www.w3.org/2000/svg}"
NO_FORMULA = re.compile(r"\$(?!_\{\w+\}\$)(?<!\}\$)")
"""A dollar sign that does not belong to a subscript such as that of ``QuantityName.mathtext``."""
ET.register_namespace("", SVG[1:-1])
ET.register_namespace("xlink", "http://www.w3.org/1999/xlink")


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A sheet as PNG, and as HTML whose panels a page arranges to its width."""

    png: bytes
    markup: str


def draw(sheet: Sheet, name: str) -> Drawing:
    """Draw the sheet; the same sheet and name give the same bytes. Names of the page's other pictures must differ."""
    with _settings(name):
        figure = figure_of(sheet)
        drawn = _png(figure)
        figure.set_layout_engine("none")  # both have the layout of the first
        svg = io.BytesIO()
        figure.savefig(svg, format="svg", dpi=160, transparent=True, metadata={"Date": None})
        return Drawing(png=drawn, markup=_markup(ET.fromstring(svg.getvalue()), figure, sheet))


def save(sheet: Sheet, path: Path) -> None:
    """Draw the sheet as a PNG alone."""
    with _settings(path.stem):
        path.write_bytes(_png(figure_of(sheet)))


def _png(figure: Figure) -> bytes:
    stream = io.BytesIO()
    figure.savefig(stream, format="png", metadata={"Software": None}, pil_kwargs={"compress_level": 3})
    return stream.getvalue()


@contextmanager
def _settings(name: str) -> Iterator[None]:
    """Drawing in our style, whatever a user's matplotlibrc says; letters that the font lacks become boxes."""
    settings = {**style.SETTINGS, "svg.hashsalt": name}
    collected = gc.isenabled()
    gc.disable()  # a figure is thousands of small objects that all live; to look for dead ones takes a sixth of the time
    try:
        with matplotlib.style.context(settings, after_reset=True), warnings.catch_warnings():
            warnings.filterwarnings("ignore", "Glyph")
            yield
    finally:
        if collected:
            gc.enable()


def figure_of(sheet: Sheet) -> Figure:
    """The sheet as a figure: a key, and below it a grid of parts of one size, each with the axes of a panel."""
    columns = sheet.columns
    width, height = style.WIDTH / columns, INCH * sheet.height + style.BOTTOM + style.TOP
    entries = _columns_of_key(sheet)
    above = KEY_LINE * -(-len(sheet.key) // entries) + (2.5 * KEY_LINE if sheet.scale else 0.0) + 3.0
    # To lay out every panel takes as long as to draw it: names beside an axis need that, numbers have their margins.
    named = any(panel.y.words for panel in sheet.panels)
    size = (style.WIDTH / INCH, (above + height * len(sheet.rows)) / INCH)
    figure = Figure(figsize=size, layout="constrained" if named else None)
    grid = figure.add_gridspec(
        len(sheet.rows) + 1, columns, height_ratios=[above] + [height] * len(sheet.rows)
    )
    margins = {"left": style.LEFT / width, "right": 1.0 - style.RIGHT / width}
    margins |= {"bottom": style.BOTTOM / height, "top": 1.0 - style.TOP / height}
    if sheet.key or sheet.scale:
        _draw_key(figure.add_subfigure(grid[0, :]), sheet, entries, above)
    number = 0
    for row, panels in enumerate(sheet.rows, 1):
        for column, panel in enumerate(panels):
            part = figure.add_subfigure(grid[row, column])
            part.set_gid(PANEL.format(number))
            axes = part.subplots(gridspec_kw=None if named else margins)
            _draw_panel(axes, panel, width)
            number += 1
    return figure


def _columns_of_key(sheet: Sheet) -> int:
    """Columns in which the key is no wider than a telephone shows."""
    longest = max(map(len, sheet.key), default=1)
    return max(1, int(0.5 * style.WIDTH / (style.LETTER * (longest + 6))))


def _draw_key(part: SubFigure, sheet: Sheet, columns: int, height: float) -> None:
    part.set_gid(KEY)
    if sheet.key:
        handles = [_sample(look) for look in sheet.key.values()]
        part.legend(handles, [_text(label) for label in sheet.key], loc="upper left", ncols=columns)
    if sheet.scale:
        _draw_scale(part, sheet.scale, height)


def _sample(look: Look) -> Line2D | Patch:
    """A piece of what an entry of the key names."""
    if look.opacity:
        return Patch(color=look.colour, alpha=look.opacity, linewidth=0.0)
    return Line2D([], [], **_line(look))


def _draw_scale(part: SubFigure, scale: ColourScale, height: float) -> None:
    axes = part.add_axes((14.0 / style.WIDTH, 17.0 / height, 180.0 / style.WIDTH, 7.0 / height))
    colours = ScalarMappable(Normalize(-scale.limit, scale.limit), style.DIVERGING)
    bar = part.colorbar(colours, cax=axes, orientation="horizontal")
    bar.outline.set_visible(False)
    bar.ax.text(1.04, 0.5, _text(scale.label), transform=axes.transAxes, va="center", size=8)


def _text(text: str) -> str:
    """Text in which only subscripts are set: names may hold any sign."""
    return NO_FORMULA.sub(r"\\$", text)


def _draw_panel(axes: Axes, panel: Panel, width: float) -> None:
    longest = int((width - style.RIGHT) / style.LETTER)
    title = (
        panel.title
        if len(panel.title) <= longest + 4
        else textwrap.shorten(panel.title, longest, placeholder="…")
    )
    axes.set_title(_text(title))
    for name in "xy":
        _set_axis(axes, name, getattr(panel, name), width)
    for span in panel.spans:
        axes.axvspan(
            span.first, span.last, color=span.look.colour, alpha=span.look.opacity, linewidth=0.0, zorder=0.7
        )
    for guide in panel.guides:
        across = axes.axvline if guide.axis == "x" else axes.axhline
        across(guide.at, zorder=1.5, **_line(guide.look))
    dense = sum(len(s) for s in panel.series if isinstance(s, Map) or _marked(s)) > constants.MOST_MARKS
    if dense:
        axes.set_rasterization_zorder(LINES)
    for series in panel.series:
        _draw_series(axes, series, 0.6 if dense else 1.0)
    for name in "xy":
        axis: Axis = getattr(panel, name)
        axes.set(**{f"{name}lim": (axis.low, axis.high)})
    for frame in panel.frames:
        _draw_frame(axes, frame)
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
    if axis.words is not None:
        half = int(0.58 * width / style.LETTER)
        words = [
            textwrap.fill(_text(word), half) if name == "y" else _text(word) for word in axis.words.values()
        ]
        axes.set(**{f"{name}ticks": [*axis.words], f"{name}ticklabels": words})
        axes.grid(False, axis=name)  # type: ignore[arg-type]


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


def _marked(series: DataSeries) -> bool:
    return isinstance(series, Trace) and bool(series.look.marker)


def _draw_series(axes: Axes, series: DataSeries, size: float) -> None:
    """Draw a series; ``size`` is that of its marks over the usual one."""
    match series:
        case Trace(x=x, y=y, look=look):
            look = replace(look, size=size * look.size)
            axes.plot(x, y, **_line(look), zorder=MARKS if look.marker else LINES)
        case Band(x=x, low=low, high=high, x_high=x_high, look=look):
            back = (x if x_high is None else x_high)[::-1], high[::-1]
            around = np.concatenate([x, back[0]]), np.concatenate([low, back[1]])
            axes.fill(*around, color=look.colour, alpha=look.opacity, linewidth=0.0)
        case ErrorBars(x=x, y=y, u=u, look=look, along=along):
            sides: dict[str, Any] = {f"{along}err": u, "elinewidth": look.width, "capthick": look.width}
            axes.errorbar(x, y, **sides, **{**_line(look), "linestyle": "none"})
        case Bars():
            begin = axes.get_xlim()[0] if axes.get_xscale() == "log" else 0.0
            axes.barh(series.places, series.lengths - begin, series.height, begin, color=series.colours)
        case Map(x=x, y=y, values=values, limit=limit):
            colours: dict[str, Any] = {"c": values, "cmap": style.DIVERGING, "vmin": -limit, "vmax": limit}
            axes.scatter(
                x,
                y,
                16.0 * size**2,
                marker="s",
                linewidths=0.4,
                edgecolors=style.FAINT,
                zorder=MARKS,
                **colours,
            )


def _draw_frame(axes: Axes, frame: Frame) -> None:
    """A frame within the axes, widened so that a single value has a width."""
    sides = []
    for name in "xy":
        low, high = sorted(getattr(axes, f"get_{name}lim")())
        pad, bounds = 0.03 * (high - low), getattr(frame, name)
        first, last = (low, high) if bounds is None else (min(bounds) - pad, max(bounds) + pad)
        sides.append((max(first, low), min(last, high)))
    (left, right), (bottom, top) = sides
    edge = {"linestyle": "--", "linewidth": 1.0, "edgecolor": style.INK, "zorder": 3.0}
    axes.add_patch(Rectangle((left, bottom), right - left, top - bottom, fill=False, **edge))  # type: ignore[arg-type]


def _markup(svg: ET.Element, figure: Figure, sheet: Sheet) -> str:
    """The key and rows of panels, each a drawing of its own with the part of the figure that it shows."""
    parts = {part.get_gid(): part for part in figure.subfigs}
    groups = {group.get("id"): group for group in svg.iter(f"{SVG}g")}
    shared = svg.findall(f"{SVG}defs")  # clip paths
    for group in groups.values():
        group.attrib.pop("id", None)

    def drawing(name: str, title: str = "") -> str:
        box = _extent(figure, parts[name])
        alone = ET.Element(
            f"{SVG}svg", {"viewBox": " ".join(f"{x:.2f}" for x in box), "style": f"--w:{box[2]:.2f}"}
        )
        if title:
            ET.SubElement(alone, f"{SVG}title").text = title
        alone.extend([*shared, groups[name]])
        shared.clear()
        return ET.tostring(alone, encoding="unicode")

    out = [
        f'<div class="panels" style="--widest:{style.WIDTH / sheet.columns:.2f};--abreast:{sheet.columns}">'
    ]
    if KEY in parts:
        out.append(f'<div class="key">{drawing(KEY)}</div>')
    numbers = iter(range(len(sheet.panels)))
    for row in sheet.rows:
        out += [
            '<div class="row">',
            *(drawing(PANEL.format(next(numbers)), panel.title) for panel in row),
            "</div>",
        ]
    return "\n".join([*out, "</div>"])


def _extent(figure: Figure, part: SubFigure) -> tuple[float, float, float, float]:
    """Left, top, width and height [pt] of a part of a figure, of a key without the empty part at its right."""
    scale, box = INCH / figure.dpi, part.bbox
    right = box.x1
    if part.get_gid() == KEY:
        boxes = [artist.get_tightbbox() for artist in (*part.legends, *part.axes)]
        right = max(inside.x1 for inside in boxes if inside is not None) + 4.0
    return box.x0 * scale, (figure.bbox.height - box.y1) * scale, (right - box.x0) * scale, box.height * scale
