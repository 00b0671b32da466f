"""Rig faults and environment terms taken off the points, for the direct method to be redone."""

from __future__ import annotations

import math

import numpy as np

from mffit.points import Points
from mffit.rig import RigFaults
from mffit.rig.readings import environment_factor


def corrected_points(points: Points, faults: RigFaults) -> Points:
    """Points as a faultless rig at reference conditions would have reported them.

    Parameters
    ----------
    points : raw points (n,)
    faults : what the diagnosis found; the angles' offsets are added to the readings, the channels' faults removed
    """
    factor = environment_factor(points, faults)
    Fy = (points.Fy - faults.F0_N - faults.crosstalk * points.Fz) / faults.gain / factor
    Mz = (points.Mz - faults.M0_Nm) / factor
    phi_t = points.phi_t
    if not math.isnan(faults.path_radius_m):
        phi_t = np.sign(phi_t) / faults.path_radius_m
    play = math.radians(faults.backlash_deg) / 2.0 * np.sign(np.nan_to_num(Mz))
    return points.replace(
        Fy=Fy,
        Mz=Mz,
        phi_t=phi_t,
        alpha=points.alpha + math.radians(faults.alpha_0_deg) - play,
        gamma=points.gamma + math.radians(faults.gamma_0_deg),
    )
