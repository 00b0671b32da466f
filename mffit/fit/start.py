"""Starting values read off the data: the odd part, the stiffnesses and the base file."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.points import Points
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


def starting_values(
    values: Mapping[str, Any], points: Points, C_alpha: Mapping[float, float]
) -> dict[str, float]:
    """Improve on the base values by what can be read off the data directly.

    Parameters
    ----------
    values : every value of the file
    points : raw points
    C_alpha : cornering stiffness [N/rad] by load [N], ISO signs; may be empty
    """
    start = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    for name, value in NEVER_ZERO.items():
        if abs(start[name]) < 1e-9:
            start[name] = value
    upright = np.abs(points.gamma) < np.radians(1.0)
    if np.any(upright):
        friction = np.max(np.abs(points.Fy[upright]) / points.Fz[upright])
        start["PDY1"] = max(float(friction), 0.5)
    if C_alpha:
        start.update(_cornering_stiffness(C_alpha, start))
    return start


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
