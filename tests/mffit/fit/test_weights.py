"""Weights of points: from the stated uncertainty, from the misfit, and of outliers."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.fit import constants, weights
from mffit.fit.weights import enlarged


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


def test_a_stretch_that_the_model_misses_pulls_less_than_its_size():
    rng = np.random.default_rng(10)
    residual = rng.standard_normal(400)
    residual[40:60] += 40.0 * np.sin(np.linspace(0.0, np.pi, 20))
    factor = enlarged(residual)
    assert np.all(np.isfinite(factor))
    assert factor[50] > 2.0
