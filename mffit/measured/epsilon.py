"""eps_gamma at one load: plain, corrected for finite spin, and from the moments; and its dependence on load."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import CAMBER_OF_SLOPES, COVERAGE_FACTOR_95, USUAL_U_MOMENT
from mffit.measured import constants, wording
from mffit.measured.camber_reduction import camber_reduction, true_camber_stiffness
from mffit.measured.evidence import DirectEvidence
from mffit.measured.result import CarriedEpsilon, LoadDependence, LoadResult, Source
from mffit.measured.stiffnesses import OddCurve, sweep
from mffit.measured.turning import Turning
from mffit.measured.uncertain import combined
from mffit.measured.zeros import LoadGroup, zeros
from mffit.rig_errors import AtZero
from tir import Quantity
from tir.constants import EPS_GAMMA_NEAR_ONE


class Factor(NamedTuple):
    """The estimates of eps_gamma from one camber stiffness."""

    plain: UFloat  #: by (17), with the bias of finite spin in its uncertainty
    debiased: UFloat  #: corrected for finite spin


def factor(
    evidence: DirectEvidence, C_gamma: UFloat, found: Turning, r_e: UFloat, stiffer: UFloat | float
) -> Factor:
    """eps_gamma at one load.

    ``C_gamma`` is the camber stiffness, corrected for rig errors [N/rad], r_e the effective radius [m], ``stiffer`` the
    relative excess of the tyre's stiffness in the camber sweep over that at the zeros. The secant follows the published
    procedure, whose budget has neither finite spin nor temperature.
    """
    if not evidence.published:
        C_gamma = C_gamma * (1.0 - stiffer)
    ratio = camber_reduction(found.C_phit, C_gamma, r_e)
    spin = (1.0 - ratio.nominal_value) * found.phi_t[0] ** 2
    plain = ratio if evidence.published and not evidence.spin_of_model else ratio + spin * evidence.spin_left
    return Factor(plain, ratio - spin * evidence.spin_known)


def corrected(evidence: DirectEvidence, C_gamma: UFloat, C_alpha: UFloat | None) -> UFloat:
    """A camber stiffness [N/rad] corrected for rig errors."""
    if C_alpha is None or evidence.rig is None:
        return C_gamma
    at = AtZero(C_alpha.nominal_value, C_gamma.nominal_value, 0.0)
    return true_camber_stiffness(C_gamma, evidence.rig.errors, at)


def stiffer_in_camber(evidence: DirectEvidence, group: LoadGroup) -> UFloat | float:
    """Relative excess of the tyre's stiffness in the camber sweep over that at its zeros.

    It follows from repeated conditions if there is a drift; else it is 0 with an uncertainty from the difference of temperatures.
    """
    points = evidence.points
    leaning = sweep(points, points.Fy, group, "gamma", evidence.config)
    upright = np.concatenate([zeros(points, group, direction) for direction in (1, -1)])
    if evidence.shares is not None:
        return evidence.shares.between(points, leaning, upright)
    known = [T[np.isfinite(T)] for T in (points.T[leaning], points.T[upright])]
    return (float(np.mean(known[0]) - np.mean(known[1])) if all(map(len, known)) else 0.0) * evidence.warming


def epsilon_from_moments(
    evidence: DirectEvidence, group: LoadGroup, found: Turning, r_e: UFloat
) -> float | None:
    """eps_gamma from the self-aligning moments, without uncertainty; None without a clear turn-slip moment.

    Spin on a disc changes the trail far more than the side force, so moments are not proportional to spin: on simulated rigs the
    value is wrong by 0.3. Uncertainties of readings and rig do not cover this bias, and a correction needs a model of the moment.
    """
    moment, parts, rig = found.zeros.moment, evidence.parts, evidence.rig
    assert rig is not None
    if moment is None or abs(moment.nominal_value) < COVERAGE_FACTOR_95 * moment.std_dev:
        return None
    u = np.where(np.isfinite(parts.u_Mz_odd), parts.u_Mz_odd, USUAL_U_MOMENT / math.sqrt(2.0))
    i = sweep(evidence.points, parts.Mz_odd, group, "gamma", evidence.config)
    slope = OddCurve(evidence.points.gamma[i], parts.Mz_odd[i], u[i]).slope(
        local=CAMBER_OF_SLOPES.rad, curvature=float(constants.CURVATURE_SPREAD)
    )
    if slope is None:
        return None
    C_phit = math.copysign(moment.n * rig.R.n, moment.n * found.zeros.phi_t)
    return float(1.0 + r_e.n * slope.value / C_phit)


def carried_by_file(
    config: Config, row: LoadResult, law: LoadDependence, fitted: Quantity | None
) -> CarriedEpsilon:
    """PECP1 and PECP2 of the property file: the one place that decides between the estimates of eps_gamma.

    ``row`` is the result at the nominal load, and ``fitted`` PECP1 after a fit. [coefficients] can hold PECP1 only where the
    choice is "model".
    """
    by_hand = config.coefficients.get("PECP1")
    source: Source = "hand" if by_hand is not None and by_hand.is_held else config.spin.pecp1
    measured = {"direct": row.epsilon_gamma, "debiased": row.epsilon_debiased or row.epsilon_gamma}
    pecp1 = measured.get(source) or fitted or row.epsilon_gamma
    assert pecp1 is not None
    return CarriedEpsilon(source, pecp1, law)


def load_dependence(
    loads: Sequence[float], epsilon: Sequence[UFloat], nominal: int, Fz0: float
) -> LoadDependence:
    """PECP2 from the slope of eps_gamma over the loads [N], relative to its value at that with index ``nominal``.

    Rig errors common to all loads are treated as correlated. PECP2 is not 0 only if slope and PECP1 clearly differ from zero
    and eps_gamma stays below its limit within the loads.
    """
    at_nominal = epsilon[nominal]
    pecp1 = float(at_nominal.nominal_value)
    others = [i for i in range(len(loads)) if i != nominal]
    if not others:
        return LoadDependence(0.0, None, wording.ONE_LOAD)
    x = np.array([[(loads[i] - loads[nominal]) / Fz0] for i in others])
    (law,) = combined([epsilon[i] - at_nominal for i in others], x).numbers
    slope, u = float(law.nominal_value), float(law.std_dev)
    u_pecp2 = u / max(abs(pecp1), 1e-12)
    most = max(pecp1 + slope * (load - loads[nominal]) / Fz0 for load in loads)
    if abs(slope) <= COVERAGE_FACTOR_95 * u:
        why = wording.SLOPE_IN_NOISE.format(slope=slope, twice=2.0 * u)
    elif abs(pecp1) <= COVERAGE_FACTOR_95 * at_nominal.std_dev:
        why = wording.EPSILON_IN_NOISE
    elif most >= 1.0 - EPS_GAMMA_NEAR_ONE:
        why = wording.SLOPE_TOO_STEEP.format(largest=most)
    else:
        pecp2 = slope / pecp1
        return LoadDependence(pecp2, u_pecp2, wording.LOAD_SLOPE.format(pecp2=pecp2, u=u_pecp2))
    return LoadDependence(0.0, u_pecp2, why)
