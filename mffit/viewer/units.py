"""The units of the page in SI."""

from __future__ import annotations

from tir.units import KINDS


def in_si(unit: str) -> float:
    """One of the unit in SI: 1 for SI units and for no unit."""
    return next((known[unit.lower()] for known in KINDS.values() if unit.lower() in known), 1.0)
