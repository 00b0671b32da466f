"""The standard error of a mean is right for correlated noise."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import lfilter

from mffit.points.mean import autoregression, errors_of_means, mean_and_error


def ar1(n: int, correlation_s: float, rate_Hz: float, generator: np.random.Generator) -> np.ndarray:
    """Stationary noise of variance 1 that forgets itself within ``correlation_s``."""
    remembers = math.exp(-1.0 / (correlation_s * rate_Hz)) if correlation_s else 0.0
    fresh = generator.standard_normal(n + 2000) * math.sqrt(1.0 - remembers**2)
    return lfilter([1.0], [1.0, -remembers], fresh)[2000:]


@pytest.mark.parametrize(
    ("seconds", "correlation_s", "ripple"),
    [(30, 0.0, 0.0), (30, 0.2, 0.0), (30, 0.8, 0.0), (60, 0.8, 0.0), (90, 2.0, 0.0), (30, 0.2, 1.0)],
)
def test_two_standard_errors_cover_the_mean(seconds, correlation_s, ripple):
    """20 Hz, 30-90 s as a rig records a point; the ripple is once per revolution of the wheel.

    Six hundred records leave 0.9 % of statistical error on a coverage of 95 %; with some ten independent
    samples in a record, the normal interval itself falls short by three.
    """
    generator = np.random.default_rng(11)
    n, time = seconds * 20, np.arange(seconds * 20) / 20.0
    covered, errors, means = 0, [], []
    for _ in range(600):
        phase = generator.uniform(0.0, 2.0 * math.pi)
        x = ar1(n, correlation_s, 20.0, generator) + ripple * np.sin(20.0 * time + phase)
        mean, error, _ = mean_and_error(x)
        covered += abs(mean) < 1.96 * error
        errors.append(error)
        means.append(mean)
    assert 0.90 <= covered / 600 <= 0.985
    assert np.mean(errors) == pytest.approx(np.std(means), rel=0.15)


def test_the_error_of_independent_samples_is_the_textbook_one():
    x = np.random.default_rng(3).standard_normal(1000)
    assert mean_and_error(x)[1] == pytest.approx(np.std(x, ddof=1) / math.sqrt(1000), rel=0.1)


def test_the_error_of_an_ar1_process_approaches_its_known_inefficiency():
    """(1 + r) / (1 - r) for x_t = r x_(t-1) + e; 5 % is twice the scatter of a record this long."""
    r, n = 0.9, 40_000
    x = lfilter([1.0], [1.0, -r], np.random.default_rng(4).standard_normal(n))
    expected = np.std(x) * math.sqrt((1 + r) / (1 - r) / n)
    assert mean_and_error(x)[1] == pytest.approx(expected, rel=0.05)


def test_burg_finds_the_coefficients_of_a_known_process():
    coefficients = np.array([1.2, -0.5])
    x = lfilter([1.0], np.r_[1.0, -coefficients], np.random.default_rng(5).standard_normal(20_000))
    found, innovation = autoregression(x - x.mean())
    np.testing.assert_allclose(found[:2], coefficients, atol=0.03)
    assert innovation == pytest.approx(1.0, rel=0.03)


@given(level=st.floats(-1e4, 1e4), size=st.floats(1e-2, 1e4), n=st.integers(2, 60), seed=st.integers(0, 1000))
def test_the_error_scales_with_the_noise_and_not_with_the_level(level, size, n, seed):
    x = np.random.default_rng(seed).standard_normal(n)
    mean, error, _ = mean_and_error(x)
    moved_mean, moved_error, _ = mean_and_error(level + size * x)
    assert moved_mean == pytest.approx(level + size * mean, abs=1e-8 * (abs(level) + size))
    assert moved_error == pytest.approx(size * error, rel=1e-4)
    assert math.isfinite(error)
    assert error > 0.0


def test_constant_short_and_broken_records():
    assert mean_and_error(np.full(50, 3.2))[:2] == (pytest.approx(3.2), 0.0)
    assert math.isnan(mean_and_error(np.array([1.0]))[1])
    assert math.isnan(mean_and_error(np.array([1.0, np.nan, 2.0]))[1])


def test_short_plateaus_share_what_they_show_of_their_noise():
    """Plateaus of some two independent samples: their own errors are often four times too small, shared ones are not."""
    generator = np.random.default_rng(21)
    own, shared = [], []
    for _ in range(60):
        records = [ar1(64, 0.8, 20.0, generator) for _ in range(5)]
        means = np.array([np.mean(x) for x in records])
        own.append(np.abs(means) / [mean_and_error(x)[1] for x in records])
        shared.append(np.abs(means) / errors_of_means(records))
    assert np.mean(np.array(own) > 4.0) > 0.02
    assert np.mean(np.array(shared) > 4.0) < 0.01


def test_records_that_really_differ_keep_their_own_errors():
    generator = np.random.default_rng(22)
    sizes = np.array([1.0, 3.0, 10.0, 30.0, 0.3, 0.1])
    errors = errors_of_means([size * generator.standard_normal(400) for size in sizes])
    np.testing.assert_allclose(errors, sizes / 20.0, rtol=0.2)


def test_records_without_scatter_lend_nothing():
    noisy = np.random.default_rng(23).standard_normal(100)
    errors = errors_of_means([np.full(50, 3.2), noisy, np.full(10, np.nan)])
    assert errors[0] == 0.0
    assert errors[1] == mean_and_error(noisy)[1]
    assert np.isnan(errors[2])
