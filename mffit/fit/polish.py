"""The joint polish: all free coefficients and rig errors together, fitted to all points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.plan import FitPlan
from mffit.fit.posterior import joint, strongest_correlations
from mffit.fit.problem import FitProblem
from mffit.fit.profile import follow
from mffit.least_squares import Solution, solve
from mffit.rig_errors import error_of


def polish(stated: FitProblem, plan: FitPlan) -> Fitted:
    """The joint fit with its errors.

    Weights are balanced between the channels and reduced for outliers; a bent valley of equally good fits is followed.
    ``stated`` is near the solution, with weights as stated.
    """
    problem, scale = _approached(stated, plan).reweighted()
    problem, solution = _solved(problem, plan)
    decided = _decided_by_points(solution, plan)
    valley = follow(problem, plan.numbers(problem), solution, decided)
    if valley is not None and valley.better:
        problem, solution = _solved(problem.with_values(valley.better), plan)
        decided = _decided_by_points(solution, plan)
    posterior = joint(problem, solution, plan.held)
    stderr = posterior.stderr
    return Fitted(
        values={name: v for name, v in solution.values.items() if error_of(name) is None},
        rig={name: (v, stderr[name]) for name, v in solution.values.items() if error_of(name)},
        correlation=strongest_correlations(posterior, solution.names),
        posterior=posterior,
        intervals=valley.intervals if valley is not None else {},
        problem=problem,
        numbers=tuple(plan.numbers(problem)),
        held=plan.held,
        at_bound=solution.at_bound | solution.at_limit,
        regularised=frozenset(plan.free) - decided,
        scale=scale,
        cost=solution.cost,
        hand=plan.hand,
    )


def _approached(problem: FitProblem, plan: FitPlan) -> FitProblem:
    """The problem near its solution, by passes over more and more of its points."""
    for stride in _strides(len(problem.points)):
        thinned = problem.reweighted()[0].thinned(stride)
        last = stride <= constants.STRIDE_DIVISOR  # the fit to all points can then do the rest
        tolerance = constants.STAGE_TOLERANCE if last else constants.POLISH_TOLERANCE
        problem = problem.with_values(_solution(thinned, plan, tolerance).values)
    return problem


def _strides(n: int) -> Iterator[int]:
    """Strides that thin n points in successive passes before the final fit to all of them."""
    stride = max(1, n // constants.POINTS_OF_A_STAGE)
    yield stride
    while stride > constants.STRIDE_DIVISOR**2:
        stride //= constants.STRIDE_DIVISOR
        yield stride


def _solved(problem: FitProblem, plan: FitPlan) -> tuple[FitProblem, Solution]:
    solution = _solution(problem, plan, constants.POLISH_TOLERANCE)
    return problem.with_values(solution.values), solution


def _solution(problem: FitProblem, plan: FitPlan, tolerance: float) -> Solution:
    numbers = plan.numbers(problem)
    return solve(problem.free([n.name for n in numbers]), numbers, tolerance=tolerance)


def _decided_by_points(solution: Solution, plan: FitPlan) -> frozenset[str]:
    """Coefficients that the points determine better than their priors do."""
    errors = np.sqrt(np.diag(solution.covariance)).tolist()
    share, prior = constants.FITTED_SHARE_OF_PRIOR, plan.scatter
    return frozenset(
        name
        for name, u in zip(solution.names, errors, strict=True)
        if name in prior and u < share * prior[name]
    )
