"""With wrong noise and inexact models the right effect is named, or none.

A case of each sort; ``tests/studies/diagnosis_study.py --hard`` runs whole sets.
"""

from __future__ import annotations

import pytest
from blind_hard import hard
from blind_scores import judge

SEED = 77
NAMED = (
    "outliers-loadcell-gain-large-2057952192",
    "compliance-steering-compliance-large-1687762816",
)


def case(name):
    row = name.partition("-")[0]
    return next(plan for plan in hard(row, SEED) if plan.name == name).draw()


@pytest.mark.parametrize("name", NAMED)
def test_hidden_causes_are_named_whatever_the_noise(name):
    verdict = judge(case(name))
    assert verdict.outright, verdict.line()
    assert verdict.shrink > 5.0, verdict.line()


def test_an_inexact_model_is_repaired_between_the_points():
    """3 % in every coefficient beside the effect: both are estimated, so that the file is better at new points."""
    verdict = judge(case("inexact-temperature-moderate-322253524"))
    assert verdict.outright, verdict.line()
    assert verdict.shrink > 5.0, verdict.line()


def test_correlated_errors_are_not_an_effect():
    verdict = judge(case("correlated-none-large-227047202"))
    assert not verdict.named
    assert not verdict.unexplained
