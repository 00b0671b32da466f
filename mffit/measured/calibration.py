"""Multiplicative errors of the readings: calibration of a channel, compliance of the steering, errors that look like camber."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.constants import CAMBER_OF_SLOPES
from mffit.measured import constants
from mffit.measured.evidence import DirectEvidence
from mffit.measured.stiffnesses import LoadSlopes, sweep
from mffit.measured.turning import Turning
from mffit.measured.uncertain import polynomial
from mffit.measured.zeros import LoadGroup, u_of
from mffit.rig_errors import DECLARED, AtLoad, Slopes


class Factors(NamedTuple):
    """Correction factors for stiffnesses and force as read: 1, with the uncertainty of the calibrations."""

    C_alpha: UFloat
    C_gamma: UFloat
    F_phit: UFloat
    yields: float  #: relative change of C_alpha by a compliance of the steering of 1 deg/Nm


def calibration(
    evidence: DirectEvidence, group: LoadGroup, over_load: Slopes, slopes: LoadSlopes, found: Turning | None
) -> Factors:
    """The correction factors at one load. An error common to all loads is one source: it cancels in differences and ratios of
    results.

    ``over_load`` are relative changes of stiffnesses and force per relative change of load; ``slopes`` and ``found`` are
    stiffnesses and turn-slip force as read.
    """
    of_camber, spin = 0.0, 0.0
    if slopes.C_gamma is not None:
        of_camber = 1.0 / slopes.C_gamma.nominal_value
        spin = 0.0 if found is None else found.force.nominal_value * found.phi_t[0]
    by_moment = _by_moment(evidence, group, slopes, found)
    at = AtLoad(over_load, by_moment, group.load * of_camber, spin * of_camber)
    factors: dict[str, UFloat] = dict.fromkeys(Slopes._fields, 1.0)
    for error, declared in DECLARED:
        if declared.calibrates:
            shares = declared.calibrates(at)._asdict()
            factors = {n: x - shares[n] * evidence.calibration[error.name] for n, x in factors.items()}
    return Factors(**factors, yields=math.radians(at.by_moment.C_alpha))


def powers_of_load(found: Sequence[tuple[LoadGroup, LoadSlopes]], load: float) -> Slopes:
    """Relative change of stiffnesses and force per relative change of load, at ``load`` [N]; 1 if only one load was measured.

    The turn-slip force, camber stiffness times spin, has the power of the camber stiffness.
    """

    def power(name: str) -> float:
        known = {
            group.load: abs(C.nominal_value) for group, own in found if (C := getattr(own, name)) is not None
        }
        if load not in known or len(known) < 2:
            return 1.0
        loads = np.array(sorted(known))
        slope = np.gradient(np.log([known[one] for one in loads]), np.log(loads))
        return float(slope[np.searchsorted(loads, load)])

    of_camber = power("C_gamma")
    return Slopes(power("C_alpha"), of_camber, of_camber)


def _by_moment(
    evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes, found: Turning | None
) -> Slopes:
    """Relative change of stiffnesses and force per unit of steering compliance [rad/Nm]; 0 if Mz was not measured."""
    if slopes.C_alpha is None:
        return Slopes()
    C_alpha = float(slopes.C_alpha.nominal_value)
    of_camber, of_zero = 0.0, 0.0
    if slopes.C_gamma is not None:
        of_camber = C_alpha * _moment_over(evidence, group, "gamma") / slopes.C_gamma.nominal_value
    if found is not None and found.zeros.moment is not None:
        of_zero = C_alpha * found.zeros.moment.nominal_value / found.zeros.forward.nominal_value
    return Slopes(_moment_over(evidence, group, "alpha"), of_camber, of_zero)


def _moment_over(evidence: DirectEvidence, group: LoadGroup, angle: str) -> float:
    """Slope of Mz over an angle at zero [Nm/rad]; 0 if Mz was not measured at enough angles."""
    points, parts = evidence.points, evidence.parts
    Mz = points.Mz if evidence.rig is None else parts.Mz_odd
    i = sweep(points, Mz, group, angle, evidence.config)
    x = (points.gamma if angle == "gamma" else evidence.odd_slip)[i]
    near = x <= 1.01 * (CAMBER_OF_SLOPES if angle == "gamma" else constants.CUBIC_SIDESLIP).rad
    if len(np.unique(np.round(x[near], 4))) < 2:
        return 0.0
    return float(polynomial(x[near], Mz[i][near], u_of(points, "Mz")[i][near], (1, 3))[0][0])
