"""A blind set: hidden causes are named, and no others.

The normal run has a case of each sort; ``-m slow`` tests the rates of a larger set, with a margin for the chance
of few cases. ``tests/studies/diagnosis_study.py`` runs whole sets.
"""

from __future__ import annotations

import pytest
from blind_scores import LOOK_ALIKE, judge, nothing, pairs, rates, singles, unknown
from blind_set import ADDED

SEED = 8
OUTRIGHT = (
    "8035-curvature-asymmetry-faint-exact",
    "8082-backlash-moderate-inexact",
    "8202-camber-reduction-load+speed-large-exact",
    "8400-none-large-inexact",
    "8605-leaned-bump-large-exact",
)
"""Tyre, rig, two at once, nothing, structure without a name; exact and inexact models."""


ADDED_ONES = tuple(
    plan.name for plan in singles(SEED) if any(f"-{cause}-moderate" in plan.name for cause in ADDED)
)


def plans():
    return [*singles(SEED), *pairs(SEED, 3), *nothing(SEED, 4), *unknown(SEED, 6)]


def case(name):
    plan = next((plan for plan in plans() if plan.name == name), None)
    assert plan, (
        f"no case {name}: the cases are drawn from CAUSES in its order; add an effect to ADDED (blind_set.py)"
    )
    return plan


@pytest.mark.parametrize("name", [*OUTRIGHT, *ADDED_ONES])
def test_hidden_causes_are_named_and_no_others(name):
    """One case of each sort that the data decide."""
    verdict = judge(case(name).draw())
    assert verdict.outright, verdict.line()
    assert verdict.structure or not verdict.causes or verdict.shrink > 2.0, verdict.line()


@pytest.fixture(scope="module")
def verdicts():
    """Every seventh of effect and size; three pairs, four right models, three structures without a name."""
    chosen = [*list(singles(SEED))[::7], *pairs(SEED, 3), *nothing(SEED, 4), *unknown(SEED, 3)]
    return [judge(plan.draw()) for plan in chosen]


def share(verdicts, name):
    hits, of = rates(verdicts)[name]
    return hits / of


@pytest.mark.slow
def test_a_hidden_effect_is_named_first(verdicts):
    assert share(verdicts, "named first, tied or not") >= 0.85


@pytest.mark.slow
def test_a_hidden_effect_is_first_or_in_its_tie(verdicts):
    assert share(verdicts, "first or inside its tie") >= 0.95


@pytest.mark.slow
def test_ties_are_between_effects_that_look_alike(verdicts):
    for verdict in verdicts:
        for named, tied in zip(verdict.named, verdict.ties, strict=True):
            if tied:
                assert any({named, *tied} & alike for alike in LOOK_ALIKE), verdict.line()


@pytest.mark.slow
def test_nothing_is_named_when_nothing_is_hidden(verdicts):
    assert share(verdicts, "nothing hidden, nothing named") == 1.0


@pytest.mark.slow
def test_both_of_two_are_found(verdicts):
    assert share(verdicts, "both of two found") >= 0.6


@pytest.mark.slow
def test_false_extra_effects_are_rare(verdicts):
    assert share(verdicts, "false extra effects") <= 0.1


@pytest.mark.slow
def test_structure_without_a_name_is_reported_as_unexplained_in_its_region(verdicts):
    assert share(verdicts, "unknown: unexplained, right region") == 1.0
    assert share(verdicts, "unknown: not forced onto an effect") == 1.0


@pytest.mark.slow
def test_the_corrected_model_is_nearer_to_the_truth_between_the_points(verdicts):
    assert rates(verdicts)["median gap shrinkage"][0] >= 5.0
