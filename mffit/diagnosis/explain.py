"""Estimation of scatter, effects, inexact coefficients and unnamed structure, in turn until they are consistent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import MISFIT_AT_NOISE, TWO_SIGMA
from mffit.diagnosis import constants
from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.estimated import estimated
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.imitation import imitations
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.prediction import LeftOutPrediction, chosen_by_prediction, judged
from mffit.diagnosis.problem import DiagnosisProblem, refitted
from mffit.diagnosis.scatter import beyond_memory, learned_noise
from mffit.diagnosis.search import Search
from mffit.diagnosis.selection import select
from mffit.effects import Effect
from mffit.rig import Simulation
from mffit.scatter import rms


def explain(search: Search) -> Explanation:
    """The explanation of the readings.

    If the model was fitted to these points, model error remains as smooth structure, which does not count against an effect.
    """
    seen = search.asked.seen
    found = _of_fitted_model(search) if seen else _of_given_model(search)
    if found.chosen.effects and (found.bump.found or found.smooth.found):
        found = replace(found, imitated=imitations(found.problem, search.candidates))
    if seen and found.smooth.found:
        found = _predicting(found, search.inexact)
    return estimated(found, search).contested()


def _all_at_once(search: Search) -> tuple[Simulation, Noise]:
    """The simulation with all effects and coefficients fitted together, each held by its prior, and the noise around it.

    Whatever the library contains explains the readings there, so that nothing of it counts as noise.
    """
    points, start, declared = search.points, search.start, search.declared
    alike = [e for e in search.candidates if not e.differs_by_run]  # the others are rivals of the noise
    state, noise = start, search.stated
    read: np.ndarray | None = None
    for _ in range(constants.MOST_EXPLANATION_ROUNDS):
        shared = search.shared(noise, state)
        at: dict[str, float] = (
            {} if read is None else {n: state.number(n, points) for e in alike for n in e.parameters}
        )
        together = DiagnosisProblem(points, start, shared, declared).fit_together(alike, at)
        if search.inexact:
            plain = DiagnosisProblem(points, start, noise.alone(), declared)
            together, _ = plain.refine(together, search.inexact)
        before, state = read, together.state
        read = state.predict(points, search.channels)
        if before is not None:
            moved = rms(((read - before) / noise.u)[noise.used])
            if moved < 1.0:  # over the noise: it stays the same
                break
        noise = learned_noise(search, state)
    return state, noise


def _selected_around(
    search: Search, state: Simulation, noise: Noise, known: Hypothesis | None = None
) -> Explanation:
    """The effects selected from nothing and from all effects at once, or from a ``known`` set; coefficients estimated."""
    visible = beyond_memory(noise, search.candidates)
    problem = search.problem(state, noise, search.candidates if known is None else known.effects)
    places = [problem.null]
    if known is None:
        places.append(problem.fit_together(visible))
    else:
        places.append(refitted(problem, known, [e for e in visible if e.id in known.ids]))
    return _selected(problem, visible, places).with_coefficients(search.inexact)


def _of_given_model(search: Search) -> Explanation:
    """The explanation of the gap of a model that was not fitted to these points."""
    state, noise = _all_at_once(search)
    found = _selected_around(search, state, noise)
    if noise.offset and not noise.offset & found.chosen.ids:
        # Offsets of runs that were assumed in the noise but are not named are noise.
        noise = learned_noise(search, found.without_run_offsets, without_offsets=True)
        found = _selected_around(search, found.refined.state, noise, found.chosen)
    if search.inexact:  # coefficients act otherwise where only the named effects act with them
        found = _selected_around(search, found.refined.state, noise, found.chosen)
    return found


def _of_fitted_model(search: Search) -> Explanation:
    """The explanation of the gap of a model that was fitted to these points."""
    noise, found, without_offsets = learned_noise(search, search.start), None, False
    for _ in range(constants.MOST_EXPLANATION_ROUNDS):
        last, state = found, search.start if found is None else found.refined.state
        found = _selected_around(search, state, noise, None if found is None else found.chosen)
        if rms(search.misfit / noise.u) > MISFIT_AT_NOISE:
            found = replace(found, misfit=search.misfit)
        if found.smooth.found:
            break  # left-out sweeps decide; the noise hardly matters against the misfit of the given model
        if last is not None and found.chosen.ids == last.chosen.ids:
            break
        lost = bool(noise.offset) and not noise.offset & found.chosen.ids
        without_offsets = without_offsets or lost
        noise = learned_noise(search, found.without_run_offsets, without_offsets=without_offsets)
    assert found is not None
    return found


def _selected(
    given: DiagnosisProblem, candidates: Sequence[Effect], places: Sequence[Hypothesis]
) -> Explanation:
    """The selected effects, in competition with unnamed structure, without those of low certainty."""
    problem, chosen = select(given, candidates, places)
    bumps = bump_scan(problem.points, problem.noise, problem.structure.allowed)
    found = Explanation(problem, chosen, tuple(candidates), bumps.best(chosen), bumps, refined=chosen)
    while found.chosen.effects:
        certainty = {effect: found.certainty(effect) for effect in found.chosen.effects}
        least = min(certainty, key=lambda effect: certainty[effect])
        if certainty[least] >= constants.LEAST_CERTAINTY:
            break
        found = found.only(found.chosen.others(least))
    return found


def _predicting(found: Explanation, inexact: Inexactness) -> Explanation:
    """The explanation with effects chosen by prediction of left-out sweeps.

    For a model with smooth model error, next to which evidence can hardly decide between effects.
    """
    prediction, candidates = LeftOutPrediction(found.plain, inexact, found.independent), found.candidates
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
            > TWO_SIGMA * refined.stderr.get(name, 0.0)
            for name in effect.parameters
        )

    kept = tuple(effect for effect in found.chosen.effects if is_left(effect))
    if len(kept) == len(found.chosen.effects):
        return found
    return significant(found.only(kept).with_coefficients(inexact), inexact)
