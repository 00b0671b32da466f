"""Figures as SVG inside a page and as a PNG beside it, both from one drawing of each panel."""

from __future__ import annotations

import io
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
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
SURPLUS = re.compile(
    r'(?<=\.\d\d)\d+| (id|clip-path)="[^"]*"|\n| transform="rotate\(-0 [^"]*"'
    r"|; stroke-linejoin: miter|font-family: [^;]*; |text-anchor: start; "
)
"""In a tag: decimals beyond a hundredth of a point, names that would occur twice in a page, ends of lines, and what the page's
style sheet says or would be so without it."""
OUTLINE = re.compile(r'(?<= d=")[^"]*')
STEP = re.compile(r"([A-Za-z])([^A-Za-z]*)")
"""A command of an outline with its numbers."""
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
        abreast = max(1, int(constants.PAPER_WIDTH / widest))
        out = [f'<div class="panels" style="--widest:{widest:.2f};--abreast:{abreast}">']
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
    drawn = OUTLINE.sub(lambda outline: _shortened(outline[0]), BETWEEN.sub("", drawn))
    short = TAG.sub(lambda tag: SURPLUS.sub("", tag[0]), drawn)
    lowered = LOWERED.sub(r'<tspan dy=".3em" font-size="70%">\1</tspan><tspan dy="-.21em">\2</tspan>', short)
    return f'<svg viewBox="0 0 {width:.2f} {height:.2f}" style="--w:{width:.2f}">{lowered}</svg>'


def _shortened(outline: str) -> str:
    """The same outline in steps from place to place, a third of the text: lines in hundredths of a point, marks in tenths."""
    per_point = 10 if outline.count("M") > constants.MOST_MARKS_IN_HUNDREDTHS else 100
    out: list[str] = []
    x = y = first_x = first_y = 0
    for command, text in STEP.findall(outline):
        numbers = [round(per_point * float(number)) for number in text.split()]
        if not numbers:
            x, y = first_x, first_y
            out.append("z")
            continue
        if command == "M":
            out.append(f"M{_decimal(numbers[0], per_point)} {_decimal(numbers[1], per_point)}")
            first_x, first_y = numbers
        elif command != "L":
            steps = [number - (x, y)[k % 2] for k, number in enumerate(numbers)]
            out.append(command.lower() + " ".join(_decimal(step, per_point) for step in steps))
        elif per_point == 10 and abs(numbers[0] - x) <= 1 and numbers[1] == y:
            out.append("h.01")  # a line with hardly any length, whose ends are a disc
        elif numbers[1] == y:
            out.append(f"h{_decimal(numbers[0] - x, per_point)}")
        elif numbers[0] == x:
            out.append(f"v{_decimal(numbers[1] - y, per_point)}")
        else:
            up = _decimal(numbers[1] - y, per_point)
            out.append(f"l{_decimal(numbers[0] - x, per_point)}{up if up[0] == '-' else ' ' + up}")
        x, y = numbers[-2:]
    return "".join(out)


@cache
def _decimal(number: int, per_point: int) -> str:
    """A number of tenths or hundredths as short as possible: ``.5``, ``-3``."""
    text = f"{number / per_point:.2f}".rstrip("0").rstrip(".")
    return text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


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
