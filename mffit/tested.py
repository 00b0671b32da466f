"""How a property file says to where a range was tested: written and read back."""

from __future__ import annotations

import re


def words_on_tested(end: float, unit: str) -> str:
    """The end of a comment on a range's limit."""
    return f"tested to {end:.6g} {unit}"


def end_tested(comment: str) -> float | None:
    """To where the data went, in SI, if the comment says it."""
    found = re.search(r"\btested to (-?[\d.]+(?:e[+-]?\d+)?)", comment)
    return float(found[1]) if found else None
