"""Coefficients of longitudinal and combined slip converted to another nominal load and pressure."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

LINEAR_IN_LOAD = (
    ("PDX1", "PDX2"),
    ("PHX1", "PHX2"),
    ("PVX1", "PVX2"),
    ("REX1", "REX2"),
    ("REY1", "REY2"),
    ("RHY1", "RHY2"),
    ("RVY1", "RVY2"),
    ("SSZ3", "SSZ4"),
)
"""Coefficients of a + b dfz."""
OVER_PRESSURE = {("PPX1", "PPX2"): ("PKX1", "PKX2"), ("PPX3", "PPX4"): ("PDX1", "PDX2")}
"""Coefficients of 1 + a dpi + b dpi^2, and those that this factor multiplies."""


def at_nominal(values: Mapping[str, Any], load: float, pressure: float) -> dict[str, Any]:
    """The values with FNOMIN [N] and NOMPRES [Pa] replaced, and coefficients that give the same Fx and the same weights.

    The forms of the equations are closed under such a change, so it is exact. The moment arms SSZ1-4 stay relative to the radius.
    """
    v = dict(values)
    scale = load / float(v["FNOMIN"])  # dfz of the file = scale * the new dfz + shift
    shift = scale - 1.0
    for first, second in LINEAR_IN_LOAD:
        v[first], v[second] = v[first] + v[second] * shift, v[second] * scale
    a, b, c = (float(v[name]) for name in ("PEX1", "PEX2", "PEX3"))
    v["PEX1"] = a + b * shift + c * shift**2
    v["PEX2"] = (b + 2.0 * c * shift) * scale
    v["PEX3"] = c * scale**2
    growth = math.exp(v["PKX3"] * shift)
    v["PKX1"], v["PKX2"] = growth * (v["PKX1"] + v["PKX2"] * shift), growth * v["PKX2"] * scale
    v["PKX3"] *= scale
    v["SSZ2"] *= scale
    scale = pressure / float(v["NOMPRES"])
    shift = scale - 1.0
    for (first, second), multiplied in OVER_PRESSURE.items():
        a, b = float(v[first]), float(v[second])
        here = 1.0 + a * shift + b * shift**2
        for name in multiplied:
            v[name] *= here
        v[first], v[second] = (a + 2.0 * b * shift) * scale / here, b * scale**2 / here
    return {**v, "FNOMIN": load, "NOMPRES": pressure}
