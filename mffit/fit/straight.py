"""Cornering stiffness without spin: the one measured on the path, corrected by the fitted model."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.fit.posterior import spread_through
from mffit.fit.result import FitResult
from mffit.measured import LoadResult
from mffit.points import Points, main_path, make_points
from mffit.rig import Simulation
from tir import Quantity

STEP = 1e-4  # rad; the curve bends by less than 1e-6 of its slope


def straight_cornering_stiffness(fitted: FitResult, points: Points, row: LoadResult) -> Quantity | None:
    """The tyre's cornering stiffness on a straight path [N/rad]; None if none was measured.

    Parameters
    ----------
    fitted : the model and what is uncertain in it
    points : of the campaign, whose usual path, pressure and speed count
    row : the measurement at its load

    Notes
    -----
    The model gives the ratio of the slopes without and with spin, with an uncertainty from its posterior and for the formula
    itself; the stiffness is the measured one.
    """
    phi_t = main_path(points)
    if row.C_alpha is None or phi_t == 0.0:
        return row.C_alpha
    tyre, posterior = fitted.simulation.faultless, fitted.posterior
    rows = [i for i, name in enumerate(posterior.names) if name in tyre.values]
    names = [posterior.names[i] for i in rows]
    straight, curved = (_slope(tyre, points, row.load, path, names) for path in (0.0, phi_t))
    ratio = straight.slope / curved.slope
    change = straight.by_coefficient / straight.slope - curved.by_coefficient / curved.slope
    u = float(spread_through(change[None], posterior.covariance[np.ix_(rows, rows)])[0])
    u = math.hypot(u, constants.SPIN_CORRECTION_OF_MODEL * (ratio - 1.0))
    C = row.C_alpha
    return Quantity(ratio * C.value, abs(ratio * C.value) * math.hypot(C.u / C.value, u), C.unit)


class _Slope(NamedTuple):
    """Slope of the side force over sideslip at zero."""

    slope: float  #: [N/rad]
    by_coefficient: np.ndarray  #: (k,) its derivatives


def _slope(tyre: Simulation, points: Points, load: float, phi_t: float, names: Sequence[str]) -> _Slope:
    """The model's slope on a path of turn slip ``phi_t`` [1/m], at the usual pressure and speed of ``points``."""
    p, V = float(np.median(points.p)), float(np.median(points.V))
    around = make_points(np.array([STEP, -STEP]), 0.0, load, p=p, V=V, phi_t=phi_t)
    forces, by_coefficient = tyre.sensitivities(around, names)
    up, down = forces.Fy
    slope, changes = float(up - down), by_coefficient.Fy[0] - by_coefficient.Fy[1]
    return _Slope(slope / (2.0 * STEP), changes / (2.0 * STEP))
