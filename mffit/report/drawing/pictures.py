"""Figures as SVG inside a page and as a PNG beside it, both from one drawing of each panel."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.image import imsave
from matplotlib.text import Text

from mffit.report import constants
from mffit.report.drawing import panels
from mffit.report.drawing.records import Sheet
from mffit.report.drawing.texts import SUBSCRIPT

MARGIN, ROW_GAP, KEY_GAP = 8.0, 6.0, 15.0
"""Around the PNG, between its rows of panels, and between entries of its key [pt]."""
TAG = re.compile(r"<[^>]*>")
BETWEEN = re.compile(r"<defs>.*?</defs>|(?<=>)\s+(?=<)", re.DOTALL)
"""Clip paths, which the drawings do not need, and indentation."""
SURPLUS = re.compile(r'(?<=\.\d\d)\d+| (id|clip-path)="[^"]*"|\n')
"""In a tag: decimals beyond a hundredth of a point, names that would occur twice in a page, and ends of lines."""
LOWERED = re.compile(SUBSCRIPT.pattern + "([^$<]*)")
"""A subscript and the text behind it."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drawing:
    """A panel or an entry of the key."""

    width: float  #: [pt]
    svg: str
    pixels: np.ndarray  #: (height, width, 3), red, green and blue


@dataclass(frozen=True, slots=True, kw_only=True)
class Picture:
    """A sheet as drawings: the entries of its key, and its panels in rows."""

    key: Sequence[Drawing]
    rows: Sequence[Sequence[Drawing]]

    def markup(self) -> str:
        """HTML that a page arranges to its width."""
        widest = max(drawing.width for row in self.rows for drawing in row)
        out = [f'<div class="panels" style="--widest:{widest:.2f}">']
        for name, drawings in (("key", self.key), *(("row", row) for row in self.rows)):
            if drawings:
                out += [f'<div class="{name}">', *(drawing.svg for drawing in drawings), "</div>"]
        return "\n".join([*out, "</div>"])

    def save(self, path: Path) -> None:
        """Write key and panels as a PNG, arranged as on a wide page; the same drawings give the same bytes."""
        lines = [_beside(entries, KEY_GAP) for entries in _key_lines(self.key)]
        lines += [_beside(row, panels.GAP) for row in self.rows]
        width = max(line.shape[1] for line in lines)
        stacked = [_padded(line, line.shape[0] + _pixels(ROW_GAP), width) for line in lines]
        margin = _pixels(MARGIN)
        around = ((margin, margin), (margin, margin), (0, 0))
        sheet = np.pad(np.vstack(stacked), around, constant_values=255)
        level = int(constants.PICTURE_COMPRESSION)
        imsave(path, sheet, dpi=int(constants.PICTURE_DPI), pil_kwargs={"compress_level": level})


def draw(sheet: Sheet) -> Picture:
    """Every panel and every entry of the key, drawn once."""
    with panels.settings():
        drawn = map(_drawing, panels.panels(sheet))
        rows = [list(islice(drawn, len(row))) for row in sheet.rows]
        return Picture(key=[_drawing(entry) for entry in panels.key(sheet)], rows=rows)


def _drawing(figure: Figure) -> Drawing:
    """The figure as SVG, where subscripts are set by the browser, and as pixels, where matplotlib sets them."""
    canvas = figure.canvas
    assert isinstance(canvas, FigureCanvasAgg)
    written = [
        a
        for a in (*figure.get_children(), *(a for axes in figure.axes for a in axes.texts))
        if isinstance(a, Text)
    ]
    indexed = [text for text in written if SUBSCRIPT.search(text.get_text())]
    stream = io.StringIO()
    figure.savefig(stream, format="svg", transparent=True, metadata={"Date": None})
    for text in indexed:
        text.set_parse_math(True)
    canvas.draw()
    for text in indexed:
        text.set_parse_math(False)
    pixels = np.asarray(canvas.buffer_rgba())[..., :3].copy()
    width, height = figure.get_size_inches() * panels.INCH
    return Drawing(width=float(width), svg=_svg(stream.getvalue(), width, height), pixels=pixels)


def _svg(text: str, width: float, height: float) -> str:
    """What the file draws, without its head and names."""
    drawn = text[text.index('<g id="figure_1">') : text.rindex("</svg>")]
    short = TAG.sub(lambda tag: SURPLUS.sub("", tag[0]), BETWEEN.sub("", drawn))
    lowered = LOWERED.sub(r'<tspan dy=".3em" font-size="70%">\1</tspan><tspan dy="-.21em">\2</tspan>', short)
    return f'<svg viewBox="0 0 {width:.2f} {height:.2f}" style="--w:{width:.2f}">{lowered}</svg>'


def _key_lines(key: Sequence[Drawing]) -> Iterator[list[Drawing]]:
    """The entries of the key in lines as wide as the picture."""
    line: list[Drawing] = []
    for entry in key:
        if line and sum(one.width + KEY_GAP for one in [*line, entry]) > constants.PICTURE_WIDTH:
            yield line
            line = []
        line.append(entry)
    if line:
        yield line


def _beside(drawings: Sequence[Drawing], gap: float) -> np.ndarray:
    """Pixels of drawings side by side, with a gap [pt] behind each."""
    height = max(drawing.pixels.shape[0] for drawing in drawings)
    return np.hstack([_padded(d.pixels, height, d.pixels.shape[1] + _pixels(gap)) for d in drawings])


def _padded(pixels: np.ndarray, height: int, width: int) -> np.ndarray:
    """White added below and on the right."""
    room = ((0, height - pixels.shape[0]), (0, width - pixels.shape[1]), (0, 0))
    return np.pad(pixels, room, constant_values=255)


def _pixels(points: float) -> int:
    return round(points * constants.PICTURE_DPI / panels.INCH)
