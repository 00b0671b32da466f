"""Estimates for the sections that a cornering test does not measure.

They complete the file so that a simulation can run; they are not measurements and are marked as estimates in the file.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

SHAPES = {
    "BREFF": 8.0,
    "DREFF": 0.25,
    "FREFF": 0.05,
    "PCX1": 1.6,
    "PEX1": 0.1,
    "PKX3": -0.2,
    "RBX1": 12.0,
    "RBX2": 10.0,
    "RCX1": 1.0,
    "RBY1": 11.0,
    "RBY2": 8.0,
    "RCY1": 1.0,
    "QSX3": 0.03,
    "QSY1": 0.01,
}
"""Shapes that are common to road tyres."""


def estimates(values: Mapping[str, Any]) -> dict[str, float]:
    """Vertical, longitudinal, combined-slip, rolling and structural coefficients, scaled from what is known.

    The static deflection at nominal load is 5 % of the unloaded radius, the longitudinal peak the lateral one, the longitudinal
    slip stiffness 1.3 times the cornering stiffness, and the arm of the load half the width per radian of camber.
    """
    v = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    R0 = v["UNLOADED_RADIUS"]
    vertical = v["FNOMIN"] / (0.05 * R0)
    return {
        "VERTICAL_STIFFNESS": vertical,
        "VERTICAL_DAMPING": 0.0005 * vertical,
        "LONGITUDINAL_STIFFNESS": 1.5 * vertical,
        "LATERAL_STIFFNESS": 0.7 * vertical,
        "PDX1": v["PDY1"],
        "PDX2": v["PDY2"],
        "PKX1": 1.3 * abs(v["PKY1"]),
        "QSX2": 0.5 * v["WIDTH"] / R0,
        **SHAPES,
    }
