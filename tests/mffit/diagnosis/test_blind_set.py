"""A small blind set: what is hidden is named, and nothing is named that is not there.

The rates asked for leave room for the chance of few cases; ``tests/studies/diagnosis_study.py`` runs large sets.
"""

from __future__ import annotations

import pytest
from blind_scores import LOOK_ALIKE, judge, nothing, pairs, rates, singles, unknown

SEED = 8


@pytest.fixture(scope="module")
def verdicts():
    """Every third effect, sizes in turn; three pairs, four right models, three structures without a name."""
    chosen = list(singles(SEED))[::7]
    plans = [*chosen, *pairs(SEED, 3), *nothing(SEED, 4), *unknown(SEED, 3)]
    return [judge(plan.draw()) for plan in plans]


def share(verdicts, name):
    hits, of = rates(verdicts)[name]
    return hits / of


def test_a_hidden_effect_is_named_first(verdicts):
    assert share(verdicts, "named first, tied or not") >= 0.85


def test_a_hidden_effect_is_first_or_in_its_tie(verdicts):
    assert share(verdicts, "first or inside its tie") >= 0.95


def test_ties_are_between_effects_that_look_alike(verdicts):
    for verdict in verdicts:
        for named, tied in zip(verdict.named, verdict.ties, strict=True):
            if tied:
                assert any({named, *tied} & alike for alike in LOOK_ALIKE), verdict.line()


def test_nothing_is_named_when_nothing_is_hidden(verdicts):
    assert share(verdicts, "nothing hidden, nothing named") == 1.0


def test_both_of_two_are_found(verdicts):
    assert share(verdicts, "both of two found") >= 0.6


def test_hardly_anything_extra_is_named(verdicts):
    assert share(verdicts, "false extra effects") <= 0.1


def test_structure_without_a_name_is_called_unexplained_where_it_is(verdicts):
    assert share(verdicts, "unknown: unexplained, right region") == 1.0
    assert share(verdicts, "unknown: not forced onto an effect") == 1.0


def test_the_corrected_model_is_nearer_to_the_truth_where_nothing_was_measured(verdicts):
    assert rates(verdicts)["median gap shrinkage"][0] >= 5.0
