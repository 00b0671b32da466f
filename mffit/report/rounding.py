"""Numbers as people read them: rounded by their uncertainty, with the sign that typographers use."""

from __future__ import annotations

import math

from mffit.report import constants
from tir import Quantity

MINUS = "\N{MINUS SIGN}"
PLAIN = str.maketrans({MINUS: "-", "±": "+-", "×": "x", "–": "-"})


def ascii_only(text: str) -> str:
    """The same in characters that any terminal shows and any program reads back."""
    return text.translate(PLAIN)


def decimals_of(u: float, digits: int = 2) -> int:
    """Decimals that show ``digits`` significant digits of an uncertainty; negative ones are cut to 0."""
    if not (math.isfinite(u) and u > 0.0):
        return 0
    places = digits - 1 - math.floor(math.log10(u))
    return max(0, places - (round(u, places) >= 10.0 ** (digits - places)))


def number(value: float | None, decimals: int | None = None, *, digits: int = 4) -> str:
    """A number with fixed decimals, or else ``digits`` significant ones; a dash where there is none."""
    if value is None or not math.isfinite(value):
        return "–"
    if decimals is None:
        whole = (
            10.0**digits <= abs(value) < constants.LARGEST_PLAIN_NUMBER
        )  # all of its digits are shorter than a power of ten
        text = f"{value:.0f}" if whole else f"{value:.{digits}g}"
    else:
        text = f"{value:.{decimals}f}"
        if float(text) == 0.0:
            text = text.lstrip("-")
    return text.replace("-", MINUS)


def with_u(value: float | None, u: float | None, unit: str = "") -> str:
    """``value ± u unit`` with the digits that the uncertainty allows."""
    unit = f" {unit}" if unit else ""
    if value is None or not math.isfinite(value):
        return "–"
    if u is None or not math.isfinite(u) or u <= 0.0:
        return number(value) + unit
    if u < 1e-6:
        return f"{number(value, digits=7)} ± {number(u, digits=2)}{unit}"
    if u >= 100.0:
        step = 10.0 ** (math.floor(math.log10(u)) - 1)
        value, u = round(value / step) * step, round(u / step) * step
    places = decimals_of(u)
    return f"{number(value, places)} ± {number(u, places)}{unit}"


def stated(quantity: Quantity | None, unit: str = "", scale: float = 1.0) -> str:
    """A measured quantity with the uncertainty that it carries; a dash where it was not measured."""
    if quantity is None:
        return "–"
    return with_u(scale * quantity.value, scale * quantity.u, unit)


def per_cent(share: float) -> str:
    """A confidence as per cent; never a round 0 or 100, which would claim certainty."""
    if share > 0.99:
        return "more than 99 %"
    return "less than 1 %" if share < 0.01 else f"{100.0 * share:.0f} %"


def times(value: float | None, reference: float | None) -> str:
    """A ratio such as ``1.03 × noise``, without the word."""
    if not value or not reference or not math.isfinite(value / reference):
        return "–"
    return f"{value / reference:.2f} ×"
