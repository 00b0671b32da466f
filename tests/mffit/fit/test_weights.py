"""Which residuals lose their weight."""

from __future__ import annotations

import numpy as np

from mffit.fit.weights import enlarged, standing_out


def test_noise_alone_stands_out_as_rarely_as_said():
    rng = np.random.default_rng(8)
    sweep = np.repeat(np.arange(20), 20)
    alarms = sum(np.any(standing_out(rng.standard_normal(400), 1.0, sweep)) for _ in range(400))
    assert alarms <= 12  # 4 expected at 1 %; 12 or more has a chance of one in a thousand


def test_planted_readings_are_found_and_nothing_else():
    rng = np.random.default_rng(9)
    sweep = np.repeat(np.arange(20), 20)
    residual = rng.standard_normal(400)
    planted = rng.permutation(400)[:8]
    residual[planted] += 15.0 * rng.choice([-1.0, 1.0], 8)
    assert set(np.flatnonzero(standing_out(residual, 1.0, sweep))) == set(planted)


def test_a_stretch_that_the_model_misses_is_no_outlier():
    rng = np.random.default_rng(10)
    sweep = np.repeat(np.arange(20), 20)
    residual = rng.standard_normal(400)
    residual[40:60] += 40.0 * np.sin(np.linspace(0.0, np.pi, 20))
    factor, _ = enlarged(residual, sweep)
    assert np.all(np.isfinite(factor))
    assert factor[50] > 2.0  # but it pulls less than its size


def test_two_points_have_no_neighbours_to_judge_them():
    residual = np.array([0.3, -0.2, 0.1, 0.4, 60.0, -0.3])
    sweep = np.array([0, 0, 0, 0, 1, 1])
    assert not np.any(standing_out(residual, 1.0, sweep))


def test_unused_points_are_left_alone():
    residual = np.zeros(30)
    residual[::2] = np.random.default_rng(2).standard_normal(15)
    residual[10] = 50.0
    assert list(np.flatnonzero(standing_out(residual, 1.0, np.zeros(30, int)))) == [10]
