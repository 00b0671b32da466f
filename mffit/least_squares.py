"""The one least-squares solver: numbers with start, bounds and prior, exact derivatives, no knowledge of any coefficient."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve

from mffit import constants
from tir.derivatives import gradient, plain, traced
from tir.frozen import ReadOnlyArrays

NEGLIGIBLE = 0.01
"""Changes of the sum of squares below this share of the stopping criterion are negligible: such steps are not tried."""

EXACT = 1e-9
"""Prior standard deviation of a number that is exactly known."""

POLISH_TOLERANCE = 1e-6
"""Predicted decrease of a step, relative to the sum of squares, at which a search ends."""

MOST_STEPS = 1000
"""Accepted steps after which a search is given up: along a valley of numbers that the data hardly separate, the sum of squares
falls for two hundred."""

SHORTENED = 0.3
"""Factor by which an undamped move becomes shorter after each rejection."""

HOLDS_ALL = 1e3
"""Growth of the damping within one step from which undamped moves are tried too: it then holds numbers that need none."""

UNDAMPED = 1e-9
"""Smallest damping: it only keeps the quadratic form positive definite against rounding."""


@dataclass(frozen=True, slots=True)
class FreeNumber:
    """One free number: starting value, bounds and prior."""

    name: str
    start: float
    lower: float = -math.inf
    upper: float = math.inf
    expected: float = 0.0  #: mean of the prior
    spread: float = math.inf  #: standard deviation of the prior; infinite without a prior


@dataclass(frozen=True, slots=True)
class Linear(ReadOnlyArrays):
    """Residuals and their derivatives at one set of values; those of the data may be :func:`condensed`."""

    data: np.ndarray  #: (m,) residuals of the data in units of their uncertainty
    slope: np.ndarray  #: (m, k) derivatives of ``data``
    limits: np.ndarray
    """(l,) residuals of physical limits: positive where a limit is violated, without cost otherwise."""
    limits_slope: np.ndarray  #: (l, k) derivatives of ``limits``


def broken(limits: np.ndarray) -> np.ndarray:
    """Residuals (l,) of physical limits that enter the cost: as given where violated, else 0."""
    return np.asarray(np.maximum(limits, 0.0))


def condensed(blocks: Iterable[tuple[np.ndarray, np.ndarray]]) -> tuple[np.ndarray, np.ndarray]:
    """Residuals (m,) and derivatives (m, k) of consecutive blocks of data.

    If there are very many rows, k + 1 rows with the same sums of squares and products replace them, which suffices for solver and
    covariance and limits the memory to a few blocks.
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
    """Sums of products (k + 1, k + 1) of the derivatives and the residuals of a block."""
    across = slope.T @ data
    return np.block([[slope.T @ slope, across[:, None]], [across, data @ data]])


@dataclass(frozen=True, slots=True)
class LeastSquaresProblem:
    """Residuals as functions of the numbers (k,)."""

    residual: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
    """Residuals of data (m,) and limits (l,), as in :class:`Linear`."""
    linear: Callable[[np.ndarray], Linear]  #: residuals with derivatives


def of_numbers(names: Sequence[str], at: Callable[[Mapping[str, Any]], Linear]) -> LeastSquaresProblem:
    """The least-squares problem of named numbers; ``at`` takes them plain or, for the derivatives, traced."""

    def named(x: np.ndarray) -> dict[str, float]:
        return dict(zip(names, x.tolist(), strict=True))

    def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        here = at(named(x))
        return here.data, here.limits

    return LeastSquaresProblem(residual, lambda x: at(traced(named(x))))


def of_model(
    model: Callable[[Mapping[str, Any]], Any],
    names: Sequence[str],
    measured: np.ndarray,
    u: Any,
    limits: Callable[[Mapping[str, Any]], tuple[np.ndarray, np.ndarray]] | None = None,
) -> LeastSquaresProblem:
    """The least-squares problem of a model (m,) of named numbers, plain or traced, for measured values (m,).

    ``u`` is the standard uncertainty of the measured values, scalar or (m,). ``limits`` returns residuals (l,) of limits and
    their derivatives (l, k) if the numbers are traced.
    """

    def at(numbers: Mapping[str, Any]) -> Linear:
        found = model(numbers)
        slope = np.broadcast_to(gradient(found, list(numbers.values())), (len(measured), len(names)))
        data = (np.broadcast_to(plain(found), len(measured)) - measured) / u
        held = (np.zeros(0), np.zeros((0, len(names)))) if limits is None else limits(numbers)
        return Linear(data, (slope.T / u).T, *held)

    return of_numbers(names, at)


@dataclass(frozen=True, eq=False)
class Solution(ReadOnlyArrays):
    """The end of a search; its derivatives are computed on first use."""

    objective: Objective
    x: np.ndarray  #: (k,)
    cost: float  #: sum of squares of data, priors and limits
    steps: int
    known: Linear | None  #: residuals and derivatives at ``x``, if the search computed them

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the free numbers."""
        return tuple(number.name for number in self.objective.numbers)

    @property
    def values(self) -> dict[str, float]:
        """The numbers by name."""
        return dict(zip(self.names, self.x.tolist(), strict=True))

    @cached_property
    def here(self) -> Linear:
        """Residuals and derivatives at the solution."""
        return self.objective.problem.linear(self.x) if self.known is None else self.known

    @property
    def data(self) -> np.ndarray:
        """Residuals (m,) of the data, as in :class:`Linear`."""
        return self.here.data

    @property
    def jacobian(self) -> np.ndarray:
        """Derivatives (m, k) of the data."""
        return self.here.slope

    @property
    def prior(self) -> np.ndarray:
        """Precision (k,) of the priors, 1 / spread^2."""
        return self.objective.precision

    @property
    def covariance(self) -> np.ndarray:
        """Covariance (k, k) from data and priors; limits carry no information and do not enter."""
        return inverse(self.jacobian.T @ self.jacobian + np.diag(self.prior))

    @property
    def at_bound(self) -> frozenset[str]:
        """Numbers at one of their own bounds."""
        ends = zip(self.objective.numbers, self.x, strict=True)
        return frozenset(n.name for n, value in ends if touches(value, n.lower, n.upper))

    @property
    def at_limit(self) -> frozenset[str]:
        """Numbers for which violated limits contribute a large share of the curvature of the sum of squares."""
        active = self.here.limits_slope[self.here.limits > 0.0]
        by_limits, by_data = np.sum(active**2, axis=0), np.sum(self.jacobian**2, axis=0)
        share = constants.HELD_BY_LIMIT_SHARE
        rows = zip(self.names, by_limits, by_data, strict=True)
        return frozenset(name for name, a, b in rows if a > share * (a + b) and a > 0.0)

    @property
    def left(self) -> float:
        """Predicted decrease of ``cost`` by an undamped step: 0 at a minimum."""
        return Quadratic.around(self.objective, self.x, self.here).left


def solve(
    problem: LeastSquaresProblem,
    numbers: Sequence[FreeNumber],
    *,
    max_steps: int = MOST_STEPS,
    tolerance: float = POLISH_TOLERANCE,
) -> Solution:
    """The minimum of the sum of squares of data, priors and limits within the bounds, by Levenberg-Marquardt.

    If residuals are large, their second derivatives matter. These are estimated from the gradients of successive steps, and
    every step is tried with and without them (Dennis, Gay and Welsch 1981). The search ends after ``max_steps`` accepted steps,
    or if an undamped step would reduce the sum of squares by less than the share ``tolerance`` (Bates and Watts 1981); a damped
    step is not a criterion, because its decrease is small whenever the damping is large.
    """
    objective = Objective.of(problem, numbers)
    x = np.clip([n.start for n in numbers], objective.lower, objective.upper)
    at = problem.linear(x)
    here: Linear | None = at
    cost = objective.cost(x, at.data, at.limits)
    damping, taken, close = 1e-3, 0, False
    form, bend = Quadratic.around(objective, x, at), np.zeros((len(x), len(x)))
    while taken < max_steps and len(x) and not close:
        close = form.left < tolerance * cost
        forms = [form, form.bent(bend)] if bend.any() and not close else [form]
        step = _step(objective, x, cost, forms, UNDAMPED if close else damping, NEGLIGIBLE * tolerance * cost)
        if step is None:
            break
        taken += 1
        move, x, cost, damping, here = step.x - x, step.x, step.cost, step.damping, step.here
        if not close and taken < max_steps:
            here = at = problem.linear(x)
            before, form = form, Quadratic.around(objective, x, at)
            bend = _bend(bend, move, before, form)
    return Solution(objective, x, cost, taken, here)


def touches(value: float, lower: float, upper: float) -> bool:
    """Whether a value lies at one of its bounds; never where a bound is infinite."""
    width = upper - lower
    return math.isfinite(width) and min(value - lower, upper - value) < constants.AT_BOUND_SHARE * width


def inverse(information: np.ndarray) -> np.ndarray:
    """Inverse of an information matrix (k, k); undetermined directions get a very large variance."""
    scale = np.sqrt(np.maximum(np.diag(information), 1e-24))
    size, axes = np.linalg.eigh(information / np.outer(scale, scale))
    floor = 1e-14 * max(size.max(initial=0.0), 1e-300)
    return np.asarray((axes / np.maximum(size, floor)) @ axes.T / np.outer(scale, scale))


def root(covariance: np.ndarray) -> np.ndarray:
    """A matrix R (k, k) with R @ R.T = covariance, accurate even if variances differ by orders of magnitude."""
    scale = np.sqrt(np.maximum(np.diag(covariance), 1e-300))
    size, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * axes * np.sqrt(np.maximum(size, 0.0)))


class Objective(NamedTuple):
    """The sum of squares of data, priors and limits, and the bounds."""

    problem: LeastSquaresProblem
    numbers: tuple[FreeNumber, ...]
    lower: np.ndarray
    upper: np.ndarray
    expected: np.ndarray
    precision: np.ndarray

    @classmethod
    def of(cls, problem: LeastSquaresProblem, numbers: Sequence[FreeNumber]) -> Objective:
        return cls(
            problem=problem,
            numbers=tuple(numbers),
            lower=np.array([n.lower for n in numbers]),
            upper=np.array([n.upper for n in numbers]),
            expected=np.array([n.expected for n in numbers]),
            precision=np.array([0.0 if math.isinf(n.spread) else n.spread**-2.0 for n in numbers]),
        )

    def cost(self, x: np.ndarray, data: np.ndarray, limits: np.ndarray) -> float:
        over = broken(limits)
        total = float(data @ data + over @ over + self.precision @ (x - self.expected) ** 2)
        return total if math.isfinite(total) else math.inf


class _Step(NamedTuple):
    x: np.ndarray
    cost: float
    damping: float  #: for the next step
    here: Linear | None = None  #: residuals and derivatives at ``x``, of the last step


def _step(
    objective: Objective,
    x: np.ndarray,
    cost: float,
    forms: Sequence[Quadratic],
    damping: float,
    least: float,
) -> _Step | None:
    """The best of the steps of all quadratic forms if it reduces the sum of squares, else None.

    After each rejection damping grows; where it has grown far, undamped moves, ever shorter, are tried, too. Damping alone gives
    up where the derivative by one number vanishes, as at the zero of a coefficient that enters as an even function: it must grow
    until it holds this number, and by then it holds all others.

    A step with a predicted decrease of ``least`` or less is not tried: at a kink, as between a wheel's play and its stops, such
    steps alternate, and rounding would decide on which side they end. An undamped step is the last one, near the minimum. Its
    decrease may be smaller than rounding, so it is accepted unless the sum rises by more than ``least``.
    """
    last, first, share = damping == UNDAMPED, damping, 1.0
    undamped: list[np.ndarray | None] = []

    def tried(form: Quadratic, move: np.ndarray | None, damping: float) -> _Step | None:
        if move is None:
            return _Step(x, math.inf, damping)
        promised = form.gain(move)
        if promised <= least and not last:
            return None
        trial = np.clip(x + move, objective.lower, objective.upper)
        # The derivatives at the solution are asked for.
        here = objective.problem.linear(trial) if last else None
        data, limits = objective.problem.residual(trial) if here is None else (here.data, here.limits)
        new = objective.cost(trial, data, limits)
        return _Step(trial, new, next_damping(damping, cost - new, promised), here)

    while damping < 1e12:
        found = [tried(form, form.move(damping), damping) for form in forms]
        if damping > HOLDS_ALL * first:
            undamped = undamped or [form.move(UNDAMPED) for form in forms]
            share *= SHORTENED
            for form, move in zip(forms, undamped, strict=True):
                found.append(None if move is None else tried(form, share * move, first))
        best = min(filter(None, found), key=lambda step: step.cost, default=None)
        if best is None:
            return None
        if best.cost < cost or (last and best.cost <= cost + least):
            return best
        if last:
            return None
        damping = max(6.0 * damping, 1e-8)
    return None


class Quadratic(NamedTuple):
    """Local model of the sum of squares from linearised residuals: quadratic in data and priors, limits kept individually."""

    gradient: np.ndarray  #: (k,) half the gradient of the sum of squares of data and priors
    curvature: np.ndarray  #: (k, k) half the Hessian of the sum of squares of data and priors
    limits: np.ndarray  #: (l,) residuals of limits, positive where violated
    limits_slope: np.ndarray  #: (l, k)
    low: np.ndarray  #: (k,) moves to the lower bounds
    high: np.ndarray  #: (k,) moves to the upper bounds

    @classmethod
    def around(cls, objective: Objective, x: np.ndarray, here: Linear) -> Quadratic:
        return cls(
            gradient=here.slope.T @ here.data + objective.precision * (x - objective.expected),
            curvature=here.slope.T @ here.slope + np.diag(objective.precision),
            limits=here.limits,
            limits_slope=here.limits_slope,
            low=objective.lower - x,
            high=objective.upper - x,
        )

    def bent(self, bend: np.ndarray) -> Quadratic:
        """The form with additional curvature (k, k), which need not be positive definite."""
        return self._replace(curvature=self.curvature + bend)

    def gain(self, move: np.ndarray) -> float:
        """Predicted decrease of the sum of squares by a move (k,)."""
        before, after = broken(self.limits), broken(self.limits + self.limits_slope @ move)
        return float(before @ before - after @ after - (2.0 * self.gradient + self.curvature @ move) @ move)

    @property
    def left(self) -> float:
        """Predicted decrease of the sum of squares by the undamped move to the minimum of the form."""
        move = self.move(UNDAMPED)
        return math.inf if move is None else self.gain(move)

    def move(self, damping: float) -> np.ndarray | None:
        """The move (k,) to the minimum of the damped form within the bounds; None if the form is not positive definite.

        An active-set method: each Newton step includes the limits violated at its start, and a line search ends it at the minimum
        along its direction or at a bound. A number stays at a bound as long as the gradient pushes it outwards. Since the move
        already accounts for bounds and limits, they rarely cause its rejection.
        """
        over = self.limits > 0.0
        size = np.diag(self.curvature) + np.sum(self.limits_slope[over] ** 2, axis=0)
        damped = self.curvature + np.diag(damping * np.maximum(size, 1e-12 * np.max(size, initial=1e-300)))
        move, limits, largest = np.zeros(len(size)), self.limits, 0.0
        held: np.ndarray | None = None
        for _ in range(int(constants.LOOKS_AT_LIMITS)):
            over = limits > 0.0
            by_limits = self.limits_slope[over]
            slope = self.gradient + damped @ move + by_limits.T @ limits[over]
            low, high = move <= self.low, move >= self.high
            if held is None:
                held = low & (slope > 0.0) | high & (slope < 0.0)
            free = ~held
            curvature = damped + by_limits.T @ by_limits
            way = np.zeros(len(move))
            try:
                factor = cho_factor(curvature[np.ix_(free, free)], check_finite=False)
            except np.linalg.LinAlgError:
                return None
            way[free] = -cho_solve(factor, slope[free], check_finite=False)
            fall = -float(slope @ way)
            largest = max(largest, fall)
            if fall <= 1e-12 * largest:
                inwards = held & ~(low & (slope >= 0.0) | high & (slope <= 0.0))
                if not inwards.any():
                    break
                held[np.argmax(np.where(inwards, slope**2 / np.diag(curvature), 0.0))] = False
                continue
            with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
                room = np.where(
                    way == 0.0, math.inf, np.where(way > 0.0, self.high - move, self.low - move) / way
                )
            nearest = int(np.argmin(room))
            share = _lowest(float(slope @ way), float(way @ damped @ way), limits, self.limits_slope @ way)
            reached = share >= room[nearest]
            move = np.clip(move + min(share, room[nearest]) * way, self.low, self.high)
            if reached:
                held[nearest] = True
                move[nearest] = (self.high if way[nearest] > 0.0 else self.low)[nearest]
            limits = self.limits + self.limits_slope @ move
        return move


@np.errstate(over="ignore", invalid="ignore")  # from a coefficient held at an absurd value, no step is finite
def _lowest(slope: float, curvature: float, limits: np.ndarray, rise: np.ndarray) -> float:
    """The step length, from 0, at which half the sum of squares is minimal along a direction.

    ``slope`` is its first derivative at 0 and ``curvature`` its second derivative without limits; ``rise`` (l,) are the
    derivatives of the residuals ``limits`` (l,).
    """
    over = limits > 0.0
    turns = np.where(over, rise < 0.0, rise > 0.0)  # limits that change between kept and violated on the way
    place = -limits[turns] / rise[turns]
    order = np.argsort(place)
    place, sign = place[order], np.where(over[turns], -1.0, 1.0)[order]
    bend = np.cumsum(np.append(curvature + rise[over] @ rise[over], sign * rise[turns][order] ** 2))
    bend = np.maximum(bend, curvature)  # rounding of steep limits could make it smaller
    # The derivative at 0 and at each change:
    at = slope + np.cumsum(np.append(0.0, bend[:-1] * np.diff(place, prepend=0.0)))
    k = int(np.searchsorted(at, 0.0)) - 1
    return float((place[k - 1] if k > 0 else 0.0) - at[k] / bend[k])


def _bend(bend: np.ndarray, move: np.ndarray, before: Quadratic, after: Quadratic) -> np.ndarray:
    """Updated estimate (k, k) of the second-derivative part of the curvature, from the gradients at both ends of a move (k,).

    The symmetric rank-one update, skipped where rounding would dominate it (Nocedal and Wright 2006, section 6.2).
    """
    lacking = after.gradient - before.gradient - (after.curvature + bend) @ move
    size = np.diag(after.curvature)
    size = np.sqrt(np.maximum(size, 1e-12 * np.max(size)))
    along = float(lacking @ move)
    rounding = math.sqrt(np.finfo(float).eps) * np.linalg.norm(lacking / size) * np.linalg.norm(size * move)
    return bend if abs(along) <= rounding else bend + np.outer(lacking, lacking) / along


def next_damping(damping: float, fall: float, promised: float) -> float:
    """The damping after a step, from its actual and its predicted decrease of the sum of squares."""
    if fall > 0.75 * promised:
        return damping / 5.0
    return damping if fall > 0.25 * promised else 3.0 * damping
