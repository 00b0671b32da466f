"""Axis systems: ISO-W inside, SAE and adapted SAE in files and rigs.

ISO-W (TYDEX W): x forward, y left, z up; ``alpha = atan(Vsy/Vx)``; ``gamma > 0`` leans the top of the wheel to -y; load
``Fz > 0``. From there each system reverses the channels listed; gamma and Mx are the same in all.
"""

from typing import Any

FLIPPED: dict[str, frozenset[str]] = {
    "iso": frozenset(),
    "sae": frozenset({"alpha", "Fy", "Fz", "My", "Mz"}),
    "adapted-sae": frozenset({"Fy", "My", "Mz"}),
}


def sign(axes: str, channel: str) -> float:
    """-1.0 if the channel is reversed between ISO-W and ``axes``, else 1.0."""
    return -1.0 if channel in FLIPPED[axes] else 1.0


def to_iso(axes: str, channel: str, values: Any) -> Any:
    """Values of a channel in ISO-W, from ``axes``."""
    return sign(axes, channel) * values


def from_iso(axes: str, channel: str, values: Any) -> Any:
    """Values of a channel in ``axes``, from ISO-W."""
    return sign(axes, channel) * values
