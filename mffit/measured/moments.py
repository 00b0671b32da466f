"""eps_gamma from the self-aligning moments instead of the side forces."""

from __future__ import annotations

import math

import numpy as np
from uncertainties import UFloat

from mffit.constants import USUAL_U_MOMENT
from mffit.measured import constants
from mffit.measured.evidence import DirectEvidence
from mffit.measured.groups import LoadGroup
from mffit.measured.slopes import slope_at_zero
from mffit.measured.stiffnesses import sweep
from mffit.measured.turning import Turning


def epsilon_from_moments(
    evidence: DirectEvidence, group: LoadGroup, found: Turning, r_e: UFloat
) -> float | None:
    """The value, without an uncertainty; None without a clear turn-slip moment.

    Spin on a disc changes the trail far more than the side force, so the moments are not proportional to spin: on simulated
    rigs the value is off by 0.3. No uncertainty of readings and rig states that, and the bias needs a model of the moment.
    """
    moment, parts, rig = found.zeros.moment, evidence.parts, evidence.rig
    assert rig is not None
    if moment is None or abs(moment.nominal_value) < constants.CLEAR_MOMENT * moment.std_dev:
        return None
    u = np.where(np.isfinite(parts.u_Mz_odd), parts.u_Mz_odd, USUAL_U_MOMENT / math.sqrt(2.0))
    index = sweep(evidence.points, parts.Mz_odd, group, "gamma", evidence.config)
    slope = slope_at_zero(
        evidence.points.gamma[index],
        parts.Mz_odd[index],
        u[index],
        local=constants.CUBIC_CAMBER.rad,
        curvature=float(constants.CURVATURE_SPREAD),
    )
    if slope is None:
        return None
    return float(1.0 + r_e.n * slope.value / (found.sign * moment.n * rig.R.n))
