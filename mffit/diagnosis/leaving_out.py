"""Effects judged by what they predict of sweeps that were left out: where the model's own formulae cannot follow the points."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import norm

from mffit.diagnosis.candidates import Hypothesis, Problem
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.selection import MOST_EFFECTS
from mffit.effects import Effect

FALSE_ALARM = 0.01
"""Probability that chance alone lets any effect of the library pass (Bonferroni, one-sided)."""
WORTH = 0.02
"""Share of what left-out sweeps show beyond the noise that an effect must take to be named."""
WORSE = 2.0
"""Standard errors over the sweeps by which a prediction is worse than another."""
FEWEST_SWEEPS = 8
"""Fewer sweeps do not tell chance from a gain that all of them share."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """What a hypothesis predicts of every sweep from all others."""

    chi2: np.ndarray  #: (s, 2) by sweep and channel, Fy and Mz

    def falls(self, other: Predicted) -> float:
        """By how many standard errors over the sweeps ``other`` is nearer to the readings."""
        return _z(np.sum(self.chi2 - other.chi2, axis=1))

    def raised(self, other: Predicted) -> bool:
        """Whether ``other`` is farther off in a channel, beyond chance."""
        return any(_z(column) < -WORSE for column in (self.chi2 - other.chi2).T)


def _z(change: np.ndarray) -> float:
    error = float(np.std(change, ddof=1)) / np.sqrt(len(change))
    return float(np.mean(change)) / error if error > 0.0 else 0.0


class Prediction:
    """Left-out sweeps predicted to first order, every number estimated again without them.

    Parameters
    ----------
    problem : points, model and the scatter of the readings alone
    inexact : prior of the model's coefficients, which are estimated again as well
    """

    def __init__(self, problem: Problem, inexact: Inexactness) -> None:
        self.problem, self.inexact = problem, inexact
        used, n = problem.noise.used, len(problem.points)
        self.channel = (used >= n).astype(int)
        _, self.sweep = np.unique(problem.points.sweep[used % n], return_inverse=True)
        self.sweeps = int(self.sweep.max(initial=-1)) + 1
        columns = inexact.columns(problem.points, problem.start)
        self.joint = problem.seen_through(problem.noise.sharing(columns))

    def of(self, hypothesis: Hypothesis, *more: np.ndarray) -> Predicted:
        """With the numbers of a hypothesis free, and changes of the readings (2n, k) at their usual size."""
        problem, state = self.problem, hypothesis.state
        columns = [self.inexact.columns(problem.points, state), *more]
        columns += [groups[0] for groups in problem.columns(state, hypothesis.effects).values()]
        C = problem.noise.whiten(np.column_stack(columns))
        r = problem.whitened(state)
        A, b = C.T @ C + np.eye(C.shape[1]), C.T @ r
        chi2 = np.zeros((self.sweeps, 2))
        for k in range(self.sweeps):
            rows = np.flatnonzero(self.sweep == k)
            out = C[rows]
            error = r[rows] - out @ np.linalg.solve(A - out.T @ out, b - out.T @ r[rows])
            chi2[k] = np.bincount(self.channel[rows], error**2, minlength=2)
        return Predicted(chi2)


def chosen_by_prediction(prediction: Prediction, candidates: Sequence[Effect]) -> Hypothesis:
    """Forward steps: the effect that predicts left-out sweeps best, while the sweeps together gain beyond chance.

    Nothing is taken that is farther off in a channel; what another has made needless goes, and is not tried again.
    """
    current, new = prediction.problem.null, list(candidates)
    needed = norm.isf(FALSE_ALARM / max(len(candidates), 1))
    while prediction.sweeps >= FEWEST_SWEEPS and len(current.effects) < MOST_EFFECTS:
        before = prediction.of(current)
        open_ = max(float(np.sum(before.chi2)) - len(prediction.sweep), 0.0)
        best: tuple[float, Effect | None] = (WORTH * open_, None)
        for effect, groups in prediction.problem.columns(current.state, new).items():
            for columns in groups:
                after = prediction.of(current, columns)
                gain = float(np.sum(before.chi2 - after.chi2))
                if gain > best[0] and before.falls(after) > needed and not before.raised(after):
                    best = gain, effect
        if best[1] is None:
            break
        new.remove(best[1])
        current = prediction.joint.fit((*current.effects, best[1]), current.numbers)
        for effect in current.effects[:-1]:
            without = _without(prediction, current, effect)
            if prediction.of(without).falls(prediction.of(current)) < needed:
                current = without
    return current


def _without(prediction: Prediction, chosen: Hypothesis, effect: Effect) -> Hypothesis:
    """The hypothesis less one of its effects, fitted again."""
    others = tuple(e for e in chosen.effects if e is not effect)
    numbers = {n: chosen.numbers[n] for e in others for n in e.parameters}
    return prediction.joint.fit(others, numbers) if others else prediction.problem.null


@dataclass(frozen=True, slots=True)
class Judged:
    """What left-out sweeps say of one effect that was chosen by them."""

    confidence: float  #: share that it takes of what they show beyond the noise
    tied: tuple[Hypothesis, ...]  #: with another effect in its place, no worse beyond chance


def judged(prediction: Prediction, chosen: Hypothesis, effect: Effect, rivals: Sequence[Effect]) -> Judged:
    """Compare a chosen effect with its absence and with others in its place."""
    without, present = _without(prediction, chosen, effect), prediction.of(chosen)
    absent = float(np.sum(prediction.of(without).chi2))
    taken, left = absent - float(np.sum(present.chi2)), float(np.sum(present.chi2)) - len(prediction.sweep)
    tied = []
    others = [e for e in rivals if e not in chosen.effects]
    for rival, groups in prediction.problem.columns(without.state, others).items():
        near = min((prediction.of(without, g) for g in groups), key=lambda p: float(np.sum(p.chi2)))
        if near.falls(present) < WORSE:
            tied.append(prediction.joint.fit((*without.effects, rival), without.numbers))
    return Judged(max(taken, 0.0) / max(taken + max(left, 0.0), 1e-9), tuple(tied))
