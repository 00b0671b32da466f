"""The ways in which a rig and its surroundings distort what they measure: the one table of names, units and meanings."""

from __future__ import annotations

import math
from dataclasses import dataclass, field, fields
from typing import Any

REFERENCE_TEMPERATURE = 25.0  # degC
WARMTH = "(T - T_ref), T_ref the mean temperature of the data unless it is fitted"
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
    k_T_per_K: float = _fault(0.0, "1/K", f"Fy and Mz times 1 + k_T {WARMTH}")
    T_ref_degC: float = _fault(REFERENCE_TEMPERATURE, "degC", "temperature at which the model holds")
    k_V_per_mps: float = _fault(
        0.0, "s/m", "Fy and Mz times 1 + k_V (V - V_ref), V_ref the most frequent speed"
    )
    k_t_per_s: float = _fault(
        0.0, "1/s", "Fy and Mz times 1 + k_t t, t the time at which the point was taken"
    )
    compliance_deg_per_Nm: float = _fault(0.0, "deg/Nm", "true sideslip angle = reading + compliance Mz")
    nonlinearity_per_kN: float = _fault(0.0, "1/kN", "reported Fy times 1 + nonlinearity |Fy|")
    hysteresis_deg: float = _fault(
        0.0,
        "deg",
        "true sideslip angle = reading - hysteresis sense, sense 1 or -1 as the sweep goes up or down",
    )
    k_T_grip_per_K: float = _fault(0.0, "1/K", f"friction times 1 + k {WARMTH}")
    k_T_stiffness_per_K: float = _fault(0.0, "1/K", f"cornering stiffness times 1 + k {WARMTH}")
    wear_per_km: float = _fault(0.0, "1/km", "Fy and Mz times 1 + wear s, s the distance rolled")
    warm_up: float = _fault(0.0, "-", "Fy and Mz times 1 - warm_up exp(-s/1 km), s the distance rolled")


NO_FAULTS = RigFaults()
FAULT_NAMES: tuple[str, ...] = tuple(row.name for row in fields(RigFaults))
UNITS: dict[str, str] = {row.name: row.metadata["unit"] for row in fields(RigFaults)}
MEANINGS: dict[str, str] = {row.name: row.metadata["meaning"] for row in fields(RigFaults)}
OF_RUN = "@"
"""Stands between a fault and the file of the one run in which that much is added to it: ``F0_N@zeros.csv``."""
