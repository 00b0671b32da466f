"""The ways in which a rig and its surroundings distort what they measure: the one table of names, units and meanings."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any

REFERENCE_TEMPERATURE = 25.0  # degC


def _fault(undisturbed: float, unit: str, meaning: str) -> Any:
    return field(default=undisturbed, metadata={"unit": unit, "meaning": meaning})


@dataclass(frozen=True, slots=True)
class RigFaults:
    """Faults of the rig and influences of the environment, in ISO-W; the default is a perfect rig.

    Angles are in degrees because that is how a rig is adjusted. ``true angle = reading + offset``.
    """

    alpha_0_deg: float = _fault(0.0, "deg", "true sideslip minus reading")
    gamma_0_deg: float = _fault(0.0, "deg", "true camber minus reading")
    gain: float = _fault(1.0, "-", "reported Fy per newton: gain Fy + F0_N + crosstalk Fz")
    F0_N: float = _fault(0.0, "N", "load-cell offset of Fy")
    crosstalk: float = _fault(0.0, "-", "share of Fz that appears in Fy")
    M0_Nm: float = _fault(0.0, "Nm", "load-cell offset of Mz")
    backlash_deg: float = _fault(0.0, "deg", "full play of the sideslip axis, taken up by the moment")
    path_radius_m: float = _fault(math.nan, "m", "true radius of the path; NaN: as declared")
    k_T_per_K: float = _fault(0.0, "1/K", "Fy and Mz times 1 + k_T (T - 25 degC)")
    k_V_per_mps: float = _fault(0.0, "s/m", "Fy and Mz times 1 + k_V (V - V_ref)")
    k_t_per_s: float = _fault(0.0, "1/s", "Fy and Mz times 1 + k_t t")


NO_FAULTS = RigFaults()
FAULT_NAMES: tuple[str, ...] = tuple(row.name for row in fields(RigFaults))
UNITS: dict[str, str] = {row.name: row.metadata["unit"] for row in fields(RigFaults)}
MEANINGS: dict[str, str] = {row.name: row.metadata["meaning"] for row in fields(RigFaults)}
