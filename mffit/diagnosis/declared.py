"""The declared rig: the prior of every rig effect."""

from __future__ import annotations

from typing import Any

import numpy as np

from mffit.config import declared_rig
from mffit.points import Points
from mffit.rig import Simulation


def declared_priors(config: Any, points: Points, start: Simulation) -> dict[str, tuple[float, float]]:
    """Declared rig errors: name -> (value in the simulation, standard uncertainty)."""
    declared = declared_rig(config.rig, _cornering_stiffness(points, start))
    if not np.any(points.phi_t):
        declared.pop("path_radius_m", None)
    return {name: (start.number(name, points), u) for name, (_, u) in declared.items()}


def _cornering_stiffness(points: Points, start: Simulation) -> float:
    """Cornering stiffness of the model at the median load and zero angles [N/rad]."""
    middle = points.select(np.array([np.argmin(np.abs(points.Fz - np.median(points.Fz)))]))
    _, slope = start.sensitivities(middle.replace(alpha=0.0, gamma=0.0), ["alpha_0_deg"])
    return float(np.degrees(slope.Fy[0, 0]))
