"""Weights of points: from the stated uncertainty, from the misfit, and of outliers."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.fit import constants, weights
from mffit.fit.weights import enlarged, outlying


def places(n: int, sweeps: int = 1) -> tuple[np.ndarray, np.ndarray]:
    """Sweep (n,) and place (n, 1) of readings at even steps."""
    return np.repeat(np.arange(sweeps), n // sweeps), np.tile(np.linspace(0.0, 1.0, n // sweeps), sweeps)[
        :, None
    ]


def test_beyond_the_threshold_the_pull_of_a_residual_is_constant():
    """Huber: with the enlarged uncertainty the pull r / sigma^2 of every residual beyond the threshold is the same."""
    residual = np.array([0.5, -3.9, 4.0, 8.0, -40.0, 400.0])
    threshold = constants.HUBER_THRESHOLD
    for scale in (1.0, 2.5):
        pull = scale * residual / weights.huber(scale * residual, scale) ** 2
        assert pull == pytest.approx(scale * np.clip(residual, -threshold, threshold))


def test_only_rare_residuals_of_pure_noise_are_outliers():
    noise = np.random.default_rng(1).normal(0.0, 3.0, 20_000)
    assert np.mean(weights.huber(noise, 3.0) > 1.0) < 0.001
    assert weights.huber(np.array([18.0]), 3.0)[0] > 1.1


def test_the_robust_scale_of_normal_noise_is_its_standard_deviation():
    noise = np.random.default_rng(2).normal(0.0, 3.0, 20_000)
    noise[:500] = 1e4
    assert weights.robust_scale(noise) == pytest.approx(3.0, rel=0.05)


def test_unused_points_do_not_reduce_the_robust_scale():
    residual = np.concatenate([np.zeros(500), np.random.default_rng(3).normal(0.0, 2.0, 400)])
    assert weights.robust_scale(residual) == pytest.approx(2.0, rel=0.1)
    assert weights.robust_scale(np.zeros(5)) == 1.0


def test_uncertainties_are_the_stated_ones_else_a_hundredth_of_the_span():
    values = np.array([-500.0, 0.0, 1500.0, np.nan])
    found = weights.stated_or_nominal(np.array([6.0, np.nan, 0.0, 6.0]), values)
    assert found == pytest.approx([6.0, 20.0, 20.0, np.inf])
    assert np.all(np.isinf(weights.stated_or_nominal(np.full(2, np.nan), np.full(2, np.nan))))
    assert np.all(weights.stated_or_nominal(np.full(2, np.nan), np.full(2, 7.0)) > 0.0)


def test_noise_alone_gives_outliers_at_the_stated_rate():
    rng = np.random.default_rng(8)
    alarms = sum(np.any(outlying(rng.standard_normal(400), *places(400, 20))) for _ in range(200))
    assert alarms <= 7  # 2 expected at 1 %; more than 7 have a chance of one in a thousand


def test_planted_outliers_are_found_and_nothing_else():
    rng = np.random.default_rng(9)
    residual = rng.standard_normal(400)
    planted = rng.permutation(400)[:8]
    residual[planted] += 15.0 * rng.choice([-1.0, 1.0], 8)
    assert set(np.flatnonzero(outlying(residual, *places(400, 20)))) == set(planted)


def test_a_stretch_that_the_model_misses_is_not_an_outlier():
    rng = np.random.default_rng(10)
    residual = rng.standard_normal(400)
    residual[40:60] += 40.0 * np.sin(np.linspace(0.0, np.pi, 20))
    factor = enlarged(residual, *places(400, 20))
    assert np.all(np.isfinite(factor))
    assert factor[50] > 2.0  # but it pulls less than its size


def test_points_with_fewer_than_two_neighbours_are_not_outliers():
    residual = np.array([0.3, -0.2, 0.1, 0.4, 60.0, -0.3])
    sweep = np.array([0, 0, 0, 0, 1, 1])
    assert not np.any(outlying(residual, sweep, np.zeros((6, 1))))


def test_unused_points_are_never_outliers():
    residual = np.zeros(30)
    residual[::2] = np.random.default_rng(2).standard_normal(15)
    residual[10] = 50.0
    assert list(np.flatnonzero(outlying(residual, *places(30)))) == [10]


def test_an_outlier_is_beyond_the_two_sided_limit_for_all_readings_together():
    """One per cent for any of 400 readings, on either side: 0.01 / 800 beyond 4.215 standard deviations."""
    for size, found in ((4.23, True), (4.20, False), (-4.23, True), (-4.20, False)):
        residual = np.random.default_rng(5).normal(0.0, 1e-4, 400)
        residual[200] = size
        assert outlying(residual, *places(400))[200] == found


def missed(alpha: np.ndarray) -> np.ndarray:
    """What a formula misses, which grows towards the ends of a sweep, in units of the noise."""
    return np.asarray(6.0 * np.sin(alpha / 2.0) + 0.15 * alpha**2)


UNEVEN = np.array([-12.0, -9, -6, -4, -3, -2, -1, -0.5, 0, 0.5, 1, 2, 3, 6, 12])


def test_a_true_reading_after_a_long_last_step_is_no_outlier():
    """By the steps before it, the miss at the end of an uneven sweep is far off the line through its neighbours."""
    rng = np.random.default_rng(11)
    sweep, alpha = np.repeat(np.arange(12), len(UNEVEN)), np.tile(UNEVEN, 12)
    for _ in range(20):
        residual = missed(alpha) + rng.standard_normal(len(alpha))
        assert not np.any(outlying(residual, sweep, alpha[:, None] / 24.0))


def test_an_outlier_is_found_where_the_formula_misses_by_more():
    """Eight times the noise, in the middle of sweeps that the formula misses by more than this; its neighbours are sound."""
    rng = np.random.default_rng(12)
    sweep, alpha = np.repeat(np.arange(12), len(UNEVEN)), np.tile(UNEVEN, 12)
    residual = missed(alpha) + rng.standard_normal(len(alpha))
    planted = len(UNEVEN) * np.arange(12) + rng.integers(4, 11, 12)
    residual[planted] += 8.0 * rng.choice([-1.0, 1.0], 12)
    found = set(np.flatnonzero(outlying(residual, sweep, alpha[:, None] / 24.0)))
    assert found <= set(planted)
    assert len(found) >= 10
