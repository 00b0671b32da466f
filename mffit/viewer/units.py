"""Units of the page in SI."""

from __future__ import annotations

from tir.units import KINDS


def in_si(unit: str) -> float:
    """What one of a unit is in SI: 1 for SI units and for what has none."""
    return next((known[unit.lower()] for known in KINDS.values() if unit.lower() in known), 1.0)
