"""Noise that is not as stated, models off everywhere, effects without a name: the right name, or none.

A case of each sort; ``tests/studies/diagnosis_study.py --hard`` runs whole sets.
"""

from __future__ import annotations

import pytest
from blind_hard import hard, smooth
from blind_scores import judge

SEED = 77
NAMED = (
    "outliers-loadcell-gain-large-2057952192",
    "correlated-residual-torque-large-492419518",
    "compliance-steering-compliance-large-1687762816",
)


def case(name):
    row = name.partition("-")[0]
    return next(plan for plan in hard(row, SEED) if plan.name == name).draw()


@pytest.mark.parametrize("name", NAMED)
def test_what_is_hidden_is_named_whatever_the_noise(name):
    verdict = judge(case(name))
    assert verdict.outright, verdict.line()
    assert verdict.shrink > 5.0, verdict.line()


def test_a_model_off_everywhere_is_repaired_where_nobody_measured():
    """3 % in every coefficient beside the effect: both are estimated, so that the file is better at new points."""
    verdict = judge(case("inexact-temperature-moderate-322253524"))
    assert verdict.outright, verdict.line()
    assert verdict.shrink > 5.0, verdict.line()


def test_errors_that_remember_each_other_are_no_effect():
    verdict = judge(case("correlated-none-large-227047202"))
    assert not verdict.named
    assert not verdict.unexplained


def test_a_smooth_effect_outside_the_library_is_not_explained_away():
    verdict = judge(list(smooth(SEED))[2].draw())
    assert not verdict.named
    assert verdict.unexplained
