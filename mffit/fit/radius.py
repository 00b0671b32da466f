"""Radius coefficients: the file's effective rolling radius at the tested loads is the measured one."""

from __future__ import annotations

from collections.abc import Mapping
from types import SimpleNamespace
from typing import Any

import numpy as np

from tir.evaluate import evaluate


def radius_coefficients(
    values: Mapping[str, Any], r_e: Mapping[float, float], speed: float
) -> dict[str, float]:
    """Q_RE0, and DREFF where several loads were measured, such that Re(Fz) passes through the measurements.

    Parameters
    ----------
    values : every value of the file; its shape of Re over load and speed is kept
    r_e : measured effective radius [m] by load [N]
    speed : at which it was measured [m/s]

    Notes
    -----
    Re is linear in Q_RE0 and DREFF but for the small centrifugal growth, so two Newton steps are exact to rounding.
    """
    names = ("Q_RE0", "DREFF") if len(r_e) > 1 else ("Q_RE0",)
    loads, target = np.array(list(r_e)), np.array(list(r_e.values()))
    current = {name: float(values[name]) for name in names}

    def error(trial):
        p = SimpleNamespace(**{**values, **trial})
        return target - evaluate(p, loads, Vx=speed)[1].Re

    for _ in range(3):
        residual = error(current)
        slopes = np.empty((len(loads), len(names)))
        for column, name in enumerate(names):
            step = 1e-6
            slopes[:, column] = (residual - error({**current, name: current[name] + step})) / step
        change = np.linalg.lstsq(slopes, residual, rcond=None)[0]
        current = {name: current[name] + float(d) for name, d in zip(names, change, strict=True)}
    return current
