"""The ways in which a rig and its surroundings distort what they measure: the one table of names, units and meanings."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any

REFERENCE_TEMPERATURE = 25.0  # degC
FORCE = "reported Fy = gain Fy + F0 + crosstalk Fz"


def _fault(undisturbed: float, unit: str, meaning: str) -> Any:
    return field(default=undisturbed, metadata={"unit": unit, "meaning": meaning})


@dataclass(frozen=True, slots=True)
class RigFaults:
    """Faults of the rig and influences of the environment, in ISO-W; the default is a perfect rig.

    Angles are in degrees because that is how a rig is adjusted; a path radius of NaN is the declared one.
    """

    alpha_0_deg: float = _fault(0.0, "deg", "true sideslip angle = reading + alpha_0")
    gamma_0_deg: float = _fault(0.0, "deg", "true camber = reading + gamma_0")
    gain: float = _fault(1.0, "-", FORCE)
    F0_N: float = _fault(0.0, "N", FORCE)
    crosstalk: float = _fault(0.0, "-", FORCE)
    M0_Nm: float = _fault(0.0, "Nm", "reported Mz = Mz + M0")
    backlash_deg: float = _fault(0.0, "deg", "full play; true sideslip angle = reading - play/2 sign(Mz)")
    path_radius_m: float = _fault(math.nan, "m", "true radius of the path")
    k_T_per_K: float = _fault(0.0, "1/K", f"Fy and Mz times 1 + k_T (T - {REFERENCE_TEMPERATURE:g} degC)")
    k_V_per_mps: float = _fault(
        0.0, "s/m", "Fy and Mz times 1 + k_V (V - V_ref), V_ref the most frequent speed"
    )
    k_t_per_s: float = _fault(
        0.0, "1/s", "Fy and Mz times 1 + k_t t, t the time at which the point was taken"
    )


NO_FAULTS = RigFaults()
FAULT_NAMES: tuple[str, ...] = tuple(row.name for row in fields(RigFaults))
UNITS: dict[str, str] = {row.name: row.metadata["unit"] for row in fields(RigFaults)}
MEANINGS: dict[str, str] = {row.name: row.metadata["meaning"] for row in fields(RigFaults)}
