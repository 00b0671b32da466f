"""Coefficients of rolling: the effective radius as measured, and the resistance from the measured moment My."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.points import Points
from tir import Quantity, Tyre
from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of


def effective_radius(values: Mapping[str, Any], loads: np.ndarray, speed: float) -> Any:
    """Effective rolling radius [m] at loads (n,) [N] and a speed [m/s], plain or traced as the values are."""
    return outputs_of(("Re",), SimpleNamespace(**values), {"Fz": loads, "Vx": speed})[0]


RADIUS_COEFFICIENTS = ("Q_RE0", "DREFF")
"""Coefficients that measured effective radii determine; the second one needs several loads."""


def radius_coefficients(
    values: Mapping[str, Any],
    r_e: Mapping[float, float],
    speed: float,
    free: Sequence[str] = RADIUS_COEFFICIENTS,
) -> dict[str, float]:
    """Q_RE0, and DREFF where several loads were measured, with which Re(Fz) passes through the measurements.

    ``r_e`` [m] by load [N] was measured at ``speed`` [m/s]. The shape of Re over load and speed is kept, and of the two only
    the ``free`` ones change.

    Re is linear in Q_RE0 and DREFF but for the small centrifugal growth, so two Gauss-Newton steps are exact to rounding.
    """
    names = tuple(free)[: len(r_e)]
    loads, target = np.array(list(r_e)), np.array(list(r_e.values()))
    found = {name: float(values[name]) for name in names}
    if not names:
        return {}
    for _ in range(3):
        numbers = traced(found)
        Re = effective_radius({**values, **numbers}, loads, speed)
        slope = np.broadcast_to(gradient(Re, list(numbers.values())), (len(loads), len(names)))
        change = np.linalg.lstsq(slope, target - plain(Re), rcond=None)[0]
        found = {name: found[name] + float(d) for name, d in zip(names, change, strict=True)}
    return found


def rolling_resistance(values: Mapping[str, Any], points: Points) -> dict[str, Quantity]:
    """QSY1 with its standard uncertainty from measured My, all other values held; empty if My was not measured."""
    used = np.isfinite(points.My) & (points.direction > 0) & points.free_rolling
    if not np.any(used):
        return {}
    chosen = points.select(np.flatnonzero(used))

    def moment(QSY1: float) -> np.ndarray:
        trial = Tyre.from_values(values).replace(QSY1=QSY1)
        return trial(
            chosen.Fz, chosen.alpha, chosen.gamma, phi_t=chosen.phi_t, Vx=chosen.V, p=chosen.p, turn_slip=True
        ).My

    at_zero = moment(0.0)
    slope = moment(1.0) - at_zero  # My is linear in QSY1
    QSY1 = float(slope @ (chosen.My - at_zero) / (slope @ slope))
    scatter = float(np.sum((chosen.My - at_zero - QSY1 * slope) ** 2)) / max(len(slope) - 1, 1)
    return {"QSY1": Quantity(QSY1, math.sqrt(scatter / float(slope @ slope)), "-")}
