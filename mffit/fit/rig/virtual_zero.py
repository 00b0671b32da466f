"""The fitted model at zero sideslip and camber on a faultless rig: its turn-slip force and its own eps_gamma."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.points import Points, main_path
from mffit.rig import Simulation

BESIDE_ZERO = (-1e-9, 1e-9)
"""Camber angles [rad] on either side of zero, where PKY3 |camber| gives the side force a kink: a slope is the mean of both."""


def zero_points(points: Points, load: float) -> Points:
    """The condition (0, 0) at the load [N], as it was run: forwards, and backwards too where the data have backward runs."""
    usual = np.flatnonzero(points.phi_t == main_path(points))
    # The nearest load; of equal ones the usual pressure, 1 kPa counting as 1 N.
    apart = np.abs(points.Fz - load) + 1e-3 * np.abs(points.p - np.median(points.p))
    nearest = int(usual[np.argmin(apart[usual])])
    directions = np.array([1, -1] if np.any(points.direction < 0) else [1])
    zero = np.zeros(len(directions))
    chosen = points.select(np.full(len(directions), nearest))
    return chosen.replace(
        alpha=zero, gamma=zero, Fz=zero + load, direction=directions, mount=np.ones_like(directions)
    )


def epsilon_gamma_of_model(values: Mapping[str, Any], points: Points, load: float, r_e: float) -> float:
    """eps_gamma by (17), as the direct method would find it for the model on a rig without faults and noise.

    ``load`` [N] is that at which the turn-slip force was measured, ``r_e`` [m] the measured effective radius.
    """
    tyre, zero = Simulation(values), zero_points(points, load)
    C_phit = float(tyre.readings(zero).Fy.mean()) / float(zero.phi_t[0])
    both_sides = zero.select(np.zeros(2, int)).replace(gamma=np.array(BESIDE_ZERO))  # forwards
    slopes = tyre.sensitivities(both_sides, ["gamma_0_deg"])[1].Fy
    C_gamma = math.degrees(float(slopes.mean()))  # per degree to per radian
    return 1.0 + r_e * C_gamma / C_phit
