"""Rolling resistance from the measured moment My."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from mffit.points import Points
from tir import Quantity, Tyre


def rolling_resistance(values: Mapping[str, Any], points: Points) -> dict[str, Quantity]:
    """QSY1 with its standard uncertainty from measured My, all other values held; empty if My was not measured."""
    used = np.isfinite(points.My) & (points.direction > 0)
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
