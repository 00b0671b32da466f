"""The price of an effect as docs/diagnosis.md states it: the logarithm of the number of candidates plus 4."""

from __future__ import annotations

import math
from itertools import combinations

import pytest
from test_selection import A, B, C, Table, chosen, effect

from mffit.diagnosis.selection import select


def evidence(**worth: float) -> dict[str, tuple[float, ...]]:
    """Evidence of every set: the sum over its effects."""
    sets = [c for k in range(1, len(worth) + 1) for c in combinations(worth, k)]
    return {"".join(names): (sum(worth[n] for n in names),) for names in sets}


@pytest.mark.parametrize(("above", "taken"), [(-0.1, []), (0.1, ["a"])])
def test_the_first_effect_pays_for_the_choice_among_all(above, taken):
    assert chosen(Table(**evidence(a=math.log(3.0) + 4.0 + above, b=1.0, c=0.0)), A, B, C) == taken


@pytest.mark.parametrize(("above", "taken"), [(-0.1, ["a"]), (0.1, ["a", "b"])])
def test_the_second_effect_pays_the_same(above, taken):
    assert chosen(Table(**evidence(a=60.0, b=math.log(3.0) + 4.0 + above, c=0.0)), A, B, C) == taken


def test_more_candidates_are_a_higher_price():
    letters = "abcdefghijklmnopqrst"
    for worth, taken in ((math.log(20.0) + 3.9, []), (math.log(20.0) + 4.1, ["a"])):
        table = {**dict.fromkeys(letters, (0.0,)), "a": (worth,)}
        table |= {"a" + other: (worth,) for other in letters[1:]}
        assert chosen(Table(**table), *map(effect, letters)) == taken


def test_four_effects_are_the_most():
    problem = Table(**evidence(a=60.0, b=50.0, c=40.0, d=30.0, e=25.0))
    _, best, steps = select(problem, [effect(name) for name in "abcde"])
    assert best.ids == set("abcd")
    assert len(steps) == 4


def test_all_of_a_small_library_may_be_taken():
    _, best, steps = select(Table(**evidence(a=60.0, b=50.0)), [A, B])
    assert best.ids == {"a", "b"}
    assert len(steps) == 2


def test_an_effect_that_became_needless_is_dropped():
    """c is added first; a and b together make it needless."""
    problem = Table(a=(50.0,), b=(45.0,), c=(60.0,), ab=(120.0,), ac=(90.0,), bc=(70.0,), abc=(121.0,))
    assert chosen(problem, A, B, C) == ["a", "b"]
