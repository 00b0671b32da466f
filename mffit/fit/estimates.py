"""Estimates for the sections that a cornering test does not measure.

They complete the file so that a simulation can run; they are not measurements and are marked as estimates in the file.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from mffit.fit import constants


def estimates(values: Mapping[str, Any]) -> dict[str, float]:
    """Vertical, longitudinal, combined-slip, rolling and structural coefficients scaled from what is known.

    The longitudinal peak is the lateral one, the longitudinal slip stiffness 1.3 times the cornering stiffness, the static
    deflection at nominal load 5 % of the unloaded radius. Combined slip and relaxation have shapes common to road tyres.
    """
    v = {name: float(value) for name, value in values.items() if isinstance(value, (int, float))}
    Fz0, R0 = v["FNOMIN"], v["UNLOADED_RADIUS"]
    vertical = Fz0 / (constants.ESTIMATED_STATIC_DEFLECTION * R0)
    return {
        "VERTICAL_STIFFNESS": vertical,
        "VERTICAL_DAMPING": constants.ESTIMATED_DAMPING_TIME * vertical,
        "BREFF": 8.0,
        "DREFF": 0.25,
        "FREFF": 0.05,
        "LONGITUDINAL_STIFFNESS": constants.ESTIMATED_LONGITUDINAL_STIFFNESS * vertical,
        "LATERAL_STIFFNESS": constants.ESTIMATED_LATERAL_STIFFNESS * vertical,
        "PCX1": 1.6,
        "PDX1": v["PDY1"],
        "PDX2": v["PDY2"],
        "PEX1": 0.1,
        "PKX1": constants.ESTIMATED_SLIP_STIFFNESS * abs(v["PKY1"]),
        "PKX3": -0.2,
        "RBX1": 12.0,
        "RBX2": 10.0,
        "RCX1": 1.0,
        "RBY1": 11.0,
        "RBY2": 8.0,
        "RCY1": 1.0,
        "QSX2": constants.ESTIMATED_OVERTURNING_ARM * v["WIDTH"] / R0,
        "QSX3": 0.03,
        "QSY1": 0.01,
    }
