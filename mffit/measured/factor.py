"""eps_gamma of one load with its budget: the plain value, the value corrected for finite spin, random draws."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.measured.budget import by_draws
from mffit.measured.budget_rows import Draws
from mffit.measured.camber_reduction import camber_reduction, true_camber_stiffness
from mffit.measured.evidence import DirectEvidence
from mffit.measured.groups import LoadGroup, zeros
from mffit.measured.stiffnesses import sweep
from mffit.measured.turning import Turning
from mffit.rig_errors import AtZero


class Factor(NamedTuple):
    """The estimates of eps_gamma from one camber stiffness."""

    plain: UFloat  #: by (17), finite spin in its uncertainty
    debiased: UFloat  #: corrected for finite spin
    ratio: tuple[UFloat, UFloat]  #: numerator and denominator of (17), both over the path radius [N]

    @property
    def draws(self) -> Draws:
        """u and 95 % interval of the plain value by random draws."""
        return by_draws(*self.ratio, self.plain)


def factor(evidence: DirectEvidence, C_gamma: UFloat, found: Turning, r_e: UFloat, warmer: float) -> Factor:
    """eps_gamma of one load.

    Parameters
    ----------
    evidence : has the errors that are common to all loads
    C_gamma : camber stiffness, less what the rig adds to it [N/rad]
    found : turn-slip force and stiffness
    r_e : effective radius [m]
    warmer : how much warmer the tyre was in the camber sweep than at zero [K]

    Notes
    -----
    A secant is the published procedure, whose budget has neither finite spin nor temperature.
    """
    assert evidence.rig is not None
    shared, R = evidence.shared, evidence.rig.R
    if not evidence.published:
        C_gamma = C_gamma * (1.0 - warmer * shared.warming)
    ratio = camber_reduction(found.force, C_gamma, r_e, R, found.sign).epsilon_gamma
    spin = (1.0 - ratio.nominal_value) * found.phi_t[0] ** 2
    plain = ratio if evidence.published else ratio + spin * shared.spin_left
    return Factor(plain, ratio - spin * shared.spin_known, (r_e / R * C_gamma, found.sign * found.force))


def corrected(evidence: DirectEvidence, C_gamma: UFloat | None, C_alpha: UFloat | None) -> UFloat | None:
    """A camber stiffness [N/rad] less what the rig errors add to it."""
    if C_gamma is None or C_alpha is None or evidence.rig is None:
        return C_gamma
    at = AtZero(C_alpha.nominal_value, C_gamma.nominal_value, 0.0)
    return true_camber_stiffness(C_gamma, evidence.rig.errors, at)


def warmer_in_camber(evidence: DirectEvidence, group: LoadGroup) -> float:
    """How much warmer the tyre was in the camber sweep than at its zeros [K]; 0 if it was not measured at both."""
    points = evidence.points
    leaning = points.T[sweep(points, points.Fy, group, "gamma", evidence.config)]
    upright = points.T[np.concatenate([zeros(points, group, direction) for direction in (1, -1)])]
    known = [T[np.isfinite(T)] for T in (leaning, upright)]
    if not all(map(len, known)):
        return 0.0
    return float(np.mean(known[0]) - np.mean(known[1]))
