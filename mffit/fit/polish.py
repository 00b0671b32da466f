"""The joint polish: all free coefficients and rig errors together, fitted to all points; and fits that are as good as it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.other_ends import other_ends
from mffit.fit.plan import FitPlan
from mffit.fit.posterior import joint, strongest_correlations
from mffit.fit.problem import FitProblem
from mffit.fit.profile import follow
from mffit.least_squares import FreeNumber, Solution, minimum, solve
from mffit.rig_errors import error_of

Intervals = Mapping[str, tuple[float, float]]


def polish(stated: FitProblem, plan: FitPlan) -> Fitted:
    """The joint fit with its errors, those of the quadratic form around it.

    Weights are balanced between the channels and reduced for outliers. ``stated`` is near the solution, with weights as stated;
    readings that state no uncertainty get that of their misfit.
    """
    problem, scale = _approached(stated, plan).with_noise_of_misfit().reweighted()
    problem, solution = _solved(problem, plan.numbers(problem))
    return _fitted(problem, solution, plan.numbers(problem), plan, scale)


def with_equally_good(fitted: Fitted) -> Fitted:
    """The fit with errors that cover what is as good: a bent valley is followed, and other ends are searched.

    It is the better one where the valley or another end holds a better fit.
    """
    problem, numbers = fitted.problem, fitted.problem.starting_here(fitted.numbers)
    solution = solve(problem.free([n.name for n in numbers]), numbers, max_steps=0)
    decided = _within_their_priors(_errors(solution), numbers)
    valley = follow(problem, numbers, solution, decided)
    if valley is not None and valley.better:
        problem, solution = _solved(problem.with_values(valley.better), numbers)
    ends = other_ends(problem, problem.starting_here(numbers), solution)
    if ends.better:
        problem, solution = _solved(problem.with_values(ends.better), numbers)
    if problem is not fitted.problem:
        moved = _fitted(problem, solution, numbers, fitted, fitted.scale)
        fitted = replace(moved, stages=fitted.stages, attempts=fitted.attempts)
    intervals = _wider_of(valley.intervals if valley is not None else {}, ends.intervals)
    stderr = {name: max(u, _half_width(intervals.get(name))) for name, u in fitted.stderr.items()}
    return replace(
        fitted,
        intervals=intervals,
        stderr=stderr,
        rig={name: (v, stderr[name]) for name, (v, _) in fitted.rig.items()},
        regularised=fitted.regularised
        | (_with_prior(numbers).keys() - _within_their_priors(stderr, numbers)),
    )


def _fitted(
    problem: FitProblem,
    solution: Solution,
    numbers: Sequence[FreeNumber],
    given: FitPlan | Fitted,
    scale: Mapping[str, float],
) -> Fitted:
    """The record of a solution, at which ``problem`` is; ``given`` says what was held."""
    posterior = joint(problem, solution, {**given.held, **given.held_rig}).without(given.held_rig)
    stderr = posterior.stderr
    return Fitted(
        values={name: v for name, v in solution.values.items() if error_of(name) is None},
        rig={name: (v, stderr[name]) for name, v in solution.values.items() if error_of(name)},
        correlation=strongest_correlations(posterior, solution.names),
        posterior=posterior,
        stderr=stderr,
        intervals={},
        problem=problem,
        numbers=tuple(problem.starting_here(numbers)),
        held=given.held,
        held_rig=given.held_rig,
        at_bound=solution.at_bound | solution.at_limit,
        at_limit=solution.at_limit - solution.at_bound,
        regularised=frozenset(_with_prior(numbers)) - _within_their_priors(stderr, numbers),
        scale=scale,
        left=solution.left,
        cost=solution.cost,
        hand=given.hand,
    )


def _wider_of(one: Intervals, other: Intervals) -> dict[str, tuple[float, float]]:
    """The intervals that contain both."""
    return {**one, **other} | {
        name: (min(one[name][0], other[name][0]), max(one[name][1], other[name][1]))
        for name in one.keys() & other.keys()
    }


def _half_width(interval: tuple[float, float] | None) -> float:
    """The standard uncertainty that belongs to a 95 % interval; 0 without one."""
    return 0.0 if interval is None else (interval[1] - interval[0]) / (2.0 * COVERAGE_FACTOR_95)


def _approached(problem: FitProblem, plan: FitPlan) -> FitProblem:
    """The problem near its solution, by passes over more and more of its points."""
    for stride in _strides(len(problem.points)):
        thinned = problem.reweighted()[0].thinned(stride)
        last = stride <= constants.STRIDE_DIVISOR  # the fit to all points can then do the rest
        tolerance = constants.STAGE_TOLERANCE if last else constants.POLISH_TOLERANCE
        numbers = plan.numbers(thinned)
        near = minimum(thinned.free([n.name for n in numbers]), numbers, tolerance=tolerance)
        problem = problem.with_values(near.values)
    return problem


def _strides(n: int) -> Iterator[int]:
    """Strides that thin n points in successive passes before the final fit to all of them."""
    stride = max(1, n // constants.POINTS_OF_A_STAGE)
    yield stride
    while stride > constants.STRIDE_DIVISOR**2:
        stride //= constants.STRIDE_DIVISOR
        yield stride


def _solved(problem: FitProblem, numbers: Sequence[FreeNumber]) -> tuple[FitProblem, Solution]:
    numbers = problem.starting_here(numbers)
    solution = solve(problem.free([n.name for n in numbers]), numbers, tolerance=constants.POLISH_TOLERANCE)
    return problem.with_values(solution.values), solution


def _errors(solution: Solution) -> dict[str, float]:
    """Standard error of every free number; held ones count as exact."""
    return dict(zip(solution.names, np.sqrt(np.diag(solution.covariance)).tolist(), strict=True))


def _with_prior(numbers: Sequence[FreeNumber]) -> dict[str, float]:
    """Standard deviation of the prior of every coefficient that has one."""
    return {n.name: n.spread for n in numbers if error_of(n.name) is None and math.isfinite(n.spread)}


def _within_their_priors(errors: Mapping[str, float], numbers: Sequence[FreeNumber]) -> frozenset[str]:
    """Coefficients that the points determine better than their priors do."""
    share = constants.FITTED_SHARE_OF_PRIOR
    return frozenset(name for name, spread in _with_prior(numbers).items() if errors[name] < share * spread)
