"""The numbers of an explanation, estimated together with what is uncertain of model and rig, and their standard errors.

The estimate is that of a build: every reading counts as independent, with the misfit that remains as noise, so that the file is
the best that the formula can do. So are the standard errors (:mod:`mffit.fit.told`): those of repeated campaigns, in which noise,
model error and the errors of the rig are drawn anew.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.constants import TWO_SIGMA
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.inexact import EXACT, known_around, slopes_of, spread_of
from mffit.diagnosis.odd_level import OddLevel, odd_level
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.search import Search
from mffit.fit.stages import is_asymmetry
from mffit.fit.told import Told, numbers_told
from mffit.linearised.components import CERTAIN_EVIDENCE
from mffit.linearised.gaussian import Informed
from mffit.numbers import Numbers
from mffit.points.like import curves
from mffit.rig import Simulation
from mffit.rig_errors import error_of
from mffit.scatter import rms


def told(found: Explanation, search: Search) -> Explanation:
    """The explanation with its numbers :func:`estimated`, without effects that what the formula misses imitates.

    Beside structure, evidence alone does not tell an effect from it: the estimate must also differ from the given value by more
    than two of its standard errors. Calibrations, which look like the tyre, count as exact there, as they do for the evidence,
    and so do coefficients that a build fitted to this tyre.
    """
    done = estimated(found, search)
    unknown = done.smooth.is_strange or done.bump.found  # which lowers every confidence
    if unknown or not any(done.problem.amplitude.values()) or not done.chosen.effects:
        return done
    beside = _beside(done, search)
    fitted = search.inexact.names if search.asked.coefficients is not None else ()
    exact = {n for n in beside.names if n in fitted or ((e := error_of(n)) is not None and e.is_gain)}
    u = _standard_errors(done, done.plain, done.refined, beside.given(exact), done.freed.names)
    points, start, numbers = done.problem.points, search.start, done.refined.numbers
    away = {
        effect: max(
            (abs(numbers[n] - start.number(n, points)) / u[n] for n in effect.parameters if u.get(n)),
            default=math.inf,
        )
        for effect in done.chosen.effects
    }
    least = min(away, key=away.__getitem__)
    if away[least] > TWO_SIGMA:
        return done
    others = tuple(effect for effect in found.candidates if effect is not least)
    return told(replace(found.only(found.chosen.others(least)), candidates=others), search)


def _beside(found: Explanation, search: Search) -> Numbers:
    """The prior of all that may move in addition to the numbers of the effects."""
    return search.beside.without({n for effect in found.chosen.effects for n in effect.parameters})


def estimated(found: Explanation, search: Search) -> Explanation:
    """The explanation with the numbers of its effects estimated together with coefficients and rig errors that may move."""
    noise, points = found.independent, found.problem.points
    left = noise.measured(points) - found.refined.state.predict(points, noise.channels)
    plain = DiagnosisProblem(points, search.start, noise.at_least(left), found.problem.declared)
    beside = _beside(found, search)
    freed = _freed(found, beside, search.inexact.names)
    refined, coefficients = plain.refine(found.chosen, freed)
    u = {**refined.stderr, **_standard_errors(found, plain, refined, beside, freed.names)}
    return replace(
        found,
        refined=replace(refined, stderr={name: u[name] for name in refined.stderr}),
        coefficients={name: (value, u[name]) for name, (value, _) in coefficients.items()},
        freed=freed,
        strained=_strained(plain, found.chosen, search),
        weights=plain.noise,
    )


def _freed(found: Explanation, beside: Numbers, known: Sequence[str]) -> Numbers:
    """The numbers ``beside`` the effects that are estimated with them; all others stay as given, with their uncertainty.

    Calibrations look like the tyre and stay, and on a flat track the zeros, which the coefficients take up. Beside a model
    error, on a disc the asymmetries and all else move if the evidence tells them from it, as in a build. Without model error
    and effects the evidence decides. ``known`` are names of the numbers that may be wrong in the given model.
    """
    points = found.problem.points
    rig = {n: e for n in beside.names if n not in known and (e := error_of(n)) is not None}
    free = beside.given({n for n, e in rig.items() if e.is_gain or not points.curved})
    evidence = _Evidence.of(found, free)
    if not any(found.problem.amplitude.values()):
        return free if found.chosen.effects or evidence.of_names(free.names) > 0.0 else EXACT
    odd = {n for n in free.names if points.curved and is_asymmetry(n)}
    groups = odd, {*free.names} - odd
    return free.given({n for g in groups if evidence.of_names(g) <= CERTAIN_EVIDENCE for n in g})


class _Evidence(NamedTuple):
    """The readings' evidence for numbers within their priors, beside the model error of an explanation."""

    known: Numbers  #: all that may move, the numbers of the effects included
    slopes: np.ndarray  #: (m, k) whitened derivatives of the readings by them
    missed: np.ndarray  #: (m, s) whitened changes by the model error
    residual: np.ndarray  #: (m,) whitened, at the prior means

    @classmethod
    def of(cls, found: Explanation, free: Numbers) -> _Evidence:
        """The evidence at the numbers of an explanation, with those ``free`` in addition to its effects'."""
        problem, structure = found.plain, found.problem.structure
        known, missed = problem.uncertain(found.refined, free), structure.columns(found.problem.amplitude)
        slopes, residual = problem.linear(found.refined, known)
        return cls(known, problem.noise.whiten(slopes), problem.noise.whiten(missed), residual)

    def of_names(self, names: Collection[str]) -> float:
        """Gain of log evidence by the named numbers."""
        return self._gain(self.known) - self._gain(self.known.given(names))

    def _gain(self, numbers: Numbers) -> float:
        own = self.slopes[:, self.known.rows(numbers.names)] @ numbers.root
        return Informed.of_rows(np.hstack([own, self.missed]), self.residual).gain


def with_given_coefficients(found: Explanation, search: Search) -> Simulation:
    """The simulation with the effects and the errors of the rig estimated within their declaration.

    The coefficients stay as given, and calibrations, which look like the tyre, as declared.
    """
    plain = DiagnosisProblem(found.problem.points, search.start, found.plain.noise, found.problem.declared)
    held = {n for n in search.beside.names if (e := error_of(n)) is None or e.is_gain}
    return plain.refine(found.chosen, search.beside.without(held))[0].state


def beyond_build(found: Explanation, search: Search) -> dict[str, tuple[float, float]]:
    """By channel, what a built file misses beyond the noise and what its build left, if it is more than twice that."""
    plain, out = found.plain, dict[str, tuple[float, float]]()
    if not search.asked.left:
        return out
    away = plain.measured - plain.predict(with_given_coefficients(found, search))
    missed = plain.noise.by_channel(np.where(np.isfinite(plain.noise.u), away, np.nan))
    u = found.scatter.by_channel(found.scatter.u)
    for name, left in search.asked.left.items():
        if name in missed:
            beyond = rms(missed[name]) ** 2 - rms(np.where(np.isfinite(u[name]), u[name], np.nan)) ** 2
            if beyond > (TWO_SIGMA * left) ** 2:
                out[name] = math.sqrt(beyond), left
    return out


def odd_runs(found: Explanation, search: Search, *, doubted: bool) -> OddLevel | None:
    """The runs that read a share more or less than the file of a build says, or the corrected model.

    In the runs at one level a build may leave more than in all together: unless something else makes the model ``doubted``, its
    model error counts as well, although it is known.
    """
    asked, plain = search.asked, found.plain
    left = {n: x if doubted else math.hypot(x, asked.missed.get(n, 0.0)) for n, x in asked.left.items()}
    state = with_given_coefficients(found, search) if left else found.refined.state
    simulated = plain.predict(state)
    return odd_level(plain.points, plain.measured - simulated, simulated, found.scatter, left)


def _strained(plain: DiagnosisProblem, chosen: Hypothesis, search: Search) -> bool:
    """Whether the coefficients of a build would have to change forces by more than their uncertainty and its misfit explain."""
    left = search.asked.left
    if not left or not search.inexact.names:
        return False
    given, free = (plain.refine(chosen, one)[0].state for one in (EXACT, search.inexact))
    spread = spread_of(search.inexact, given, plain.points, plain.channels)
    moved, u = (plain.noise.by_channel(x) for x in (plain.predict(free) - plain.predict(given), spread))
    return any(rms(moved[n]) > TWO_SIGMA * math.hypot(left[n], rms(u[n])) for n in left if n in moved)


def _standard_errors(
    found: Explanation, plain: DiagnosisProblem, refined: Hypothesis, beside: Numbers, freed: Sequence[str]
) -> dict[str, float]:
    """By name, standard errors of the refined numbers and of those ``beside``, of which all but the ``freed`` are held."""
    points, weights, scatter = plain.points, plain.noise, found.independent
    known = plain.uncertain(refined, beside)
    held = set(beside.names) - set(freed)
    order = sorted(range(len(known.names)), key=lambda k: known.names[k] not in held)
    names = [known.names[k] for k in order]
    unit = np.linalg.qr(known.root[order].T)[1].T  # triangular: the last columns move no held number
    white = weights.whiten(slopes_of(refined.state, points, names, plain.channels) @ unit)
    noisy = white * (weights.beyond_weights * scatter.u[weights.used] / weights.u[weights.used])[:, None]
    left = np.nan_to_num(plain.measured - plain.predict(refined.state))
    missed = weights.whiten(found.problem.structure.estimated(found.problem.amplitude, left))
    of, none = curves(points)[weights.used % len(points)], np.zeros(len(names))
    told = [
        Told(white[own].T @ white[own], noisy[own].T @ noisy[own], white[own].T @ missed[own], none)
        for own in (of == k for k in np.unique(of))
    ]
    units = replace(known_around(dict.fromkeys(names, 0.0), np.ones(len(names))), held=frozenset(held))
    covariance = numbers_told(told, units).covariance
    variance = np.sum((unit @ covariance) * unit, axis=1)
    return dict(zip(names, np.sqrt(np.maximum(variance, 0.0)).tolist(), strict=True))
