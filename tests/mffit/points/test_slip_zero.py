"""The sign of slip where few readings lie near zero force."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.points.slip_zero import Driven, slip_zero, unexplained_drive


def readings(near: float) -> Driven:
    """Forty readings near zero force with a slope of slip over force, and a whole curve that rises with slip."""
    force = np.concatenate([np.linspace(-0.25, 0.25, 40), np.repeat([-1.1, 1.1], 40)])
    slip = np.concatenate([near * np.linspace(-0.25, 0.25, 40), np.repeat([-0.15, 0.15], 40)])
    n = len(slip)
    some = np.tile([0.0, 0.02, -0.02, 0.01], n // 4)
    Fz = 1400.0 * (1.0 + 0.2 * some)
    return Driven(
        slip, force * Fz, Fz, some, 0.0 * some, np.full(n, 250e3), np.full(n, np.nan), np.full(n, 16.7)
    )


def test_few_readings_near_zero_that_contradict_the_whole_curve_name_no_sign():
    """Slip steps of 0.02 leave a stiff tyre hardly a reading near zero; braking was then taken for positive."""
    assert slip_zero(readings(-0.05)) is None
    assert slip_zero(readings(0.05)).slope > 0.0


def test_the_zero_follows_load_camber_pressure_and_sideslip():
    """Slip against the loaded radius: its zero under every condition, found beside the compliance and despite outliers."""
    rng = np.random.default_rng(8)
    n = 600
    load, gamma, p = rng.uniform(800.0, 2200.0, n), rng.uniform(0.0, 0.1, n), rng.uniform(200e3, 300e3, n)
    alpha, force = rng.uniform(0.0, 0.1, n), rng.uniform(-0.3, 0.3, n)
    zero = -0.02 - 1e-5 * (load - 1500.0) + 4e-8 * (p - 250e3) + 0.05 * gamma * load / 1500.0 - 0.03 * alpha
    compliance = 0.05 + 2.0 * alpha**2
    slip = zero + compliance * force
    slip[::40] += 0.3
    driven = Driven(slip, force * load, load, alpha, gamma, p, np.full(n, np.nan), np.full(n, 16.7))
    np.testing.assert_allclose(slip_zero(driven).at(driven), zero, atol=1e-6)


def test_braking_that_is_positive_throughout_is_still_found():
    driven = readings(0.05)
    assert slip_zero(driven._replace(kappa=-driven.kappa)).slope < 0.0


def test_a_freely_rolling_wheel_shows_no_zero_of_slip():
    """Its recorded slip is noise, and Fx over it has no meaning."""
    driven = readings(0.05)
    assert slip_zero(driven._replace(kappa=-0.9999 + 1e-3 * driven.kappa)) is None


def test_a_zero_that_curves_with_sideslip_is_found_straight_ahead():
    """Most readings roll freely through 12 deg, as those of a wheel whose speed over the road's does not follow the angle."""
    rng = np.random.default_rng(5)
    alpha = np.concatenate([rng.uniform(-0.2, 0.2, 600), np.zeros(200)])
    force = np.concatenate([np.zeros(600), rng.uniform(-1.0, 1.0, 200)])
    n = len(alpha)
    zero = 1.0 / np.cos(alpha) - 1.0 - 0.003
    fixed = np.full(n, 1500.0)
    driven = Driven(
        zero + 0.03 * force, force * fixed, fixed, alpha, 0.0 * fixed, fixed, np.full(n, np.nan), fixed
    )
    np.testing.assert_allclose(slip_zero(driven).at(driven), zero, atol=3e-4)


def test_the_drive_without_slip_is_told_over_the_load_of_each_reading():
    """2.5 times the load driving and braking, at loads of 1 to 5: the range is 5 times the load, not that of the largest."""
    load = np.repeat([200.0, 600.0, 1000.0], 100)
    force = 2.5 * load * np.tile(np.repeat([-1.0, 1.0], 50), 3)
    none = np.zeros(len(load))
    assert unexplained_drive(Driven(none, force, load, none, none, none, none, none)) == pytest.approx(5.0)
