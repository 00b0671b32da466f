"""The finished model on a faultless rig at zero sideslip and camber: its turn-slip force and its own eps_gamma."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.points import Points, main_path
from mffit.rig import Simulation


def zero_points(points: Points, load: float) -> Points:
    """The condition (0, 0) at the load [N]: forwards, and backwards too where the data have backward runs."""
    usual = np.flatnonzero(points.phi_t == main_path(points))
    apart = np.abs(points.Fz - load) + 1e-3 * np.abs(points.p - np.median(points.p))
    nearest = int(usual[np.argmin(apart[usual])])
    directions = np.array([1, -1] if np.any(points.direction < 0) else [1])
    zero = np.zeros(len(directions))
    chosen = points.select(np.full(len(directions), nearest))
    return chosen.replace(
        alpha=zero, gamma=zero, Fz=zero + load, direction=directions, mount=np.ones_like(directions)
    )


def epsilon_gamma_of_model(
    values: Mapping[str, Any], points: Points, load: float, r_e: float, R: float
) -> float:
    """eps_gamma by (17), as the direct method would find it if the model stood on the rig without noise."""
    tyre = Simulation(values)
    zero = zero_points(points, load)
    F_phit = float(tyre.readings(zero).Fy.mean())
    C_phit = F_phit / float(zero.phi_t[0])
    step = np.radians(0.5)
    forward = zero.select(np.zeros(2, int)).replace(gamma=np.array([step, -step]))
    Fy = tyre.readings(forward).Fy
    return 1.0 + r_e * float(Fy[0] - Fy[1]) / (2.0 * step) / C_phit
