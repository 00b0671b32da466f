"""The record of a diagnosis, made from an explanation, with every effect compared with its rivals."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.config import Config, axis_signs
from mffit.diagnosis import constants, wording
from mffit.diagnosis.bumps import Bump
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.limits import limits
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import DiagnosisNote, HardlyThisTyre, NoiseBeyondStated
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.repair import Repair
from mffit.diagnosis.result import AcceptedEffect, Diagnosis
from mffit.diagnosis.selection import ForwardStep
from mffit.diagnosis.tails import outlying
from mffit.diagnosis.ties import separation
from mffit.diagnosis.validation import Gap, gap
from mffit.diagnosis.where import Region, where
from mffit.effects import Effect
from mffit.points import Points
from mffit.rig import Readings, Simulation
from mffit.suspicion import Outlier, outliers
from tir import Tyre
from tir.parameters import BY_NAME


def named_effects(found: Explanation, given: DiagnosisProblem) -> tuple[AcceptedEffect, ...]:
    """The records of all accepted effects, each judged together with the others."""
    return tuple(_found(found, effect, given) for effect in found.chosen.effects)


def answer(
    found: Explanation,
    named: Sequence[AcceptedEffect],
    repair: Repair,
    given: DiagnosisProblem,
    tyre: Tyre,
    config: Config,
    notes: Sequence[DiagnosisNote],
    candidates: Sequence[Effect],
    alternatives: Mapping[str, float],
    gap_before: Gap,
) -> Diagnosis:
    """The record of an explanation.

    ``found`` is the explanation that left-out sweeps confirm, with the ``named`` effects and the confidence of the
    ``alternatives`` by id; ``given`` is the problem of the given model; ``gap_before`` is the gap of all uncorrected readings.
    """
    points, chosen, scatter = given.points, found.chosen, found.scatter
    before = given.predict(given.start)
    explained = given.predict(found.refined.state) if chosen.effects or found.coefficients else before
    done = repair.explanation
    after = given.predict(done.refined.state) if done.chosen.effects or done.coefficients else before
    hardly = any(isinstance(note, HardlyThisTyre | NoiseBeyondStated) for note in notes)
    unexplained = found.bump.found or found.smooth.found or hardly
    known = {i for one in named for i in (one.effect.id, *one.tied_with)}
    corrected = _corrected(tyre, done)
    diagnosis = Diagnosis(
        headline="",
        points=points,
        noise=scatter,
        before=before,
        after=after,
        gap_before=gap_before,
        gap_after=gap(given.measured - after, scatter),
        gap_named=gap(given.measured - explained, scatter),
        validation=repair.validation,
        where=where(points, given.measured - before, scatter),
        effects=tuple(_with_repair(one, done) for one in named),
        alternatives=alternatives,
        steps=tuple(found.steps),
        unexplained=unexplained,
        unexplained_where=_remaining(found, given.measured - explained) if unexplained else (),
        bump=found.bump if found.bump.found else None,
        smooth=found.smooth if found.smooth.found else None,
        outliers=_outliers(points, explained, scatter),
        coefficients=dict(done.coefficients),
        limits=limits(found.problem, chosen, candidates, known),
        given=given.start,
        state=done.refined.state,
        signs=axis_signs(config),
        tyre=tyre if repair.keeps_file else corrected,
        with_terms=corrected if repair.keeps_file else None,
        notes=tuple(notes),
        model_after=f"{config.tyre.name}.tir",
    )
    return replace(diagnosis, headline=wording.headline(diagnosis))


def _with_repair(named: AcceptedEffect, done: Explanation) -> AcceptedEffect:
    """The record, with the numbers of the repair if the effect is repaired."""
    if named.effect not in done.chosen.effects:
        return replace(named, repaired=False)
    numbers, stderr = done.refined.numbers, done.refined.stderr
    return replace(named, parameters={n: (numbers[n], stderr.get(n, 0.0)) for n in named.parameters})


def _remaining(found: Explanation, residual: np.ndarray) -> tuple[Region, ...]:
    """Regions that remain unexplained, the bump first."""
    regions = where(found.problem.points, residual, found.scatter)[: constants.MOST_UNEXPLAINED_REGIONS]
    return (_bump_region(found.bump), *regions) if found.bump.found else regions


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
    usual = noise.u * np.sqrt(noise.weight)
    off = np.abs(np.concatenate([points.channel(name) for name in noise.channels]) - after)
    used = usual.copy()
    used[[i for i in outlying(noise) if off[i] > constants.DIAGNOSED_OUTLIER_RATIO * usual[i]]] = np.inf
    return outliers(points, *(Readings.split(rows, noise.channels) for rows in (usual, used, after)))


def _found(found: Explanation, effect: Effect, given: DiagnosisProblem) -> AcceptedEffect:
    """The record of one accepted effect, judged together with all other accepted ones."""
    problem, chosen, steps = found.problem, found.chosen, found.steps
    alone = len(chosen.effects) == 1
    step = next(
        (s for s in steps if s.best.effects[-1].id == effect.id),
        steps[min(len(steps), len(chosen.effects)) - 1],
    )
    tied, confidence, together = _judged(found, effect, step)
    noise = {name: problem.noise.typical(name) for name in problem.channels}
    separations = [separation(problem.points, chosen, t, noise) for t in tied]
    with_it = found.refined.state if alone else _without_later(found, effect, step)
    numbers, stderr = found.refined.numbers, found.refined.stderr
    return AcceptedEffect(
        effect=effect,
        confidence=confidence,
        together=together,
        parameters={n: (numbers[n], stderr.get(n, 0.0)) for n in effect.parameters},
        before={n: given.start.number(n, given.points) for n in effect.parameters},
        gap_after=gap(problem.measured - problem.predict(with_it), found.scatter),
        tied=tuple(rival.effects[-1] for rival in tied),
        separation=min(separations, key=lambda s: s.chi2, default=None),
        T_ref=chosen.state.faults["T_ref_degC"] if "temperatures" in effect.needs else None,
    )


def _without_later(found: Explanation, effect: Effect, step: ForwardStep) -> Simulation:
    """The simulation with an effect and the effects accepted before it."""
    if not found.coefficients:
        return step.best.state
    start, points = found.problem.start, found.problem.points
    later = found.chosen.effects[found.chosen.effects.index(effect) + 1 :]
    given = {name: start.number(name, points) for one in later for name in one.parameters}
    return found.refined.state.with_numbers(given)


class Judgement(NamedTuple):
    """The comparison of an effect with its rivals."""

    tied: Sequence[Hypothesis]  #: equally good explanations with another effect in its place
    confidence: float
    together: float  #: confidence in this effect or one of the tied ones that are not likelier


def _judged(found: Explanation, effect: Effect, step: ForwardStep) -> Judgement:
    """The confidence in an effect, and its ties."""
    if effect.id in found.predicted:  # unnamed structure leaves evidence too weak to decide
        tied, known = found.predicted[effect.id].tied, found.confidence(effect)
        return Judgement(tied, known / (1.0 + len(tied)), known)
    rivals = _rivals(found.problem, found.chosen, effect, step)
    tied = tuple(rival for rival in rivals if _tied(found.chosen, rival))
    weight = {rival.ids: math.exp(min(-_lead(found.chosen, rival, rival in tied), 50.0)) for rival in rivals}
    known, total = found.confidence(effect), 1.0 + sum(weight.values())
    together = 1.0 + sum(weight[rival.ids] for rival in tied if weight[rival.ids] <= 1.0)
    return Judgement(tied, tempered(known / total), tempered(known * together / total))


def _tied(chosen: Hypothesis, rival: Hypothesis) -> bool:
    """Whether a rival explains the readings equally well.

    That is so if the evidence hardly differs, or if it differs moderately between effects that these readings are not expected to
    separate. A rival that the likelihood does not exclude is tied as well: priors alone do not separate effects.
    """
    lead = chosen.log_evidence - rival.log_evidence
    alike = chosen.apart(rival) < constants.SEPARATING_CHI2
    near = lead < (-math.log(constants.TIE_EXCLUDED_BY_CHANCE) if alike else constants.TIED_EVIDENCE)
    return near or not chosen.excludes(rival, constants.TIE_EXCLUDED_BY_CHANCE)


def _lead(chosen: Hypothesis, rival: Hypothesis, tied: bool) -> float:
    """Gain of log evidence over a rival; over a tied one at most the gain of log likelihood, which decides about ties."""
    lead = chosen.log_evidence - rival.log_evidence
    return min(lead, max(chosen.ahead(rival), 0.0)) if tied else lead


def _rivals(
    problem: DiagnosisProblem, chosen: Hypothesis, effect: Effect, step: ForwardStep
) -> list[Hypothesis]:
    """Refitted explanations in which another of a step's best candidates replaces one effect."""
    others = chosen.others(effect)
    kept = chosen.numbers_of(others)
    return [
        problem.fit((*others, trial.effects[-1]), kept)
        for trial in step.trials[: constants.CANDIDATES_FITTED]
        if trial.effects[-1].id not in chosen.ids
    ]


def not_accepted(steps: Sequence[ForwardStep], chosen: Hypothesis) -> dict[str, float]:
    """Weights of the effects that were not accepted, from the first step if an effect was accepted, else from the last.

    Empty if left-out sweeps decided otherwise than the evidence.
    """
    if not steps:
        return {}
    weights = steps[0 if chosen.effects else -1].weights()
    if chosen.effects and max(weights, key=weights.__getitem__) not in chosen.ids:
        return {}
    return {
        name: weight
        for name, weight in weights.items()
        if name not in chosen.ids and name != "none" and weight > constants.LEAST_ALTERNATIVE
    }


def _corrected(tyre: Tyre, found: Explanation) -> Tyre:
    """The property file with the estimated coefficients, each with its reason in the comment."""
    of_tyre = {name: number for name, number in found.coefficients.items() if name in BY_NAME}
    changes = {name: value for name, (value, _) in of_tyre.items()}
    status = {name: wording.adjusted(float(tyre[name]), u) for name, (_, u) in of_tyre.items()}
    for effect in found.chosen.effects:
        for name in effect.parameters:
            if name in BY_NAME:
                changes[name] = found.refined.numbers[name]
                error = found.refined.stderr.get(name, 0.0)
                status[name] = wording.status(effect, float(tyre[name]), error)
    return tyre.replace(**changes).annotate(status=status) if changes else tyre


def tempered(weight: float) -> float:
    """The weight of an explanation among all others, its log odds divided by ``LOG_ODDS_DIVISOR``."""
    if not 0.0 < weight < 1.0:
        return min(max(weight, 0.0), 1.0)
    odds = (weight / (1.0 - weight)) ** (1.0 / constants.LOG_ODDS_DIVISOR)
    return odds / (1.0 + odds)
