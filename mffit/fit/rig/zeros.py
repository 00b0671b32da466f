"""Readings at zero sideslip and camber on a disc: the model's values there, and PECP1 from them if eps_gamma was not measured.

The turn-slip force determines the ratio of camber stiffness to 1 - PECP1. Without camber sweeps the camber stiffness is the base
file's, and its uncertainty contributes to that of PECP1.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import constants
from mffit.fit.start import camber_stiffness_terms
from mffit.measured import Measured
from mffit.points import Points, main_path
from mffit.rig import Simulation
from tir import Quantity
from tir.constants import EPS_GAMMA_NEAR_ONE
from tir.parameters import BY_NAME

CAMBER_REDUCTION = "PECP1"
BESIDE_ZERO = (-1e-9, 1e-9)
"""Camber angles [rad] just below and above zero: PKY3 |camber| makes a kink at zero, so the slope is the mean of both sides."""


@dataclass(frozen=True, slots=True)
class TurningZeros:
    """The measured turn-slip force at zero sideslip and camber, and the force expected before the fit."""

    load: float  #: [N]
    force: Quantity  #: measured force, corrected for rig errors [N]
    expected: float  #: force of the values before the fit [N]
    before: Mapping[str, float]  #: coefficients that the zeros determine, with their values before the fit
    start: Mapping[str, float]  #: the same coefficients with their starting values

    camber: bool  #: whether camber sweeps determine the camber stiffness

    @property
    def contradicted(self) -> bool:
        """Whether measured and expected force differ by more than noise and the scatter of similar tyres explain."""
        share = constants.SIMILAR_TYRES_SPREAD * abs(self.expected)
        return abs(self.force.value - self.expected) > max(COVERAGE_FACTOR_95 * self.force.u, share)


def turning_zeros(values: Mapping[str, Any], points: Points, measured: Measured) -> TurningZeros | None:
    """The zeros nearest the nominal load; None where eps_gamma was measured or no zeros show a turn-slip force."""
    rows = [row for row in measured.per_load if row.F_phit is not None]
    if measured.epsilon_gamma is not None or not rows:
        return None
    row = min(rows, key=lambda row: abs(row.load - float(values["FNOMIN"])))
    force = row.F_phit
    assert force is not None
    zero = zero_points(points, row.load)
    expected = float(Simulation(values).readings(zero).Fy.mean())
    start = _start(values, force.value / expected if expected else 0.0)
    if not start:
        # The camber stiffness that gives the measured C_phit = R0 |K_yg0| / (1 - PECP1) with PECP1 unchanged.
        PECP1 = min(float(values[CAMBER_REDUCTION]), 1.0 - EPS_GAMMA_NEAR_ONE)
        C_phit = force.value / float(zero.phi_t[0])
        C_gamma = -(1.0 - PECP1) * C_phit / float(values["UNLOADED_RADIUS"])
        terms = camber_stiffness_terms(values, {row.load: C_gamma}, float(zero.p[0]))
        start = {CAMBER_REDUCTION: PECP1, "PKY6": terms["PKY6"]}
    if len(rows) > 1:  # the loads show how the camber stiffness changes with load
        start["PKY7"] = float(values["PKY7"])
    return TurningZeros(
        load=row.load,
        force=force,
        expected=expected,
        before={name: float(values[name]) for name in start},
        start=start,
        camber=any(row.C_gamma is not None for row in measured.per_load),
    )


def _start(values: Mapping[str, Any], ratio: float) -> dict[str, float]:
    """PECP1 that multiplies the turn-slip force by ``ratio``, to first order; empty if that is not plausible.

    The force is proportional to the camber stiffness over 1 - PECP1.
    """
    lowest, highest = BY_NAME[CAMBER_REDUCTION].bounds[0], 1.0 - EPS_GAMMA_NEAR_ONE
    PECP1 = 1.0 - (1.0 - float(values[CAMBER_REDUCTION])) / ratio if ratio else float(highest)
    return {CAMBER_REDUCTION: PECP1} if lowest < PECP1 < highest else {}


def zero_points(points: Points, load: float) -> Points:
    """Points at zero sideslip and camber at the load [N]: forwards, and also backwards if the data have backward runs."""
    usual = np.flatnonzero(points.phi_t == main_path(points))
    # The nearest load; among equal loads the pressure nearest the median, with 1 kPa counting as 1 N.
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

    ``load`` [N] is the load of the measured turn-slip force, ``r_e`` [m] the measured effective radius.
    """
    tyre, zero = Simulation(values), zero_points(points, load)
    C_phit = float(tyre.readings(zero).Fy.mean()) / float(zero.phi_t[0])
    both_sides = zero.select(np.zeros(2, int)).replace(gamma=np.array(BESIDE_ZERO))  # forwards
    slopes = tyre.sensitivities(both_sides, ["gamma_0_deg"])[1].Fy
    C_gamma = math.degrees(float(slopes.mean()))  # per degree to per radian
    return 1.0 + r_e * C_gamma / C_phit
