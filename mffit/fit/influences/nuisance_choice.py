"""Choice of the influences of :mod:`mffit.fit.influences.nuisances` that a fit models: the significant ones."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from mffit.as_json import keys
from mffit.config import Config
from mffit.constants import FEWEST_SWEEPS_TO_PREDICT, MOST
from mffit.errors import InputError
from mffit.fit.fitted import Fitted, uncertain
from mffit.fit.influences.joint import JointFit, LeftOutGroups, beyond_chance
from mffit.fit.influences.nuisances import NUISANCES, TEMPERATURE, Nuisance
from mffit.fit.problem import FitProblem
from mffit.least_squares import FreeNumber, solve
from mffit.left_out import clearly_above_zero
from mffit.linearised import LinearisedFit
from mffit.linearised.components import LIKELY_EVIDENCE
from mffit.linearised.inputs import word_of
from mffit.points import Points, levels
from mffit.rig_errors import BY_NAME, P_REF, T_REF, V_REF
from mffit.scatter import clearly_below_zero
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
    """Errors of left-out sweeps without the influence, if computed."""
    beside: Gaps = field(default_factory=dict)
    """Errors of left-out sweeps with the influence, if computed."""


keys(
    Verdict,
    "id=nuisance.id name=nuisance.name modelled reason numbers=nuisance.numbers left_out_rmse",
    left_out_rmse=lambda row: {"with": row.beside, "without": row.without} if row.beside else None,
)


@dataclass(frozen=True, slots=True)
class NuisanceChoice:
    """The influences that a fit models in addition to coefficients and declared rig errors."""

    verdicts: tuple[Verdict, ...]
    near: NearSolution  #: fit with the modelled influences but without random effects; coefficients at a bound are held
    scatter: Mapping[str, float] = field(default_factory=dict)
    """Standard deviation among the runs of each random effect."""

    @property
    def modelled(self) -> tuple[Nuisance, ...]:
        """The influences that are modelled."""
        return tuple(verdict.nuisance for verdict in self.verdicts if verdict.modelled)


_WITHIN_CHANCE = "what it explains is within chance"
_WORSE = "left-out sweeps are predicted worse with it"
_AS_MODEL_ERROR = "what the formula misses explains it as well"
_OF_NO_RIG = "no rig has one of this sign, so that it would take up something else"
_TOO_FEW = f"fewer than {FEWEST_SWEEPS_TO_PREDICT} sweeps do not show whether it predicts them better"


class NearSolution(NamedTuple):
    """A fit with some influences, near its solution."""

    problem: FitProblem  #: weighted as in the first fit
    numbers: Sequence[FreeNumber]
    chosen: tuple[Nuisance, ...]

    def joint(self, group: np.ndarray, more: Iterable[Nuisance] = ()) -> JointFit:
        """The linear mixed model with further influences ``more``; groups (n,) may differ in grip and stiffness."""
        of_runs = next(nuisance for nuisance in NUISANCES if nuisance.per_run)
        added = [number for nuisance in more for number in nuisance.free(self.problem.points, {})]
        problem = self.problem.with_values({number.name: number.start for number in added})
        return JointFit.of(problem, [*self.numbers, *added], of_runs.numbers, group)

    def left_out(self, group: np.ndarray) -> LeftOutGroups:
        """Each group (n,) of points predicted from all others, without random effects."""
        joint = self.joint(group)
        return joint.left_out(joint.alike(), group)


def refuse_lacking(config: Config, points: Points) -> None:
    """Refuse, with InputError, an influence that [fit] demands and for which the points lack something."""
    for nuisance in NUISANCES:
        if nuisance.setting(config) and (lacking := nuisance.lacking(points)):
            raise InputError(
                f"asks for the {nuisance.name}, but {lacking}; measure it, or remove the key",
                file=config.path,
                line=config.line_of(f"fit.{nuisance.key}"),
                key=f"fit.{nuisance.key}",
            )


def choose(config: Config, first: Fitted, left: LinearisedFit | None = None) -> NuisanceChoice:
    """The influences that [fit] demands, and the significant ones.

    ``first`` is the fit without influences, ``left`` the linear model of its residuals. Forward selection: each step adds the
    influence with the largest gain. Meanwhile grip and stiffness have a random effect per sweep, so that scatter between sweeps
    is not mistaken for an influence.
    """
    points = first.problem.points
    refuse_lacking(config, points)
    first = replace(first, problem=at_reference(config, first.problem))
    verdicts: dict[str, Verdict] = {}
    demanded, open_ = [], []
    for nuisance in NUISANCES:
        setting, lacking = nuisance.setting(config), nuisance.lacking(points)
        if setting is False:
            verdicts[nuisance.id] = Verdict(nuisance, False, _said(config, nuisance))
        elif lacking:
            verdicts[nuisance.id] = Verdict(nuisance, False, lacking)
        elif setting:
            demanded.append(nuisance)
        else:
            open_.append(nuisance)
    of_runs = [nuisance for nuisance in (*demanded, *open_) if nuisance.per_run]
    given, candidates = ([n for n in some if not n.per_run] for some in (demanded, open_))
    scatter = dict[str, float]()
    numbers = [number for number in first.numbers if number.name not in first.at_bound]
    model = NearSolution(first.problem, numbers, ())
    if given or candidates or of_runs:
        judged, model = _judged(config, model, given, candidates, _Formula(first, left))
        for nuisance in of_runs:
            verdict, scatter = _of_runs(config, model, nuisance, demanded=nuisance in demanded)
            judged[nuisance.id] = verdict
        verdicts |= judged
    return NuisanceChoice(tuple(verdicts[nuisance.id] for nuisance in NUISANCES), model, scatter)


class _Formula(NamedTuple):
    """The fit without influences, and the linear model of what it misses if that is known."""

    fitted: Fitted
    left: LinearisedFit | None

    def refutes(self, nuisance: Nuisance, problem: FitProblem) -> str:
        """Why a significant influence, with its numbers in the ``problem``, is not modelled, in words; empty if it is.

        A sign that no published tyre has asks whether the influence is the model error: the temperature may rise along every
        sweep alike.
        """
        if nuisance.key != TEMPERATURE:
            return _OF_NO_RIG if nuisance.of_no_rig(problem) else ""
        if self.left is None or self.left.is_exact:
            return ""
        spread = {n.name: n.spread for n in map(uncertain, nuisance.free(problem.points, {}))}
        told = self.left.told_of(self.fitted.simulation, spread)
        u = told.u * [*spread.values()]
        strange = any(
            clearly_below_zero(BY_NAME[name].known_sign * problem.value(name), min(own, BY_NAME[name].spread))
            for name, own in zip(spread, u.tolist(), strict=True)
        )
        return _AS_MODEL_ERROR if strange and told.gain < LIKELY_EVIDENCE else ""


def reference_temperature(config: Config, points: Points) -> float:
    """Temperature at which the file holds [degC]: as given in [fit], else the mean of the data to 0.1 K."""
    given = config.fit.T_ref_degC
    return round(float(np.nanmean(points.T)), 1) if given is None else given


def at_reference(config: Config, problem: FitProblem) -> FitProblem:
    """The problem with the conditions at which its model holds: the points' mean pressure, the tested speed next to the nominal
    one and, if measured, the reference temperature.
    """
    points = problem.points
    speed = float(np.clip(config.tyre.nominal_speed, points.V.min(), points.V.max()))
    reference = {P_REF: round(float(np.mean(points.p)) / 1e3, 1), V_REF: round(speed, 1)}
    if np.any(np.isfinite(points.T)):
        reference[T_REF] = reference_temperature(config, points)
    return problem.with_values(reference)


def _judged(
    config: Config,
    model: NearSolution,
    demanded: Sequence[Nuisance],
    candidates: Sequence[Nuisance],
    formula: _Formula,
) -> tuple[dict[str, Verdict], NearSolution]:
    """The verdicts on demanded influences and candidates, and the fit with the modelled ones; ``model`` has no influences yet."""
    group = parts_of_sweeps(model.problem.points)
    base = model.left_out(group).gaps
    if demanded:
        model = _refitted(model, demanded)
    enough = len(np.unique(group)) >= FEWEST_SWEEPS_TO_PREDICT
    verdicts = {}
    for nuisance in candidates:
        reason = f"it needs the {_named(nuisance.after)}, which is not modelled" if nuisance.after else ""
        verdicts[nuisance.id] = Verdict(nuisance, False, reason if enough else _TOO_FEW)
    left = list(candidates)
    while enough and left:
        joint = model.joint(group, left)
        new = _numbers(left)
        here = joint.left_out(joint.alike(new), group)
        gains, steps = dict[tuple[Nuisance, ...], float](), list(_steps(left, model.chosen))
        for step in steps:
            numbers, last = _numbers(step), step[-1]
            # Candidates that the best one is chosen from: a pair competes with all steps, a single influence only with those
            # that need the same other influence.
            rivals = len(steps) if step[1:] else sum(other.after == last.after for other in left)
            gain = joint.gain(numbers, new)
            seen = beyond_chance(gain, len(numbers), rivals)
            after = joint.left_out(joint.alike(new - numbers), group)
            verdicts[last.id] = Verdict(
                last, False, _WORSE if seen else _WITHIN_CHANCE, here.gaps, after.gaps
            )
            if seen and np.sum(after.density) > np.sum(here.density):
                gains[step] = gain
        if not gains:
            break
        # A pair is added only if no single influence is significant.
        best = min(gains, key=lambda step: (len(step), -gains[step]))
        refitted = _refitted(model, best)
        reasons = (formula.refutes(nuisance, refitted.problem) for nuisance in best)
        if reason := next(filter(None, reasons), ""):
            for nuisance in best:
                verdicts[nuisance.id] = replace(verdicts[nuisance.id], reason=reason)
            left = [nuisance for nuisance in left if nuisance not in best]
            continue
        rivals_of = {nuisance.rival: nuisance for nuisance in best}
        for other in left:
            if other.id in rivals_of:
                verdicts[other.id] = Verdict(other, False, f"the {rivals_of[other.id].name} explains more")
        left = [nuisance for nuisance in left if nuisance not in best and nuisance.id not in rivals_of]
        model = refitted
    here = model.left_out(group)
    for nuisance in model.chosen:
        reason = _said(config, nuisance) if nuisance in demanded else "what it explains is beyond chance"
        verdicts[nuisance.id] = Verdict(nuisance, True, reason, base, here.gaps)
    return verdicts, model


def _of_runs(
    config: Config, model: NearSolution, nuisance: Nuisance, *, demanded: bool
) -> tuple[Verdict, dict[str, float]]:
    """The verdict on random effects of the runs, and their standard deviations if they are modelled.

    The random effects of a wholly left-out run are unknown, so halves of runs are left out and the other half determines them.
    In addition whole runs must not be predicted worse, and no condition that runs hold may explain most of the gain: either shows
    that model error was mistaken for differences of runs.
    """
    points = model.problem.points
    sweeps = np.unique(points.sweep, return_inverse=True)[1]
    joint = model.joint(sweeps)
    differ, alike = joint.explained(), joint.alike()
    halves = halves_of_runs(points)
    without, beside = (joint.left_out(of, halves) for of in (alike, differ.given))
    gaps, scatter = (
        (without.gaps, beside.gaps),
        dict(zip(nuisance.numbers, differ.scatter.tolist(), strict=True)),
    )
    if demanded:
        return Verdict(nuisance, True, _said(config, nuisance), *gaps), scatter
    gain = differ.value - joint.model.evidence(alike).value
    if not beyond_chance(gain, len(scatter)):
        return Verdict(nuisance, False, _WITHIN_CHANCE, *gaps), {}
    # The gain must be significant over the runs: scatter shows in most runs, not in a few.
    of_run = np.unique(halves[joint.looked_at]) // 2
    if not clearly_above_zero(np.bincount(of_run, without.squares - beside.squares)):
        reason = "left-out halves of sweeps are not predicted clearly better with it"
        return Verdict(nuisance, False, reason, *gaps), {}
    for name in levels.SETTINGS:
        held = levels.labels_of_setting(points, name)
        by_level = model.joint(np.unique(held, return_inverse=True)[1]).explained().value
        if by_level > differ.value - (1.0 - MOST) * gain:
            reason = f"it follows the {word_of(name)}, over which the formula misses the tyre"
            return Verdict(nuisance, False, reason, *gaps), {}
    without, beside = (joint.left_out(of, sweeps) for of in (alike, differ.given))
    if np.mean(np.log(beside.squares / without.squares)) > 0.0:  # the logarithm gives every run equal weight
        reason = "whole left-out sweeps are predicted worse with it, because the formula misses them"
        return Verdict(nuisance, False, reason, without.gaps, beside.gaps), {}
    return Verdict(nuisance, True, "left-out halves of sweeps are predicted better with it", *gaps), scatter


def _numbers(some: Iterable[Nuisance]) -> set[str]:
    return {name for nuisance in some for name in nuisance.numbers}


def halves_of_runs(points: Points) -> np.ndarray:
    """Index (n,) of the half of its run in which each point lies: below or above the middle of the sideslip or camber range.

    The two halves share the tyre's state but not their angles, so an improvement cannot come from details of one half's curve.
    """
    out = np.empty(len(points), dtype=int)
    for k, rows in enumerate(points.rows_of_sweeps.values()):
        angle = max((points.alpha[rows], points.gamma[rows]), key=np.ptp)
        out[rows] = 2 * k + (angle > 0.5 * (angle.min() + angle.max()))
    return out


def _steps(left: Sequence[Nuisance], chosen: Sequence[Nuisance]) -> Iterator[tuple[Nuisance, ...]]:
    """Candidates for the next step: each influence, paired with the one that it needs if that is not modelled yet."""
    there = {nuisance.id for nuisance in chosen}
    by_id = {nuisance.id: nuisance for nuisance in left}
    for nuisance in left:
        if not nuisance.after or nuisance.after in there:
            yield (nuisance,)
        elif nuisance.after in by_id:
            yield (by_id[nuisance.after], nuisance)


def _named(key: str) -> str:
    return next(nuisance.name for nuisance in NUISANCES if nuisance.id == key)


def _refitted(model: NearSolution, added: Sequence[Nuisance]) -> NearSolution:
    """The model with further influences, refitted from its current values."""
    problem = model.problem
    more = (number for nuisance in added for number in nuisance.free(problem.points, {}))
    numbers = problem.starting_here([*model.numbers, *more])
    found = solve(problem.free([number.name for number in numbers]), numbers)
    return NearSolution(problem.with_values(found.values), numbers, (*model.chosen, *added))


def _said(config: Config, nuisance: Nuisance) -> str:
    """The setting of [fit] as written in the file."""
    given = getattr(config.fit, nuisance.key)
    return f"[fit] {nuisance.key} = {str(given).lower() if isinstance(given, bool) else repr(given)}"
