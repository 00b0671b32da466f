"""Selection of effects by evidence: the best set that is reached from no effect, and from all effects at once."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from mffit.constants import CANDIDATES_FITTED, MOST
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.priors import log_prior, price
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.subsets import LinearSets
from mffit.effects import Effect
from mffit.rig import Simulation


@dataclass(frozen=True, slots=True)
class Contest:
    """Every candidate for one place in an explanation, in addition to the effects that fill the other places."""

    before: Hypothesis  #: with the place empty
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
    def fitted(self) -> tuple[Hypothesis, ...]:
        """The trials that were fitted in full."""
        return tuple(one for one in self.trials if one.state is not self.before.state)

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


def select(
    problem: DiagnosisProblem, candidates: Sequence[Effect], places: Iterable[Hypothesis]
) -> tuple[DiagnosisProblem, Hypothesis]:
    """The most probable set of effects that is reached from any of the ``places``, its effects in the order of their weight.

    The covariance of the returned problem contains the most likely smooth structure in addition to these effects.
    """
    found = (_climbed(problem, candidates, place) for place in places)
    return max(found, key=lambda one: _posterior(one[0], one[1], candidates))


def contest(problem: DiagnosisProblem, before: Hypothesis, candidates: Sequence[Effect]) -> Contest:
    """Every candidate in addition to the effects of ``before``; those that gain much to first order are fitted in full."""
    trials = []
    sets = LinearSets(*problem.with_structure_of(before), candidates)
    gains = sets.gains(sets.of(before.effects))
    for rank, (effect, gain) in enumerate(gains):
        effects = (*before.effects, effect)
        if rank < CANDIDATES_FITTED and gain >= MOST * gains[0][1]:
            trials.append(problem.fit(effects, before.numbers))
        else:  # to first order
            trials.append(replace(before, effects=effects, log_evidence=before.log_evidence + gain))
    trials.sort(key=lambda t: -(t.log_evidence + log_prior(t.effects[-1], problem.start)))
    return Contest(before, tuple(trials), price(len(candidates)), problem.start)


def _climbed(
    problem: DiagnosisProblem, candidates: Sequence[Effect], at: Hypothesis
) -> tuple[DiagnosisProblem, Hypothesis]:
    """The best set reached from a hypothesis: the readings are linearised there, the best set is fitted, and so on.

    A fit may end in a local optimum, so a set may look different at every visit; the search ends when it meets a set again.
    """
    met, best = {at.ids}, None
    while True:
        here = problem.at_amplitude(at.smooth)
        sets = LinearSets(here, at, candidates)
        ends = [sets.best(sets.of(at.effects)), sets.best(sets.taken_away(sets.of(candidates)))]
        members = max(ends, key=sets.weight)
        effects = sets.effects(sets.in_order(members))
        at = here.fit(effects, sets.numbers(members)) if effects else here.null
        found = here.with_structure_of(at)
        if best is None or _posterior(*found, candidates) > _posterior(*best, candidates):
            best = found
        if at.ids in met:
            return best
        met.add(at.ids)


def _posterior(problem: DiagnosisProblem, found: Hypothesis, candidates: Sequence[Effect]) -> float:
    """Log posterior of a set up to a constant: its evidence, less the price of every effect."""
    priors = [log_prior(effect, problem.start) - price(len(candidates)) for effect in found.effects]
    return found.log_evidence + sum(priors)
