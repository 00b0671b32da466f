"""How wide text is, and which of its letters are subscripts."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from PIL.ImageFont import FreeTypeFont

SUBSCRIPT = re.compile(r"\$_\{(\w+)\}\$")
SMALLER = 0.7
"""Size of a subscript over that of its text."""
LOWER = 0.22
"""How far a subscript is below the base line, in sizes of the text."""
MEASURED_AT = 64
"""Size [pixels] at which widths are measured."""


def runs(text: str) -> Iterator[tuple[str, bool]]:
    """Pieces of a text, and whether each is a subscript."""
    for k, piece in enumerate(SUBSCRIPT.split(text)):
        if piece:
            yield piece, k % 2 == 1


def plain(text: str) -> str:
    """The text as a table shows it: ``F_y``."""
    return SUBSCRIPT.sub(r"_\1", text)


@cache
def font(pixels: int, bold: bool = False) -> FreeTypeFont:
    """DejaVu Sans, which comes with matplotlib, so that pictures are the same on every machine."""
    from PIL import ImageFont

    found = find_spec("matplotlib")
    assert found is not None
    assert found.origin is not None
    name = "DejaVuSans-Bold.ttf" if bold else "DejaVuSans.ttf"
    path = Path(found.origin).parent / "mpl-data" / "fonts" / "ttf" / name
    return ImageFont.truetype(str(path), pixels, layout_engine=ImageFont.Layout.BASIC)


@cache
def width_of(text: str, size: float, bold: bool = False) -> float:
    """Width of a line of text [pt]."""
    measure = font(MEASURED_AT, bold).getlength
    total = sum(measure(piece) * (SMALLER if lowered else 1.0) for piece, lowered in runs(text))
    return total * size / MEASURED_AT


def shortened(text: str, room: float, size: float) -> str:
    """The text, cut with an ellipsis where it is wider than the room [pt]."""
    if width_of(text, size) <= room:
        return text
    text = plain(text)
    while text and width_of(text + "…", size) > room:
        text = text[:-1]
    return text.rstrip() + "…"
