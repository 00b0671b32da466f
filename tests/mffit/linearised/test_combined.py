"""Which combinations of conditions were tested, and how far others lie from them."""

from __future__ import annotations

import itertools

import numpy as np
import pytest

from mffit.linearised.combined import Combinations
from mffit.linearised.inputs import Input

ALPHA = Input("alpha", -0.12, 0.12, 0.02)
KAPPA = Input("kappa", -0.12, 0.12, 0.02)
LOAD = Input("Fz", 1000.0, 3000.0, 1000.0)
INPUTS = (ALPHA, KAPPA, LOAD)
ANGLES, SLIPS = np.linspace(-0.12, 0.12, 13), np.linspace(-0.12, 0.12, 13)
LOADS = (1000.0, 2000.0, 3000.0)
GROWTH = np.array([2.0, 1.0, 0.1])


def plan(*parts) -> np.ndarray:
    return np.array([row for part in parts for row in itertools.product(*part)])


def test_a_complete_plan_leaves_nothing_untested():
    """Sparse settings too: what lies between two tested combinations counts as tested."""
    random, at = np.random.default_rng(0), plan((ANGLES[::3], SLIPS[::2], LOADS[::2]))
    asked = np.column_stack([random.uniform(one.lower, one.upper, 500) for one in INPUTS])
    found = Combinations.of(INPUTS, at, GROWTH, "Fx")
    assert not np.any(found.at(asked))
    assert not any(found.untested(asked))


CROSS = plan((ANGLES, (0.0,), LOADS), ((0.0, 0.06), SLIPS, LOADS))
"""Sideslip alone, and slip at two sideslips."""


def test_the_error_grows_from_the_nearest_tested_combination():
    """For one condition as beyond its range; without longitudinal slip there is no Fx, which shows nothing of it."""
    of = {name: Combinations.of(INPUTS, CROSS, GROWTH, name) for name in ("Fx", "Fy")}
    at = np.array([[0.1, -0.1, 2000.0]])
    by_sideslip = (2.0**2) * 0.04**2 * (0.04 + 0.06)
    by_slip = 0.1**2 * 0.1
    assert of["Fx"].at(at) == pytest.approx(by_sideslip)
    assert of["Fy"].at(at) == pytest.approx(min(by_slip, by_sideslip))
    assert not np.any(
        of["Fx"].at(np.array([[0.12, 0.0, 2000.0], [0.06, -0.12, 1500.0], [0.03, 0.12, 3000.0]]))
    )
    assert of["Fx"].untested(at) == [("alpha", "kappa")]


def test_the_mirror_image_of_a_tested_combination_is_tested():
    found = Combinations.of(INPUTS, CROSS, GROWTH, "Fx")
    sides = np.array([[side * 0.06, 0.1, 1700.0] for side in (1.0, -1.0)])
    assert not np.any(found.at(sides))
    one, other = found.at(np.array([[side * 0.11, 0.1, 1700.0] for side in (1.0, -1.0)]))
    assert one == pytest.approx(other)
    assert one > 0.0


def test_the_variance_is_continuous():
    found = Combinations.of(INPUTS, CROSS, GROWTH, "Fx")
    line = np.column_stack([np.linspace(-0.12, 0.12, 2001), np.full(2001, -0.07), np.full(2001, 1400.0)])
    steps = np.abs(np.diff(found.at(line)))
    assert np.max(steps) < 0.01 * np.max(found.at(line))


def test_three_conditions_that_were_combined_in_pairs_are_tested():
    """What three conditions do together, beyond what each two do, is small."""
    at = plan((ANGLES, SLIPS, LOADS[1:2]), (ANGLES, (0.0,), LOADS), ((0.0,), SLIPS, LOADS))
    asked = np.array([[0.1, 0.1, 3000.0], [0.1, 0.1, 2000.0], [0.1, 0.0, 3000.0]])
    found = Combinations.of(INPUTS, at, GROWTH, "Fy")
    assert not np.any(found.at(asked))
    assert found.untested(asked) == [(), (), ()]
    apart = Combinations.of(INPUTS, at[at[:, 0] * at[:, 1] == 0.0], GROWTH, "Fy")
    assert apart.untested(asked) == [("alpha", "kappa"), ("alpha", "kappa"), ()]


def test_conditions_that_no_test_plan_holds_do_not_count():
    warmth = Input("T", 20.0, 60.0, 10.0, (30.0, 50.0))
    found = Combinations.of((warmth,), np.full((5, 1), 40.0), np.ones(1), "Fy")
    assert not np.any(found.at(np.array([[np.nan], [90.0]])))
    assert found.untested(np.array([[np.nan]])) == [()]
