"""Numbers as people read them: rounded by their uncertainty, with the sign that typographers use."""

import math

from mffit import constants
from tir import Quantity

MINUS = "\N{MINUS SIGN}"
UNKNOWN = "–"
PLAIN = str.maketrans({MINUS: "-", "±": "+-", "×": "x", UNKNOWN: "-"})


class AtLeast(Quantity):
    """A largest force or moment that was reached at the end of the tested slip, where the curve does not fall: no peak."""

    __slots__ = ()


def ascii_only(text: str) -> str:
    """The text in characters that any terminal shows and any program reads back."""
    return text.translate(PLAIN)


def decimals_of(u: float, digits: int = 2) -> int:
    """Decimals that show ``digits`` significant digits of an uncertainty; at least 0."""
    if not (math.isfinite(u) and u > 0.0):
        return 0
    places = digits - 1 - math.floor(math.log10(u))
    return max(0, places - (round(u, places) >= 10.0 ** (digits - places)))


def rounded_up(value: float, digits: int = 2) -> float:
    """The next larger number of so few significant digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - digits + 1)
    return float(f"{math.ceil(value / step) * step:.{digits}g}")


def number(value: float | None, decimals: int | None = None, *, digits: int = 4) -> str:
    """A number with fixed decimals, or else ``digits`` significant ones; a dash for None or NaN."""
    if value is None or not math.isfinite(value):
        return UNKNOWN
    if decimals is None:
        whole = 10.0**digits <= abs(value) < constants.LARGEST_PLAIN_NUMBER
        text = f"{value:.0f}" if whole else f"{value:.{digits}g}"
    else:
        text = f"{value:.{decimals}f}"
        if float(text) == 0.0:
            text = text.lstrip("-")
    return text.replace("-", MINUS)


def rounded(value: float | None, u: float | None) -> tuple[str, str]:
    """A value and its uncertainty, both with the digits of the value that the uncertainty leaves; u has two.

    A value without an uncertainty keeps four digits, and the text of its uncertainty is empty.
    """
    if value is None or not math.isfinite(value):
        return UNKNOWN, ""
    if u is None or not math.isfinite(u) or u <= 0.0:
        return number(value), ""
    power = ""
    if u < constants.SMALLEST_PLAIN_U:
        exponent = math.floor(math.log10(max(abs(value), u)))
        value, u = value / 10.0**exponent, u / 10.0**exponent
        power = f"e{exponent}".replace("-", MINUS)
    value, u = _in_steps(value, u), _in_steps(u, u)
    places = decimals_of(u)
    return number(value, places) + power, number(u, places) + power


def to_uncertainty(value: float, u: float, sign: str = "") -> str:
    """A number for a sentence: to two digits of its uncertainty, to three of its own without one.

    ``sign`` "+" shows the sign of a positive number as well.
    """
    if not (math.isfinite(u) and u > 0.0):
        return f"{value:{sign}.3g}"
    return f"{_in_steps(value, u):{sign}.{decimals_of(u)}f}"


def _in_steps(value: float, u: float) -> float:
    """A multiple of the second digit of an uncertainty of 100 or more; else the value itself."""
    if u < 100.0 or not math.isfinite(value):
        return value
    step = 10.0 ** (math.floor(math.log10(u)) - 1)
    return round(value / step) * step


def with_u(value: float | None, u: float | None, unit: str = "") -> str:
    """``value ± u unit`` with the digits that the uncertainty leaves."""
    texts = rounded(value, u)
    if texts[0] == UNKNOWN:
        return UNKNOWN
    return " ± ".join(filter(None, texts)) + (f" {unit}" if unit else "")


def stated(quantity: Quantity | None, unit: str = "", scale: float = 1.0) -> str:
    """A measured quantity with its uncertainty; a dash where it was not measured."""
    if quantity is None:
        return UNKNOWN
    least = "at least " if isinstance(quantity, AtLeast) else ""
    return least + with_u(scale * quantity.value, scale * quantity.u, unit)


def as_good_as(value: float | None, u: float | None) -> str:
    """A value with the digits that its stated uncertainty leaves; 0 without power of ten."""
    if value == 0.0 and u is not None and 0.0 < u < constants.SMALLEST_PLAIN_U:
        return "0"
    return rounded(value, u)[0]


def per_cent(share: float) -> str:
    """A confidence in per cent; never a round 0 or 100, which would claim certainty."""
    limit = constants.NEARLY_CERTAIN
    if share > limit:
        return f"more than {100.0 * limit:.0f} %"
    if share < 1.0 - limit:
        return f"less than {100.0 * (1.0 - limit):.0f} %"
    return f"{100.0 * share:.0f} %"


def times(value: float | None, reference: float | None) -> str:
    """A ratio, ``1.03 ×``; a dash if one of the numbers is missing or zero."""
    if not value or not reference or not math.isfinite(value / reference):
        return UNKNOWN
    return f"{value / reference:.2f} ×"
