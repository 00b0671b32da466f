"""The search for effects ends for any evidence."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mffit.diagnosis.constants import EVIDENCE_MARGIN
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.selection import price, select
from mffit.effects import Effect, Free

MOST_FITS = 500
"""Far more than a search among three effects needs."""


def effect(name: str) -> Effect:
    return Effect(name, name, "rig", "", (Free(name, 1.0),))


A, B, C = (effect(name) for name in "abc")


class Table:
    """A problem with tabulated evidence; several numbers are the results of successive fits of a set."""

    def __init__(self, **evidence: tuple[float, ...]) -> None:
        self.evidence = {frozenset(names): list(values) for names, values in evidence.items()}
        self.fits, self.start, self.channels = 0, None, ("Fy", "Mz")
        self.null = self.hypothesis((), 0.0)

    def hypothesis(self, effects, evidence):
        numbers = {e.id: 1.0 for e in effects}
        nothing = np.empty(0)
        return Hypothesis(
            effects, numbers, numbers, 0.0, evidence, self.start, nothing, np.empty((0, len(effects)))
        )

    def promising(self, before, candidates):
        beside = frozenset(e.id for e in before.effects)
        known = {e: self.evidence.get(beside | {e.id}, (0.0,))[0] for e in candidates}
        return [(e, max(value - before.log_evidence, 0.0)) for e, value in known.items()]

    def at_amplitude(self, smooth):
        return self

    def fit(self, effects, start=None):
        self.fits += 1
        if self.fits > MOST_FITS:
            pytest.fail("the search goes round in circles")
        values = self.evidence[frozenset(e.id for e in effects)]
        return self.hypothesis(tuple(effects), values.pop(0) if len(values) > 1 else values[0])


def chosen(problem, *effects):
    return sorted(select(problem, effects)[1].ids)


@pytest.mark.parametrize("side", [-0.05, 0.05])
def test_an_effect_is_kept_for_the_price_at_which_it_was_added(side):
    """Between the prices of two and of three candidates it was once added, dropped, and added again."""
    b = price(3) + side
    problem = Table(
        a=(100.0,), b=(20.0,), c=(0.0,), ab=(100.0 + b,), ac=(100.0,), bc=(20.0,), abc=(100.0 + b,)
    )
    assert math.log(2.0) + EVIDENCE_MARGIN < b
    assert chosen(problem, A, B, C) == (["a", "b"] if side > 0.0 else ["a"])


def test_the_search_ends_if_a_set_looks_worse_at_every_visit():
    """With b, a looks needless; without a, b is worth nothing; and a fit of a and b always ends somewhere better."""
    rising = tuple(100.0 + 10.0 * k for k in range(MOST_FITS))
    problem = Table(a=(60.0,), b=(50.0, *rising), c=(0.0,), ab=rising, ac=(60.0,), bc=(50.0,), abc=(90.0,))
    assert chosen(problem, A, B, C) == ["b"]


def test_two_effects_that_are_better_together_replace_the_first():
    problem = Table(a=(60.0,), b=(40.0,), c=(40.0,), ab=(80.0,), ac=(75.0,), bc=(120.0,), abc=(121.0,))
    assert chosen(problem, A, B, C) == ["b", "c"]
