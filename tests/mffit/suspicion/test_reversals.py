"""Readings where a moving sweep turns back."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.points import Points, make_points
from mffit.suspicion.reversals import Reversals, turning_sentences

LOADS = (600.0, 1200.0, 1800.0, 2400.0)
NOISE = 0.8
STEP, MOST = np.radians(0.4), np.radians(10.0)
"""Of the steered angle between readings, and at the turns."""


def swept() -> Points:
    """Sweeps 0 -> +10 -> -10 -> 0 deg at a steady rate, one per load."""
    up = np.arange(0.0, MOST, STEP)
    alpha = np.concatenate([up, np.arange(MOST, -MOST, -STEP), np.arange(-MOST, 0.0, STEP)])
    n, sweeps = len(alpha), len(LOADS)
    return make_points(
        np.tile(alpha, sweeps),
        0.0,
        np.repeat(LOADS, n),
        p=2e5,
        V=11.0,
        phi_t=0.0,
        sweep=np.repeat(np.arange(sweeps), n),
        sweep_names=[f"s{k}" for k in range(sweeps)],
        continuous=True,
    )


def inertia(points: Points) -> np.ndarray:
    """Moment (n,) of a mass that is steered, per its size, read through a filter of half a reading's time constant."""
    rate = np.diff(points.alpha, prepend=points.alpha[0]) / STEP
    turned = np.where(np.diff(points.sweep, prepend=0) == 0, np.diff(rate, prepend=rate[0]), 0.0)
    turned = np.where(np.abs(turned) > 1.5, turned, 0.0)
    after = np.exp(-np.arange(4) / 1.2)
    return np.convolve(turned, after)[: len(points)]


def smooth(points: Points) -> np.ndarray:
    """What a formula misses (n,): a wave over sideslip that grows with load."""
    return 2.0 * (points.Fz / 1500.0) * np.sin(3.0 * points.alpha / MOST)


@pytest.mark.parametrize("seed", range(6))
def test_a_smooth_miss_and_noise_are_nothing_at_turns(seed):
    """Ten draws each, so sixty in all."""
    points, found = swept(), []
    reversals = Reversals(points)
    for k in range(10):
        random = np.random.default_rng(100 * seed + k)
        left = smooth(points) + NOISE * random.standard_normal(len(points))
        found.append(bool(np.any(reversals.off(left))))
    assert not any(found)


@pytest.mark.parametrize("seed", range(3))
def test_a_planted_inertia_is_found_where_it_is_and_nowhere_else(seed):
    points = swept()
    moment = 10.0 * inertia(points)
    left = smooth(points) + moment + NOISE * np.random.default_rng(seed).standard_normal(len(points))
    off = Reversals(points).off(left)
    assert np.all(off[np.abs(moment) > 5.0])
    assert np.all(np.degrees(np.abs(points.alpha[off])) > 7.0)


def test_departures_smaller_than_the_miss_elsewhere_do_no_harm_and_count_fully():
    """A moment that a line from the leg shows, but that the formula's miss hides."""
    points = swept()
    left = 10.0 * smooth(points) + 3.0 * inertia(points)
    left += 0.2 * np.random.default_rng(1).standard_normal(len(points))
    assert not np.any(Reversals(points).off(left))


def test_readings_without_a_value_are_not_flagged():
    points = swept()
    moment = 10.0 * inertia(points)
    left = moment + NOISE * np.random.default_rng(2).standard_normal(len(points))
    left[points.sweep == 1] = np.nan
    off = Reversals(points).off(left)
    assert np.array_equal(np.unique(points.sweep[off]), [0, 2, 3])


def test_the_sentence_states_both_sizes():
    points = swept()
    model = {"Mz": np.zeros(len(points))}
    off = np.abs(inertia(points)) > 0.5
    measured = np.where(off, 9.0, 2.0)
    (sentence,) = turning_sentences(points.replace(Mz=measured), model, {"Mz": off})
    assert (
        f"Mz is off the model by 9 Nm rms where sweeps turn back ({np.sum(off)} readings), and by 2 Nm"
        in sentence
    )


def test_a_straight_leg_is_extrapolated_exactly():
    points = swept()
    straight = 3.0 - 40.0 * points.alpha
    for leg in Reversals(points).legs:
        assert np.sum(leg.lines * straight[leg.behind], axis=1) == pytest.approx(straight[leg.rows])
