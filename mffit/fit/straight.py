"""Cornering stiffness on a straight path, from the fitted model and the measured stiffness on the disc."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.fit.result import FitResult
from mffit.fit.rig.rig_numbers import COMPLIANCE
from mffit.measured import LoadResult
from mffit.points import Points, main_path, main_pressure, make_points
from mffit.rig import Simulation
from mffit.rig_errors import V_REF
from tir import Quantity

STEP = 1e-4  # rad; the curve bends by less than 1e-6 of its slope


def straight_cornering_stiffness(fitted: FitResult, points: Points, row: LoadResult) -> Quantity | None:
    """The tyre's cornering stiffness on a straight path [N/rad] at the load of the direct measurement on a disc; None if none
    was measured.

    The value is the model's slope without turn slip. Three components make up its uncertainty: the posterior, a share of the
    correction from the curved to the straight path, and the part of the difference between the model's and the measured slope
    on the curved path that exceeds both uncertainties.
    """
    if row.C_alpha is None:
        return None
    phi_t = main_path(points)
    tyre, posterior = fitted.simulation.faultless, fitted.posterior
    names = [name for name in posterior.names if name in tyre.values]
    straight, curved = (_slope(tyre, points, row.load, path, names) for path in (0.0, phi_t))
    u, u_curved = (float(posterior.spread_of(x.by_coefficient[None], names)[0]) for x in (straight, curved))
    # The measured slope is over the angle as read, which the compliance of the steering changes.
    yielding = tyre.with_numbers({COMPLIANCE: fitted.simulation.faults[COMPLIANCE]})
    as_read = _slope(yielding, points, row.load, phi_t, names).slope
    gap = (as_read - row.C_alpha.value) ** 2 - u_curved**2 - row.C_alpha.u**2
    formula = constants.SPIN_CORRECTION_OF_MODEL * (straight.slope - curved.slope)
    return Quantity(straight.slope, math.hypot(u, formula, math.sqrt(max(gap, 0.0))), row.C_alpha.unit)


class _Slope(NamedTuple):
    """Slope of the side force over sideslip at zero."""

    slope: float  #: [N/rad]
    by_coefficient: np.ndarray  #: (k,) its derivatives


def _slope(tyre: Simulation, points: Points, load: float, phi_t: float, names: Sequence[str]) -> _Slope:
    """The model's slope on a path of turn slip ``phi_t`` [1/m], at the usual pressure of ``points`` and the file's speed."""
    usual, stated = main_pressure(points), tyre.faults[V_REF]
    p, V = (float(np.median(values[usual])) for values in (points.p, points.V))
    V = V if math.isnan(stated) else stated
    around = make_points(np.array([STEP, -STEP]), 0.0, load, p=p, V=V, phi_t=phi_t)
    forces, by_coefficient = tyre.sensitivities(around, names)
    up, down = forces.Fy
    slope, changes = float(up - down), by_coefficient.Fy[0] - by_coefficient.Fy[1]
    return _Slope(slope / (2.0 * STEP), changes / (2.0 * STEP))
