"""Subscripts in the texts of a picture, and how wide a text is."""

from __future__ import annotations

import re
from functools import cache

SUBSCRIPT = re.compile(r"\$_\{(\w+)\}\$")
"""As in ``QuantityName.mathtext``; other dollar signs are plain text."""


def plain(text: str) -> str:
    """The text as a table shows it: ``F_y``."""
    return SUBSCRIPT.sub(r"_\1", text)


@cache
def width_of(text: str, size: float, bold: bool = False) -> float:
    """Width of a line of text [pt]; subscripts count as large letters."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import text_to_path

    font = FontProperties(size=size, weight="bold" if bold else "normal")
    return float(text_to_path.get_text_width_height_descent(SUBSCRIPT.sub(r"\1", text), font, False)[0])


def shortened(text: str, room: float, size: float) -> str:
    """The text, cut with an ellipsis where it is wider than the room [pt]."""
    if width_of(text, size) <= room:
        return text
    text = plain(text)
    while text and width_of(text + "…", size) > room:
        text = text[:-1]
    return text.rstrip() + "…"
