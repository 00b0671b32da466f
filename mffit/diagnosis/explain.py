"""Estimation of scatter, effects, inexact coefficients and unnamed structure, in turn until they are consistent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.imitation import imitations
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.learning import beyond_memory, learned_noise, settled
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.prediction import LeftOutPrediction, chosen_by_prediction, judged
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.selection import select
from mffit.diagnosis.smooth import StructureBeside, smooth_basis
from mffit.effects import Effect
from mffit.linearised.constants import DIVISIONS_OF_A_SWEEP
from mffit.points import Points
from mffit.rig import Simulation
from mffit.scatter import rms


def explain(
    points: Points,
    start: Simulation,
    stated: Noise,
    candidates: Sequence[Effect],
    inexact: Inexactness,
    declared: Mapping[str, tuple[float, float]],
    *,
    seen: bool = False,
) -> Explanation:
    """The explanation of the readings.

    ``declared`` has the value and standard uncertainty of each declared rig error. ``seen``: the model was fitted to these
    points, so model error remains as smooth structure, which is no evidence against an effect.
    """
    channels = stated.channels
    simulated = start.readings(points, channels)
    coarse, basis = smooth_basis(points, simulated), smooth_basis(points, simulated, DIVISIONS_OF_A_SWEEP)
    measured = np.concatenate([points.channel(name) for name in channels])
    misfit = measured - start.predict(points, channels)
    found: Explanation | None = None
    at, noise, without_offsets = start, stated, False
    for _ in range(constants.MOST_EXPLANATION_ROUNDS):
        lost = found is not None and bool(noise.offset) and not noise.offset & found.chosen.ids
        if (
            found is not None
            and not (lost or inexact)
            and all(e.differs_by_run for e in found.chosen.effects)
        ):
            break  # the scatter was already estimated from these residuals
        # Offsets of runs were assumed in the noise but not selected as effects: re-estimate the noise without them.
        without_offsets = without_offsets or lost
        before, state = noise, start if found is None else found.without_run_offsets
        noise = learned_noise(
            stated, before, points, state, candidates, inexact, coarse, without_offsets=without_offsets
        )
        around_start = bool(inexact) and at is start
        if found is not None and settled(before, noise) and not (around_start or lost):
            break
        offset = None
        if found is not None and inexact:
            # The influence of a coefficient depends on the rest of the model: linearise again at the last estimate.
            at = start.with_numbers({name: value for name, (value, _) in found.coefficients.items()})
            offset = inexact.moved(points, found.refined.state, at, channels)
        columns = inexact.columns(points, start if found is None else found.refined.state, channels)
        noise_of_all = noise.sharing(columns)
        # Coefficients linearised at the start leave errors like unnamed structure, so it competes from the second round on.
        beside = None if found is None and inexact and not seen else StructureBeside.over(basis, noise_of_all)
        problem = DiagnosisProblem(points, at, noise_of_all, declared, offset, beside)
        last = found
        visible = beyond_memory(noise, candidates)
        found = _selected(problem, visible)
        if seen and rms(misfit / noise.u) > constants.MISFIT_AT_NOISE:
            found = replace(found, misfit=misfit)
        found = found.with_coefficients(inexact)
        if seen and found.smooth.found:
            break  # left-out sweeps decide; the noise hardly matters against the misfit of the given model
        if last is not None and found.chosen.ids == last.chosen.ids:
            break
    assert found is not None
    if found.chosen.effects and (found.bump.found or found.smooth.found):
        found = replace(found, imitated=imitations(found.problem, candidates))
    return (
        _predicting(found, beyond_memory(noise, candidates), inexact)
        if seen and found.smooth.found
        else found
    )


def _selected(given: DiagnosisProblem, candidates: Sequence[Effect]) -> Explanation:
    """The selected effects, in competition with unnamed structure, without those of low certainty."""
    problem, chosen, steps = select(given, candidates)
    bumps = bump_scan(problem.points, problem.noise)
    found = Explanation(problem, chosen, steps, bumps.best(chosen), bumps, refined=chosen)
    while given.beside is not None and found.chosen.effects:
        certainty = {effect: found.certainty(effect) for effect in found.chosen.effects}
        least = min(certainty, key=lambda effect: certainty[effect])
        if certainty[least] >= constants.LEAST_CERTAINTY:
            break
        found = found.only(found.chosen.others(least))
    return found


def _predicting(found: Explanation, candidates: Sequence[Effect], inexact: Inexactness) -> Explanation:
    """The explanation with effects chosen by prediction of left-out sweeps.

    For a model with smooth model error, next to which evidence can hardly decide between effects.
    """
    prediction = LeftOutPrediction(found.plain, inexact, found.independent)
    chosen = chosen_by_prediction(prediction, candidates)
    support = {effect.id: judged(prediction, chosen, effect, candidates) for effect in chosen.effects}
    tied = [rival for one in support.values() for rival in one.tied]
    best = min((chosen, *tied), key=lambda one: prediction.of(one).total)
    if best is not chosen:  # the selection was to first order; a refitted rival predicts better
        chosen = best
        support = {effect.id: judged(prediction, chosen, effect, candidates) for effect in chosen.effects}
    found = replace(found.choosing(chosen), predicted=support)
    return significant(found.with_coefficients(inexact), inexact)


def significant(found: Explanation, inexact: Inexactness) -> Explanation:
    """The explanation without effects whose numbers are not significant once coefficients are estimated with them."""
    problem, refined = found.problem, found.refined

    def is_left(effect: Effect) -> bool:
        return any(
            abs(refined.numbers[name] - problem.start.number(name, problem.points))
            > constants.TWO_SIGMA * refined.stderr.get(name, 0.0)
            for name in effect.parameters
        )

    kept = tuple(effect for effect in found.chosen.effects if is_left(effect))
    if len(kept) == len(found.chosen.effects):
        return found
    return significant(found.only(kept).with_coefficients(inexact), inexact)


def only_first(found: Explanation, inexact: Inexactness) -> Explanation:
    """The explanation with only the effect that explains most."""
    chosen = found.problem.fit(found.steps[0].best.effects[:1])
    return replace(found.choosing(chosen), steps=found.steps[:2]).with_coefficients(inexact)
