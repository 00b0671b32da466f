"""The one least-squares: numbers with start, bounds and prior, exact derivatives; knows no coefficient by name."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve

AT_BOUND = 1e-4
"""Distance from a bound, relative to the width between both, at which a number counts as held by it."""
FIRST_DAMPING = 1e-3
MOST_DAMPING = 1e12
FELT = 0.1
"""Share of a number's stiffness that comes from broken limits, from which on the number counts as held by them."""


@dataclass(frozen=True, slots=True)
class Number:
    """One free number: where it starts, how far it may go, and what is known of it beforehand."""

    name: str
    start: float
    lower: float = -math.inf
    upper: float = math.inf
    expected: float = 0.0  #: centre of the prior
    spread: float = math.inf  #: its standard deviation; infinite where nothing is known


@dataclass(frozen=True, slots=True)
class Linear:
    """A problem at one place: residuals of the data, and of physical limits that are broken there."""

    data: np.ndarray  #: (m,) in units of their uncertainty
    slope: np.ndarray  #: (m, k) derivative of ``data``
    limits: np.ndarray  #: (l,) zero where a limit is kept
    limits_slope: np.ndarray  #: (l, k)


@dataclass(frozen=True, slots=True)
class Problem:
    """Residuals as functions of the numbers (k,); the data's and the limits', together or with derivatives."""

    residual: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  #: data (m,) and limits (l,)
    linear: Callable[[np.ndarray], Linear]


@dataclass(frozen=True, slots=True)
class Solution:
    """Where the search ended."""

    values: Mapping[str, float]
    data: np.ndarray  #: (m,) residual of the data
    jacobian: np.ndarray  #: (m, k) of the data
    prior: np.ndarray  #: (k,) precision that is known beforehand, 1 / spread^2
    cost: float  #: sum of squares of data, priors and limits
    at_bound: frozenset[str]  #: numbers at a bound of their own
    at_limit: frozenset[str]  #: numbers that a physical limit holds
    steps: int

    @property
    def names(self) -> tuple[str, ...]:
        return tuple(self.values)

    @property
    def covariance(self) -> np.ndarray:
        """Covariance (k, k) from data and priors. Limits are no information and stay out of it."""
        return inverse(self.jacobian.T @ self.jacobian + np.diag(self.prior))


def solve(
    problem: Problem, numbers: Sequence[Number], *, max_steps: int = 60, tolerance: float = 1e-6
) -> Solution:
    """Minimise the sum of squares of data, priors and broken limits within the bounds (Levenberg-Marquardt).

    Parameters
    ----------
    problem : residuals and exact derivatives
    numbers : what may move
    max_steps : accepted steps at most
    tolerance : relative decrease of the sum of squares at which the search ends
    """
    lower = np.array([n.lower for n in numbers])
    upper = np.array([n.upper for n in numbers])
    expected = np.array([n.expected for n in numbers])
    precision = np.array([0.0 if math.isinf(n.spread) else n.spread**-2.0 for n in numbers])

    def cost(x: np.ndarray, data: np.ndarray, limits: np.ndarray) -> float:
        total = float(data @ data + limits @ limits + precision @ (x - expected) ** 2)
        return total if math.isfinite(total) else math.inf

    x = np.clip([n.start for n in numbers], lower, upper)
    here = problem.linear(x)
    value = cost(x, here.data, here.limits)
    damping, taken = FIRST_DAMPING, 0
    while taken < max_steps and len(x):
        gradient = here.slope.T @ here.data + here.limits_slope.T @ here.limits + precision * (x - expected)
        curvature = here.slope.T @ here.slope + here.limits_slope.T @ here.limits_slope + np.diag(precision)
        moved, new, damping = _step(problem, cost, x, value, gradient, curvature, lower, upper, damping)
        if moved is None:
            break
        gained, x, value = value - new, moved, new
        here = problem.linear(x)
        taken += 1
        if gained < tolerance * value:
            break
    names = [n.name for n in numbers]
    return Solution(
        values=dict(zip(names, x.tolist(), strict=True)),
        data=here.data,
        jacobian=here.slope,
        prior=precision,
        cost=value,
        at_bound=frozenset(n.name for n, v in zip(numbers, x, strict=True) if touches(v, n.lower, n.upper)),
        at_limit=_held(names, here),
        steps=taken,
    )


def touches(value: float, lower: float, upper: float) -> bool:
    """Whether a value lies at one of its bounds: the one rule for it."""
    return (
        min(value - lower, upper - value) < AT_BOUND * (upper - lower)
        if math.isfinite(upper - lower)
        else False
    )


def inverse(information: np.ndarray) -> np.ndarray:
    """Inverse of a precision matrix (k, k); directions that nothing determines get a very large variance."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-24))
    size, axes = np.linalg.eigh(information / np.outer(scale, scale))
    return (
        (axes / np.maximum(size, 1e-14 * max(size.max(initial=0.0), 1e-300)))
        @ axes.T
        / np.outer(scale, scale)
    )


def root(covariance: np.ndarray) -> np.ndarray:
    """A matrix (k, k) whose product with its transpose is the covariance of numbers that differ by orders of magnitude."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    size, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    return scale[:, None] * axes * np.sqrt(np.maximum(size, 0.0))


def _step(problem, cost, x, value, gradient, curvature, lower, upper, damping):
    """The next place that is better, its cost and the damping to go on with; None if there is none."""
    pushed = ((x <= lower) & (gradient > 0.0)) | ((x >= upper) & (gradient < 0.0))
    free = ~pushed
    scale = np.maximum(np.diag(curvature), 1e-12 * np.max(np.diag(curvature), initial=1e-300))
    if not free.any():
        return None, value, damping
    H, g, d = curvature[np.ix_(free, free)], gradient[free], scale[free]
    while damping < MOST_DAMPING:
        move = np.zeros(len(x))
        try:
            move[free] = -cho_solve(
                cho_factor(H + np.diag(damping * d), check_finite=False), g, check_finite=False
            )
        except np.linalg.LinAlgError:
            damping = max(10.0 * damping, 1e-8)
            continue
        trial = np.clip(x + move, lower, upper)
        new = cost(trial, *problem.residual(trial))
        if new < value:
            step = trial - x
            promised = -(2.0 * gradient @ step + step @ curvature @ step)
            kept = (value - new) / max(promised, 1e-300)
            return trial, new, damping / 5.0 if kept > 0.75 else damping if kept > 0.25 else 3.0 * damping
        if np.all(np.abs(trial - x) <= 1e-12 * (1.0 + np.abs(x))):
            return None, value, damping
        damping *= 6.0
    return None, value, damping


def _held(names: Sequence[str], here: Linear) -> frozenset[str]:
    """Numbers whose stiffness comes to a good part from limits that are broken."""
    active = here.limits_slope[here.limits > 0.0]
    by_limits, by_data = np.sum(active**2, axis=0), np.sum(here.slope**2, axis=0)
    return frozenset(
        n for n, a, b in zip(names, by_limits, by_data, strict=True) if a > FELT * (a + b) and a > 0.0
    )
