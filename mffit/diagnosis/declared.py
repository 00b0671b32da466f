"""What the owner of the rig declares of its errors: the prior of every rig effect."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mffit.points import Points
from mffit.rig import Simulation

U_PATH_LENGTHS = 0.002
"""Standard uncertainty of a path radius [m] whose four lengths were taped."""


def declared_rig(config: Any, points: Points, start: Simulation) -> dict[str, tuple[float, float]]:
    """Rig errors: name -> (value, standard uncertainty), for those of which the configuration says something."""
    rig, faults = config.rig, start.faults
    stiffness = _cornering_stiffness(points, start)
    rows = {
        "F0_N": (faults.F0_N, rig.u_loadcell_offset_N),
        "gamma_0_deg": (faults.gamma_0_deg, rig.u_camber_alignment_deg),
        "alpha_0_deg": (faults.alpha_0_deg, math.degrees(rig.u_slip_alignment_N / stiffness)),
        "backlash_deg": (faults.backlash_deg, rig.u_backlash_deg),
    }
    if np.any(points.phi_t):
        rows["path_radius_m"] = (
            start.number("path_radius_m", points),
            U_PATH_LENGTHS if rig.u_path_radius is None else rig.u_path_radius,
        )
    return {name: (value, u) for name, (value, u) in rows.items() if u > 0.0}


def _cornering_stiffness(points: Points, start: Simulation) -> float:
    """Of the model at the median load [N/rad]."""
    middle = points.select(np.array([np.argmin(np.abs(points.Fz - np.median(points.Fz)))]))
    step = np.radians(0.1)
    up, down = (start.predict(middle.replace(alpha=s, gamma=0.0))[0] for s in (step, -step))
    return max(abs(float(up - down)) / (2.0 * step), 1.0)
