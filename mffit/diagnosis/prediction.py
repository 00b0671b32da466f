"""Selection of effects by prediction of left-out sweeps, for a model with smooth model error."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mffit import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem, refitted
from mffit.effects import Effect
from mffit.left_out import moved_without, needed_fall, over_scatter
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True)
class Predicted(ReadOnlyArrays):
    """Sum of squared prediction errors of every left-out group of points."""

    chi2: np.ndarray  #: (s, c) by group and channel

    @property
    def total(self) -> float:
        """Sum over groups and channels."""
        return float(np.sum(self.chi2))

    def falls(self, other: Predicted, channel: int | None = None) -> float:
        """Mean improvement by ``other`` in standard errors over the groups, for all channels or the index ``channel``."""
        change = self.chi2 - other.chi2
        return over_scatter(np.sum(change, axis=1) if channel is None else change[:, channel])


class LeftOutPrediction:
    """Prediction of left-out sweeps to first order, with every number re-estimated without them.

    ``problem`` supplies the weights of the readings, ``noise`` their pure scatter if it differs.
    """

    def __init__(self, problem: DiagnosisProblem, inexact: Inexactness, noise: Noise | None = None) -> None:
        self.problem, self.inexact = problem, inexact
        used, n = problem.noise.used, len(problem.points)
        scatter = (noise or problem.noise).u[used] / problem.noise.u[used]
        self.channel = used // n
        self.of_noise = np.bincount(self.channel, scatter**2, minlength=len(problem.channels))
        numbers, self.sweep = np.unique(problem.points.sweep[used % n], return_inverse=True)
        self.sweeps = len(numbers)
        columns = inexact.columns(problem.points, problem.start, problem.channels)
        self._asked: tuple[Hypothesis, np.ndarray, np.ndarray] | None = None
        self.joint = problem.seen_through(problem.noise.sharing(columns))

    def of(self, hypothesis: Hypothesis, *more: np.ndarray) -> Predicted:
        """The prediction with the numbers of a hypothesis free, and with further columns of changes (c n, k)."""
        C, r = self._whitened(hypothesis)
        if more:
            C = np.column_stack([C, self.problem.noise.whiten(np.column_stack(more))])
        information, gradient = np.eye(C.shape[1]) + C.T @ C, -C.T @ r
        square = np.zeros((self.sweeps, len(self.problem.channels)))
        for k, of_sweep in enumerate(square):
            rows = np.flatnonzero(self.sweep == k)
            error = r[rows] - C[rows] @ moved_without(C[rows], -r[rows], information, gradient)
            of_sweep += np.bincount(self.channel[rows], error**2, minlength=len(of_sweep))
        return Predicted(square)

    def _whitened(self, hypothesis: Hypothesis) -> tuple[np.ndarray, np.ndarray]:
        """Whitened changes (m, k) by the numbers of a hypothesis, and its residual (m,); the last ones are cached."""
        if self._asked is None or self._asked[0] is not hypothesis:
            problem, state = self.problem, hypothesis.state
            columns = [self.inexact.columns(problem.points, state, problem.channels)]
            columns += [groups[0] for groups in problem.columns(state, hypothesis.effects).values()]
            self._asked = hypothesis, problem.noise.whiten(np.column_stack(columns)), problem.whitened(state)
        return self._asked[1:]

    def beyond_noise(self, predicted: Predicted) -> np.ndarray:
        """By channel, misfit (c,) beyond the noise."""
        return np.maximum(predicted.chi2.sum(axis=0) - self.of_noise, 0.0)

    def without(self, chosen: Hypothesis, effect: Effect) -> Hypothesis:
        """The hypothesis without one of its effects, refitted."""
        return refitted(self.joint, chosen, chosen.others(effect))


def chosen_by_prediction(prediction: LeftOutPrediction, candidates: Sequence[Effect]) -> Hypothesis:
    """The effects found by forward selection: each step adds the one that predicts left-out sweeps best, if significantly.

    All channels count together. An effect that a later one makes superfluous is dropped.
    """
    current, left = prediction.problem.null, list(candidates)
    needed = needed_fall(len(candidates))
    if prediction.sweeps < constants.FEWEST_SWEEPS_TO_PREDICT:
        return current
    while left:
        added = _best_addition(prediction, current, left, needed)
        if added is None:
            break
        left.remove(added)
        current = prediction.joint.fit((*current.effects, added), current.numbers)
        for effect in current.effects[:-1]:
            without = prediction.without(current, effect)
            if prediction.of(without).falls(prediction.of(current)) < needed:
                current = without
    return current


def _best_addition(
    prediction: LeftOutPrediction, current: Hypothesis, candidates: Sequence[Effect], needed: float
) -> Effect | None:
    """The candidate that reduces the misfit of left-out sweeps most, if substantially and significantly; None without any."""
    before = prediction.of(current)
    most, best = constants.LEAST_PREDICTED_SHARE * float(prediction.beyond_noise(before).sum()), None
    for effect, groups in prediction.problem.columns(current.state, candidates).items():
        for columns in groups:
            after = prediction.of(current, columns)
            gain = before.total - after.total
            if gain > most and before.falls(after) > needed:
                most, best = gain, effect
    return best


@dataclass(frozen=True, slots=True)
class Judged:
    """Support of an effect by left-out sweeps."""

    confidence: float
    """Share of the misfit beyond the noise that it removes, in the channel where it removes most."""
    tied: tuple[Hypothesis, ...]  #: with another effect in its place, not significantly worse


def judged(
    prediction: LeftOutPrediction, chosen: Hypothesis, effect: Effect, rivals: Sequence[Effect]
) -> Judged:
    """The support of a chosen effect, from a comparison with its absence and with rivals in its place.

    Every channel has its own formulae, so misfit in one channel does not count against an effect on another. A rival is tied only
    if it is not significantly worse both in total and in the channel that the effect explains most.
    """
    without, present = prediction.without(chosen, effect), prediction.of(chosen)
    removed = np.maximum(np.sum(prediction.of(without).chi2 - present.chi2, axis=0), 0.0)
    most = int(np.argmax(removed))
    taken, left = float(removed[most]), float(prediction.beyond_noise(present)[most])
    tied = []
    others = [e for e in rivals if e not in chosen.effects]
    for rival, groups in prediction.problem.columns(without.state, others).items():
        near = min((prediction.of(without, columns) for columns in groups), key=lambda p: p.total)
        if max(near.falls(present), near.falls(present, most)) < constants.TWO_SIGMA:
            tied.append(prediction.joint.fit((*without.effects, rival), without.numbers))
    return Judged(taken / max(taken + left, 1e-9), tuple(tied))
