"""What a diagnosis says: the record of an explanation, every effect judged beside its rivals."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mffit.config import Config, axis_signs
from mffit.diagnosis import wording
from mffit.diagnosis.candidates import Hypothesis, Problem
from mffit.diagnosis.confidence import tempered
from mffit.diagnosis.explain import Explanation
from mffit.diagnosis.limits import limits
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import HardlyThisTyre, Note
from mffit.diagnosis.result import Diagnosis, Found
from mffit.diagnosis.scatter import WILD, wild
from mffit.diagnosis.selection import TIE, Step
from mffit.diagnosis.ties import separation
from mffit.diagnosis.unknown import Bump
from mffit.diagnosis.validate import Validation, gap
from mffit.diagnosis.where import Region, where
from mffit.effects import Effect
from mffit.points import Points
from mffit.suspicion import Outlier, outliers
from tir import Tyre
from tir.parameters import BY_NAME


def answer(
    found: Explanation,
    given: Problem,
    tyre: Tyre,
    config: Config,
    validation: Validation,
    notes: Sequence[Note],
    candidates: Sequence[Effect],
) -> Diagnosis:
    """The record of an explanation.

    Parameters
    ----------
    found : what explains the readings, as far as left-out sweeps confirm it
    given : readings and simulation before
    tyre, config : the model that was given
    validation : what left-out sweeps say
    notes : remarks so far
    candidates : effects that the data can show
    """
    points, chosen, scatter = given.points, found.chosen, found.scatter
    before, after = given.start.predict(points), found.refined.state.predict(points)
    if not chosen.effects and not found.coefficients:
        after = before
    residual_before, residual_after = given.measured - before, given.measured - after
    hardly = any(isinstance(note, HardlyThisTyre) for note in notes)
    unexplained = found.bump.found or found.smooth.found or hardly
    remaining = where(points, residual_after, scatter) if unexplained else ()
    named = tuple(_found(found, effect, given) for effect in chosen.effects)
    known = {i for one in named for i in (one.effect.id, *one.tied_with)}
    return Diagnosis(
        points=points,
        noise=scatter,
        before=before,
        after=after,
        gap_before=gap(residual_before, scatter),
        gap_after=gap(residual_after, scatter),
        validation=validation,
        where=where(points, residual_before, scatter),
        effects=named,
        alternatives=_alternatives(found.steps, chosen),
        steps=tuple(found.steps),
        unexplained=unexplained,
        unexplained_where=((_bump_region(found.bump),) if found.bump.found else ()) + remaining[:4],
        bump=found.bump if found.bump.found else None,
        smooth=found.smooth if found.smooth.found else None,
        outliers=_outliers(points, after, scatter),
        coefficients=dict(found.coefficients),
        limits=limits(found.problem, chosen, candidates, known),
        given=given.start,
        state=found.refined.state,
        signs=axis_signs(config),
        tyre=_corrected(tyre, found),
        notes=tuple(notes),
        model_after=f"{config.tyre.name}.tir",
    )


def _outliers(points: Points, after: np.ndarray, noise: Noise) -> tuple[Outlier, ...]:
    """The readings that lost nearly all their weight, and stand out of what was found too."""
    if noise.weight is None:
        return ()
    usual = noise.u * np.sqrt(noise.weight)
    off = np.abs(np.concatenate([points.Fy, points.Mz]) - after)
    used = usual.copy()
    used[[i for i in wild(noise) if off[i] > WILD * usual[i]]] = np.inf
    Fy, Mz = zip(np.split(usual, 2), np.split(used, 2), np.split(after, 2), strict=True)
    return outliers(points, *((a, b) for a, b in zip(Fy, Mz, strict=True)))


def _found(found: Explanation, effect: Effect, given: Problem) -> Found:
    """What is said of one accepted effect: judged beside all the others that were accepted."""
    problem, chosen, steps = found.problem, found.chosen, found.steps
    others = tuple(e for e in chosen.effects if e.id != effect.id)
    step = next(
        (s for s in steps if s.best.effects[-1].id == effect.id),
        steps[min(len(steps), len(chosen.effects)) - 1],
    )
    if effect.id in found.predicted:  # evidence says little beside structure that may be anything
        tied = list(found.predicted[effect.id].tied)
        confidence = found.certainty(effect) / (1.0 + len(tied))
    else:
        rivals = _rivals(problem, chosen, step, others)
        tied = [r for r in rivals if chosen.log_evidence - r.log_evidence < TIE]
        share = 1.0 / (1.0 + sum(math.exp(min(r.log_evidence - chosen.log_evidence, 50.0)) for r in rivals))
        confidence = tempered(found.certainty(effect) * share)
    separations = [separation(problem.points, chosen, t, problem.noise.Fy, problem.noise.Mz) for t in tied]
    upto = found.refined if not others else step.best
    numbers, stderr = found.refined.numbers, found.refined.stderr
    return Found(
        effect=effect,
        confidence=confidence,
        parameters={n: (numbers[n], stderr.get(n, 0.0)) for n in effect.parameters},
        before={n: given.start.number(n, given.points) for n in effect.parameters},
        gap_after=gap(problem.measured - upto.state.predict(problem.points), found.scatter),
        tied_with=tuple(t.effects[-1].id for t in tied),
        separation=min(separations, key=lambda s: s.chi2, default=None),
        T_ref=chosen.state.faults.T_ref_degC if "temperatures" in effect.needs else None,
    )


def _rivals(problem: Problem, chosen: Hypothesis, step: Step, others: tuple[Effect, ...]) -> list[Hypothesis]:
    """Explanations with another effect in the place of one, refitted beside the others, but for those without a chance."""
    ids = {e.id for e in chosen.effects}
    names = {name for e in others for name in e.parameters}
    kept = {name: value for name, value in chosen.numbers.items() if name in names}
    hopeless = 40.0 + (0.5 * abs(step.gain) if others else 0.0)
    out = []
    for trial in step.trials:
        rival = trial.effects[-1]
        if rival.id in ids or step.best.log_evidence - trial.log_evidence > hopeless:
            continue
        out.append(problem.fit((*others, rival), kept))
    return out


def _alternatives(steps: Sequence[Step], chosen: Hypothesis) -> dict[str, float]:
    """Weights of what was not accepted: in the first step if something was, else in the last.

    None where the choice was made by prediction against the weight of evidence.
    """
    if not steps:
        return {}
    accepted = {effect.id for effect in chosen.effects}
    source = steps[0 if chosen.effects else -1].weights()
    if accepted and max(source, key=source.__getitem__) not in accepted:
        return {}
    return {name: w for name, w in source.items() if name not in accepted and name != "none" and w > 1e-4}


def _bump_region(bump: Bump) -> Region:
    return Region(
        bump.channel,
        bump.region,
        bump.amplitude,
        float(np.sign(bump.amplitude) * np.sqrt(2.0 * max(bump.gain, 0.0))),
    )


def _corrected(tyre: Tyre, found: Explanation) -> Tyre:
    """The property file with the tyre effects as coefficients and their reason in the comments."""
    changes, status = {}, {}
    for name, (value, error) in found.coefficients.items():
        changes[name], status[name] = value, wording.adjusted(float(tyre[name]), error)
    for effect in found.chosen.effects:
        for name in effect.parameters:
            if name in BY_NAME:
                changes[name] = found.refined.numbers[name]
                error = found.refined.stderr.get(name, 0.0)
                status[name] = wording.status(effect.id, float(tyre[name]), error)
    return tyre.replace(**changes).annotate(status=status) if changes else tyre
