"""The lag of moving sweeps where the filter of the virtual rig has no answer: no relaxation, a wheel that does not roll."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.points import make_points
from mffit.points.clock import rolled_distance
from mffit.rig.lag import lag_of_move, lagged_setting

TIME = np.arange(40) / 20.0
ALPHA = np.radians(5.0 * np.sin(1.3 * TIME))
SPEED = np.where((TIME > 0.5) & (TIME < 1.0), 0.0, 6.0)
"""The wheel stops for ten samples while the angle moves on."""


def sweep(V=6.0):
    return make_points(ALPHA, 0.0, 1400.0, p=240e3, V=V, phi_t=0.0, continuous=True, time=TIME)


@pytest.mark.parametrize("sigma", [0.0, -1e-4])  # a search may try a length below its bound
def test_without_relaxation_a_rolling_wheel_answers_at_once(sigma):
    follows, _ = lagged_setting(sweep(), sigma)
    assert follows == pytest.approx(ALPHA)


@pytest.mark.parametrize("V", [6.0, SPEED])
def test_no_relaxation_is_the_limit_of_a_short_one(V):
    """Value and derivative by the relaxation length."""
    follows, slope = lagged_setting(sweep(V), 0.0)
    near, near_slope = lagged_setting(sweep(V), 1e-7)
    assert follows == pytest.approx(near, abs=1e-7)
    assert slope == pytest.approx(near_slope, abs=1e-5)


@pytest.mark.parametrize("sigma", [0.0, 0.4])
def test_a_wheel_that_does_not_roll_keeps_the_angle_that_its_force_answers_to(sigma):
    follows, slope = lagged_setting(sweep(SPEED), sigma)
    standing = np.flatnonzero(SPEED == 0.0)
    assert np.ptp(ALPHA[standing]) > 0.01
    assert np.ptp(follows[standing]) == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(slope[standing]) == pytest.approx(0.0, abs=1e-12)


def test_a_stop_is_a_filter_over_the_distance_rolled():
    """The samples of a wheel that stopped and rolled on equal those of the same angles over the same distances without time."""
    follows, slope = lagged_setting(sweep(SPEED), 0.4)
    steps = np.diff(TIME) * 0.5 * (SPEED[1:] + SPEED[:-1])
    expected = [ALPHA[0]]
    for move, d, before in zip(np.diff(ALPHA), steps, ALPHA[:-1], strict=True):
        # sigma d(alpha')/ds + alpha' = alpha, in a thousand steps of distance
        value, n = expected[-1], 1000
        for k in range(n if d > 0.0 else 0):
            angle = before + move * (k + 0.5) / n
            value += (angle - value) * (1.0 - np.exp(-d / n / 0.4))
        expected.append(value)
    assert follows == pytest.approx(expected, abs=1e-7)
    up, down = (lagged_setting(sweep(SPEED), 0.4 + h)[0] for h in (1e-6, -1e-6))
    assert slope == pytest.approx((up - down) / 2e-6, abs=1e-8)


def test_every_sweep_begins_settled_and_steady_points_have_no_lag():
    both = make_points(
        np.tile(ALPHA, 3), 0.0, 1400.0, p=240e3, V=6.0, phi_t=0.0,
        time=np.concatenate([TIME, TIME, np.full(40, np.nan)]), sweep=np.repeat([0, 1, 2], 40),
        sweep_names=("a", "b", "c"), continuous=np.repeat([True, True, False], 40),
    )  # fmt: skip
    follows, slope = lagged_setting(both, 0.4)
    alone, alone_slope = lagged_setting(sweep(), 0.4)
    assert follows == pytest.approx(np.concatenate([alone, alone, ALPHA]))
    assert slope == pytest.approx(np.concatenate([alone_slope, alone_slope, np.zeros(40)]))
    order = np.random.default_rng(1).permutation(120)
    assert lagged_setting(both.select(order), 0.4)[0] == pytest.approx(follows[order])


@pytest.mark.parametrize("share", [0.1, 0.5, 0.95])
def test_a_move_at_once_is_a_steep_one_between_two_more_samples(share):
    """The same recording with samples just before and after the move, between which it goes evenly."""
    row, sigma, short = 7, 0.4, 1e-6
    moved = np.where(np.arange(40) > row, np.radians(1.0), 0.0)
    rolled = rolled_distance(TIME, np.full(40, 6.0))
    instant = TIME[row] + share / 20.0
    time = np.insert(TIME, row + 1, [instant - short, instant + short])
    known = {"p": 240e3, "V": 6.0, "phi_t": 0.0, "continuous": True}
    even, _ = lagged_setting(make_points(moved, 0.0, 1400.0, time=TIME, **known), sigma)
    fine = make_points(np.insert(moved, row + 1, [0.0, np.radians(1.0)]), 0.0, 1400.0, time=time, **known)
    steep = np.delete(lagged_setting(fine, sigma)[0], [row + 1, row + 2])
    added, by_sigma, by_share = lag_of_move(row, np.radians(1.0), rolled, sigma, share)
    assert even - added == pytest.approx(steep, abs=1e-6)
    for step, change in (((1e-5, 0.0), by_sigma), ((0.0, 1e-5), by_share)):
        up, down = (
            lag_of_move(row, np.radians(1.0), rolled, sigma + way * step[0], share + way * step[1])[0]
            for way in (1.0, -1.0)
        )
        assert change == pytest.approx((up - down) / 2e-5, rel=1e-5, abs=1e-9)
