"""What the columns and channels of a rig are called, and their units: one table for every sentence, picture and page."""

from __future__ import annotations

from typing import NamedTuple


class Quantity(NamedTuple):
    """How an engineer names a number."""

    word: str
    unit: str


CONDITIONS = {
    "alpha_deg": Quantity("sideslip", "deg"),
    "gamma_deg": Quantity("camber", "deg"),
    "Fz_N": Quantity("load", "N"),
    "p_kPa": Quantity("pressure", "kPa"),
    "V_mps": Quantity("speed", "m/s"),
    "T_degC": Quantity("temperature", "degC"),
    "t_s": Quantity("time", "s"),
}
"""Conditions of a point, by their column."""
CHANNELS = {
    "Fy": Quantity("side force", "N"),
    "Mz": Quantity("self-aligning moment", "Nm"),
}
"""Measured channels that are simulated, by their symbol."""
