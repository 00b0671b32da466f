"""The influences of :mod:`mffit.fit.influences.nuisances` that a fit models: those that the sweeps show beyond chance."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from mffit.constants import FEWEST_SWEEPS_TO_PREDICT, LEAST_PREDICTED_SHARE
from mffit.errors import InputError
from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.influences.nuisances import NUISANCES, Nuisance
from mffit.fit.problem import FitProblem
from mffit.fit.run_scatter import OfRuns, Part, Runs, halves_of_runs
from mffit.fit.weights import stated_or_nominal
from mffit.least_squares import FreeNumber, condensed, minimum
from mffit.left_out import Predicted, Support, improves, left_out_errors, needed_fall, predicted
from mffit.points import Points
from mffit.rig_errors import BY_NAME
from mffit.scatter import rms
from mffit.suspicion import parts_of_sweeps

Gaps = Mapping[str, float]
"""By channel, rms error of left-out sweeps [N] or [Nm]."""


@dataclass(frozen=True, slots=True)
class Verdict:
    """Whether an influence is modelled, and why."""

    nuisance: Nuisance
    modelled: bool
    reason: str  #: in words
    without: Gaps = field(default_factory=dict)
    """Errors of left-out sweeps without it, where they were computed."""
    beside: Gaps = field(default_factory=dict)
    """The same with it."""


@dataclass(frozen=True, slots=True)
class NuisanceChoice:
    """What a fit models beside coefficients and declared rig errors."""

    verdicts: tuple[Verdict, ...]
    near: NearSolution  #: with what is modelled, but for the numbers of every run; coefficients at a bound are held there
    scatter: Mapping[str, float] = field(default_factory=dict)
    """Standard deviation among the runs of every number that each of them has."""

    @property
    def modelled(self) -> tuple[Nuisance, ...]:
        """The influences that are modelled."""
        return tuple(verdict.nuisance for verdict in self.verdicts if verdict.modelled)


_WITHIN_CHANCE = "what it explains is within chance"
_LITTLE = "it explains little of what the fit misses"
_WORSE = "left-out sweeps are predicted worse with it"
_TOO_FEW = f"fewer than {FEWEST_SWEEPS_TO_PREDICT} sweeps do not show whether it predicts them better"


class _Prediction(NamedTuple):
    by_sweep: Predicted
    gaps: Gaps


class NearSolution(NamedTuple):
    """A fit with some influences, near its solution."""

    problem: FitProblem  #: with the weights of the first fit
    numbers: Sequence[FreeNumber]
    chosen: tuple[Nuisance, ...]


def choose(config: Any, first: Fitted) -> NuisanceChoice:
    """The influences that [fit] demands, and those that explain more than chance does.

    ``first`` is the fit without any. Forward steps: the influence that chance explains least is added, and one that a later step
    makes needless is dropped. Grip and stiffness may differ from sweep to sweep meanwhile, so that no influence is taken for it.
    """
    points = first.problem.points
    verdicts: dict[str, Verdict] = {}
    demanded, open_ = [], []
    for nuisance in NUISANCES:
        setting, lacking = nuisance.setting(config), nuisance.lacking(points)
        if setting is False:
            verdicts[nuisance.id] = Verdict(nuisance, False, _said(config, nuisance))
        elif lacking and setting:
            raise InputError(
                f"asks for the {nuisance.name}, but {lacking}; measure it, or remove the key",
                file=config.path,
                line=config.line_of(f"fit.{nuisance.key}"),
                key=f"fit.{nuisance.key}",
            )
        elif lacking:
            verdicts[nuisance.id] = Verdict(nuisance, False, lacking)
        elif setting:
            demanded.append(nuisance)
        else:
            open_.append(nuisance)
    of_runs = [nuisance for nuisance in (*demanded, *open_) if nuisance.per_run]
    common = [[n for n in some if not n.per_run] for some in (demanded, open_)]
    scatter = dict[str, float]()
    numbers = [number for number in first.numbers if number.name not in first.at_bound]
    model = NearSolution(at_reference(config, first.problem), numbers, ())
    if any(common) or of_runs:
        judged, model = _judged(config, model, *common)
        for nuisance in of_runs:
            verdict, scatter = _of_runs(config, model, nuisance, demanded=nuisance in demanded)
            judged[nuisance.id] = verdict
        verdicts |= judged
    return NuisanceChoice(tuple(verdicts[nuisance.id] for nuisance in NUISANCES), model, scatter)


def reference_temperature(config: Any, points: Points) -> float:
    """Temperature at which the file holds [degC]: given, else the mean of the data to 0.1 K."""
    given = config.fit.T_ref_degC
    return round(float(np.nanmean(points.T)), 1) if given is None else given


def at_reference(config: Any, problem: FitProblem) -> FitProblem:
    """The problem with the reference temperature of its points, where they have temperatures."""
    if not np.any(np.isfinite(problem.points.T)):
        return problem
    return problem.with_values({"T_ref_degC": reference_temperature(config, problem.points)})


def _judged(
    config: Any, model: NearSolution, demanded: Sequence[Nuisance], candidates: Sequence[Nuisance]
) -> tuple[dict[str, Verdict], NearSolution]:
    """The verdicts on demanded influences and candidates, and the fit with what is modelled; ``model`` is the one without any."""
    group = parts_of_sweeps(model.problem.points)
    base = predicted_left_out(model, (), group)
    here = base
    if demanded:
        model = _refitted(model, demanded)
        here = predicted_left_out(model, (), group)
    enough = len(np.unique(group)) >= FEWEST_SWEEPS_TO_PREDICT
    left = list(candidates)
    tried: dict[str, tuple[str, _Prediction]] = {}
    channels = list(model.problem.sigma)
    while enough and left:
        least = LEAST_PREDICTED_SHARE * _beyond_noise(model.problem)
        equations, helpful = _equations(model, left, group), dict[tuple[Nuisance, ...], Support]()
        steps = list(_steps(left, model.chosen))
        for step in steps:
            support, last = equations.support(step), step[-1]
            # What needs another influence is no rival of that one; two together are one more chance beside each alone.
            rivals = len(steps) if step[1:] else sum(other.after == last.after for other in left)
            after = predicted_left_out(model, step, group)
            seen = _WORSE if support.removed > least else _LITTLE
            tried[last.id] = (seen if support.beyond_chance(rivals) else _WITHIN_CHANCE, after)
            own = [channels.index(name) for name in last.about if name in channels] or None
            if improves(here.by_sweep, after.by_sweep, support, candidates=rivals, least=least, channels=own):
                helpful[step] = support
        if not helpful:
            break
        # Two together only if neither does alone; of those that chance never explains, the one that explains most.
        best = min(helpful, key=lambda step: (len(step), helpful[step].chance, -helpful[step].chi2))
        rivals_of_best = {nuisance.rival for nuisance in best}
        left = [nuisance for nuisance in left if nuisance not in best and nuisance.id not in rivals_of_best]
        model = _refitted(model, best)
        here = predicted_left_out(model, (), group)
        for old in [n for n in model.chosen if n in candidates and n not in best]:
            if old not in model.chosen:
                continue
            equations = _equations(model, (), group)
            needed = equations.support(_with_those_after(model, old)).beyond_chance()
            if not needed and equations.support(best, without=_with_those_after(model, old)).beyond_chance():
                tried[old.id] = (_WITHIN_CHANCE, here)
                model = _without(model, old)
                here = predicted_left_out(model, (), group)
    return _verdicts(config, model, candidates, demanded, base, here, tried, enough=enough), model


def _of_runs(
    config: Any, model: NearSolution, nuisance: Nuisance, *, demanded: bool
) -> tuple[Verdict, dict[str, float]]:
    """The verdict on numbers of every run, and their scatter if they are modelled.

    What a run that is left out shows of its own numbers is unknown, so halves of runs are left out: the other half shows them.
    Whole runs must not be predicted worse: they are where a mistake of the formula is taken for a difference of runs.
    """
    problem, points = model.problem, model.problem.points
    sweeps = np.unique(points.sweep, return_inverse=True)[1]
    if not demanded and sweeps.max() + 1 < FEWEST_SWEEPS_TO_PREDICT:
        return Verdict(nuisance, False, _TOO_FEW), {}
    runs = _linear_runs(model, nuisance, points.sweep)
    parts = runs.parts()
    spread = runs.spread(parts)

    def predictions(group: np.ndarray) -> list[_Prediction]:
        """Without and with numbers of every run; errors are summed over sweeps."""
        errors = runs.left_out(parts, group, (np.zeros_like(spread), spread))
        return [_judged_errors(problem, error, sweeps) for error in errors]

    without, beside = predictions(halves_of_runs(points))
    gaps, scatter = (without.gaps, beside.gaps), dict(zip(nuisance.numbers, spread.tolist(), strict=True))
    if demanded:
        return Verdict(nuisance, True, _said(config, nuisance), *gaps), scatter
    support = runs.support_of_scatter(parts, spread)
    removed = 1.0 - beside.by_sweep.total / without.by_sweep.total
    # A gain that few runs hold is theirs; a scatter shows in most of them.
    shared = removed > LEAST_PREDICTED_SHARE and without.by_sweep.falls(beside.by_sweep) > needed_fall(1)
    if not shared or not improves(without.by_sweep, beside.by_sweep, support):
        seen = "left-out halves of sweeps are not predicted clearly better with it"
        return Verdict(nuisance, False, seen if support.beyond_chance() else _WITHIN_CHANCE, *gaps), {}
    whole = predictions(sweeps)
    if whole[0].by_sweep.raised(whole[1].by_sweep):
        reason = "whole left-out sweeps are predicted worse with it, because the formula misses them"
        return Verdict(nuisance, False, reason, whole[0].gaps, whole[1].gaps), {}
    return Verdict(nuisance, True, "left-out halves of sweeps are predicted better with it", *gaps), scatter


class _Equations(NamedTuple):
    """A fit, linearised, with numbers of influences that it does not model yet, beside grip and stiffness of every group."""

    names: tuple[str, ...]  #: of all shared numbers
    away: np.ndarray  #: (k,) their distance from where an influence has no effect; 0 of coefficients
    candidates: frozenset[str]  #: those of the names that it does not model
    runs: Runs
    parts: Part

    def support(self, more: Iterable[Nuisance], without: Iterable[Nuisance] = ()) -> Support:
        """What the numbers of influences explain, after all numbers of the model but those of ``without``."""
        tested = {name for nuisance in more for name in nuisance.numbers}
        gone = (self.candidates | {name for nuisance in without for name in nuisance.numbers}) - tested
        is_tested, is_gone = (np.array([name in some for name in self.names]) for some in (tested, gone))
        step = np.where(is_tested | is_gone, -self.away, 0.0)
        return self.runs.support(self.parts, np.flatnonzero(~is_gone), np.flatnonzero(is_tested), step)


def _equations(model: NearSolution, candidates: Iterable[Nuisance], group: np.ndarray) -> _Equations:
    """The equations of a fit with some candidates; groups (n,) differ in grip and stiffness."""
    of_runs = next(nuisance for nuisance in NUISANCES if nuisance.per_run)
    added = [number for nuisance in candidates for number in nuisance.free(model.problem.points, {})]
    start = {number.name: number.start for number in added}
    more = model._replace(problem=model.problem.with_values(start), numbers=[*model.numbers, *added])
    runs, names = _linear_runs(more, of_runs, group), tuple(n.name for n in more.numbers)
    own = {name for nuisance in model.chosen for name in nuisance.numbers}
    away = [model.problem.value(name) - BY_NAME[name].undisturbed if name in own else 0.0 for name in names]
    return _Equations(names, np.array(away), frozenset(start), runs, runs.parts())


def _beyond_noise(problem: FitProblem) -> float:
    """Sum of squares of the residuals that the noise of the points does not explain; 0 if it explains all."""
    out = 0.0
    for name, residual in problem.misfit().items():
        used, sigma = residual != 0.0, problem.sigma[name]
        u = stated_or_nominal(problem.points.u(name), np.where(used, problem.points.channel(name), np.nan))
        noise = u[used] / sigma[used]
        out += max(float(residual @ residual - noise @ noise), 0.0)
    return out


def _with_those_after(model: NearSolution, old: Nuisance) -> list[Nuisance]:
    return [nuisance for nuisance in model.chosen if nuisance is old or nuisance.after == old.id]


def _linear_runs(model: NearSolution, nuisance: Nuisance, run: np.ndarray) -> Runs:
    """The fit, linearised, with numbers of every run (n,), which lies within a sweep."""
    problem = model.problem
    numbers = problem.starting_here(model.numbers)
    x = np.array([number.start for number in numbers])
    names = [*(n.name for n in numbers), *nuisance.numbers]
    precision, away = _priors(numbers, x)
    sweeps = problem.sweeps(names)
    radii, by_radii = problem.radii_rows(names[: len(x)])
    return Runs(
        rows=lambda: (
            OfRuns(np.tile(rows, len(problem.sigma)), slope[:, : len(x)], slope[:, len(x) :], data)
            for rows, data, slope in sweeps()
        ),
        run=run,
        information=np.diag(precision) + by_radii.T @ by_radii,
        pull=away + by_radii.T @ radii,
    )


def _steps(left: Sequence[Nuisance], chosen: Sequence[Nuisance]) -> Iterator[tuple[Nuisance, ...]]:
    """What may be added next: an influence, together with the one that it needs if that is not modelled yet."""
    there = {nuisance.id for nuisance in chosen}
    by_id = {nuisance.id: nuisance for nuisance in left}
    for nuisance in left:
        if not nuisance.after or nuisance.after in there:
            yield (nuisance,)
        elif nuisance.after in by_id:
            yield (by_id[nuisance.after], nuisance)


def _verdicts(
    config: Any,
    model: NearSolution,
    candidates: Sequence[Nuisance],
    demanded: Sequence[Nuisance],
    base: _Prediction,
    here: _Prediction,
    tried: Mapping[str, tuple[str, _Prediction]],
    *,
    enough: bool,
) -> dict[str, Verdict]:
    out, there = {}, {nuisance.id for nuisance in model.chosen}
    for nuisance in (*demanded, *candidates):
        modelled, other = nuisance in model.chosen, tried.get(nuisance.id)
        if nuisance in demanded:
            reason, gaps = _said(config, nuisance), (base.gaps, here.gaps)
        elif modelled:
            reason, gaps = "what it explains is beyond chance", (base.gaps, here.gaps)
        elif nuisance.rival in there:
            reason, gaps = f"the {_named(nuisance.rival)} explains more", ({}, {})
        elif other is not None:
            reason, gaps = other[0], (here.gaps, other[1].gaps)
        elif not enough:
            reason, gaps = _TOO_FEW, ({}, {})
        else:
            reason, gaps = f"it needs the {_named(nuisance.after)}, which is not modelled", ({}, {})
        out[nuisance.id] = Verdict(nuisance, modelled, reason, *gaps)
    return out


def _named(key: str) -> str:
    return next(nuisance.name for nuisance in NUISANCES if nuisance.id == key)


def predicted_left_out(model: NearSolution, more: Iterable[Nuisance], group: np.ndarray) -> _Prediction:
    """Left-out parts of sweeps as the model predicts them, to first order with further influences."""
    problem = model.problem
    added = (number for nuisance in more for number in nuisance.free(problem.points, {}))
    numbers = [*problem.starting_here(model.numbers), *added]
    x = np.array([number.start for number in numbers])
    names = [number.name for number in numbers]
    problem = problem.with_values(dict(zip(names, x.tolist(), strict=True)))
    sweeps = problem.sweeps(names)
    r, J = condensed(itertools.chain((block[1:] for block in sweeps()), [problem.radii_rows(names)]))
    precision, away = _priors(numbers, x)
    information, gradient = J.T @ J + np.diag(precision), J.T @ r + away
    error = np.empty((len(problem.sigma), len(group)))
    for rows, data, slope in sweeps():
        own = np.tile(np.unique(group[rows], return_inverse=True)[1], len(problem.sigma))
        found = left_out_errors(slope, data, information, gradient, own)
        error[:, rows] = found.reshape(len(problem.sigma), -1)
    return _judged_errors(problem, error, group)


def _priors(numbers: Sequence[FreeNumber], x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Precision (k,) of the priors, and precision times the distance of the numbers from them."""
    precision = np.array([0.0 if np.isinf(number.spread) else number.spread**-2.0 for number in numbers])
    return precision, precision * (x - [number.expected for number in numbers])


def _judged_errors(problem: FitProblem, error: np.ndarray, group: np.ndarray) -> _Prediction:
    """The prediction whose errors (c, n) are in units of the weights, by group (n,) of the points."""
    count, channels = len(group), len(problem.sigma)
    groups = np.tile(group, channels)
    by_sweep = predicted(error.ravel(), groups, np.repeat(np.arange(channels), count), channels=channels)
    gaps = {}
    for (name, sigma), errors in zip(problem.sigma.items(), error, strict=True):
        used = np.isfinite(sigma) & np.isfinite(getattr(problem.points, name))
        if np.any(used):
            gaps[name] = rms(errors[used] * sigma[used])
    return _Prediction(by_sweep, gaps)


def _refitted(model: NearSolution, added: Sequence[Nuisance]) -> NearSolution:
    """The model with more influences, fitted again from where it is."""
    points = model.problem.points
    numbers = [*model.numbers, *(number for nuisance in added for number in nuisance.free(points, {}))]
    return solved(model._replace(numbers=numbers, chosen=(*model.chosen, *added)))


def _without(model: NearSolution, dropped: Nuisance) -> NearSolution:
    """The model without an influence and those that need it, fitted again."""
    kept = tuple(n for n in model.chosen if n not in _with_those_after(model, dropped))
    gone = {name: BY_NAME[name].undisturbed for n in model.chosen if n not in kept for name in n.numbers}
    numbers = [number for number in model.numbers if number.name not in gone]
    return solved(NearSolution(model.problem.with_values(gone), numbers, kept))


def solved(model: NearSolution, most: int | None = None) -> NearSolution:
    """The model fitted again from where it is, in ``most`` steps at most if this is given."""
    numbers = model.problem.starting_here(model.numbers)
    slips = "Fx" in model.problem.sigma
    usual = constants.REFIT_STEPS_UNDER_SLIP if slips else constants.REFIT_STEPS
    found = minimum(
        model.problem.free([number.name for number in numbers]),
        numbers,
        max_steps=most or usual,
        tolerance=constants.POLISH_TOLERANCE if slips else constants.REFIT_TOLERANCE,
    )
    return model._replace(problem=model.problem.with_values(found.values))


def _said(config: Any, nuisance: Nuisance) -> str:
    """The setting of [fit] as it is in the file."""
    given = getattr(config.fit, nuisance.key)
    return f"[fit] {nuisance.key} = {str(given).lower() if isinstance(given, bool) else repr(given)}"
