"""Evidence of every set of effects at once, with the readings linearised at one simulation.

The readings are linear in the numbers of all candidates, so the evidence of a set follows from inner products of columns, and
a search over sets needs no further simulation. Numbers present in the simulation count from their values before.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.priors import SWITCH, beyond_declaration, log_prior, moving, number, price
from mffit.diagnosis.problem import DiagnosisProblem, not_too_steep
from mffit.effects import Effect
from mffit.least_squares import FreeNumber
from mffit.linearised.gaussian import Informed


@dataclass(frozen=True, eq=False)
class Member:
    """An effect as columns of the linear model; one effect may have several, from different finite steps."""

    effect: Effect
    columns: range  #: among the inner products, of which the first is the residual


ON = FreeNumber(SWITCH, 0.0, spread=1.0)
"""The number of a column that is the change by a switch."""


Members = tuple[int, ...]
"""Indices of the members of a set, in ascending order."""


class LinearSets:
    """The sets of some candidates, with the readings linearised at a fitted hypothesis."""

    def __init__(self, problem: DiagnosisProblem, at: Hypothesis, candidates: Sequence[Effect]) -> None:
        self.problem = problem
        self.members: list[Member] = []
        priors = {
            e: tuple(number(f, {}, problem.start, problem.points) for f in moving((e,))) for e in candidates
        }
        known = {n.name: _moved(at, n) for e, numbers in priors.items() if e.id in at.ids for n in numbers}
        at_rest = {
            n.name: n.expected for numbers in priors.values() for n in numbers if known.get(n.name) == 0.0
        }
        state = at.state.with_numbers(at_rest) if at_rest else at.state
        changes, away, first = list[np.ndarray](), list[float](), 1
        # By row; each column is a change by one standard deviation of its number's prior.
        self._numbers = [ON]
        for effect, groups in problem.columns(state, candidates).items():
            numbers = priors[effect]
            moved = [known.get(n.name, 0.0) for n in numbers]
            present = effect.id in at.ids and (effect.switches or any(moved))
            if present and effect.switches:
                off = state.with_numbers({SWITCH: 0.0})
                groups, moved = problem.columns(off, [effect])[effect], [1.0]
            for columns in groups[: 1 if present else None]:
                end = first + columns.shape[1]
                self.members.append(Member(effect, range(first, end)))
                self._numbers.extend(numbers or (ON,))
                changes.append(columns)
                away.extend(moved or [0.0])
                first = end
        whole = problem.whitened(state)[:, None]
        if changes:
            white = not_too_steep(problem.noise.whiten(np.hstack(changes)))  # faster than one by one
            whole = np.hstack([whole + white @ np.array(away)[:, None], white])
        self._products = whole.T @ whole
        self._expected, self._spread, self._lower, self._upper = np.array(
            [(n.expected, n.spread, n.lower, n.upper) for n in self._numbers]
        ).T
        self._declared = np.array([n.name in problem.declared for n in self._numbers])
        self._price = [log_prior(one.effect, problem.start) - price(len(candidates)) for one in self.members]
        self._known: dict[Members, tuple[float, np.ndarray]] = {}

    def of(self, effects: Sequence[Effect]) -> Members:
        """The set of some effects."""
        ids = {effect.id for effect in effects}
        found = {
            one.effect.id: k for k, one in reversed(list(enumerate(self.members))) if one.effect.id in ids
        }
        return tuple(sorted(found.values()))

    def effects(self, members: Members) -> tuple[Effect, ...]:
        """The effects of a set."""
        return tuple(self.members[k].effect for k in members)

    def numbers(self, members: Members) -> dict[str, float]:
        """The most probable numbers of a set, within their bounds."""
        columns = self._columns(members)
        values = self._expected[columns] + self._spread[columns] * self._solved(members)[1]
        values = np.clip(values, self._lower[columns], self._upper[columns])
        found = zip((self._numbers[c] for c in columns), values.tolist(), strict=True)
        return {n.name: value for n, value in found if n is not ON}

    def weight(self, members: Members) -> float:
        """Log posterior of a set up to a constant: evidence, price of every effect, and prior order of causes."""
        return self._solved(members)[0]

    def gains(self, members: Members) -> list[tuple[Effect, float]]:
        """The effects that a set lacks with the log evidence that each adds, best first."""
        known, out = self.weight(members), dict[Effect, float]()
        for k in self._absent(members):
            effect, gain = self.members[k].effect, self.weight(_with(members, k)) - self._price[k] - known
            out[effect] = max(gain, out.get(effect, 0.0))
        return sorted(out.items(), key=lambda row: -row[1])

    def _solved(self, members: Members) -> tuple[float, np.ndarray]:
        if members not in self._known:
            self._known[members] = self._solve(members)
        return self._known[members]

    def _columns(self, members: Members) -> np.ndarray:
        """The columns (k,) of a set."""
        return np.array([c for k in members for c in self.members[k].columns], dtype=int)

    def _informed(self, columns: np.ndarray) -> Informed:
        """The numbers of some columns (k,), in units of their priors, as the readings inform about them."""
        return Informed.by(self._products[columns[:, None], columns], self._products[columns, 0])

    def _solve(self, members: Members) -> tuple[float, np.ndarray]:
        """Weight of a set, and the most probable amounts (k,) of its columns."""
        weight = sum(self._price[k] for k in members) - 0.5 * float(self._products[0, 0])
        if not members:
            return weight, np.zeros(0)
        columns = self._columns(members)
        found, spread = self._informed(columns), self._spread[columns]
        values = self._expected[columns] + spread * found.mean
        for c, value in zip(columns.tolist(), values.tolist(), strict=True):
            if self._declared[c]:
                weight += beyond_declaration(self._numbers[c], value, self.problem.declared)
        over = np.maximum(self._lower[columns] - values, values - self._upper[columns])
        over = np.maximum(over, 0.0) / spread  # beyond the bounds, in standard deviations of the priors
        moved_back = float(np.sum((over / found.u) ** 2)) if over.any() else 0.0
        return weight + found.gain - 0.5 * moved_back, found.mean

    def taken_away(self, members: Members) -> Members:
        """The set without the effects that add less than they cost, dropped one by one, the least useful first."""
        while members:
            fewer = self._without_least(members)
            if self.weight(fewer) <= self.weight(members):
                break
            members = fewer
        return members

    def _without_least(self, members: Members) -> Members:
        """The set without the effect that adds least to all others.

        Without columns b, the sum of squares rises by x_b' V_bb^-1 x_b and the log determinant of the information by that of
        V_bb, where V is the inverse of the information.
        """
        found = self._informed(self._columns(members))
        x, V, worth, end = found.mean, found.covariance, [], 0
        for k in members:
            place = slice(end, end := end + len(self.members[k].columns))
            own = V[place, place]
            worth.append(
                self._price[k]
                + 0.5 * float(x[place] @ np.linalg.solve(own, x[place]) + np.linalg.slogdet(own)[1])
            )
        return _without(members, members[int(np.argmin(worth))])

    def best(self, members: Members) -> Members:
        """The best set that adding and dropping effects reach from a set, and exchanging them where neither helps."""
        while True:
            for near in (self._more_or_fewer, self._exchanged):
                trial = max(near(members), key=self.weight, default=members)
                if self.weight(trial) > self.weight(members):
                    members = trial
                    break
            else:
                return members

    def in_order(self, members: Members) -> Members:
        """The members of a set, each the one that adds most to those before."""
        order: Members = ()
        while len(order) < len(members):
            left = [k for k in members if k not in order]
            order = (*order, max(left, key=lambda k: self.weight(_with(order, k))))
        return order

    def _absent(self, members: Members) -> list[int]:
        ids = {self.members[k].effect.id for k in members}
        return [k for k, one in enumerate(self.members) if one.effect.id not in ids]

    def _more_or_fewer(self, members: Members) -> list[Members]:
        fewer = [_without(members, k) for k in members]
        return [*fewer, *(_with(members, k) for k in self._absent(members))]

    def _exchanged(self, members: Members) -> list[Members]:
        rests = [_without(members, k) for k in members]
        return [_with(rest, k) for rest, k in product(rests, self._absent(members))]


def _moved(at: Hypothesis, of: FreeNumber) -> float:
    """Distance of a number from its prior mean, in prior standard deviations; 0 if it has hardly moved.

    Some derivatives are infinite at the mean, where only finite steps show the effect.
    """
    distance = (at.numbers[of.name] - of.expected) / of.spread
    return distance if abs(distance) > constants.HARDLY_MOVED else 0.0


def _without(members: Members, k: int) -> Members:
    return tuple(m for m in members if m != k)


def _with(members: Members, k: int) -> Members:
    return tuple(sorted((*members, k)))
