"""Radius coefficients with which the file's effective rolling radius is the measured one."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of


def effective_radius(values: Mapping[str, Any], loads: np.ndarray, speed: float) -> Any:
    """Effective rolling radius [m] at loads (n,) [N] and a speed [m/s], plain or traced as the values are."""
    return outputs_of(("Re",), SimpleNamespace(**values), {"Fz": loads, "Vx": speed})[0]


def radius_coefficients(
    values: Mapping[str, Any], r_e: Mapping[float, float], speed: float
) -> dict[str, float]:
    """Q_RE0, and DREFF where several loads were measured, with which Re(Fz) passes through the measurements.

    ``r_e`` [m] by load [N] was measured at ``speed`` [m/s]. The shape of Re over load and speed is kept.

    Re is linear in Q_RE0 and DREFF but for the small centrifugal growth, so two Gauss-Newton steps are exact to rounding.
    """
    names = ("Q_RE0", "DREFF") if len(r_e) > 1 else ("Q_RE0",)
    loads, target = np.array(list(r_e)), np.array(list(r_e.values()))
    found = {name: float(values[name]) for name in names}
    for _ in range(3):
        numbers = traced(found)
        Re = effective_radius({**values, **numbers}, loads, speed)
        slope = np.broadcast_to(gradient(Re, list(numbers.values())), (len(loads), len(names)))
        change = np.linalg.lstsq(slope, target - plain(Re), rcond=None)[0]
        found = {name: found[name] + float(d) for name, d in zip(names, change, strict=True)}
    return found
