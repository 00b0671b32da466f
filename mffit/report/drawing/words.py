"""Lines of text at known places, drawn without matplotlib's layout, which took half the time of a picture."""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

from matplotlib.backend_bases import RendererBase
from matplotlib.font_manager import FontProperties
from matplotlib.text import Text
from matplotlib.transforms import Transform

from mffit.report.drawing.texts import SUBSCRIPT, width_of

INCH = 72.0
Align = Literal["left", "center", "right"]
SHARES: dict[str, float] = {"left": 0.0, "center": 0.5, "right": 1.0}
"""Part of the width that lies before the place, by alignment."""


@cache
def _font(size: float, bold: bool) -> FontProperties:
    """Made once: the search for a font takes long."""
    return FontProperties(size=size, weight="bold" if bold else "normal")


class Words(Text):
    """Text on a baseline that begins, has its middle, or ends at a place; upwards if ``turned``."""

    def __init__(
        self,
        x: float,
        y: float,
        text: str,
        *,
        size: float,
        colour: str,
        transform: Transform,
        align: Align = "left",
        bold: bool = False,
        turned: bool = False,
    ) -> None:
        super().__init__(
            x,
            y,
            text,
            color=colour,
            fontproperties=_font(size, bold),
            horizontalalignment=align,
            rotation=90.0 if turned else 0.0,
            rotation_mode="anchor",
            transform=transform,
        )
        self._width = width_of(text, size, bold)
        self._turned = turned

    def draw(self, renderer: RendererBase) -> None:
        """Draw the text in its colour."""
        text = self.get_text()
        if not text:
            return
        x, y = self.get_transform().transform(self.get_unitless_position())
        width: Any = renderer.points_to_pixels(self._width)
        before = SHARES[self.get_horizontalalignment()] * width
        x, y = (x, y - before) if self._turned else (x - before, y)
        if renderer.flipy():
            y = renderer.get_canvas_width_height()[1] - y
        pen: Any = renderer.new_gc()
        pen.set_foreground(self.get_color())
        math: Any = bool(self.get_parse_math() and SUBSCRIPT.search(text))
        angle = 90.0 if self._turned else 0.0
        renderer.draw_text(pen, x, y, text, self.get_fontproperties(), angle, ismath=math, mtext=self)
        pen.restore()
