"""The staged fit of one model to the raw points, and the joint polish of tyre and rig that ends it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from mffit.errors import InputError
from mffit.fit import weights
from mffit.fit.coverage import StageCoverage
from mffit.fit.posterior import Posterior, joint, strongest_correlations
from mffit.fit.problem import Problem
from mffit.fit.profile import follow
from mffit.fit.stages import STAGES, WITH_CAMBER, Stage, StageRecord
from mffit.least_squares import Number, Solution, solve
from mffit.points import Points, main_pressure
from mffit.progress import Progress, silent
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME as RIG_ERRORS
from mffit.scatter import rms
from tir.parameters import BY_NAME

ENOUGH_FOR_A_STAGE = 600
"""Points used in a stage before the polish; more would only cost time, as the polish uses all."""
MORE_BY = 8
"""Times as many points in each pass of a large fit; the last pass has all."""
DECIDED = 0.5
"""A coefficient counts as fitted, not as tied, if its standard error is below this share of what was known before."""
FALSE_MINIMUM = 1.3
"""Misfit in units of the stated noise from which on the fit starts again from other shapes."""
BETTER = 0.97
"""A restart replaces the fit before only if its sum of squares is this much smaller."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """Values and errors of the free numbers after the polish."""

    values: Mapping[str, float]  #: coefficients
    rig: Mapping[str, tuple[float, float]]  #: rig error -> (value, standard error)
    correlation: Mapping[str, tuple[str, float]]
    posterior: Posterior  #: of tyre and rig, held values included
    intervals: Mapping[
        str, tuple[float, float]
    ]  #: 95 % intervals of coefficients in a bent valley of equally good fits
    problem: Problem  #: at the solution, with the weights used in the end
    numbers: tuple[Number, ...]  #: that were free in the end
    held: Mapping[str, float]  #: spread of what the fit took as it was
    at_bound: frozenset[str]
    regularised: frozenset[
        str
    ]  #: coefficients to which what was known before contributes as much as the data
    stages: tuple[StageRecord, ...]
    scale: tuple[float, float]  #: robust misfit over stated uncertainty, Fy and Mz
    cost: float
    attempts: tuple[str, ...] = ()  #: other shapes from which the fit was started again

    @property
    def simulation(self) -> Simulation:
        """Fitted, rig errors included."""
        return self.problem.simulation


@dataclass(frozen=True, slots=True)
class Plan:
    """What a fit frees and what is known of it beforehand."""

    cover: tuple[StageCoverage, ...]
    expected: Mapping[str, float]  #: centre of every coefficient's prior
    scatter: Mapping[str, float]  #: how far this tyre's value may be from it, 1 sigma
    rig: tuple[Number, ...] = ()  #: rig errors, freed in the polish
    extra: tuple[str, ...] = ()  #: coefficients freed in the polish only
    held: Mapping[str, float] = field(
        default_factory=dict
    )  #: standard uncertainty of measured values that stay
    noise_stated: bool = True  #: whether the points say how uncertain they are

    @property
    def free(self) -> list[str]:
        return [name for row in self.cover for name in row.free]


SHAPES: Mapping[str, Mapping[str, float]] = {
    "a round side-force curve": {"PCY1": 1.2, "PEY1": 0.3, "PEY2": 0.0},
    "a peaked side-force curve": {"PCY1": 1.7, "PEY1": -1.5, "PEY2": 0.0},
    "a short trail": {"QBZ1": 15.0, "QCZ1": 1.2, "QEZ1": -0.5, "QEZ2": 0.0},
    "a long trail": {"QBZ1": 5.0, "QCZ1": 1.1, "QEZ1": -3.0, "QEZ2": 0.0},
}
"""Other places to start from where the first fit ends too far away."""


def fit_staged(
    problem: Problem,
    start: Mapping[str, float],
    plan: Plan,
    progress: Progress,
    *,
    restarts: bool = True,
    first: Callable[[Fitted], object] = lambda fitted: None,
) -> Fitted:
    """Fit stage by stage, then tyre and rig together; again from other shapes where that ends far from the noise.

    Parameters
    ----------
    problem : points, weights (as stated) and fixed values
    start : starting value of every coefficient
    plan : what is free
    progress : called with a sentence before each step
    restarts : whether to start again where the fit ends far from the noise
    first : called with a fit that ends there, before it is started again; may refuse the data
    """
    _enough_points(problem.points, plan.free)
    best = _fit_from(problem, start, plan, progress)
    far = plan.noise_stated and max(best.scale) > FALSE_MINIMUM
    if not restarts or (not far and not best.at_bound & BY_SHAPE):
        return best
    first(best)
    tried = []
    for shape, values in SHAPES.items():
        progress(f"starting again from {shape}")
        tried.append(shape)
        other = _fit_from(problem, {**start, **values}, plan, silent)
        if other.cost < BETTER * best.cost:
            best = other
    return dataclasses.replace(best, attempts=tuple(tried))


BY_SHAPE = frozenset(name for values in SHAPES.values() for name in values)


def _fit_from(problem: Problem, start: Mapping[str, float], plan: Plan, progress: Progress) -> Fitted:
    values = {name: start[name] for name in plan.free}
    problem = problem.with_values({**values, **{name: start[name] for name in plan.extra}})
    records = []
    for stage, row in zip(STAGES, plan.cover, strict=True):
        if not row.free:
            continue
        progress(f"fitting {stage.title.lower()}")
        reopened = [name for other in plan.cover if other.stage in stage.reopened for name in other.free]
        problem = problem.with_values(_fit_stage(problem, stage, [*reopened, *row.free], plan))
        records.append(_record(problem, stage.name, stage.title, row.free))
    progress("joint polish")
    fitted = _polish(problem, plan)
    records.append(
        _record(fitted.problem, "polish", "Joint polish of tyre and rig", [n.name for n in fitted.numbers])
    )
    return dataclasses.replace(fitted, stages=tuple(records))


def _fit_stage(problem: Problem, stage: Stage, names: Sequence[str], plan: Plan) -> Mapping[str, float]:
    """Values near enough to start the polish from; the play of the steering axis is left to that one."""
    index = np.flatnonzero(_used_by(stage, problem.points))
    index = index[:: max(1, len(index) // ENOUGH_FOR_A_STAGE)]
    if len(index) < len(names):
        return {}
    part = problem.select(index)
    unused = np.full(len(index), np.inf)
    part = dataclasses.replace(
        part,
        sigma_Fy=part.sigma_Fy if "Fy" in stage.channels else unused,
        sigma_Mz=part.sigma_Mz if "Mz" in stage.channels else unused,
        radii=(),
        simulation=part.simulation.with_numbers({"backlash_deg": 0.0}),
    )
    if stage.zero_camber:
        names = [n for n in names if n not in WITH_CAMBER]
    part, _ = _reweighted(part)
    return solve(part.free(names), _numbers(part, names, plan), max_steps=15, tolerance=1e-3).values


def _used_by(stage: Stage, points: Points) -> np.ndarray:
    """Mask (n,) of the points that the stage is fitted to."""
    used = np.ones(len(points), bool)
    if stage.main_pressure:
        used &= main_pressure(points)
    if stage.zero_camber:
        used &= np.abs(points.gamma) < np.radians(1.0)
    return used


def _polish(stated: Problem, plan: Plan) -> Fitted:
    """All free numbers together: balance the channels, discount outliers, look along the valley where it is bent."""
    near = stated
    for step in _steps(len(stated.points)):
        thinned = _thinned(_reweighted(near)[0], step)
        last = step <= MORE_BY  # the passes with all points are then cheap enough to do the rest
        near = near.with_values(_solved(thinned, plan, tolerance=1e-3 if last else 1e-6).values)
    problem, scale = _reweighted(near)
    problem, solution = _settled(problem, plan)
    valley = follow(problem, _numbers_of(problem, plan), solution, _decided(solution, plan))
    if valley is not None and valley.better:
        problem, solution = _settled(problem.with_values(valley.better), plan)
    posterior = joint(problem, solution, plan.held)
    stderr = posterior.stderr
    return Fitted(
        values={n: v for n, v in solution.values.items() if n not in RIG},
        rig={n: (v, stderr[n]) for n, v in solution.values.items() if n in RIG},
        correlation=strongest_correlations(posterior, solution.names),
        posterior=posterior,
        intervals=valley.intervals if valley is not None else {},
        held=plan.held,
        problem=problem,
        numbers=tuple(_numbers_of(problem, plan)),
        at_bound=solution.at_bound | solution.at_limit,
        regularised=frozenset(plan.free) - _decided(solution, plan),
        stages=(),
        scale=scale,
        cost=solution.cost,
    )


RIG = frozenset(RIG_ERRORS)


def _decided(solution: Solution, plan: Plan) -> frozenset[str]:
    """Coefficients of which the data say more than what was known before."""
    errors = np.sqrt(np.diag(solution.covariance)).tolist()
    known = plan.scatter
    return frozenset(
        n for n, u in zip(solution.names, errors, strict=True) if n in known and u < DECIDED * known[n]
    )


def _settled(problem: Problem, plan: Plan) -> tuple[Problem, Solution]:
    solution = _solved(problem, plan, tolerance=1e-6)
    return problem.with_values(solution.values), solution


def _solved(problem: Problem, plan: Plan, *, tolerance: float) -> Solution:
    numbers = _numbers_of(problem, plan)
    return solve(problem.free([n.name for n in numbers]), numbers, tolerance=tolerance)


def _numbers_of(problem: Problem, plan: Plan) -> list[Number]:
    """Every free coefficient and rig error, starting from where the problem is."""
    at = {n.name: problem.simulation.number(n.name, problem.points) for n in plan.rig}
    rig = [dataclasses.replace(n, start=at[n.name]) for n in plan.rig]
    return [*_numbers(problem, [*plan.free, *plan.extra], plan), *rig]


def _numbers(problem: Problem, names: Sequence[str], plan: Plan) -> list[Number]:
    """The named coefficients with the table's bounds and what is known of each."""
    out = []
    for name in names:
        row = BY_NAME[name]
        start = row.inside(float(problem.simulation.values[name]))
        known = plan.scatter.get(name, math.inf)
        out.append(Number(name, start, *row.bounds, plan.expected[name], known))
    return out


def _reweighted(problem: Problem) -> tuple[Problem, tuple[float, float]]:
    """Weights from the misfit itself: a model that misses by more than the noise must not let one channel rule."""
    residual = problem.misfit()
    n = len(problem.points)
    out, scales = [], []
    for part, sigma in ((residual[:n], problem.sigma_Fy), (residual[n:], problem.sigma_Mz)):
        factor, scale = weights.enlarged(part, problem.points.sweep)
        out.append(sigma * factor)
        scales.append(scale)
    return dataclasses.replace(problem, sigma_Fy=out[0], sigma_Mz=out[1]), (scales[0], scales[1])


def _steps(n: int) -> Iterator[int]:
    """For n points: every how many of them count on the way to the solution, fewer and fewer left out."""
    step = max(1, n // ENOUGH_FOR_A_STAGE)
    yield step
    while step > MORE_BY**2:
        step //= MORE_BY
        yield step


def _thinned(problem: Problem, step: int) -> Problem:
    """Every k-th point, each counted k times so that what was known before weighs as much as it does beside all."""
    if step == 1:
        return problem
    part = problem.select(np.arange(0, len(problem.points), step))
    share = 1.0 / math.sqrt(step)
    return dataclasses.replace(part, sigma_Fy=share * part.sigma_Fy, sigma_Mz=share * part.sigma_Mz)


def _record(problem: Problem, name: str, title: str, parameters: Sequence[str]) -> StageRecord:
    out, points = problem.simulation.readings(problem.points), problem.points
    return StageRecord(name, title, tuple(parameters), rms(out.Fy - points.Fy), rms(out.Mz - points.Mz))


def _enough_points(points: Points, free: list[str]) -> None:
    moment = [n for n in free if BY_NAME[n].channel == "Mz"]
    for channel, needed, values in (
        ("Fy_N", len(free) - len(moment), points.Fy),
        ("Mz_Nm", len(moment), points.Mz),
    ):
        available = int(np.sum(np.isfinite(values)))
        if needed and available <= needed:
            raise InputError(
                f"{available} points of {channel} cannot determine the {needed} coefficients that these sweeps call "
                "for: add points (more angles per sweep), or sweeps at fewer loads, cambers and pressures"
            )
