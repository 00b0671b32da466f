"""The joint fit: all free coefficients and rig errors together, fitted to all points."""

import math
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import MOST
from mffit.errors import InputError
from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.plan import FitPlan
from mffit.fit.problem import FitProblem
from mffit.fit.same_curve import with_expected_signs
from mffit.fit.stages import OF_CAMBER_OR_SPIN
from mffit.fit.start import SHAPES_OF_FX, SHAPES_OF_MZ
from mffit.fit.told import told_by_weights
from mffit.least_squares import POLISH_TOLERANCE, FreeNumber, Solution, solve
from mffit.linearised import LinearisedFit
from mffit.points import Points
from mffit.quantities import CHANNELS, column
from mffit.rig_errors import error_of
from tir.parameters import BY_NAME


def first_fit(problem: FitProblem, start: Mapping[str, float], plan: FitPlan) -> Fitted:
    """The joint fit, started from two passes over thinned points.

    The first pass frees only coefficients of the upright wheel on a straight path, the second all of them. With every number
    free at once, a search can end with a curvature factor at its limit. Both passes use the weights at the starting values:
    those from the first pass would be small wherever camber and spin act.
    """
    _require_enough_points(problem.points, plan.free)
    problem = problem.with_values({name: start[name] for name in (*plan.free, *plan.extra)})
    part = problem.reweighted().thinned(next(_strides(len(problem.points))))
    shapes = ({}, *(SHAPES_OF_FX if "PCX1" in plan.free else ()))
    begins = [_begun(part, plan, shape) for shape in shapes]
    ends = [_end(one, [n for n in plan.numbers(one) if n.name not in OF_CAMBER_OR_SPIN]) for one in begins]
    best = part.with_values(min(ends, key=lambda end: end.cost).values)
    near = _end(best, plan.numbers(best))
    return _lowest(polish(_approached(problem.with_values(near.values), plan), plan), problem, plan)


def _lowest(found: Fitted, stated: FitProblem, plan: FitPlan) -> Fitted:
    """The fit of the lowest minimum of Mz; ``found`` itself if it has it.

    Its coefficients are searched with all other numbers, and the weights, as found: with the weights at the starting values the
    minima differ little.
    """
    here = replace(found.problem.thinned(next(_strides(len(found.problem.points)))), radii=())
    alone = replace(here, sigma={name: u for name, u in here.sigma.items() if name == "Mz"})
    names = [name for name in plan.free if BY_NAME[name].channel == "Mz"]
    if not names:
        return found
    begins = (_begun(alone, plan, shape) for shape in ({}, *SHAPES_OF_MZ))
    first, *others = (_end(one, plan.coefficients(names, one)) for one in begins)
    best = min(others, key=lambda end: end.cost)
    if best.cost > (1.0 - constants.STAGE_TOLERANCE) * first.cost:
        return found
    values = {n.name: found.problem.value(n.name) for n in found.numbers}
    return polish(stated.with_values({**values, **best.values}), plan)


def _begun(problem: FitProblem, plan: FitPlan, shape: Mapping[str, float]) -> FitProblem:
    """The problem with another ``shape`` of a curve to start from, as far as its coefficients are free."""
    return problem.with_values({n: plan.hand.inside(n, x) for n, x in shape.items() if n in plan.free})


def _end(problem: FitProblem, numbers: Sequence[FreeNumber]) -> Solution:
    """The end of a rough search."""
    return solve(problem.free([n.name for n in numbers]), numbers, tolerance=constants.STAGE_TOLERANCE)


def polish(stated: FitProblem, plan: FitPlan) -> Fitted:
    """The joint fit, with uncertainties from the quadratic form around the solution.

    Weights are balanced between the channels and reduced far from the model. ``stated`` is near the solution and has the stated
    weights; readings without a stated uncertainty are assigned the scatter of their misfit.
    """
    expected = {name: x for name, x in plan.expected.items() if name not in plan.hand.names}
    near = stated.with_values(with_expected_signs(stated.simulation.values, expected))
    problem = near.with_noise_of_misfit().reweighted()
    return _fitted(problem, plan.numbers(problem), plan)


def with_known_zeros(
    fitted: Fitted, stated: FitProblem, plan: FitPlan, left: LinearisedFit
) -> tuple[Fitted, FitPlan]:
    """The fit with zeros of a flat track held at their estimates, and its plan; ``left`` is the model of the residuals.

    One set-up cannot separate a zero from an asymmetry that the formula misses: a free zero absorbs the asymmetry, tens of
    standard uncertainties away from the readings at zero slip. The zeros are therefore estimated together with the model error.
    Those that the readings tell beside it, and the fit agrees, stay free. If no model error is likely, fit and plan are returned
    unchanged.
    """
    if left.is_exact:
        return fitted, plan
    spread = {n.name: n.spread for n in plan.rig}
    found = {n: (off, u) for n, (off, u) in left.zeros.items() if u >= MOST * spread[n] or abs(off) > u}
    u = {name: own for name, (_, own) in found.items()}
    plan = replace(
        plan, rig=tuple(n for n in plan.rig if n.name not in found), held_rig={**plan.held_rig, **u}
    )
    here = replace(stated, simulation=fitted.simulation)
    values = {name: fitted.problem.value(name) + change for name, (change, _) in found.items()}
    return polish(here.with_values(values), plan), plan


def refitted(fitted: Fitted, stated: FitProblem, tolerance: float = POLISH_TOLERANCE) -> Fitted:
    """The same numbers fitted to other points, starting at the values of ``fitted``; ``tolerance`` as of :func:`solve`.

    Weights are computed twice, because the first solution may be far from those values.
    """
    here = stated.with_values({n.name: fitted.problem.value(n.name) for n in fitted.numbers})
    weighted = here.with_noise_of_misfit().reweighted()
    numbers = weighted.starting_here(fitted.numbers)
    near = _end(weighted, numbers)
    here = here.with_values(near.values).with_noise_of_misfit().reweighted()
    return _fitted(here, numbers, fitted, tolerance)


def _fitted(
    problem: FitProblem,
    numbers: Sequence[FreeNumber],
    given: FitPlan | Fitted,
    tolerance: float = POLISH_TOLERANCE,
) -> Fitted:
    """The fit of some numbers, started at the values of ``problem``; ``given`` names the held numbers."""
    numbers = problem.starting_here(numbers)
    solution = solve(problem.free([n.name for n in numbers]), numbers, tolerance=tolerance)
    problem = problem.with_values(solution.values)
    posterior = told_by_weights(problem, numbers, {**given.held, **given.held_rig})
    known = {name: problem.value(name) for name in given.held_rig}
    absent = [name for name, value in known.items() if (e := error_of(name)) and value == e.undisturbed]
    stderr, share = posterior.stderr, MOST
    return Fitted(
        values={name: v for name, v in solution.values.items() if error_of(name) is None},
        rig={
            name: (value, stderr[name])
            for name, value in {**solution.values, **known}.items()
            if error_of(name) and name not in absent
        },
        correlation=posterior.strongest_correlations(solution.names, constants.STRONG_CORRELATION),
        posterior=posterior,
        problem=problem,
        numbers=tuple(problem.starting_here(numbers)),
        held=given.held,
        held_rig=given.held_rig,
        at_bound=solution.at_bound | solution.at_limit,
        at_limit=solution.at_limit - solution.at_bound,
        regularised=frozenset(
            n.name
            for n in numbers
            if math.isfinite(n.spread) and error_of(n.name) is None and stderr[n.name] >= share * n.spread
        ),
        left=solution.left,
        hand=given.hand,
    )


def _approached(problem: FitProblem, plan: FitPlan) -> FitProblem:
    """The problem near its solution, after passes over more and more of its points."""
    for stride in _strides(len(problem.points)):
        thinned = problem.reweighted().thinned(stride)
        last = stride <= constants.STRIDE_DIVISOR  # the fit to all points can then do the rest
        tolerance = constants.STAGE_TOLERANCE if last else POLISH_TOLERANCE
        numbers = plan.numbers(thinned)
        near = solve(thinned.free([n.name for n in numbers]), numbers, tolerance=tolerance)
        problem = problem.with_values(near.values)
    return problem


def _strides(n: int) -> Iterator[int]:
    """Strides that thin n points in successive passes before the final fit to all of them."""
    stride = max(1, n // constants.POINTS_OF_A_STAGE)
    yield stride
    while stride > constants.STRIDE_DIVISOR**2:
        stride //= constants.STRIDE_DIVISOR
        yield stride


def _require_enough_points(points: Points, free: Sequence[str]) -> None:
    needed = Counter(BY_NAME[name].channel or "Fy" for name in free)
    for channel in CHANNELS:
        available = int(np.sum(np.isfinite(points.channel(channel))))
        if needed[channel] and available <= needed[channel]:
            raise InputError(
                f"{available} points of {column(channel)} cannot determine the {needed[channel]} coefficients that these sweeps "
                "free: add points (more angles per sweep), or sweeps at fewer loads, cambers and pressures"
            )
