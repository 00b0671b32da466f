"""The decomposition on curves whose parts are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mffit.parts import split
from mffit.points import make_points

COMMON = dict(Fz=1500.0, p=250e3, V=6.0, phi_t=-1 / 1.323, u_Fy=6.0, u_Mz=0.6)


def sweep(alpha_deg, gamma_deg=0.0, **more):
    alpha, gamma = np.radians(alpha_deg), np.broadcast_to(np.radians(gamma_deg), np.shape(alpha_deg))
    odd = -1800 * np.sin(1.3 * np.arctan(11 * alpha)) - 1700 * np.sin(gamma)
    even = -320 + 900 * alpha**2
    return make_points(alpha, gamma, Fy=odd + even, Mz=40 * alpha - 3.0, **{**COMMON, **more}), odd, even


def test_exact_mirrors_give_the_parts_back():
    points, odd, even = sweep(np.array([-6.0, -3, -1, 0, 1, 3, 6]))
    parts = split(points)
    np.testing.assert_allclose(parts.Fy_odd, odd, atol=1e-9)
    np.testing.assert_allclose(parts.Fy_even, even, atol=1e-9)
    assert set(parts.paired) == {"exact"}
    assert parts.u_Fy_odd[0] == pytest.approx(6.0 / np.sqrt(2))


def test_shifted_set_points_are_interpolated_along_the_sweep():
    points, odd, _ = sweep(np.linspace(-6.3, 6.0, 60))
    parts = split(points)
    inside = parts.paired == "interpolated"
    assert inside.sum() > 50
    np.testing.assert_allclose(parts.Fy_odd[inside], odd[inside], atol=2.0)


def test_points_without_mirror_are_listed_and_never_filled():
    points, _, _ = sweep(np.array([-1.0, 0.0, 1.0, 5.0]), sweep_names=("camber.csv",))
    parts = split(points)
    assert parts.paired[-1] == "unpaired"
    assert np.isnan(parts.Fy_odd[-1])
    assert len(parts.unpaired) == 1
    assert "camber.csv" in parts.unpaired[0]
    assert "(5, 0)" in parts.unpaired[0]


@pytest.mark.parametrize(
    "other", [{"Fz": 2250.0}, {"p": 200e3}, {"direction": -1}, {"mount": -1}, {"V": 12.0}, {"phi_t": -1.0}]
)
def test_mirrors_are_never_taken_from_another_condition(other):
    alpha = np.radians([2.0, -2.0])
    condition = {
        name: np.array([value, other.get(name, value)])
        for name, value in {**COMMON, "direction": 1, "mount": 1}.items()
    }
    parts = split(make_points(alpha, 0.0, Fy=np.array([1.0, 2.0]), **condition))
    assert set(parts.paired) == {"unpaired"}


@given(st.lists(st.integers(-40, 40), min_size=3, max_size=12, unique=True))
def test_the_parts_come_back_at_any_levels(levels):
    alpha_deg = np.array(sorted({*levels, *(-level for level in levels)})) / 5.0
    points, odd, even = sweep(alpha_deg)
    parts = split(points)
    np.testing.assert_allclose(parts.Fy_odd, odd, atol=1e-9)
    np.testing.assert_allclose(parts.Fy_even, even, atol=1e-9)
    np.testing.assert_allclose(parts.Mz_odd, 40 * points.alpha, atol=1e-9)
    np.testing.assert_allclose(parts.Mz_even, -3.0, atol=1e-9)
