"""Numbers with a decimal comma: recognition and conversion, for all readers of text."""

from __future__ import annotations

import re

NUMBER_WITH_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")


def has_decimal_comma(cell: str) -> bool:
    """Whether a cell is a number with a decimal comma."""
    return NUMBER_WITH_COMMA.fullmatch(cell) is not None


def with_decimal_point(cell: str) -> str:
    """The number with a decimal point; any other text unchanged."""
    return cell.replace(",", ".") if has_decimal_comma(cell) else cell
