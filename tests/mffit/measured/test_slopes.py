"""Slopes at zero and secants of curves whose slope is known."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.measured.stiffnesses import OddCurve

X = np.radians([0.5, 1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0])
ONE = np.ones(len(X))


@pytest.mark.parametrize(
    ("curve", "within"),
    [
        (lambda x: 2000.0 * np.tanh(x / 0.1), 0.02),
        (lambda x: 2000.0 * x / np.hypot(x, 0.1), 0.02),
        (lambda x: 20000.0 * x, 0.002),
        (lambda x: 2500.0 * np.sin(1.3 * np.arctan(20000.0 * x / (1.3 * 2500.0))), 0.001),
    ],
    ids=["tanh", "root", "line", "magic"],
)
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_the_slope_of_a_saturating_curve(curve, within, sign):
    found = OddCurve(X, sign * curve(X), 5.0 * ONE).slope(local=np.radians(2.0))
    assert found.value == pytest.approx(sign * 20000.0, rel=within)
    assert found.u_shape < 0.5 * 0.05 * 20000.0  # a cubic is within 3 %, the shape within 2 %
    assert found.dof == 5.0


def test_its_noise_is_the_scatter_over_many_draws():
    rng = np.random.default_rng(2)
    x = np.tile(X, 2)
    true = 2500.0 * np.sin(1.3 * np.arctan(20000.0 * x / (1.3 * 2500.0)))
    drawn = [
        OddCurve(x, true + rng.normal(0.0, 20.0, len(x)), np.full(len(x), 20.0)).slope(local=0.0)
        for _ in range(60)
    ]
    values = np.array([d.value for d in drawn])
    stated = np.median([d.u_noise for d in drawn])
    assert abs(values.mean() - 20000.0) < 3.0 * stated / np.sqrt(60)
    # The scatter of 60 draws is known to a tenth; a misfit larger than stated by chance enlarges u a little.
    assert 0.7 < values.std() / stated < 1.2


def test_a_misfit_beyond_the_noise_enlarges_the_uncertainty():
    wavy = 20000.0 * X + np.array([1, -1, 1, -1, 1, -1, 1, -1]) * 50.0
    quiet, loud = (OddCurve(X, wavy, u * ONE).slope(local=0.0) for u in (5.0, 50.0))
    assert quiet.u_noise > 0.5 * loud.u_noise


def test_a_misfit_of_the_shape_at_large_angles_is_no_noise():
    """A shape without curvature E misses a curve with E = -2 by far more than 2 N, one with it does not."""
    b = 20000.0 * X / (1.3 * 2500.0)
    curve = 2500.0 * np.sin(1.3 * np.arctan(b + 2.0 * (b - np.arctan(b))))
    quiet, loud = (OddCurve(X, curve, u * ONE).slope(local=0.0) for u in (2.0, 2000.0))
    assert quiet.u_noise < 2.0 * loud.u_noise / 1000.0  # the misfit would make it ten times as large


def test_without_a_cubic_a_twentieth_is_in_doubt():
    found = OddCurve(X, 20000.0 * X, 1e-3 * ONE).slope(local=np.radians(1.0))
    assert found.u_shape == pytest.approx(0.025 * 20000.0, rel=0.01)


def test_the_cubic_ends_at_its_reach():
    """Beyond 2 deg this curve is no cubic at all."""
    broken = np.where(np.radians(2.5) > X, 20000.0 * X - 2e6 * X**3, 0.0)
    found = OddCurve(X, broken, 1e-3 * ONE).slope(local=np.radians(2.0))
    assert found.u_shape == pytest.approx(abs(found.value - 20000.0) / 2.0, rel=1e-6)


def test_two_angles_are_no_curve():
    assert OddCurve(np.tile(X[:2], 3), np.tile(X[:2], 3), np.ones(6)).slope(local=1.0) is None
    assert OddCurve(X[:3], X[:3], ONE[:3]).slope(local=1.0) is not None


def test_a_secant_at_a_measured_angle_is_the_mean_of_what_was_read_there():
    x = np.radians([15.0, 5.0, 15.0, 25.0])
    found = OddCurve(x, np.array([100.0, 40.0, 110.0, 150.0]), np.full(4, 6.0)).secant(np.radians(15.0))
    assert found.value == pytest.approx(105.0 / np.radians(15.0))
    assert found.u == pytest.approx(6.0 / np.sqrt(2.0) / np.radians(15.0))


def test_a_secant_between_angles_is_interpolated():
    x = np.radians([5.0, 10.0, 20.0])
    found = OddCurve(x, np.array([50.0, 100.0, 160.0]), np.array([2.0, 2.0, 4.0])).secant(np.radians(15.0))
    assert found.value == pytest.approx(130.0 / np.radians(15.0))
    assert found.u == pytest.approx(3.0 / np.radians(15.0))


@pytest.mark.parametrize("angle", [4.0, 21.0])
def test_a_secant_beyond_the_sweep_is_none(angle):
    x = np.radians([5.0, 10.0, 20.0])
    assert OddCurve(x, x, x).secant(np.radians(angle)) is None
    assert OddCurve(x[:0], x[:0], x[:0]).secant(0.1) is None


def test_shapes_that_differ_beyond_their_noise_count():
    """A curve that the saturating shape cannot follow: its slope and the cubic's differ by far more than 0.1 N explains."""
    bent = 20000.0 * X - 4e6 * X**2 + 3e7 * X**3
    found = OddCurve(X, bent, 0.1 * ONE).slope(local=np.radians(2.0))
    assert 2.0 * found.u_shape > 0.05 * abs(found.value)
    assert abs(found.value - 20000.0) < 3.0 * found.u_shape
