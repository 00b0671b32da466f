"""An explanation of the readings, and the certainty of each of its effects."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from mffit.diagnosis.bumps import Bump, BumpScan
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.imitation import is_no_imitation
from mffit.diagnosis.inexact import EXACT
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem, refitted
from mffit.diagnosis.selection import Contest, contest
from mffit.diagnosis.smooth import Smooth
from mffit.effects import Effect
from mffit.linearised.chained import NO_MEMORY
from mffit.numbers import Numbers
from tir.frozen import ReadOnlyArrays


class WeighedPlace(NamedTuple):
    """The place of an effect among the others, compared with the best unnamed structure in it."""

    without: Hypothesis  #: the other effects, refitted
    against: float  #: log odds of the effect over unnamed structure, whatever remains beside it
    share: float  #: share of the misfit that the effect explains


@dataclass(frozen=True, slots=True)
class Explanation(ReadOnlyArrays):
    """Effects, unnamed structure, and the noise assumed for them."""

    problem: DiagnosisProblem  #: readings, model, and covariance including inexact coefficients
    chosen: Hypothesis
    candidates: tuple[Effect, ...]  #: the effects that competed
    bump: Bump  #: best local structure in the residual
    bumps: BumpScan
    refined: Hypothesis  #: the chosen effects, estimated together with the coefficients of the model
    coefficients: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Estimates of what is uncertain of model and rig: name -> (value, standard error)."""
    freed: Numbers = EXACT  #: prior of these numbers
    weights: Noise | None = None  #: noise of their estimate; None before it
    strained: bool = False  #: whether the coefficients of a build would have to move further than it explains
    places: tuple[WeighedPlace, ...] = ()  #: of each chosen effect, once they are weighed
    further: Contest | None = None  #: all candidates in addition to the chosen effects
    contests: tuple[Contest, ...] = ()  #: for each chosen effect, all candidates in its place
    imitated: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """(n,) for each effect, the share of its misfit that the best other effect would explain, see :func:`imitations`."""

    @property
    def smooth(self) -> Smooth:
        """Smooth structure found with the effects; part of the covariance if found."""
        return self.chosen.smooth

    @property
    def scatter(self) -> Noise:
        """The scatter of the readings alone."""
        return self.problem.noise.alone()

    @property
    def independent(self) -> Noise:
        """The scatter of the readings; without autocorrelation if structure remains, so that a model follows it if it can."""
        noise = self.scatter
        if not self.smooth.found:
            return noise
        scatter = {c: replace(s, memory=NO_MEMORY) for c, s in noise.scatter.items()}
        return replace(noise, scatter=scatter)

    @property
    def plain(self) -> DiagnosisProblem:
        """The problem in which coefficients are fitted instead of integrated out.

        Its covariance excludes smooth structure, because a model predicts best if it follows the readings closely.
        """
        return self.problem.seen_through(self.weights or self.independent)

    def only(self, effects: tuple[Effect, ...]) -> Explanation:
        """The explanation with some of its effects only, refitted, without estimated coefficients."""
        problem, chosen = self.problem.with_structure_of(refitted(self.problem, self.chosen, effects))
        best = self.bumps.best(chosen, problem.noise)
        new = replace(self, problem=problem, chosen=chosen, bump=best, refined=chosen)
        return replace(new, places=(), contests=(), weights=None)

    def contested(self) -> Explanation:
        """The explanation with all candidates tried in addition to the chosen effects, and in the place of each."""
        chosen, problem = self.chosen, self.problem
        places = self.places or self.weighed().places
        befores = (chosen if chosen.effects else problem.null, *(place.without for place in places))
        further, *contests = (contest(problem, one, self.candidates) for one in befores)
        return replace(self, places=places, further=further, contests=tuple(contests))

    def with_coefficients(self, inexact: Numbers) -> Explanation:
        """The explanation with all inexact coefficients estimated together with the effects: there it is linearised again."""
        return replace(self, refined=self.plain.refine(self.chosen, inexact)[0])

    def withdrawn(self) -> Explanation:
        """The explanation without effects and repair; the unnamed structure is still that found with the effects."""
        null = replace(self.problem.null, smooth=self.smooth)
        return replace(self, chosen=null, refined=null, coefficients={}, freed=EXACT, places=())

    def weighed(self) -> Explanation:
        """The explanation with every effect compared with the best unnamed structure in its place."""
        effects = self.chosen.effects
        left = self.left(self.chosen) if effects else 0.0
        return replace(self, places=tuple(self._place(effect, left) for effect in effects))

    @property
    def certainty(self) -> list[float]:
        """Probability of each effect against the best unnamed structure in its place, whatever remains beside it."""
        return [1.0 / (1.0 + math.exp(-place.against)) for place in self.places]

    def confidence(self, effect: Effect) -> float:
        """The certainty, reduced by the probability that the effect only imitates a cause outside the library.

        Unnamed structure shows that there is such a cause. The probability of imitation follows from a comparison: how well do
        other effects imitate each effect of the library if that one is removed?
        """
        k = self.chosen.effects.index(effect)
        outside, share = self.bump.found or self.smooth.is_strange, self.places[k].share
        return (is_no_imitation(share, self.imitated) if outside else share) * self.certainty[k]

    def _place(self, effect: Effect, left: float) -> WeighedPlace:
        """The place of an effect; ``left`` is what the best bump gains in addition to the chosen effects."""
        chosen = self.chosen
        without = refitted(self.problem, chosen, chosen.others(effect))
        gain = chosen.log_evidence - without.log_evidence
        against = gain + left - self.left(without) - math.log(max(len(self.candidates), 1))
        if effect.id in self.problem.noise.offsets:  # autocorrelated errors are another rival
            against = min(against, self.problem.noise.offsets[effect.id].beyond)
        open_ = left + (self.smooth.unexcused if self.smooth.is_strange else 0.0)
        explains = max(gain, chosen.alone - without.alone, 0.0)
        share = explains / (explains + open_) if open_ else 1.0
        return WeighedPlace(without, float(np.clip(against, -500.0, 500.0)), share)

    def left(self, hypothesis: Hypothesis) -> float:
        """Gain of log evidence by the best bump in addition to a hypothesis; at least 0."""
        problem, own = self.problem.with_structure_of(hypothesis)
        return max(self.bumps.best(own, problem.noise).gain, 0.0)
