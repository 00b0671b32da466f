"""The staged fit of one model to the raw points, with restarts from alternative starting values."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import FALSE_ALARM, ZERO_CAMBER, ZERO_SIDESLIP
from mffit.errors import InputError
from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.plan import FitPlan
from mffit.fit.polish import polish
from mffit.fit.problem import FitProblem
from mffit.fit.same_curve import with_expected_signs
from mffit.fit.stages import BY_STAGE, WITH_CAMBER, Stage, StageRecord
from mffit.fit.start import ALTERNATIVE_STARTS, SHAPES, STARTS_OF_A_STAGE
from mffit.least_squares import minimum
from mffit.points import Points, main_pressure
from mffit.progress import Progress, silent
from mffit.quantities import CHANNELS, column
from mffit.scatter import rms
from tir.parameters import BY_NAME

CLEARLY_LESS = -2.0 * math.log(FALSE_ALARM)
"""Fall of a sum of squares that makes a fit so much likelier that chance seldom does it."""


def fit_staged(
    problem: FitProblem,
    start: Mapping[str, float],
    plan: FitPlan,
    progress: Progress,
    *,
    restarts: bool = True,
    explained: Callable[[Fitted], bool] = lambda fitted: False,
) -> Fitted:
    """The best fit from ``start`` and, if that one ends far above the noise, from alternative starting values.

    ``explained`` is called with the first fit before alternatives are tried: they are not if it returns True, and it may refuse
    the data.
    """
    _require_enough_points(problem.points, plan.free)
    best = _fit_from(start, problem, plan, progress)
    if not restarts or not restart_worthwhile(best, plan) or explained(best):
        return best
    for shape, values in ALTERNATIVE_STARTS.items():
        progress(f"starting again from {shape}")
        other = _fit_from({**start, **values}, problem, plan, silent)
        if other.cost < best.cost - CLEARLY_LESS:
            best = other
    return replace(best, attempts=tuple(ALTERNATIVE_STARTS))


def restart_worthwhile(fitted: Fitted, plan: FitPlan) -> bool:
    """Whether the fit ends far above the stated noise, or with the shape of a curve at a bound of the table."""
    far = plan.noise_stated and max(fitted.scale.values()) > constants.RESTART_MISFIT
    shapes = (fitted.at_bound - fitted.hand.bounded.keys()) & SHAPES
    return far or bool(shapes)


def _fit_from(start: Mapping[str, float], problem: FitProblem, plan: FitPlan, progress: Progress) -> Fitted:
    """Stage after stage, then the joint polish."""
    problem = problem.with_values({name: start[name] for name in (*plan.free, *plan.extra)})
    records = []
    for row in plan.cover:
        if not row.free:
            continue
        stage = BY_STAGE[row.stage]
        progress(f"fitting {stage.title.lower()}")
        reopened = [name for other in plan.cover if other.stage in stage.reopened for name in other.free]
        problem = problem.with_values(_fit_stage(stage, [*reopened, *row.free], problem, plan))
        records.append(_record(stage.name, stage.title, row.free, problem))
    expected = {name: x for name, x in plan.expected.items() if name not in plan.hand.names}
    problem = problem.with_values(with_expected_signs(problem.simulation.values, expected))
    progress("joint polish")
    fitted = polish(problem, plan)
    names = [number.name for number in fitted.numbers]
    records.append(_record("polish", "Joint polish of tyre and rig", names, fitted.problem))
    return replace(fitted, stages=tuple(records))


def _fit_stage(stage: Stage, names: Sequence[str], problem: FitProblem, plan: FitPlan) -> Mapping[str, float]:
    """Values that are good enough for the polish to start from."""
    index = _points_of(stage, problem.points)
    if len(index) < len(names):
        return {}
    if stage.zero_camber:
        names = [name for name in names if name not in WITH_CAMBER]
    unused = np.full(len(index), np.inf)
    part = problem.select(index).with_values({"backlash_deg": 0.0})  # play is left to the polish
    sigma = {name: u if name in stage.channels else unused for name, u in part.sigma.items()}
    part, _ = replace(part, sigma=sigma, radii=()).reweighted()
    ends = [
        minimum(
            here.free(names),
            plan.coefficients(names, here),
            max_steps=constants.REFIT_STEPS,
            tolerance=constants.STAGE_TOLERANCE,
        )
        for here in (part, *_from_elsewhere(stage, names, part, plan))
    ]
    return min(ends, key=lambda end: end.cost).values


def _from_elsewhere(
    stage: Stage, names: Sequence[str], part: FitProblem, plan: FitPlan
) -> Iterator[FitProblem]:
    """The problem with further starting values of the stage; those that somebody bounded stay inside."""
    for values in STARTS_OF_A_STAGE.get(stage.name, ()):
        yield part.with_values({n: plan.hand.inside(n, x) for n, x in values.items() if n in names})


def _points_of(stage: Stage, points: Points) -> np.ndarray:
    """Rows (m,) of the points that the stage is fitted to, thinned if there are many."""
    used = np.ones(len(points), bool)
    if stage.main_pressure:
        used &= main_pressure(points)
    if stage.zero_camber:
        used &= np.abs(points.gamma) < ZERO_CAMBER.rad
    if "alpha" not in stage.slips:
        used &= np.abs(points.alpha) < ZERO_SIDESLIP.rad
    if "kappa" not in stage.slips:
        used &= points.free_rolling
    index = np.flatnonzero(used)
    return index[:: max(1, len(index) // constants.POINTS_OF_A_STAGE)]


def _record(name: str, title: str, parameters: Sequence[str], problem: FitProblem) -> StageRecord:
    out = problem.readings()
    return StageRecord(
        name=name,
        title=title,
        parameters=tuple(parameters),
        rmse={channel: rms(out[channel] - problem.points.channel(channel)) for channel in out},
    )


def _require_enough_points(points: Points, free: Sequence[str]) -> None:
    needed = Counter(BY_NAME[name].channel or "Fy" for name in free)
    for channel in CHANNELS:
        available = int(np.sum(np.isfinite(points.channel(channel))))
        if needed[channel] and available <= needed[channel]:
            raise InputError(
                f"{available} points of {column(channel)} cannot determine the {needed[channel]} coefficients that these sweeps "
                "free: add points (more angles per sweep), or sweeps at fewer loads, cambers and pressures"
            )
