"""eps_gamma over load: PECP1 and PECP2."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.measured import constants, notes


class LoadDependence(NamedTuple):
    """PECP1 and PECP2 of eps_gamma(Fz) = PECP1 (1 + PECP2 dfz)."""

    pecp1: float
    pecp2: float
    u_pecp2: float | None
    note: str


def load_dependence(
    loads: Sequence[float], epsilon: Sequence[UFloat], nominal: int, Fz0: float
) -> LoadDependence:
    """Fit the slope over load with eps_gamma at the nominal load held; rig errors common to all loads stay correlated.

    Parameters
    ----------
    loads : [N]
    epsilon : eps_gamma at each, with its correlations
    nominal : which of them is the load nearest FNOMIN
    Fz0 : FNOMIN [N]

    Notes
    -----
    PECP2 is written only where the slope exceeds 2 u, |PECP1| exceeds 2 u and eps_gamma stays below 0.9.
    """
    at_nominal = epsilon[nominal]
    pecp1 = float(at_nominal.nominal_value)
    others = [i for i in range(len(loads)) if i != nominal]
    if not others:
        return LoadDependence(pecp1, 0.0, None, notes.ONE_LOAD)
    x = np.array([(loads[i] - loads[nominal]) / Fz0 for i in others])
    differences = [epsilon[i] - at_nominal for i in others]
    weight = np.linalg.pinv(covariance(differences))
    y = np.array([d.nominal_value for d in differences])
    slope, u = float(x @ weight @ y / (x @ weight @ x)), float(1.0 / np.sqrt(x @ weight @ x))
    u_pecp2 = u / max(abs(pecp1), 1e-12)
    span = [pecp1 + slope * (load - loads[nominal]) / Fz0 for load in loads]
    if abs(slope) <= constants.SIGNIFICANT_SLOPE * u:
        why = notes.slope_in_noise(slope, u)
    elif abs(pecp1) <= constants.SIGNIFICANT_SLOPE * at_nominal.std_dev:
        why = notes.EPSILON_IN_NOISE
    elif max(span) >= constants.LARGEST_EPSILON:
        why = notes.slope_too_steep(max(span))
    else:
        return LoadDependence(pecp1, slope / pecp1, u_pecp2, notes.load_slope(slope / pecp1, u_pecp2))
    return LoadDependence(pecp1, 0.0, u_pecp2, why)


def covariance(numbers: Sequence[UFloat]) -> np.ndarray:
    """Covariance (n, n) of numbers with uncertainty, their independent sources in order of first appearance.

    ``uncertainties.covariance_matrix`` goes through the sources as a set, whose order, and with it the last digit of the
    sums, differs from run to run.
    """
    sources = list(dict.fromkeys(source for number in numbers for source in number.derivatives))
    slopes = np.array(
        [[number.derivatives.get(source, 0.0) * source.std_dev for source in sources] for number in numbers]
    )
    return slopes @ slopes.T
