"""Which effects the data call for: forward steps, exchange and backward check, on evidence."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from mffit.diagnosis.candidates import PROMISING, Hypothesis, Problem
from mffit.effects import Effect
from mffit.rig import Simulation

MOST_EFFECTS = 4
EXCHANGED = 4
"""Candidates that may take the place of an accepted effect: the best of the step, the others have no chance."""
EXCHANGE_GAIN = 1.0
"""Log evidence by which a set must be better than the one it takes the place of."""
FEWEST_FITTED = 4
"""Candidates of a step that are fitted in full in any case."""
CLOSE, HOPE = 0.1, 2.0
"""Gain to first order, relative to the largest and in log evidence, below which the others are not."""
MARGIN = 4.0
"""Log evidence an effect must bring beyond what picking the best of the whole list brings by chance."""
NEVER_IDENTIFIED = 1.0
"""Log prior odds of a coefficient at zero over rig effects, and of those over a coefficient that the model has."""
TIE = 1.5
"""Difference of log evidence below which two effects are not told apart."""


@dataclass(frozen=True, slots=True)
class Step:
    """One forward step: how every candidate did beside the effects accepted before."""

    before: Hypothesis
    trials: tuple[Hypothesis, ...]  #: best first, each with one effect more than ``before``
    threshold: float  #: gain of log evidence needed
    start: Simulation  #: the simulation as given

    @property
    def best(self) -> Hypothesis:
        return self.trials[0]

    @property
    def gain(self) -> float:
        return self.best.log_evidence - self.before.log_evidence

    @property
    def passes(self) -> bool:
        return self.gain > self.threshold

    def prior(self, trial: Hypothesis) -> float:
        """Log prior of the trial's newest effect."""
        return log_prior(trial.effects[-1], self.start)

    def weights(self) -> dict[str, float]:
        """Posterior weight per effect id, "none" included; the prior of each effect is one over the number of effects."""
        logs = {
            t.effects[-1].id: t.log_evidence + self.prior(t) - math.log(len(self.trials)) for t in self.trials
        }
        logs["none"] = self.before.log_evidence
        top = max(logs.values())
        total = sum(math.exp(v - top) for v in logs.values())
        return {name: math.exp(v - top) / total for name, v in logs.items()}


def log_prior(effect: Effect, start: Simulation) -> float:
    """What is known before the data: decides the order among effects that they hardly tell apart.

    A coefficient that the given model has at exactly zero was never identified and is likelier to be what is missing than
    one that the model already has.
    """
    if effect.kind != "tyre" or "turn_slip" in effect.parameters or "relaxation_m" in effect.parameters:
        return effect.prior
    unidentified = all(float(start.values[name]) == 0.0 for name in effect.parameters)
    return effect.prior + (NEVER_IDENTIFIED if unidentified else -NEVER_IDENTIFIED)


def forward_step(problem: Problem, before: Hypothesis, candidates: Sequence[Effect]) -> Step:
    """Try every candidate beside the accepted effects, all numbers refitted where that has any prospect."""
    taken = {effect.id for effect in before.effects}
    trials = []
    left = problem.promising(before, [e for e in candidates if e.id not in taken])
    for rank, (effect, gain) in enumerate(left):
        if rank < FEWEST_FITTED or (rank < PROMISING and gain > max(HOPE, CLOSE * left[0][1])):
            trials.append(problem.fit((*before.effects, effect), before.numbers))
        else:  # to first order
            effects, evidence = (*before.effects, effect), before.log_evidence + gain
            trials.append(replace(before, effects=effects, log_evidence=evidence))
    trials.sort(key=lambda t: -(t.log_evidence + log_prior(t.effects[-1], problem.start)))
    return Step(before, tuple(trials), price(len(candidates)), problem.start)


def price(candidates: int) -> float:
    """Log evidence that an effect must bring to be taken, and to be kept: the choice among all candidates, and a margin."""
    return math.log(max(candidates, 1)) + MARGIN


def select(problem: Problem, candidates: Sequence[Effect]) -> tuple[Hypothesis, list[Step]]:
    """Forward steps until nothing passes; after each, exchange and drop what became needless.

    Fits end in local optima, so that a set can look better or worse when it is met again. A set that was left for
    another is therefore never entered a second time, which ends the search after finitely many steps.
    """
    current, steps, left = problem.null, [], set[frozenset[str]]()
    while len(current.effects) < min(MOST_EFFECTS, len(candidates)):
        step = forward_step(problem, current, candidates)
        steps.append(step)
        left.add(ids(current))
        if not step.passes or ids(step.best) in left:
            break
        near = [trial.effects[-1] for trial in (*step.trials[:EXCHANGED], *steps[0].trials[:EXCHANGED])]
        current = _exchanged(problem, step.best, tuple(dict.fromkeys(near)), left)
        current = _without_needless(problem, current, step.threshold, left)
    return current, steps


def ids(hypothesis: Hypothesis) -> frozenset[str]:
    """The set of effects of a hypothesis, whatever their order."""
    return frozenset(effect.id for effect in hypothesis.effects)


def _exchanged(
    problem: Problem, current: Hypothesis, candidates: Sequence[Effect], left: set[frozenset[str]]
) -> Hypothesis:
    """Exchange single effects while that helps; adds to ``left`` what was given up."""
    for _ in range(2 if len(current.effects) > 1 else 0):
        best = current
        for i in range(len(current.effects)):
            rest = tuple(e for k, e in enumerate(current.effects) if k != i)
            new = [
                e for e in candidates
                if e not in current.effects and frozenset(o.id for o in (*rest, e)) not in left
            ]  # fmt: skip
            without = problem.fit(rest, _numbers_of(rest, current))
            lacks = best.log_evidence - without.log_evidence
            for other, gain in problem.promising(without, new):
                if (1.0 + CLOSE) * gain + HOPE < lacks:
                    continue
                trial = problem.fit((*rest, other), _numbers_of(rest, current))
                if trial.log_evidence > best.log_evidence + EXCHANGE_GAIN:
                    best = trial
        if best is current:
            break
        left.add(ids(current))
        current = best
    return current


def _without_needless(
    problem: Problem, current: Hypothesis, needed: float, left: set[frozenset[str]]
) -> Hypothesis:
    """Drop the first effect beside the others that brings less than ``needed``; adds to ``left`` what was given up."""
    for effect in current.effects if len(current.effects) > 1 else ():
        rest = tuple(e for e in current.effects if e.id != effect.id)
        if frozenset(e.id for e in rest) in left:
            continue
        without = problem.fit(rest, _numbers_of(rest, current))
        if current.log_evidence - without.log_evidence < needed:
            left.add(ids(current))
            return without
    return current


def _numbers_of(effects: Sequence[Effect], hypothesis: Hypothesis) -> dict[str, float]:
    names = {name for effect in effects for name in effect.parameters}
    return {name: value for name, value in hypothesis.numbers.items() if name in names}
