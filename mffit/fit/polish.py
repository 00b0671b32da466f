"""The joint polish: all free coefficients and rig errors together, fitted to all points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.other_ends import other_ends
from mffit.fit.plan import FitPlan
from mffit.fit.posterior import joint, strongest_correlations
from mffit.fit.problem import FitProblem
from mffit.fit.profile import follow
from mffit.least_squares import Solution, minimum, solve
from mffit.rig_errors import error_of

Intervals = Mapping[str, tuple[float, float]]


def polish(stated: FitProblem, plan: FitPlan) -> Fitted:
    """The joint fit with its errors.

    Weights are balanced between the channels and reduced for outliers; a bent valley of equally good fits is followed,
    and other ends that are as good belong to the intervals.
    ``stated`` is near the solution, with weights as stated.
    """
    problem, scale = _approached(stated, plan).reweighted()
    problem, solution = _solved(problem, plan)
    decided = _within_their_priors(_errors(solution), plan)
    valley = follow(problem, plan.numbers(problem), solution, decided)
    if valley is not None and valley.better:
        problem, solution = _solved(problem.with_values(valley.better), plan)
    ends = other_ends(problem, plan.numbers(problem), solution)
    if ends.better:
        problem, solution = _solved(problem.with_values(ends.better), plan)
    posterior = joint(problem, solution, {**plan.held, **plan.held_rig}).without(plan.held_rig)
    intervals = _wider_of(valley.intervals if valley is not None else {}, ends.intervals)
    stderr = {name: max(u, _half_width(intervals.get(name))) for name, u in posterior.stderr.items()}
    return Fitted(
        values={name: v for name, v in solution.values.items() if error_of(name) is None},
        rig={name: (v, stderr[name]) for name, v in solution.values.items() if error_of(name)},
        correlation=strongest_correlations(posterior, solution.names),
        posterior=posterior,
        stderr=stderr,
        intervals=intervals,
        problem=problem,
        numbers=tuple(plan.numbers(problem)),
        held=plan.held,
        held_rig=plan.held_rig,
        at_bound=solution.at_bound | solution.at_limit,
        regularised=frozenset(name for name in solution.names if name in plan.scatter)
        - _within_their_priors(stderr, plan),
        scale=scale,
        cost=solution.cost,
        hand=plan.hand,
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


def _solved(problem: FitProblem, plan: FitPlan) -> tuple[FitProblem, Solution]:
    numbers = plan.numbers(problem)
    solution = solve(problem.free([n.name for n in numbers]), numbers, tolerance=constants.POLISH_TOLERANCE)
    return problem.with_values(solution.values), solution


def _errors(solution: Solution) -> dict[str, float]:
    """Standard error of every free number; held ones count as exact."""
    return dict(zip(solution.names, np.sqrt(np.diag(solution.covariance)).tolist(), strict=True))


def _within_their_priors(errors: Mapping[str, float], plan: FitPlan) -> frozenset[str]:
    """Coefficients that the points determine better than their priors do."""
    share, prior = constants.FITTED_SHARE_OF_PRIOR, plan.scatter
    return frozenset(name for name, u in errors.items() if name in prior and u < share * prior[name])
