"""Colours of all pictures, chosen to be told apart with any colour vision and in grey print."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

INK = "#1c2833"
MUTED = "#5d6d7b"
FAINT = "#a9b4be"
GRID = "#e3e8ec"
ACCENT = "#0b62a4"
CONTRAST = "#c4501b"
CALM = "#2b8a6e"

VIRIDIS = (
    "#440154", "#482475", "#414487", "#355f8d", "#2a788e", "#21918c", "#22a884", "#44bf70", "#7ad151",
)  # fmt: skip
"""Dark to light; the lightest fifth of the usual scale is left out, as it cannot be seen on white."""
DIVERGING = (
    "#053061", "#2166ac", "#4393c3", "#92c5de", "#d1e5f0", "#f7f7f7", "#fddbc7", "#f4a582", "#d6604d", "#b2182b", "#67001f",
)  # fmt: skip
"""Blue to red through white, which means "within the noise"."""


def between(colours: Sequence[str], place: float) -> str:
    """The colour at a place of a scale, 0 to 1, between its neighbours."""
    at = min(max(place, 0.0), 1.0) * (len(colours) - 1)
    k = min(int(at), len(colours) - 2)
    pairs = zip(rgb(colours[k]), rgb(colours[k + 1]), strict=True)
    return "#" + "".join(f"{round(a + (at - k) * (b - a)):02x}" for a, b in pairs)


def rgb(colour: str) -> tuple[int, int, int]:
    """Red, green and blue, 0 to 255, of ``#rrggbb``."""
    return int(colour[1:3], 16), int(colour[3:5], 16), int(colour[5:7], 16)


def ramp(levels: Iterable[float]) -> dict[float, str]:
    """A colour per level, dark to light in order of the levels."""
    ordered = sorted(levels)
    steps = max(len(ordered) - 1, 1)
    return {level: between(VIRIDIS, k / steps) for k, level in enumerate(ordered)}
