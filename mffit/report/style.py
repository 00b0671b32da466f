"""How all pictures look: matplotlib's settings, and colours that differ for any colour vision and in grey print."""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from matplotlib.colors import LinearSegmentedColormap

INK = "#1c2833"
MUTED = "#5d6d7b"
FAINT = "#a9b4be"
GRID = "#e3e8ec"
ACCENT = "#0b62a4"
CONTRAST = "#c4501b"
CALM = "#2b8a6e"
SHADE = 0.25
"""Opacity of bands: three that overlap can still be told apart."""

WIDTH = 720.0
"""Of a picture [pt]; on a sheet of A4, a point is nearly a pixel, and letters are 7 pixels or more."""
LEFT, RIGHT, BOTTOM, TOP = 50.0, 10.0, 31.0, 18.0
"""Margins of a panel with numbers at its axes [pt]."""
LETTER = 5.0
"""Width of a letter of a title or key [pt], wide ones among them."""
LINE, TITLE_LINES = 10.5, 3
"""Height of a line of a title or of a name at an axis [pt], and most lines of a title."""
SETTINGS: dict[str, Any] = {
    "figure.dpi": 144,
    "font.family": "DejaVu Sans",  # comes with matplotlib, so that pictures are the same on every machine
    "font.size": 7.8,
    "mathtext.default": "regular",
    "text.color": INK,
    "axes.titlesize": 8.5,
    "axes.titlelocation": "left",
    "axes.titley": 1.0,  # a place that depends on the numbers at the axes takes a third of the time of a picture
    "axes.labelsize": 8.2,
    "axes.labelcolor": INK,
    "axes.edgecolor": FAINT,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.formatter.useoffset": False,
    "axes.formatter.limits": (-9, 9),
    "legend.frameon": False,
    "legend.fontsize": 8.2,
    "legend.borderpad": 0.0,
    "legend.borderaxespad": 0.4,
    "legend.labelspacing": 0.3,
    "errorbar.capsize": 2.5,
}


class ColourRange(NamedTuple):
    """Part of a colour map of matplotlib, dark to light; its ends cannot be seen on white, or are white on a dark page."""

    name: str
    first: float
    last: float


DIVERGING = ColourRange("RdBu_r", 0.12, 0.88)
"""Blue to red through white, which means "within the noise"."""
COLD = ColourRange("viridis", 0.12, 0.8)
WARM = ColourRange("plasma", 0.35, 0.78)
"""Colours of another quantity in the same picture: no colour is both of these."""


@cache
def colour_map(colours: ColourRange) -> LinearSegmentedColormap:
    """The part as a colour map."""
    from matplotlib import colormaps
    from matplotlib.colors import LinearSegmentedColormap

    shades = colormaps[colours.name](
        [colours.first + (colours.last - colours.first) * k / 255 for k in range(256)]
    )
    return LinearSegmentedColormap.from_list(colours.name, shades)


def ramp(levels: Iterable[float], colours: ColourRange = COLD) -> dict[float, str]:
    """A colour per level, dark to light in order of the levels."""
    from matplotlib import colormaps
    from matplotlib.colors import to_hex

    ordered, found = sorted(levels), colormaps[colours.name]
    step = (colours.last - colours.first) / max(len(ordered) - 1, 1)
    return {level: to_hex(found(colours.first + step * k)) for k, level in enumerate(ordered)}
