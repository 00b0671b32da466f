"""Estimation of scatter, effects, inexact coefficients and unnamed structure, in turn until they are consistent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit import progress as steps
from mffit.diagnosis import constants
from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.estimated import told
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.imitation import imitations
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem, refitted
from mffit.diagnosis.scatter import beyond_memory, learned_noise
from mffit.diagnosis.search import Search
from mffit.diagnosis.selection import select
from mffit.effects import Effect
from mffit.rig import Simulation
from mffit.scatter import rms


def explain(search: Search) -> Explanation:
    """The explanation of the readings."""
    state, noise = _all_at_once(search)
    found = _selected_around(search, state, noise)
    if noise.offset and not noise.offset & found.chosen.ids:
        # Offsets of runs that were assumed in the noise but are not named are noise.
        search = replace(search, candidates=tuple(e for e in search.candidates if e.id not in noise.offsets))
        noise = replace(learned_noise(search, found.chosen.state), offsets=noise.offsets)
        found = _selected_around(search, found.refined.state, noise, found.chosen)
    if search.inexact.names:  # coefficients act otherwise where only the named effects act with them
        found = _selected_around(search, found.refined.state, noise, found.chosen)
    if found.chosen.effects and (found.bump.found or found.smooth.is_strange):
        found = replace(found, imitated=imitations(found.problem, search.candidates))
    search.progress(steps.SIZING)
    return told(found, search)


def _all_at_once(search: Search) -> tuple[Simulation, Noise]:
    """The simulation with all effects and coefficients fitted together, each held by its prior, and the noise around it.

    Whatever the library contains explains the readings there, so that nothing of it counts as noise.
    """
    points, start, declared = search.points, search.start, search.declared
    alike = [e for e in search.candidates if not e.differs_by_run]  # the others are rivals of the noise
    state, noise = start, search.stated
    read: np.ndarray | None = None
    search.progress(steps.FITTING_ALL)
    for _ in range(constants.MOST_EXPLANATION_ROUNDS):
        shared = search.shared(noise, state)
        at: dict[str, float] = (
            {} if read is None else {n: state.number(n, points) for e in alike for n in e.parameters}
        )
        together = DiagnosisProblem(points, start, shared, declared).fit_together(alike, at)
        if search.inexact.names:
            plain = DiagnosisProblem(points, start, noise.alone(), declared)
            together, _ = plain.refine(together, search.inexact)
        before, state = read, together.state
        read = state.predict(points, search.channels)
        if before is not None:
            moved = rms(((read - before) / noise.u)[noise.used])
            if moved < 1.0:  # over the noise: it stays the same
                break
        if before is None:
            search.progress(steps.NOISE)
        noise = learned_noise(search, state)
    return state, noise


def _selected_around(
    search: Search, state: Simulation, noise: Noise, known: Hypothesis | None = None
) -> Explanation:
    """The effects selected from nothing and from all effects at once, or from a ``known`` set; coefficients estimated."""
    search.progress(steps.CHOOSING if known is None else steps.CHOOSING_AGAIN)
    visible = beyond_memory(noise, search.candidates)
    problem = search.problem(state, noise, search.candidates if known is None else known.effects)
    places = [problem.null]
    if known is None:
        places.append(problem.fit_together(visible))
    else:
        places.append(refitted(problem, known, [e for e in visible if e.id in known.ids]))
    problem, chosen = select(problem, visible, places)
    search.progress(steps.WEIGHING if known is None else steps.WEIGHING_AGAIN)
    return _certain(problem, chosen, visible).with_coefficients(search.inexact)


def _certain(problem: DiagnosisProblem, chosen: Hypothesis, candidates: Sequence[Effect]) -> Explanation:
    """The chosen effects in competition with unnamed structure, without those of low certainty."""
    structure = {name: of.axes for name, (_, of) in problem.structure.directions.items()}
    bumps = bump_scan(problem.points, problem.noise, problem.structure.allowed, structure)
    best = bumps.best(chosen)
    found = Explanation(problem, chosen, tuple(candidates), best, bumps, refined=chosen).weighed()
    while min(found.certainty, default=1.0) < constants.LEAST_CERTAINTY:
        least = chosen.effects[found.certainty.index(min(found.certainty))]
        found = found.only(chosen.others(least)).weighed()
        chosen = found.chosen
    return found
