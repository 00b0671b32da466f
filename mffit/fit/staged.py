"""The staged fit of one model to the raw points, and the joint polish that ends it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.errors import InputError
from mffit.fit import weights
from mffit.fit.coverage import StageCoverage
from mffit.fit.problem import Problem
from mffit.fit.result import StageRecord
from mffit.fit.solve import Solution, covariance, solve
from mffit.fit.stages import CONICITY_ON_A_DISC, IF_IDENTIFIED, STAGES, Stage
from mffit.fit.systematic import CommonError, systematic_covariance
from mffit.points import Points, main_pressure
from tir.parameters import BY_NAME

ENOUGH_FOR_A_STAGE = 600
"""Points used in a stage before the polish; more would only cost time, as the polish uses all."""
TIED_SPREAD = 0.3
"""How far spin coefficients of similar tyres scatter around each other, relative, 1 sigma."""
IDENTIFIED = 0.5
"""Largest relative standard error at which a tied coefficient is released."""

Progress = Callable[[str], None]


@dataclass(frozen=True, slots=True)
class Fitted:
    """Values and errors of the free coefficients after the polish."""

    values: Mapping[str, float]
    stderr: Mapping[str, float]
    correlation: Mapping[str, tuple[str, float]]
    at_bound: frozenset[str]
    regularised: frozenset[str]
    unmoved: frozenset[str]  #: freed, but the data did not move them: back at their start and held
    stages: tuple[StageRecord, ...]
    scale: tuple[float, float]  #: misfit over stated uncertainty, Fy and Mz
    points: Points  #: with the angles that the wheel had, as far as the model knows them


def fit_staged(
    problem: Problem,
    start: Mapping[str, float],
    cover: tuple[StageCoverage, ...],
    progress: Progress,
    extra: tuple[str, ...] = (),
    errors: tuple[CommonError, ...] = (),
) -> Fitted:
    """Fit stage by stage, then everything together.

    Parameters
    ----------
    problem : points, weights (as stated) and fixed values
    start : starting value of every coefficient
    cover : the coverage matrix; only its free coefficients are fitted
    progress : called with a sentence before each step
    extra : coefficients freed in the polish only (PECP1 when it is tied to the turn-slip force)
    errors : rig errors common to all points, which add to the standard errors
    """
    free = [name for row in cover for name in row.free]
    _enough_points(problem.points, free)
    values = {name: start[name] for name in free}
    base = dict(values)
    records = []
    for stage, row in zip(STAGES, cover, strict=True):
        if not row.free:
            continue
        progress(f"fitting {stage.title.lower()}")
        reopened = [name for other in cover if other.stage in stage.reopened for name in other.free]
        values.update(_fit_stage(problem, stage, [*reopened, *row.free], values, base))
        records.append(_record(problem, stage.name, stage.title, row.free, values))
    progress("joint polish")
    values.update({name: start[name] for name in extra})
    base.update({name: start[name] for name in extra})
    fitted = _polish(problem, values, base, errors)
    names = tuple(fitted.values)
    polished = dataclasses.replace(problem, points=fitted.points)
    records.append(_record(polished, "polish", "Joint polish", names, fitted.values))
    return dataclasses.replace(fitted, stages=tuple(records))


def _fit_stage(problem: Problem, stage: Stage, names, values, base) -> Mapping[str, float]:
    points = problem.points
    index = np.flatnonzero(_used_by(stage, problem))
    index = index[:: max(1, len(index) // ENOUGH_FOR_A_STAGE)]
    if len(index) < len(names):
        return {}
    part = dataclasses.replace(
        problem,
        points=points.select(index),
        fixed={**problem.fixed, **values},
        sigma_Fy=problem.sigma_Fy[index] if "Fy" in stage.channels else np.full(len(index), np.inf),
        sigma_Mz=problem.sigma_Mz[index] if "Mz" in stage.channels else np.full(len(index), np.inf),
        prior=_ties(points, names, base),
        tie=None,
    )
    part, _ = _reweighted(part, values)
    start = {name: values[name] for name in names}
    return solve(part.residual, start, _bounds(names), max_steps=15, tolerance=1e-3).values


def _used_by(stage: Stage, problem: Problem) -> np.ndarray:
    """Mask (n,) of the points that the stage is fitted to."""
    points = problem.points
    used = np.ones(len(points), bool)
    if stage.main_pressure:
        used &= main_pressure(points)
    if stage.zero_camber:
        used &= np.abs(points.gamma) < np.radians(1.0)
    return used


def _polish(
    problem: Problem, values: dict[str, float], base: dict[str, float], errors: tuple[CommonError, ...]
) -> Fitted:
    """All free coefficients together: balance the channels, discount outliers, release what the data identify."""
    stated = problem
    problem, scale = _reweighted(stated.settled(values), values)
    ties = _ties(problem.points, values, base)
    rough = _thinned(problem)
    solution = _solve(rough, values, ties, tolerance=1e-4)
    errors_of_data = _data_errors(rough, solution, len(problem.points))
    problem, scale = _reweighted(stated.settled(solution.values), solution.values)
    tied = {name for name in ties if name in IF_IDENTIFIED}
    released = frozenset(tied & _identified(solution, errors_of_data))
    conicity = {name for name in ties if name in CONICITY_ON_A_DISC and np.any(problem.points.phi_t)}
    unmoved = _unmoved(errors_of_data, ties) - tied - conicity
    ties = _ties(problem.points, values, base, released)
    values = {n: v for n, v in solution.values.items() if n not in unmoved}
    problem = dataclasses.replace(problem, fixed={**problem.fixed, **{n: base[n] for n in unmoved}})
    solution = _solve(problem, values, ties, tolerance=1e-5)
    names = list(solution.values)
    cov = covariance(solution.jacobian)
    final = dataclasses.replace(problem, prior=ties)
    cov = cov + systematic_covariance(final, solution.values, solution.jacobian, errors)
    stderr = dict(zip(names, np.sqrt(np.diag(cov)).tolist(), strict=True))
    return Fitted(
        values=solution.values,
        stderr=stderr,
        correlation=_strongest_correlations(names, cov),
        at_bound=solution.at_bound,
        regularised=frozenset((tied | conicity) - released),
        unmoved=frozenset(unmoved),
        stages=(),
        scale=scale,
        points=problem.points,
    )


def _solve(problem: Problem, values, ties, tolerance) -> Solution:
    problem = dataclasses.replace(problem, prior=ties)
    return solve(problem.residual, values, _bounds(values), tolerance=tolerance)


def _reweighted(problem: Problem, values) -> tuple[Problem, tuple[float, float]]:
    """Weights from the misfit itself: a model that misses by more than the noise must not let one channel rule."""
    residual = problem.data_residual(values)
    n = len(problem.points)
    out, scales = [], []
    for part, sigma in ((residual[:n], problem.sigma_Fy), (residual[n:], problem.sigma_Mz)):
        scale = max(weights.robust_scale(part), 1.0)
        out.append(sigma * scale * weights.huber(part, scale))
        scales.append(scale)
    return dataclasses.replace(problem, sigma_Fy=out[0], sigma_Mz=out[1]), (scales[0], scales[1])


def _ties(
    points: Points, names, base: Mapping[str, float], released: frozenset[str] = frozenset()
) -> dict[str, tuple[float, float]]:
    """Expected value and spread of every free coefficient: tight for spin terms, the table's bounds for the rest."""
    ties = {}
    for name in names:
        row = BY_NAME[name]
        spread = 0.5 * row.width
        if name in IF_IDENTIFIED and name not in released:
            spread = max(TIED_SPREAD * abs(base[name]), 0.02)
        if name in CONICITY_ON_A_DISC and np.any(points.phi_t):
            spread = CONICITY_ON_A_DISC[name]
        ties[name] = (base[name], spread)
    return ties


def _bounds(names) -> dict[str, tuple[float, float]]:
    return {name: BY_NAME[name].bounds for name in names}


def _thinned(problem: Problem) -> Problem:
    """Every k-th point: enough to come near the solution, at a part of the cost."""
    step = len(problem.points) // ENOUGH_FOR_A_STAGE
    if step <= 1:
        return problem
    index = np.arange(0, len(problem.points), step)
    return dataclasses.replace(
        problem,
        points=problem.points.select(index),
        sigma_Fy=problem.sigma_Fy[index],
        sigma_Mz=problem.sigma_Mz[index],
        alpha_read=None if problem.alpha_read is None else problem.alpha_read[index],
    )


def _data_errors(problem: Problem, solution: Solution, of: int) -> dict[str, float]:
    """Standard errors from the data alone, without the ties, for ``of`` points of the kind that was solved."""
    rows = 2 * len(problem.points)
    errors = np.sqrt(np.diag(covariance(solution.jacobian[:rows])) * len(problem.points) / of)
    return dict(zip(solution.values, errors.tolist(), strict=True))


def _identified(solution: Solution, errors: Mapping[str, float]) -> set[str]:
    return {n for n, v in solution.values.items() if errors[n] < IDENTIFIED * max(abs(v), 1e-12)}


def _unmoved(errors: Mapping[str, float], ties: Mapping[str, tuple[float, float]]) -> set[str]:
    """Coefficients whose error from the data exceeds half the width of all plausible values."""
    return {name for name, (_, spread) in ties.items() if errors[name] > spread}


def _strongest_correlations(names: list[str], cov: np.ndarray) -> dict[str, tuple[str, float]]:
    size = np.sqrt(np.diag(cov))
    correlation = cov / np.outer(size, size)
    np.fill_diagonal(correlation, 0.0)
    strongest = np.argmax(np.abs(correlation), axis=1) if names else []
    return {
        name: (names[j], float(correlation[i, j]))
        for i, (name, j) in enumerate(zip(names, strongest, strict=True))
        if abs(correlation[i, j]) > 0.95
    }


def _record(problem: Problem, name: str, title: str, parameters, values) -> StageRecord:
    Fy, Mz = problem.model(values)
    points = problem.points
    return StageRecord(name, title, tuple(parameters), _rms(Fy - points.Fy), _rms(Mz - points.Mz))


def _rms(x: np.ndarray) -> float:
    x = x[np.isfinite(x)]
    return float(np.sqrt(np.mean(x**2))) if len(x) else float("nan")


def _enough_points(points: Points, free: list[str]) -> None:
    moment = [n for n in free if n.startswith("Q") or n in ("PPZ1", "PPZ2")]
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
