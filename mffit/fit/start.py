"""Starting values of the fit, read off the data."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Any

import numpy as np

from mffit.constants import UPRIGHT
from mffit.measured import Measured
from mffit.points import Points, main_pressure
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
"""Starting values instead of zero, where all derivatives vanish at zero and no step would leave it."""
SHAPES_OF_FX: Sequence[Mapping[str, float]] = ({"PCX1": 1.2, "PEX1": -0.5}, {"PCX1": 1.8, "PEX1": 0.4})
"""Further starts of the longitudinal force, whose shape factor can have several minima."""


def starting_values(
    values: Mapping[str, Any], points: Points, measured: Measured, held: Collection[str] = ()
) -> dict[str, float]:
    """The values with those improved that can be read off the data directly, and with those ``held`` by hand as they are."""
    start = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    for name, value in NONZERO_STARTS.items():
        if abs(start[name]) < 1e-9 and name not in held:
            start[name] = value
    upright = np.abs(points.gamma) < UPRIGHT.rad
    if np.any(upright) and "PDY1" not in held:
        start["PDY1"] = BY_NAME["PDY1"].inside(float(np.max(np.abs(points.Fy[upright]) / points.Fz[upright])))
    C_alpha, C_gamma = measured.by_load("C_alpha"), measured.by_load("C_gamma")
    if C_alpha:
        start |= _cornering_stiffness_terms(start, C_alpha, held)
    if C_gamma:
        # With turn slip on, camber acts through the rolling spin: the force is that of K_yg0 times R0 / r_e.
        rolling = 1.0
        if measured.r_e is not None and np.any(points.phi_t):
            rolling = measured.r_e.value / start["UNLOADED_RADIUS"]
        C_gamma = {load: rolling * value for load, value in C_gamma.items()}
        start |= camber_stiffness_terms(start, C_gamma, float(points.p[main_pressure(points)].mean()), held)
    return start


def camber_stiffness_terms(
    values: Mapping[str, Any], C_gamma: Mapping[float, float], main: float, held: Collection[str] = ()
) -> dict[str, float]:
    """PKY6 and PKY7 with K_yg0(Fz) = C_gamma(Fz): exact at the load nearest FNOMIN, best slope over the others.

    ``C_gamma`` [N/rad] by load [N] was measured at the pressure ``main`` [Pa]; PPY5 takes it to the nominal one. Of the two only
    those not ``held`` by hand are returned.
    """
    if not C_gamma:
        return {}
    Fz0 = float(values["FNOMIN"]) * float(values["LFZO"])
    load, stiffness = np.array(list(C_gamma)), np.array(list(C_gamma.values()))
    pressure = 1.0 + float(values["PPY5"]) * (main / float(values["NOMPRES"]) - 1.0)
    specific = stiffness / (load * pressure * float(values["LKYC"]))
    dfz = (load - Fz0) / Fz0
    nearest = int(np.argmin(np.abs(dfz)))
    offset = dfz - dfz[nearest]
    slope = float(values["PKY7"])
    if "PKY6" in held and "PKY7" not in held and np.any(dfz):
        slope = float(dfz @ (specific - float(values["PKY6"])) / (dfz @ dfz))
    elif len(load) > 1 and "PKY7" not in held:
        slope = float(offset @ (specific - specific[nearest]) / (offset @ offset))
    found = {"PKY6": float(specific[nearest] - slope * dfz[nearest]), "PKY7": slope}
    return {name: value for name, value in found.items() if name not in held}


def _cornering_stiffness_terms(
    values: Mapping[str, float], C_alpha: Mapping[float, float], held: Collection[str]
) -> dict[str, float]:
    """PKY1 and PKY2 of the curve PKY1 Fz0 sin(PKY4 atan(Fz / (PKY2 Fz0))) nearest to the measured stiffnesses.

    Only those not ``held`` by hand change.
    """
    Fz0 = values["FNOMIN"]
    load = np.array(list(C_alpha)) / Fz0
    stiffness = np.array(list(C_alpha.values())) / Fz0
    if len(load) == 1 or "PKY2" in held:
        if "PKY1" in held:
            return {}
        shape = np.sin(values["PKY4"] * np.arctan(load / values["PKY2"]))
        return {"PKY1": float(shape @ stiffness / (shape @ shape))}
    PKY2 = np.linspace(*BY_NAME["PKY2"].usual, 78)  # in steps of 0.1
    shapes = np.sin(values["PKY4"] * np.arctan(load / PKY2[:, None]))
    PKY1 = (shapes @ stiffness) / np.sum(shapes**2, axis=1)
    if "PKY1" in held:
        PKY1 = np.full(len(PKY2), values["PKY1"])
    best = int(np.sum((shapes * PKY1[:, None] - stiffness) ** 2, axis=1).argmin())
    found = {"PKY1": float(PKY1[best]), "PKY2": float(PKY2[best])}
    return {name: value for name, value in found.items() if name not in held}
