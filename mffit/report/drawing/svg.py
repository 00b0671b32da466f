"""Drawings as SVG inside a page: panels that the page arranges to its width."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from mffit.report.drawing.layout import LaidOut
from mffit.report.drawing.letters import LOWER, SMALLER, runs
from mffit.report.drawing.shapes import CROSS, OUTLINES, Area, Drawing, Letters, Marks, Shape, Stroke


def markup(figure: LaidOut) -> str:
    """The figure as HTML: its key, then rows of panels."""
    widest = max(drawing.width for row in figure.rows for drawing in row)
    out = [f'<div class="panels" style="--widest:{_short(widest)}">']
    for name, drawings in (("key", figure.key), *(("row", row) for row in figure.rows)):
        if drawings:
            out += [f'<div class="{name}">', *map(_svg, drawings), "</div>"]
    return "\n".join([*out, "</div>"])


def _svg(drawing: Drawing) -> str:
    wide, tall = _short(drawing.width), _short(drawing.height)
    shapes = "".join(map(_element, drawing.shapes))
    return f'<svg viewBox="0 0 {wide} {tall}" style="--w:{wide}" fill="none">{shapes}</svg>'


def _element(shape: Shape) -> str:
    match shape:
        case Stroke():
            return _stroke(shape)
        case Area():
            opacity = f' fill-opacity="{_short(shape.opacity)}"' if shape.opacity < 1.0 else ""
            return f'<path d="{_path(shape.corners)}z" fill="{shape.colour}"{opacity}/>'
        case Marks():
            return _marks(shape)
        case Letters():
            return _letters(shape)


def _stroke(shape: Stroke) -> str:
    if not shape.lines:
        return ""
    dashes = f' stroke-dasharray="{" ".join(map(_short, shape.dashes))}"' if shape.dashes else ""
    path = "".join(map(_path, shape.lines))
    return f'<path d="{path}" stroke="{shape.colour}" stroke-width="{_short(shape.width)}"{dashes}/>'


def _marks(shape: Marks) -> str:
    """All marks of a series as one element, so that ten thousand of them do not slow the page."""
    size = shape.size
    if shape.marker in "o.":
        if not shape.edge:  # a line of no length with round ends is a disc
            path = "".join(f"M{x} {y}h0" for x, y in _texts(shape.at))
            return f'<path d="{path}" stroke="{shape.fill}" stroke-width="{_short(size)}" stroke-linecap="round"/>'
        r, d = _short(0.5 * size), _short(size)
        circle = f"m-{r} 0a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0"
        path = "".join(f"M{x} {y}{circle}" for x, y in _texts(shape.at))
    elif shape.marker == "x":
        path = "".join(_path(place + size * line) for place in shape.at for line in CROSS)
    else:
        path = "".join(_path(place + size * OUTLINES[shape.marker]) + "z" for place in shape.at)
    fill = f' fill="{shape.fill}"' if shape.fill else ""
    edge = f' stroke="{shape.edge}" stroke-width="{_short(shape.edge_width)}"' if shape.edge else ""
    return f'<path d="{path}"{fill}{edge}/>'


def _letters(shape: Letters) -> str:
    x, y = _short(shape.x), _short(shape.y)
    turned = f' transform="rotate(-90 {x} {y})"' if shape.turned else ""
    anchor = f' text-anchor="{shape.anchor}"' if shape.anchor != "start" else ""
    bold = ' font-weight="bold"' if shape.bold else ""
    text, below = "", 0.0
    for piece, lowered in runs(shape.text):
        depth = LOWER * shape.size if lowered else 0.0
        size = f' font-size="{_short(SMALLER * shape.size)}"' if lowered else ""
        move = f' dy="{_short(depth - below)}"' if depth != below else ""
        text += f"<tspan{move}{size}>{escape(piece)}</tspan>" if move else escape(piece)
        below = depth
    head = f'<text x="{x}" y="{y}" font-size="{_short(shape.size)}" fill="{shape.colour}"'
    return f"{head}{anchor}{bold}{turned}>{text}</text>"


def _path(points: np.ndarray) -> str:
    return "M" + "L".join(f"{x} {y}" for x, y in _texts(points))


def _texts(points: np.ndarray) -> Sequence[tuple[str, str]]:
    return [(_short(x), _short(y)) for x, y in points.tolist()]


def _short(value: float) -> str:
    """A length with two decimals, without the zeros at its end."""
    text = f"{value:.2f}".rstrip("0").rstrip(".")
    return "0" if text == "-0" else text
