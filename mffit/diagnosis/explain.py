"""Estimation of scatter, effects, inexact coefficients and unnamed structure, in turn until they are consistent."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.imitation import imitations
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.learning import beyond_memory, learned_noise, settled
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.prediction import LeftOutPrediction, chosen_by_prediction, judged
from mffit.diagnosis.problem import DiagnosisProblem, refitted
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
    search = Search(points, start, stated, tuple(candidates), inexact, declared)
    found = _of_fitted_model(search) if seen else _of_given_model(search)
    if found.chosen.effects and (found.bump.found or found.smooth.found):
        found = replace(found, imitated=imitations(found.problem, candidates))
    if seen and found.smooth.found:
        found = _predicting(found, inexact)
    return found.contested()


@dataclass(frozen=True, eq=False)
class Search:
    """Everything that stays the same while noise, effects and coefficients are estimated."""

    points: Points
    start: Simulation  #: the given model
    stated: Noise
    candidates: tuple[Effect, ...]
    inexact: Inexactness
    declared: Mapping[str, tuple[float, float]]

    @property
    def channels(self) -> tuple[str, ...]:
        return self.stated.channels

    @cached_property
    def misfit(self) -> np.ndarray:
        """Measured minus simulated (c n,) of the given model."""
        measured = np.concatenate([self.points.channel(name) for name in self.channels])
        return measured - self.start.predict(self.points, self.channels)

    @cached_property
    def coarse(self) -> np.ndarray:
        """Smooth structure (c n, k) that noise may not be taken for."""
        return smooth_basis(self.points, self.start.readings(self.points, self.channels))

    @cached_property
    def structure(self) -> np.ndarray:
        """Smooth structure (c n, k) that competes with the effects."""
        simulated = self.start.readings(self.points, self.channels)
        return smooth_basis(self.points, simulated, DIVISIONS_OF_A_SWEEP)

    def noise_around(self, state: Simulation, before: Noise, *, without_offsets: bool = False) -> Noise:
        """The noise that remains around a simulation; the search for it starts at the noise ``before``."""
        return learned_noise(
            self.stated.without(state.floats(self.points)),
            before,
            self.points,
            state,
            self.candidates,
            self.inexact,
            self.coarse,
            without_offsets=without_offsets,
        )

    def problem(self, state: Simulation, noise: Noise, effects: Sequence[Effect]) -> DiagnosisProblem:
        """The readings with coefficients linearised at a simulation and integrated out, in addition to smooth structure.

        The coefficients that ``effects`` have changed in the simulation are those of the given model.
        """
        changed = {name for effect in effects for name in effect.parameters}
        names = [name for name in self.inexact.names if name not in changed]
        numbers = {name: state.number(name, self.points) for name in names}
        at = self.start.with_numbers(numbers) if numbers and state is not self.start else self.start
        moved = None if at is self.start else self.inexact.moved(self.points, state, at, self.channels)
        shared = noise.sharing(self.inexact.columns(self.points, state, self.channels))
        beside = StructureBeside.over(self.structure, shared)
        return DiagnosisProblem(self.points, at, shared, self.declared, moved, beside)

    def all_at_once(self) -> tuple[Simulation, Noise]:
        """The simulation with all effects and coefficients fitted together, each held by its prior, and the noise around it.

        Whatever the library contains explains the readings there, so that nothing of it counts as noise.
        """
        alike = [e for e in self.candidates if not e.differs_by_run]  # the others are rivals of the noise
        state, noise = self.start, self.stated
        read: np.ndarray | None = None
        for _ in range(constants.MOST_EXPLANATION_ROUNDS):
            shared = noise.sharing(self.inexact.columns(self.points, state, self.channels))
            at: dict[str, float] = (
                {} if read is None else {n: state.number(n, self.points) for e in alike for n in e.parameters}
            )
            together = DiagnosisProblem(self.points, self.start, shared, self.declared).fit_together(
                alike, at
            )
            if self.inexact:
                plain = DiagnosisProblem(self.points, self.start, noise.alone(), self.declared)
                together, _ = plain.refine(together, self.inexact)
            before, state = read, together.state
            read = state.predict(self.points, self.channels)
            if before is not None:
                moved = rms(((read - before) / noise.u)[noise.used])
                if moved < constants.NOISE_MOVED:
                    break
            noise = self.noise_around(state, noise)
        return state, noise

    def selected(self, state: Simulation, noise: Noise, known: Hypothesis | None = None) -> Explanation:
        """The effects selected from nothing and from all effects at once, or from a ``known`` set; coefficients estimated."""
        visible = beyond_memory(noise, self.candidates)
        problem = self.problem(state, noise, self.candidates if known is None else known.effects)
        places = [problem.null]
        if known is None:
            places.append(problem.fit_together(visible))
        else:
            places.append(refitted(problem, known, [e for e in visible if e.id in known.ids]))
        return _selected(problem, visible, places).with_coefficients(self.inexact)


def _of_given_model(search: Search) -> Explanation:
    """The explanation of the gap of a model that was not fitted to these points."""
    state, noise = search.all_at_once()
    found = search.selected(state, noise)
    if noise.offset and not noise.offset & found.chosen.ids:
        # Offsets of runs that were assumed in the noise but are not named are noise.
        noise = search.noise_around(found.without_run_offsets, noise, without_offsets=True)
        found = search.selected(found.refined.state, noise, found.chosen)
    if search.inexact:  # coefficients act otherwise where only the named effects act with them
        found = search.selected(found.refined.state, noise, found.chosen)
    return found


def _of_fitted_model(search: Search) -> Explanation:
    """The explanation of the gap of a model that was fitted to these points."""
    noise, found, without_offsets = search.noise_around(search.start, search.stated), None, False
    for _ in range(constants.MOST_EXPLANATION_ROUNDS):
        last, found = (
            found,
            search.selected(
                search.start if found is None else found.refined.state,
                noise,
                None if found is None else found.chosen,
            ),
        )
        if rms(search.misfit / noise.u) > constants.MISFIT_AT_NOISE:
            found = replace(found, misfit=search.misfit)
        if (
            found.smooth.found
        ):  # left-out sweeps decide; the noise hardly matters against the misfit of the given model
            break
        if last is not None and found.chosen.ids == last.chosen.ids:
            break
        lost = bool(noise.offset) and not noise.offset & found.chosen.ids
        without_offsets, before = without_offsets or lost, noise
        noise = search.noise_around(found.without_run_offsets, noise, without_offsets=without_offsets)
        if last is not None and settled(before, noise) and not lost:
            break
    assert found is not None
    return found


def _selected(
    given: DiagnosisProblem, candidates: Sequence[Effect], places: Sequence[Hypothesis]
) -> Explanation:
    """The selected effects, in competition with unnamed structure, without those of low certainty."""
    problem, chosen = select(given, candidates, places)
    bumps = bump_scan(problem.points, problem.noise)
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
            > constants.TWO_SIGMA * refined.stderr.get(name, 0.0)
            for name in effect.parameters
        )

    kept = tuple(effect for effect in found.chosen.effects if is_left(effect))
    if len(kept) == len(found.chosen.effects):
        return found
    return significant(found.only(kept).with_coefficients(inexact), inexact)


def only_first(found: Explanation, inexact: Inexactness) -> Explanation:
    """The explanation with only the effect that explains most."""
    return found.only(found.chosen.effects[:1]).with_coefficients(inexact)
