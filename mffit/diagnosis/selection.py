"""Selection of effects by evidence: forward steps, each followed by a backward check."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.problem import DiagnosisProblem, refitted
from mffit.effects import Effect
from mffit.rig import Simulation
from tir.parameters import BY_NAME

Ids = frozenset[str]


@dataclass(frozen=True, slots=True)
class ForwardStep:
    """One forward step: every candidate in addition to the effects accepted before."""

    before: Hypothesis
    trials: tuple[Hypothesis, ...]  #: best first, each with one effect more than ``before``
    threshold: float  #: required gain of log evidence
    start: Simulation  #: the given simulation

    @property
    def best(self) -> Hypothesis:
        return self.trials[0]

    @property
    def gain(self) -> float:
        return self.best.log_evidence - self.before.log_evidence

    @property
    def passes(self) -> bool:
        return self.gain > self.threshold

    def weights(self) -> dict[str, float]:
        """Posterior weight by effect id, "none" included; the prior probability is divided equally among the effects."""
        logs = {}
        for trial in self.trials:
            newest, choice = trial.effects[-1], math.log(len(self.trials))
            logs[newest.id] = trial.log_evidence + log_prior(newest, self.start) - choice
        logs["none"] = self.before.log_evidence
        top = max(logs.values())
        total = sum(math.exp(v - top) for v in logs.values())
        return {name: math.exp(v - top) / total for name, v in logs.items()}


def log_prior(effect: Effect, start: Simulation) -> float:
    """Log prior of an effect, which ranks effects that the data hardly separate.

    A coefficient that is exactly zero in the given model was never identified, so it is more likely to be missing than others.
    """
    if effect.kind != "tyre" or not all(name in BY_NAME for name in effect.parameters):
        return effect.prior
    unidentified = all(float(start.values[name]) == 0.0 for name in effect.parameters)
    return effect.prior + (1.0 if unidentified else -1.0) * constants.UNIDENTIFIED_LOG_ODDS


def price(candidates: int) -> float:
    """Log evidence that an effect must add to be accepted and kept: a penalty for the number of candidates, and a margin."""
    return math.log(max(candidates, 1)) + constants.EVIDENCE_MARGIN


def select(
    problem: DiagnosisProblem, candidates: Sequence[Effect]
) -> tuple[DiagnosisProblem, Hypothesis, list[ForwardStep]]:
    """The problem, the selected effects, and the steps: forward selection, dropping an effect that became superfluous.

    A fit may end in a local optimum, so a set of effects may get different evidence when it is fitted again. A set that was
    replaced is therefore never entered again, which makes the search end. The covariance of the returned problem contains the
    most likely smooth structure for the selected effects.
    """
    problem = problem.at_amplitude(problem.null.smooth)
    current, steps, left = problem.null, [], set[Ids]()
    most = min(constants.MOST_EFFECTS_PER_CHANNEL * len(problem.channels), len(candidates))
    while len(current.effects) < most:
        step = forward_step(problem, current, candidates)
        steps.append(step)
        left.add(current.ids)
        if not step.passes or step.best.ids in left:
            break
        current = _without_needless(problem, step.best, step.threshold, left)
        beside = problem.at_amplitude(current.smooth)
        if beside is not problem:
            problem, current = beside, refitted(beside, current, current.effects)
    return problem, current, steps


def forward_step(problem: DiagnosisProblem, before: Hypothesis, candidates: Sequence[Effect]) -> ForwardStep:
    """Every candidate in addition to the accepted effects; the best ones to first order are fitted in full."""
    trials = []
    ranked = problem.promising(before, [e for e in candidates if e.id not in before.ids])
    for rank, (effect, gain) in enumerate(ranked):
        effects = (*before.effects, effect)
        if rank < constants.CANDIDATES_FITTED:
            trials.append(problem.fit(effects, before.numbers))
        else:  # to first order
            trials.append(replace(before, effects=effects, log_evidence=before.log_evidence + gain))
    trials.sort(key=lambda t: -(t.log_evidence + log_prior(t.effects[-1], problem.start)))
    return ForwardStep(
        before=before, trials=tuple(trials), threshold=price(len(candidates)), start=problem.start
    )


def _without_needless(
    problem: DiagnosisProblem, current: Hypothesis, needed: float, left: set[Ids]
) -> Hypothesis:
    """The hypothesis without the first effect that adds less than ``needed``; adds a replaced set to ``left``."""
    for effect in current.effects if len(current.effects) > 1 else ():
        rest = current.others(effect)
        if _ids(*rest) in left:
            continue
        without = refitted(problem, current, rest)
        if current.log_evidence - without.log_evidence < needed:
            left.add(current.ids)
            return without
    return current


def _ids(*effects: Effect) -> Ids:
    return frozenset(effect.id for effect in effects)
