"""Drawings as a PNG: key and panels arranged as a wide page arranges them."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from mffit.report import constants, style
from mffit.report.drawing.layout import GAP, INCH, LaidOut
from mffit.report.drawing.letters import LOWER, SMALLER, font, runs
from mffit.report.drawing.shapes import CROSS, OUTLINES, Area, Drawing, Letters, Marks, Shape, Stroke

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

MARGIN, ROW_GAP = 8.0, 6.0
"""Around the picture, and between rows of panels [pt]."""
SCALE = constants.PICTURE_DPI * constants.PICTURE_OVERSAMPLING / INCH
"""Pixels drawn per point."""


def save(figure: LaidOut, path: Path) -> None:
    """Write the picture; the same drawings give the same bytes."""
    from PIL import Image, ImageDraw

    placed = list(_placed(figure))
    wide = max(x + drawing.width for x, _, drawing in placed) + MARGIN
    tall = max(y + drawing.height for _, y, drawing in placed) + MARGIN
    size = (max(round(SCALE * wide), 1), max(round(SCALE * tall), 1))
    image = Image.new("RGB", size, "white")
    brush = ImageDraw.Draw(image, "RGBA")
    for x, y, drawing in placed:
        origin = np.array([x, y])
        for shape in drawing.shapes:
            _draw(image, brush, shape, origin)
    image.reduce(constants.PICTURE_OVERSAMPLING).save(path, "PNG", dpi=(constants.PICTURE_DPI,) * 2)


def _placed(figure: LaidOut) -> Iterator[tuple[float, float, Drawing]]:
    """Every drawing with the place of its top left corner [pt]."""
    y = MARGIN
    for line in _key_lines(figure.key):
        x = MARGIN
        for drawing in line:
            yield x, y, drawing
            x += drawing.width + 1.5 * GAP
        y += max(drawing.height for drawing in line) + ROW_GAP
    for row in figure.rows:
        x = MARGIN
        for drawing in row:
            yield x, y, drawing
            x += drawing.width + GAP
        y += max(drawing.height for drawing in row) + ROW_GAP


def _key_lines(key: Sequence[Drawing]) -> list[list[Drawing]]:
    """The entries of the key in lines as wide as the picture."""
    lines: list[list[Drawing]] = []
    used = math.inf
    for entry in key:
        needed = entry.width + 1.5 * GAP
        if used + needed > constants.PICTURE_WIDTH:
            lines.append([])
            used = 0.0
        lines[-1].append(entry)
        used += needed
    return lines


def _draw(image: Image, brush: ImageDraw, shape: Shape, origin: np.ndarray) -> None:
    match shape:
        case Stroke():
            for line in shape.lines:
                places = SCALE * (line + origin)
                for piece in _dashed(places, SCALE * np.array(shape.dashes)) if shape.dashes else [places]:
                    _line(brush, piece, shape.colour, shape.width)
        case Area():
            colour = (*style.rgb(shape.colour), round(255 * shape.opacity))
            brush.polygon(_flat(SCALE * (shape.corners + origin)), fill=colour)
        case Marks():
            _marks(brush, shape, origin)
        case Letters():
            _letters(image, brush, shape, origin)


def _line(brush: ImageDraw, places: np.ndarray, colour: str, width: float) -> None:
    pixels = max(1, round(SCALE * width))
    brush.line(_flat(places), fill=colour, width=pixels, joint="curve" if len(places) > 2 else None)


def _dashed(places: np.ndarray, dashes: np.ndarray) -> Iterator[np.ndarray]:
    """The dashes of a line, each a line of its own."""
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    for begin in np.arange(0.0, along[-1], dashes.sum()):
        end = min(begin + dashes[0], along[-1])
        at = np.concatenate([[begin], along[(along > begin) & (along < end)], [end]])
        yield np.column_stack([np.interp(at, along, places[:, k]) for k in (0, 1)])


def _marks(brush: ImageDraw, shape: Marks, origin: np.ndarray) -> None:
    places, size = SCALE * (shape.at + origin), SCALE * shape.size
    fill, edge = shape.fill or None, shape.edge or None
    pixels = max(1, round(SCALE * shape.edge_width)) if edge else 0
    for place in places:
        if shape.marker in "o.":
            r = 0.5 * (size + pixels)
            x, y = place
            brush.ellipse((x - r, y - r, x + r, y + r), fill=fill, outline=edge, width=pixels)
        elif shape.marker == "x":
            for line in CROSS:
                brush.line(_flat(place + size * line), fill=edge, width=pixels)
        else:
            corners = place + size * OUTLINES[shape.marker]
            brush.polygon(_flat(corners), fill=fill)
            if edge:
                brush.line(_flat(np.vstack([corners, corners[:2]])), fill=edge, width=pixels, joint="curve")


def _letters(image: Image, brush: ImageDraw, shape: Letters, origin: np.ndarray) -> None:
    x, y = SCALE * (np.array([shape.x, shape.y]) + origin)
    if shape.turned:
        _turned(image, shape, x, y)
    else:
        _write(brush, shape, x - _before(shape), y)


def _turned(image: Image, shape: Letters, x: float, y: float) -> None:
    """Text that reads upwards, its base line through ``x``."""
    from PIL import Image as Images
    from PIL import ImageDraw

    size = SCALE * shape.size
    strip = Images.new("L", (int(_length(shape)) + 2, int(1.6 * size)), 0)
    base = int(1.1 * size)
    _write(ImageDraw.Draw(strip), shape, 0.0, base, fill=255)
    strip = strip.transpose(Images.Transpose.ROTATE_90)
    corner = (round(x) - base, round(y + _before(shape)) - strip.height)
    image.paste(Images.new("RGB", strip.size, shape.colour), corner, strip)


def _write(brush: ImageDraw, shape: Letters, x: float, y: float, fill: int | None = None) -> None:
    for piece, lowered in runs(shape.text):
        face = font(round(SCALE * shape.size * (SMALLER if lowered else 1.0)), shape.bold)
        down = SCALE * LOWER * shape.size if lowered else 0.0
        brush.text((x, y + down), piece, fill=shape.colour if fill is None else fill, font=face, anchor="ls")
        x += face.getlength(piece)


def _length(shape: Letters) -> float:
    sizes = (
        (p, round(SCALE * shape.size * (SMALLER if lowered else 1.0))) for p, lowered in runs(shape.text)
    )
    return sum(font(pixels, shape.bold).getlength(piece) for piece, pixels in sizes)


def _before(shape: Letters) -> float:
    """Length of the text before its anchor [pixels]."""
    return {"start": 0.0, "middle": 0.5, "end": 1.0}[shape.anchor] * _length(shape)


def _flat(places: np.ndarray) -> list[float]:
    return places.ravel().tolist()
