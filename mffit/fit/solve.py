"""The optimiser: bounded least squares. Knows no coefficient by name."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import lmfit
import numpy as np
from scipy.optimize import least_squares


@dataclass(frozen=True, slots=True)
class Solution:
    """Where the optimiser ended."""

    values: Mapping[str, float]
    jacobian: np.ndarray  #: (m, k) of the residual at the solution, columns in the order of ``values``
    residual: np.ndarray  #: (m,)
    at_bound: frozenset[str]
    steps: int


def solve(
    residual: Callable[[Mapping[str, float]], np.ndarray],
    start: Mapping[str, float],
    bounds: Mapping[str, tuple[float, float]],
    *,
    max_steps: int = 60,
    tolerance: float = 1e-7,
) -> Solution:
    """Minimise the sum of squares of ``residual(values)`` from ``start`` within ``bounds``.

    lmfit holds the parameters and their bounds; scipy's trust-region reflective method moves them, called directly
    because lmfit neither returns the jacobian of a run that stops at its step limit nor limits steps as such.
    ``x_scale='jac'`` makes a step independent of the units of the coefficients, which span six decades.
    """
    parameters = lmfit.Parameters()
    for name, value in start.items():
        lower, upper = bounds[name]
        parameters.add(name, value=_inside(value, lower, upper), min=lower, max=upper)
    names = list(parameters)

    def objective(x: np.ndarray) -> np.ndarray:
        return residual(dict(zip(names, x.tolist(), strict=True)))

    out = least_squares(
        objective,
        [parameters[name].value for name in names],
        bounds=([parameters[name].min for name in names], [parameters[name].max for name in names]),
        x_scale="jac",
        max_nfev=max_steps,
        ftol=tolerance,
        xtol=tolerance,
        gtol=1e-10,
    )
    values = dict(zip(names, out.x.tolist(), strict=True))
    return Solution(values, np.asarray(out.jac), out.fun, frozenset(_touching(values, bounds)), out.nfev)


def covariance(jacobian: np.ndarray) -> np.ndarray:
    """Inverse of J'J (k, k), by singular values; directions the data cannot see get a very large variance."""
    scale = np.linalg.norm(jacobian, axis=0)
    scale = np.where(scale > 0, scale, 1e-30)
    _, s, vt = np.linalg.svd(jacobian / scale, full_matrices=False)
    s = np.maximum(s, 1e-9 * s.max())
    return (vt.T / s**2) @ vt / np.outer(scale, scale)


def _inside(value: float, lower: float, upper: float) -> float:
    """A start strictly between the bounds, as the trust-region method needs it."""
    margin = 1e-3 * (upper - lower)
    return float(np.clip(value, lower + margin, upper - margin))


def _touching(values: Mapping[str, float], bounds: Mapping[str, tuple[float, float]]):
    for name, value in values.items():
        lower, upper = bounds[name]
        if min(value - lower, upper - value) < 1e-4 * (upper - lower):
            yield name
