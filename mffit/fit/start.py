"""Starting values of the fit, read off the data."""

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from mffit.constants import UPRIGHT
from mffit.fit.upright import nearest, sideways, upright
from mffit.measured import Measured
from mffit.points import Points, main_pressure
from tir.equations import stiffness
from tir.parameters import BY_NAME

NONZERO_STARTS = {
    "QBZ1": 8.0,
    "QDZ1": 0.08,
    "PDYP1": 0.3,
    "PKYP1": 0.5,
    "QDTP1": 3.0,
    "QCRP1": 0.1,
    "QBRP1": 0.2,
    "QSX2": 0.1,
    "RBX2": 8.0,
    "RBY2": 8.0,
    "RVY1": 0.01,
    "RVY3": 0.05,
    "RVY4": 10.0,
    "RVY5": 1.5,
    "RVY6": 10.0,
}
"""Starting values for coefficients at which a search would be stuck at zero, because all derivatives vanish there."""
SHAPES_OF_FX: Sequence[Mapping[str, float]] = ({"PCX1": 1.2, "PEX1": -0.5}, {"PCX1": 1.8, "PEX1": 0.4})
"""Further starting values of the longitudinal force, because its sum of squares can have several minima."""
SHAPES_OF_MZ: Sequence[Mapping[str, float]] = ({"QCZ1": 1.1, "QEZ1": -6.0}, {"QCZ1": 1.7, "QEZ1": 0.8})
"""The same for the aligning moment: there is a minimum on either side of QEZ1 = 0."""


def starting_values(
    values: Mapping[str, Any], points: Points, measured: Measured, held: Collection[str] = ()
) -> dict[str, float]:
    """The starting values: those that can be read off the data are replaced, those ``held`` by hand stay."""
    start = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    for name, value in NONZERO_STARTS.items():
        if abs(start[name]) < 1e-9 and name not in held:
            start[name] = value
    upright = np.abs(points.gamma) < UPRIGHT.rad
    if np.any(upright) and "PDY1" not in held:
        start["PDY1"] = BY_NAME["PDY1"].inside(float(np.max(np.abs(points.Fy[upright]) / points.Fz[upright])))
    main = float(points.p[main_pressure(points)].mean())
    C_alpha, C_gamma = measured.by_load("C_alpha"), measured.by_load("C_gamma")
    if C_alpha:
        loads, K_ya = np.array(list(C_alpha)), np.array(list(C_alpha.values()))
        start |= nearest(start, ("PKY1", "PKY2"), lambda v: sideways(v, loads, main)[1], K_ya, held)
    if C_gamma:
        # With turn slip on, camber acts through the rolling spin, so the slope is K_yg0 times R0 / r_e.
        rolling = 1.0
        if measured.r_e is not None and np.any(points.phi_t):
            rolling = measured.r_e.value / start["UNLOADED_RADIUS"]
        C_gamma = {load: rolling * value for load, value in C_gamma.items()}
        start |= camber_stiffness_terms(start, C_gamma, main, held)
    return start


def camber_stiffness_terms(
    values: Mapping[str, Any], C_gamma: Mapping[float, float], main: float, held: Collection[str] = ()
) -> dict[str, float]:
    """PKY6 and PKY7 with K_yg0(Fz) = C_gamma(Fz), ``C_gamma`` [N/rad] by load [N] at the pressure ``main`` [Pa]."""
    loads, K_yg0 = np.array(list(C_gamma)), np.array(list(C_gamma.values()))
    return nearest(
        values, ("PKY6", "PKY7"), lambda v: stiffness.camber_stiffness(*upright(v, loads, main)), K_yg0, held
    )
