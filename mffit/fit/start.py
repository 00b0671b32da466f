"""Starting values read off the data: the odd part, the stiffnesses and the base file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.measured import Measured
from mffit.points import Points, main_pressure
from tir import Tyre

NEVER_ZERO = {"QBZ1": 8.0, "QDZ1": 0.08, "PDYP1": 0.3, "PKYP1": 0.5, "QDTP1": 3.0, "QCRP1": 0.1, "QBRP1": 0.2}
"""Where the derivative vanishes at zero, a start at zero never leaves it."""


def base_values(config, base: Tyre | None) -> dict[str, Any]:
    """Every value of the file before the fit: the base file's, else the table's defaults, with the tyre's own data."""
    values = dict(base.values) if base is not None else dict(Tyre.from_values({}).values)
    tyre = config.tyre
    given = {
        "FNOMIN": tyre.nominal_load,
        "NOMPRES": tyre.nominal_pressure * 1e3,
        "INFLPRES": tyre.nominal_pressure * 1e3,
        "LONGVL": tyre.nominal_speed,
        "UNLOADED_RADIUS": tyre.unloaded_radius,
        "WIDTH": tyre.width,
        "RIM_RADIUS": tyre.rim_radius,
        "TYRESIDE": tyre.side.upper() if tyre.side else None,
    }
    values.update({name: value for name, value in given.items() if value is not None})
    values["FITTYP"] = 62
    return values


def starting_values(values: Mapping[str, Any], points: Points, measured: Measured) -> dict[str, float]:
    """Improve on the base values by what can be read off the data directly.

    Parameters
    ----------
    values : every value of the file
    points : raw points
    measured : stiffnesses by load, ISO signs; may be empty
    """
    start = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    for name, value in NEVER_ZERO.items():
        if abs(start[name]) < 1e-9:
            start[name] = value
    upright = np.abs(points.gamma) < np.radians(1.0)
    if np.any(upright):
        friction = np.max(np.abs(points.Fy[upright]) / points.Fz[upright])
        start["PDY1"] = max(float(friction), 0.5)
    C_alpha, C_gamma = measured.by_load("C_alpha"), measured.by_load("C_gamma")
    if C_alpha:
        start.update(_cornering_stiffness(C_alpha, start))
    if C_gamma:
        # With turn slip on, camber acts through the rolling spin: the force is that of K_yg0 times R0 / r_e.
        rolling = (
            measured.r_e.value / start["UNLOADED_RADIUS"] if measured.r_e and np.any(points.phi_t) else 1.0
        )
        C_gamma = {load: rolling * value for load, value in C_gamma.items()}
        start.update(camber_stiffness_terms(start, C_gamma, float(points.p[main_pressure(points)].mean())))
    return start


def camber_stiffness_terms(
    values: Mapping[str, Any], C_gamma: Mapping[float, float], main: float
) -> dict[str, float]:
    """PKY6 and PKY7 with K_yg0(Fz) = C_gamma(Fz): exact at the load nearest FNOMIN, best slope over the others.

    ``main`` is the pressure [Pa] at which C_gamma was measured; PPY5 takes it to the nominal one.
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
    if len(load) > 1:
        slope = float(offset @ (specific - specific[nearest]) / (offset @ offset))
    return {"PKY6": float(specific[nearest] - slope * dfz[nearest]), "PKY7": slope}


def _cornering_stiffness(C_alpha: Mapping[float, float], start: Mapping[str, float]) -> dict[str, float]:
    """PKY1 and PKY2 of the curve PKY1 Fz0 sin(PKY4 atan(Fz / (PKY2 Fz0))) nearest to the measured stiffnesses."""
    Fz0 = start["FNOMIN"]
    load = np.array(list(C_alpha)) / Fz0
    stiffness = np.array(list(C_alpha.values())) / Fz0
    candidates = np.linspace(0.5, 5.0, 46)
    shapes = np.sin(start["PKY4"] * np.arctan(load / candidates[:, None]))
    PKY1 = (shapes @ stiffness) / np.sum(shapes**2, axis=1)
    misfit = np.sum((shapes * PKY1[:, None] - stiffness) ** 2, axis=1)
    if len(load) == 1:
        return {"PKY1": float(stiffness[0] / np.sin(start["PKY4"] * np.arctan(load[0] / start["PKY2"])))}
    best = int(misfit.argmin())
    return {"PKY1": float(PKY1[best]), "PKY2": float(candidates[best])}
