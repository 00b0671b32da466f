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
    k_T_per_K: float = _fault(0.0, "1/K", "Fy and Mz times 1 + k_T (T - T_ref)")
    k_V_per_mps: float = _fault(0.0, "s/m", "Fy and Mz times 1 + k_V (V - V_ref)")
    k_t_per_s: float = _fault(0.0, "1/s", "Fy and Mz times 1 + k_t t")
    compliance_deg_per_Nm: float = _fault(0.0, "deg/Nm", "true sideslip = reading + compliance Mz")
    nonlinearity_per_kN: float = _fault(0.0, "1/kN", "Fy as reported times 1 + nonlinearity |Fy|")
    hysteresis_deg: float = _fault(
        0.0, "deg", "lag of the sideslip angle behind its reading, in the sense of the sweep"
    )
    k_T_grip_per_K: float = _fault(0.0, "1/K", "friction times 1 + k (T - T_ref)")
    k_T_stiffness_per_K: float = _fault(0.0, "1/K", "cornering stiffness times 1 + k (T - T_ref)")
    wear_per_km: float = _fault(
        0.0, "1/km", "Fy and Mz times 1 + wear s, s the distance rolled since the first point"
    )
    warm_up: float = _fault(0.0, "-", "share of Fy and Mz that the first point lacks; fades over 1 km rolled")


NO_FAULTS = RigFaults()
FAULT_NAMES: tuple[str, ...] = tuple(row.name for row in fields(RigFaults))
UNITS: dict[str, str] = {row.name: row.metadata["unit"] for row in fields(RigFaults)}
MEANINGS: dict[str, str] = {row.name: row.metadata["meaning"] for row in fields(RigFaults)}
