"""Numbers with the digits that their uncertainty allows."""

from __future__ import annotations

import math


def decimals_of(u: float, digits: int = 2) -> int:
    """Decimals that show ``digits`` significant digits of an uncertainty; negative ones are cut to 0."""
    if not (math.isfinite(u) and u > 0.0):
        return 0
    places = digits - 1 - math.floor(math.log10(u))
    return max(0, places - (round(u, places) >= 10.0 ** (digits - places)))


def rounded(value: float, u: float, sign: str = "") -> str:
    """A number rounded to two digits of its uncertainty, to three digits of its own without one; ``sign`` "+" shows its sign."""
    if not (math.isfinite(u) and u > 0.0):
        return f"{value:{sign}.3g}"
    return f"{value:{sign}.{decimals_of(u)}f}"
