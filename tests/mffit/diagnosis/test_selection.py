"""The best set of effects is found, whatever a search step by step would meet first.

The readings are exactly linear in the numbers, so that the density of the readings under every set is known in closed form.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import multivariate_normal

from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.priors import price
from mffit.diagnosis.selection import select
from mffit.diagnosis.smooth import NO_SMOOTH
from mffit.diagnosis.subsets import LinearSets
from mffit.effects import Effect, Free

LETTERS = "abcdefgh"


def effect(name: str, prior: float = 0.0) -> Effect:
    return Effect(name, name, "rig", "", (Free(name, 1.0),), prior=prior)


@dataclass(frozen=True)
class State:
    """A simulation whose readings are columns @ numbers."""

    values: dict

    def number(self, name, points):
        return self.values.get(name, 0.0)

    def with_numbers(self, numbers):
        return State({**self.values, **numbers})


class Linear:
    """A problem of readings (m,) of unit noise that are linear in the numbers of some effects, of unit prior variance."""

    def __init__(self, readings: np.ndarray, columns: dict[str, np.ndarray]) -> None:
        self.readings, self.by_name = readings, columns
        self.points, self.start, self.declared = None, State({}), {}
        self.noise = SimpleNamespace(whiten=lambda x: x)
        self.null = self.hypothesis((), {})

    def whitened(self, state):
        return self.readings - sum(
            (x * self.by_name[name] for name, x in state.values.items()), np.zeros(len(self.readings))
        )

    def columns(self, state, effects):
        return {e: [self.by_name[e.id][:, None]] for e in effects}

    def at_amplitude(self, smooth):
        return self

    def with_structure_of(self, found):
        return self, found

    def density(self, names) -> float:
        C = np.array([self.by_name[name] for name in names]).reshape(len(names), len(self.readings))
        whole = np.eye(len(self.readings)) + C.T @ C
        nothing = np.zeros(len(self.readings))
        return multivariate_normal(nothing, whole).logpdf(self.readings) + 0.5 * len(
            self.readings
        ) * math.log(2.0 * math.pi)

    def fit(self, effects, start=None):
        C = np.column_stack([self.by_name[e.id] for e in effects])
        x = np.linalg.solve(np.eye(C.shape[1]) + C.T @ C, C.T @ self.readings)
        return self.hypothesis(tuple(effects), dict(zip((e.id for e in effects), x.tolist(), strict=True)))

    def hypothesis(self, effects, numbers):
        state = State(numbers)
        residual = self.whitened(state)
        return Hypothesis(
            effects, numbers, numbers, float(residual @ residual), self.density(numbers), state, residual,
            np.empty((len(residual), len(effects))), NO_SMOOTH,
        )  # fmt: skip


def drawn(seed: int, count: int, rows: int = 12) -> Linear:
    """Random columns of very different sizes, some nearly alike, and readings made of some of them."""
    rng = np.random.default_rng(seed)
    columns = rng.normal(size=(count, rows)) * rng.uniform(0.5, 20.0, count)[:, None]
    columns[1] = columns[0] + 0.3 * columns[1]  # hardly separable
    hidden = rng.random(count) < 0.4
    return Linear(
        hidden * rng.normal(size=count) @ columns + rng.normal(size=rows),
        dict(zip(LETTERS, columns, strict=False)),
    )


def chosen(problem: Linear, *effects: Effect) -> set[str]:
    every = problem.fit(effects)
    return set(select(problem, effects, [problem.null, every])[1].ids)


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10_000))
def test_the_weight_of_a_set_is_its_density_less_its_price(seed):
    """Whatever numbers the readings are linearised at: none, or those of all effects at once."""
    problem = drawn(seed, 5)
    effects = [effect(name, prior=0.1 * k) for k, name in enumerate(LETTERS[:5])]
    for at in (problem.null, problem.fit(effects)):
        sets = LinearSets(problem, at, effects)
        for count in range(6):
            for some in combinations(effects, count):
                expected = problem.density([e.id for e in some]) + sum(e.prior - price(5) for e in some)
                assert sets.weight(sets.of(some)) == pytest.approx(expected, rel=1e-6, abs=1e-6)


def test_an_exact_pair_is_found_where_each_step_alone_leads_elsewhere():
    """c looks like the sum of a and b, and explains most by itself; so does d beside it. Only a and b together are exact."""
    a, b, c, d = np.eye(8)[:4]
    columns = {"a": 50.0 * a, "b": 50.0 * b, "c": 36.0 * (a + b) + 5.0 * c, "d": 36.0 * (a - b) + 5.0 * d}
    problem = Linear(40.0 * a + 30.0 * b, columns)
    by_itself = {name: problem.density([name]) for name in columns}
    assert max(by_itself, key=by_itself.__getitem__) == "c"
    assert chosen(problem, *map(effect, "abcd")) == {"a", "b"}


@pytest.mark.parametrize("seed", range(60))
def test_no_other_set_is_more_probable(seed):
    problem, effects = drawn(seed, 6), [effect(name) for name in LETTERS[:6]]
    found = chosen(problem, *effects)
    weight = {
        frozenset(names): problem.density(names) - len(names) * price(6)
        for count in range(7)
        for names in combinations(LETTERS[:6], count)
    }
    assert weight[frozenset(found)] == pytest.approx(max(weight.values()), abs=1e-6)


@pytest.mark.parametrize(("above", "taken"), [(-0.1, set()), (0.1, {"a"})])
@pytest.mark.parametrize("candidates", [3, 8])
def test_an_effect_pays_for_the_choice_among_all(candidates, above, taken):
    """The price as docs/diagnosis.md states it: the logarithm of the number of candidates plus 4."""
    columns = {name: 1e-3 * row for name, row in zip(LETTERS, np.eye(10), strict=False)}
    columns["a"] = 30.0 * np.eye(10)[0]
    worth = math.log(candidates) + 4.0 + above + 0.5 * math.log(1.0 + 30.0**2)
    readings = np.zeros(10)
    readings[0] = math.sqrt(2.0 * worth * (1.0 + 30.0**2) / 30.0**2)
    assert chosen(Linear(readings, columns), *map(effect, LETTERS[:candidates])) == taken


def test_six_effects_are_found_together():
    """As many as act: no number of effects is the most."""
    rows = np.eye(9)
    problem = Linear(40.0 * rows[:6].sum(axis=0), {n: 30.0 * r for n, r in zip(LETTERS, rows, strict=False)})
    assert chosen(problem, *map(effect, LETTERS)) == set("abcdef")


def test_the_most_important_effect_comes_first():
    rows = np.eye(9)
    size = dict(zip("abc", (20.0, 60.0, 40.0), strict=True))
    readings = sum(size[n] * r for n, r in zip("abc", rows, strict=False))
    problem = Linear(readings, {n: 30.0 * r for n, r in zip(LETTERS, rows, strict=False)})
    best = select(problem, [effect(n) for n in LETTERS], [problem.null])[1]
    assert [e.id for e in best.effects] == ["b", "c", "a"]


def test_a_number_beyond_its_bound_is_no_explanation():
    """The play of an axis cannot be negative."""
    problem = Linear(-40.0 * np.eye(4)[0], {"a": 30.0 * np.eye(4)[0], "b": 1e-3 * np.eye(4)[1]})
    play = effect("a")
    play = replace(play, free=(Free("a", 1.0, lower=0.0),))
    assert LinearSets(problem, problem.null, [effect("a")]).best(()) == (0,)
    sets = LinearSets(problem, problem.null, [play, effect("b")])
    assert sets.best(()) == ()
    assert dict(sets.gains(()))[play] == 0.0


@pytest.mark.parametrize("before", ["", "b"])
def test_what_an_effect_adds_is_the_rise_of_the_density(before):
    problem, effects = drawn(3, 5), [effect(name, prior=0.3) for name in LETTERS[:5]]
    sets = LinearSets(problem, problem.null, effects)
    found = sets.gains(sets.of([one for one in effects if one.id in before]))
    assert [gain for _, gain in found] == sorted((gain for _, gain in found), reverse=True)
    assert {one.id for one, _ in found} == set(LETTERS[:5]) - set(before)
    for one, gain in found:
        more = problem.density([*before, one.id]) - problem.density([*before])
        assert gain == pytest.approx(max(more, 0.0), abs=1e-6)


def test_the_search_ends_if_a_set_looks_different_at_every_visit():
    """Every fit ends in another local optimum, with ever better evidence."""

    class Restless(Linear):
        visits = 0

        def fit(self, effects, start=None):
            Restless.visits += 1
            assert Restless.visits < 500, "the search goes round in circles"
            found = super().fit(effects, start)
            shifted = {name: x * (-1.0) ** Restless.visits for name, x in found.numbers.items()}
            return replace(
                self.hypothesis(tuple(effects), shifted), log_evidence=found.log_evidence + Restless.visits
            )

    base = drawn(3, 6)
    problem = Restless(base.readings, base.by_name)
    assert chosen(problem, *map(effect, LETTERS[:6])) <= set(LETTERS[:6])
