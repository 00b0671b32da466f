"""The record of a diagnosis, made from an explanation, with every effect compared with its rivals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.config import Config, axis_signs
from mffit.constants import FALSE_ALARM, MOST, NAMED_IN_SENTENCE, PREDICTION_FALSE_ALARM
from mffit.diagnosis import constants, wording
from mffit.diagnosis.bumps import Bump
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.inexact import EXACT
from mffit.diagnosis.limits import Limit, limits
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import DiagnosisNote, MoreThanBuild
from mffit.diagnosis.odd_level import OddLevel
from mffit.diagnosis.problem import DiagnosisProblem, refitted
from mffit.diagnosis.repair import Confirmed, Repair
from mffit.diagnosis.rest import Answer, Rest
from mffit.diagnosis.result import AcceptedEffect, Diagnosis, apart
from mffit.diagnosis.search import Search
from mffit.diagnosis.tails import weights
from mffit.diagnosis.ties import separation
from mffit.diagnosis.validation import Gap, gap, validate
from mffit.diagnosis.where import Region, where
from mffit.effects import Effect
from mffit.points import Points
from mffit.rig import Readings
from mffit.rig_errors import T_REF
from mffit.scatter import beyond
from mffit.suspicion.outliers import Outlier, outliers
from tir import Tyre
from tir.mode import with_turn_slip
from tir.parameters import BY_NAME


def named_effects(
    config: Config, found: Explanation, given: DiagnosisProblem, alternatives: Mapping[str, float]
) -> tuple[AcceptedEffect, ...]:
    """The records of the accepted effects, each judged together with the others.

    One that is practically excluded together with all that are tied with it is not even suspected.
    """
    u = _stated_u(found, found)
    every = (_found(config, found, effect, u, given) for effect in found.chosen.effects)
    return tuple(one for one in every if one.confidence_of_tie(alternatives) > PREDICTION_FALSE_ALARM)


def answered(
    rest: Sequence[Rest],
    named: Sequence[AcceptedEffect],
    alternatives: Mapping[str, float],
    notes: Sequence[DiagnosisNote] = (),
) -> Answer:
    """The answer: what remains decides first, then ties and confidences of what is named, then what the build states."""
    if rest:
        return Answer.UNKNOWN
    if not named:
        likely = max(alternatives.values(), default=0.0) > MOST
        likely |= any(isinstance(one, MoreThanBuild | OddLevel) for one in notes)
        return Answer.UNDECIDED if likely else Answer.NOTHING
    open_ = any(one.tied for one in named) or not any(one.repaired for one in named)
    return Answer.UNDECIDED if open_ else Answer.FOUND


def answer(
    search: Search, confirmed: Confirmed, repair: Repair, notes: Sequence[DiagnosisNote], gap_before: Gap
) -> Diagnosis:
    """The record of an explanation; ``gap_before`` is the gap of all uncorrected readings."""
    found, given, named, done = confirmed.found, confirmed.given, confirmed.named, repair.explanation
    scatter, u = found.scatter, _stated_u(done, found)
    before = given.predict(given.start)
    explained, after = (
        given.predict(one.refined.state) if one.chosen.effects or one.coefficients else before
        for one in (found, done)
    )
    odd = [one.place for one in notes if isinstance(one, OddLevel) and one.region]
    delivers = any(effect.kind == "tyre" and effect.in_file for effect in done.chosen.effects)
    moved = any(name in BY_NAME for name in done.coefficients)
    again = moved and (bool(done.chosen.effects) or not search.asked.seen)
    corrected = _corrected(search.tyre, done, u)
    diagnosis = Diagnosis(
        headline="",
        reasons=(),
        answer=answered(confirmed.rest, named, confirmed.alternatives, notes),
        rest=confirmed.rest,
        name=search.config.tyre.name,
        points=given.points,
        noise=scatter,
        before=before,
        after=after,
        gap_before=gap_before,
        gap_after=gap(given.measured - after, scatter),
        gap_named=gap(given.measured - (explained if named else after), scatter),
        validation=repair.validation,
        where=where(given.points, given.measured - before, scatter),
        effects=tuple(_with_repair(one, done, u) for one in named),
        alternatives=confirmed.alternatives,
        contests=found.contests or ((found.further,) if found.further else ()),
        unexplained_where=_remaining(found, given.measured - explained, odd) if confirmed.rest or odd else (),
        bump=found.bump if found.bump.found else None,
        smooth=found.smooth if found.smooth.found else None,
        outliers=_outliers(given.points, explained, scatter),
        coefficients=dict(done.coefficients),
        limits=_limits(confirmed, search.candidates),
        given=given.start,
        state=done.refined.state,
        signs=axis_signs(search.config),
        delivers=delivers,
        tyre=corrected if delivers else search.tyre,
        with_terms=corrected if again and not delivers else None,
        notes=tuple(notes),
        apart=apart(given.points, given.start, done.refined.state, scatter.channels) if delivers else (),
        seen=search.asked.seen,
    )
    return replace(diagnosis, headline=wording.headline(diagnosis), reasons=wording.reasons(diagnosis))


def _limits(confirmed: Confirmed, candidates: Sequence[Effect]) -> tuple[Limit, ...]:
    """The limits of the candidates that are neither named, nor tied with a named one, nor likely."""
    known = {i for one in confirmed.named for i in (one.effect.id, *one.tied_with)}
    known |= {name for name, confidence in confirmed.alternatives.items() if confidence > MOST}
    return limits(confirmed.found.problem, confirmed.found.chosen, candidates, known)


def _with_repair(named: AcceptedEffect, done: Explanation, u: Mapping[str, float]) -> AcceptedEffect:
    """The record, with the numbers of the repair if the effect is repaired."""
    if named.effect not in done.chosen.effects:
        return replace(named, repaired=False)
    numbers = done.refined.numbers
    return replace(named, parameters={n: (numbers[n], u[n]) for n in named.parameters})


def _remaining(found: Explanation, residual: np.ndarray, odd: Sequence[Region]) -> tuple[Region, ...]:
    """Regions that remain unexplained: the ``odd`` level of a setting first, then the bump."""
    regions = where(found.problem.points, residual, found.scatter)[:NAMED_IN_SENTENCE]
    bump = [_bump_region(found.bump)] if found.bump.found else []
    return (*odd, *bump, *regions)


def _bump_region(bump: Bump) -> Region:
    return Region(
        channel=bump.channel,
        region=bump.region,
        bias=bump.amplitude,
        z=float(np.sign(bump.amplitude) * np.sqrt(2.0 * max(bump.gain, 0.0))),
    )


def _outliers(points: Points, after: np.ndarray, noise: Noise) -> tuple[Outlier, ...]:
    """The readings with nearly zero weight that are also far from the explained model."""
    if noise.weight is None:
        return ()
    usual, away = noise.u * np.sqrt(noise.weight), np.abs(noise.measured(points) - after)
    ratio = np.full(len(points), beyond(PREDICTION_FALSE_ALARM / len(noise.used)))
    least = np.concatenate([weights(ratio, one.tails, 1.0) for one in noise.scatter.values()])
    used = np.where((noise.weight < least) & (away > ratio[0] * usual), np.inf, usual)
    return outliers(points, *(Readings.split(rows, noise.channels) for rows in (usual, used, after)))


def _found(
    config: Config, found: Explanation, effect: Effect, u: Mapping[str, float], given: DiagnosisProblem
) -> AcceptedEffect:
    """The record of one accepted effect, judged together with all other accepted ones; ``u`` by number."""
    problem, chosen = found.problem, found.chosen
    tied, _, confidence, together = _judged(found, effect)
    noise = {name: problem.noise.typical(name) for name in problem.channels}
    separations = [separation(config, problem.points, chosen, t, noise) for t in tied]
    with_it = _with_earlier(found, effect)
    numbers, freed = found.refined.numbers, found.freed if with_it is found.refined else EXACT
    return AcceptedEffect(
        effect=effect,
        confidence=confidence,
        together=together,
        parameters={n: (numbers[n], u[n]) for n in effect.parameters},
        before={n: given.start.number(n, given.points) for n in effect.parameters},
        gap_after=gap(given.measured - given.predict(with_it.state), found.scatter),
        held_out=validate(given, with_it, freed, weights=found.plain.noise).gap_after,
        tied=tuple(rival.effects[-1] for rival in tied),
        separation=min(separations, key=lambda s: s.chi2, default=None),
        T_ref=chosen.state.faults[T_REF] if "temperatures" in effect.needs else None,
    )


def _with_earlier(found: Explanation, effect: Effect) -> Hypothesis:
    """The hypothesis with an effect and those that explain more than it, fitted without the others."""
    chosen = found.chosen
    count = chosen.effects.index(effect) + 1
    return (
        found.refined
        if count == len(chosen.effects)
        else refitted(found.plain, chosen, chosen.effects[:count])
    )


class Judgement(NamedTuple):
    """The comparison of an effect with its rivals."""

    tied: Sequence[Hypothesis]  #: equally good explanations with another effect in its place
    weights: Sequence[float]  #: probabilities of the tied ones, relative to that of the effect
    confidence: float
    together: float  #: confidence in this effect or one of the tied ones that are not likelier


def _judged(found: Explanation, effect: Effect) -> Judgement:
    """The confidence in an effect, and its ties."""
    step = found.contests[found.chosen.effects.index(effect)]
    rivals = [trial for trial in step.fitted if trial.effects[-1].id not in found.chosen.ids]
    tied = tuple(rival for rival in rivals if _tied(found.chosen, rival))
    weight = {rival.ids: math.exp(min(-_lead(found.chosen, rival, rival in tied), 50.0)) for rival in rivals}
    known, total = found.confidence(effect), 1.0 + sum(weight.values())
    of_tied = [weight[rival.ids] for rival in tied]
    together = 1.0 + sum(w for w in of_tied if w <= 1.0)
    return Judgement(tied, of_tied, tempered(known / total), tempered(known * together / total))


def _stated_u(done: Explanation, found: Explanation) -> dict[str, float]:
    """The standard uncertainty of every number of ``done``, with what explanations tied with ``found`` leave open of it.

    An effect that takes the place of a tied one moves the numbers of the other effects.
    """
    chosen, stderr = found.chosen, done.refined.stderr
    square = {name: stderr.get(name, 0.0) ** 2 for name in done.refined.numbers}
    for effect in chosen.effects:
        of = _judged(found, effect)
        for rival, weight in zip(of.tied, of.weights, strict=True):
            for name in square.keys() & chosen.numbers.keys() & rival.numbers.keys():
                moved = rival.numbers[name] - chosen.numbers[name]
                square[name] += weight / (1.0 + sum(of.weights)) * moved**2
    return {name: math.sqrt(x) for name, x in square.items()}


def _tied(chosen: Hypothesis, rival: Hypothesis) -> bool:
    """Whether a rival explains the readings equally well.

    That is so if the evidence hardly differs, or if it differs moderately between effects that these readings are not expected to
    separate. A rival that the likelihood does not exclude is tied as well: priors alone do not separate effects. A rival that is
    far ahead is no tie, but better.
    """
    lead, most = chosen.log_evidence - rival.log_evidence, -math.log(constants.TIE_EXCLUDED_BY_CHANCE)
    alike = chosen.apart(rival) < constants.SEPARATING_CHI2
    near = lead < (most if alike else constants.TIED_EVIDENCE)
    return lead > -most and (near or not chosen.excludes(rival, constants.TIE_EXCLUDED_BY_CHANCE))


def _lead(chosen: Hypothesis, rival: Hypothesis, tied: bool) -> float:
    """Gain of log evidence over a rival; over a tied one at most the gain of log likelihood, which decides about ties."""
    lead = chosen.log_evidence - rival.log_evidence
    return min(lead, max(chosen.ahead(rival), 0.0)) if tied else lead


def not_accepted(found: Explanation) -> dict[str, float]:
    """Weights of the effects that explain something and were not accepted, the largest of all places.

    A place that would go to none of the accepted effects is left out: there, another place or a declaration decided.
    """
    chosen, out = found.chosen, dict[str, float]()
    assert found.further is not None
    for one in (*found.contests, found.further):
        weights = one.weights()
        if one is not found.further and max(weights, key=weights.__getitem__) not in chosen.ids:
            continue
        for trial in one.trials:
            name = trial.effects[-1].id
            explains = trial.log_evidence > one.before.log_evidence
            if name not in chosen.ids and explains and weights[name] > FALSE_ALARM:
                out[name] = max(weights[name], out.get(name, 0.0))
    return out


def _corrected(tyre: Tyre, found: Explanation, u: Mapping[str, float]) -> Tyre:
    """The property file with the estimated coefficients, each with its reason in the comment; ``u`` by number."""
    of_tyre = {name: number for name, number in found.coefficients.items() if name in BY_NAME}
    changes = {name: value for name, (value, _) in of_tyre.items()}
    status = {name: wording.adjusted(float(tyre[name]), own) for name, (_, own) in of_tyre.items()}
    for effect in found.chosen.effects:
        for name in effect.parameters:
            if name in BY_NAME:
                changes[name] = found.refined.numbers[name]
                status[name] = wording.status(effect, float(tyre[name]), u[name])
    if any(effect.switches for effect in found.chosen.effects):
        changes["USE_MODE"] = with_turn_slip(float(tyre["USE_MODE"]))
    return tyre.replace(**changes).annotate(status=status) if changes else tyre


def tempered(weight: float) -> float:
    """The weight of an explanation among all others, its log odds divided by ``LOG_ODDS_DIVISOR``."""
    if not 0.0 < weight < 1.0:
        return min(max(weight, 0.0), 1.0)
    odds = (weight / (1.0 - weight)) ** (1.0 / constants.LOG_ODDS_DIVISOR)
    return odds / (1.0 + odds)
