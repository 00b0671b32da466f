"""The one least-squares solver: numbers with start, bounds and prior, exact derivatives, no knowledge of any coefficient."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from mffit import constants
from tir.derivatives import gradient, plain, traced


@dataclass(frozen=True, slots=True)
class FreeNumber:
    """One free number: starting value, bounds and prior."""

    name: str
    start: float
    lower: float = -math.inf
    upper: float = math.inf
    expected: float = 0.0  #: centre of the prior
    spread: float = math.inf  #: its standard deviation; infinite without a prior


@dataclass(frozen=True, slots=True)
class Linear:
    """Residuals and their derivatives at one place; those of the data may be :func:`condensed`."""

    data: np.ndarray  #: (m,) residuals of the data in units of their uncertainty
    slope: np.ndarray  #: (m, k) derivatives of ``data``
    limits: np.ndarray  #: (l,) residuals of physical limits; zero where a limit is kept
    limits_slope: np.ndarray  #: (l, k) derivatives of ``limits``
    kept: Kept | None = None
    """Limits that are kept here, if a step may look at them: where many are near, steps that ignore them are rejected."""


def condensed(blocks: Iterable[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Residuals (m,) and derivatives (m, k) of blocks of data one after the other.

    Many are replaced by k + 1 rows with the same sums of squares and products, of all that a solver and a covariance need: the
    memory is then that of one block.
    """
    found: list[tuple[np.ndarray, np.ndarray]] = []
    size, products = 0, np.zeros(())
    for data, slope in blocks:
        found.append((data, slope))
        size += len(data)
        if size > constants.ROWS_AT_ONCE:
            products = products + sum(_products(*block) for block in found)
            found = []
    if products.ndim:
        rows = root(products).T
        return rows[:, -1], rows[:, :-1]
    return np.concatenate([data for data, _ in found]), np.concatenate([slope for _, slope in found])


def _products(data: np.ndarray, slope: np.ndarray) -> np.ndarray:
    """Sums of products (k + 1, k + 1) of the derivatives and residuals of a block."""
    across = slope.T @ data
    return np.block([[slope.T @ slope, across[:, None]], [across, data @ data]])


class Kept(NamedTuple):
    """Residuals, below zero, that kept physical limits would have, and their derivatives."""

    value: np.ndarray  #: (q,)
    slope: np.ndarray  #: (q, k)


@dataclass(frozen=True, slots=True)
class LeastSquaresProblem:
    """Residuals as functions of the numbers (k,)."""

    residual: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]  #: of data (m,) and limits (l,)
    linear: Callable[[np.ndarray], Linear]  #: the same with derivatives


def of_model(
    model: Callable[[Mapping[str, Any]], Any], names: Sequence[str], measured: np.ndarray, u: Any
) -> LeastSquaresProblem:
    """The problem without limits of a model (m,) of named numbers, plain or traced, against measured values (m,).

    ``u`` is the uncertainty of these, scalar or (m,).
    """
    none, k = np.zeros(0), len(names)

    def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        found = model(dict(zip(names, x.tolist(), strict=True)))
        return (np.broadcast_to(found, len(measured)) - measured) / u, none

    def linear(x: np.ndarray) -> Linear:
        numbers = traced(dict(zip(names, x.tolist(), strict=True)))
        found = model(numbers)
        slope = np.broadcast_to(gradient(found, list(numbers.values())), (len(measured), k))
        data = (np.broadcast_to(plain(found), len(measured)) - measured) / u
        return Linear(data, (slope.T / u).T, none, np.zeros((0, k)))

    return LeastSquaresProblem(residual, linear)


@dataclass(frozen=True, slots=True)
class Solution:
    """The end of a search."""

    values: Mapping[str, float]
    data: np.ndarray  #: (m,) residuals of the data, as in :class:`Linear`
    jacobian: np.ndarray  #: (m, k) of the data
    prior: np.ndarray  #: (k,) precision of the priors, 1 / spread^2
    cost: float  #: sum of squares of data, priors and limits
    at_bound: frozenset[str]  #: numbers at one of their own bounds
    at_limit: frozenset[str]  #: numbers that a physical limit holds
    steps: int

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the free numbers."""
        return tuple(self.values)

    @property
    def covariance(self) -> np.ndarray:
        """Covariance (k, k) from data and priors; limits are not information and do not enter."""
        return inverse(self.jacobian.T @ self.jacobian + np.diag(self.prior))


class Minimum(NamedTuple):
    """Where a search ends."""

    names: tuple[str, ...]
    x: np.ndarray  #: (k,)
    cost: float  #: sum of squares of data, priors and limits
    steps: int
    here: Linear | None  #: the problem there, where the search computed it

    @property
    def values(self) -> dict[str, float]:
        """The numbers by name."""
        return dict(zip(self.names, self.x.tolist(), strict=True))


def minimum(
    problem: LeastSquaresProblem,
    numbers: Sequence[FreeNumber],
    *,
    max_steps: int = 60,
    tolerance: float = 1e-6,
) -> Minimum:
    """The minimum that :func:`solve` finds, without the derivatives there."""
    objective = _Objective.of(problem, numbers)
    x = np.clip([n.start for n in numbers], objective.lower, objective.upper)
    here, at_x = problem.linear(x), True
    cost = objective.cost(x, here.data, here.limits)
    damping, taken = 1e-3, 0
    while taken < max_steps and len(x):
        if not at_x:  # earlier arrays are kept until here: memory that was freed is slow to get again
            here, at_x = problem.linear(x), True
        step = _step(objective, x, cost, here, damping)
        if step is None:
            break
        gained, x, cost, damping, at_x = cost - step.cost, step.x, step.cost, step.damping, False
        taken += 1
        if gained < tolerance * cost:
            break
    return Minimum(tuple(n.name for n in numbers), x, cost, taken, here if at_x else None)


def solve(
    problem: LeastSquaresProblem,
    numbers: Sequence[FreeNumber],
    *,
    max_steps: int = 60,
    tolerance: float = 1e-6,
) -> Solution:
    """The minimum of the sum of squares of data, priors and limits within the bounds, by Levenberg-Marquardt.

    Parameters
    ----------
    problem : residuals and exact derivatives
    numbers : the free numbers
    max_steps : accepted steps at most
    tolerance : relative decrease of the sum of squares at which the search ends
    """
    found = minimum(problem, numbers, max_steps=max_steps, tolerance=tolerance)
    objective = _Objective.of(problem, numbers)
    here = problem.linear(found.x) if found.here is None else found.here
    return Solution(
        values=found.values,
        data=here.data,
        jacobian=here.slope,
        prior=objective.precision,
        cost=found.cost,
        at_bound=frozenset(
            n.name for n, v in zip(numbers, found.x, strict=True) if touches(v, n.lower, n.upper)
        ),
        at_limit=_held_by_limits([n.name for n in numbers], here),
        steps=found.steps,
    )


def touches(value: float, lower: float, upper: float) -> bool:
    """Whether a value lies at one of its bounds; never where a bound is infinite."""
    width = upper - lower
    return math.isfinite(width) and min(value - lower, upper - value) < constants.AT_BOUND_SHARE * width


def inverse(information: np.ndarray) -> np.ndarray:
    """Inverse of an information matrix (k, k); undetermined directions get a very large variance."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-24))
    size, axes = np.linalg.eigh(information / np.outer(scale, scale))
    floor = 1e-14 * max(size.max(initial=0.0), 1e-300)
    return (axes / np.maximum(size, floor)) @ axes.T / np.outer(scale, scale)


def root(covariance: np.ndarray) -> np.ndarray:
    """A matrix (k, k) whose product with its transpose is the covariance; the numbers may differ by orders of magnitude."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    size, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    return scale[:, None] * axes * np.sqrt(np.maximum(size, 0.0))


class _Objective(NamedTuple):
    """The sum of squares of data, priors and limits, and the bounds."""

    problem: LeastSquaresProblem
    lower: np.ndarray
    upper: np.ndarray
    expected: np.ndarray
    precision: np.ndarray

    @classmethod
    def of(cls, problem: LeastSquaresProblem, numbers: Sequence[FreeNumber]) -> _Objective:
        return cls(
            problem=problem,
            lower=np.array([n.lower for n in numbers]),
            upper=np.array([n.upper for n in numbers]),
            expected=np.array([n.expected for n in numbers]),
            precision=np.array([0.0 if math.isinf(n.spread) else n.spread**-2.0 for n in numbers]),
        )

    def cost(self, x: np.ndarray, data: np.ndarray, limits: np.ndarray) -> float:
        total = float(data @ data + limits @ limits + self.precision @ (x - self.expected) ** 2)
        return total if math.isfinite(total) else math.inf


class _Step(NamedTuple):
    x: np.ndarray
    cost: float
    damping: float  #: for the next step


def _step(objective: _Objective, x: np.ndarray, cost: float, here: Linear, damping: float) -> _Step | None:
    """The next place with a smaller sum of squares; None if there is none."""
    precision = objective.precision
    gradient = (
        here.slope.T @ here.data + here.limits_slope.T @ here.limits + precision * (x - objective.expected)
    )
    curvature = here.slope.T @ here.slope + here.limits_slope.T @ here.limits_slope + np.diag(precision)
    at_bound = ((x <= objective.lower) & (gradient > 0.0)) | ((x >= objective.upper) & (gradient < 0.0))
    free = ~at_bound
    if not free.any():
        return None
    scale = np.maximum(np.diag(curvature), 1e-12 * np.max(np.diag(curvature), initial=1e-300))
    H, g, d = curvature[np.ix_(free, free)], gradient[free], scale[free]
    while damping < 1e12:
        move = _move(objective, x, here, _Quadratic(H, g, damping * d), free)
        if move is None:
            damping = max(10.0 * damping, 1e-8)
            continue
        trial = np.clip(x + move, objective.lower, objective.upper)
        new = objective.cost(trial, *objective.problem.residual(trial))
        if new < cost:
            taken = trial - x
            promised = -(2.0 * gradient @ taken + taken @ curvature @ taken)
            kept = (cost - new) / max(promised, 1e-300)
            return _Step(trial, new, _next_damping(damping, kept))
        if np.all(np.abs(trial - x) <= 1e-12 * (1.0 + np.abs(x))):
            return None
        damping *= 6.0
    return None


class _Quadratic(NamedTuple):
    """A quadratic form of the free numbers (f,), with damping."""

    curvature: np.ndarray  #: (f, f)
    gradient: np.ndarray  #: (f,)
    damping: np.ndarray  #: (f,)

    @property
    def minimum(self) -> np.ndarray | None:
        """Where it is smallest (f,); None if the form is not positive."""
        try:
            factor = cho_factor(self.curvature + np.diag(self.damping), check_finite=False)
        except np.linalg.LinAlgError:
            return None
        lowest: np.ndarray = -cho_solve(factor, self.gradient, check_finite=False)
        return lowest


def _move(
    objective: _Objective, x: np.ndarray, here: Linear, form: _Quadratic, free: np.ndarray
) -> np.ndarray | None:
    """The step (k,) to the minimum of the form; None if there is none.

    Where kept limits are given, the step also respects those that it would break, and the bounds that it would cross.
    """
    move = np.zeros(len(x))
    found = form.minimum
    if found is None:
        return None
    move[free] = found
    if here.kept is None:
        return move
    crossed = np.zeros(len(x), dtype=bool)
    broken = np.zeros(len(here.kept.value), dtype=bool)
    for _ in range(int(constants.LOOKS_AT_LIMITS)):
        beyond = free & ((x + move < objective.lower) | (x + move > objective.upper)) & ~crossed
        breaks = (here.kept.value + here.kept.slope @ move > 0.0) & ~broken
        if not beyond.any() and not breaks.any():
            break
        crossed |= beyond
        broken |= breaks
        move[beyond] = np.clip(x + move, objective.lower, objective.upper)[beyond] - x[beyond]
        inner = free & ~crossed
        own, outer = inner[free], crossed[free]
        slope = here.kept.slope[broken]
        curvature = form.curvature + slope[:, free].T @ slope[:, free]
        gradient = form.gradient + slope[:, free].T @ here.kept.value[broken]
        reduced = _Quadratic(
            curvature[np.ix_(own, own)],
            gradient[own] + curvature[np.ix_(own, outer)] @ move[crossed],
            form.damping[own],
        )
        found = reduced.minimum
        if found is None:
            return None
        move[inner] = found
    return move


def _next_damping(damping: float, kept: float) -> float:
    """The damping after a step that kept this share of the decrease that the quadratic form promised."""
    if kept > 0.75:
        return damping / 5.0
    return damping if kept > 0.25 else 3.0 * damping


def _held_by_limits(names: Sequence[str], here: Linear) -> frozenset[str]:
    """Numbers whose stiffness comes to a good part from broken limits."""
    active = here.limits_slope[here.limits > 0.0]
    by_limits, by_data = np.sum(active**2, axis=0), np.sum(here.slope**2, axis=0)
    share = constants.HELD_BY_LIMIT_SHARE
    return frozenset(
        n for n, a, b in zip(names, by_limits, by_data, strict=True) if a > share * (a + b) and a > 0.0
    )
