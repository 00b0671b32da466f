"""The ways in which a rig and its surroundings distort what they measure."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class RigFaults:
    """Faults of the rig and influences of the environment, in ISO-W; the default is a perfect rig.

    Angles are in degrees because that is how a rig is adjusted. ``true angle = reading + offset``.
    """

    alpha_0_deg: float = 0.0  #: sideslip misalignment
    gamma_0_deg: float = 0.0  #: camber misalignment
    gain: float = 1.0  #: reported Fy = gain Fy + F0_N + crosstalk Fz
    F0_N: float = 0.0  #: load-cell offset of Fy
    crosstalk: float = 0.0  #: share of Fz that appears in Fy
    M0_Nm: float = 0.0  #: load-cell offset of Mz
    backlash_deg: float = 0.0  #: full play of the sideslip axis, taken up by the moment
    path_radius_m: float = math.nan  #: true radius of the path; NaN: as declared
    k_T_per_K: float = 0.0  #: Fy and Mz times 1 + k_T (T - 25 degC)
    k_V_per_mps: float = 0.0  #: Fy and Mz times 1 + k_V (V - V_ref)
    k_t_per_s: float = 0.0  #: Fy and Mz times 1 + k_t t


NO_FAULTS = RigFaults()
REFERENCE_TEMPERATURE = 25.0  # degC
