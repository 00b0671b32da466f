"""The decomposition on curves whose parts are known."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mffit.parts import split
from mffit.points import concatenate, make_points

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


def test_ends_that_a_rig_holds_to_a_twentieth_of_a_step_are_mirrors():
    """Steps of 4 deg, the ends of the grid 0.15 deg apart: both have a mirror, 1 % off."""
    points, odd, _ = sweep(np.array([-4.1, 0.02, 3.95]))
    parts = split(points)
    assert parts.unpaired == ()
    np.testing.assert_allclose(parts.Fy_odd, odd, atol=0.01 * np.max(np.abs(odd)))
    apart, _, _ = sweep(np.array([-4.5, 0.0, 3.95]))
    assert len(split(apart).unpaired) == 1


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


def test_a_mirrored_set_point_that_was_run_is_not_said_to_lack():
    """Held a tenth of a degree apart, too far to be one reading; without the set-point, the programme lacks it."""
    run, _, _ = sweep(np.array([-4.0, 4.1]))
    found = split(run)
    assert set(found.paired) == {"unpaired"}
    assert found.unpaired == ()
    assert len(split(run.select(np.array([True, False]))).unpaired) == 1


def test_mirrors_are_found_up_to_the_ends_of_the_sweep():
    """Every point whose reflection lies within the measured angles, the outermost intervals included."""
    alpha_deg = np.array([-6.0, -4.0, -1.0, 0.5, 3.0, 5.0])
    points, odd, _ = sweep(alpha_deg)
    parts = split(points)
    assert list(parts.paired == "interpolated") == list((-alpha_deg >= -6.0) & (-alpha_deg <= 5.0))
    # Between angles this far apart the curve is known to some 2 %; a neighbour's reading would be 15 % off.
    np.testing.assert_allclose(parts.Fy_odd[1:], odd[1:], atol=30.0)


@pytest.mark.parametrize("angles", [[-1.0, 2.0], [-1.0, 0.5, 2.0]])
def test_two_angles_are_too_few_to_interpolate(angles):
    repeated = np.array([*angles, *angles]) + np.repeat(
        [0.0, 4e-4], len(angles)
    )  # deg: the same angles again
    parts = split(sweep(repeated)[0])
    assert np.any(parts.paired == "interpolated") == (len(angles) > 2)


def test_camber_sweeps_are_interpolated_over_camber():
    gamma_deg = np.linspace(-30.5, 30.0, 12)
    points, odd, _ = sweep(np.zeros(12), gamma_deg)
    parts = split(points)
    assert list(parts.paired == "interpolated") == [False, *[True] * 11]
    np.testing.assert_allclose(parts.Fy_odd[1:], odd[1:], atol=2.0)


def test_an_interpolated_mirror_is_the_mean_of_repeated_readings_with_the_error_of_the_nearest():
    alpha_deg = np.array([-4.2, -2.0, -2.0, 0.0, 4.0, 4.1])
    points, _, _ = sweep(alpha_deg)
    Fy = np.array([400.0, 210.0, 190.0, 0.0, -400.0, -410.0])
    u_Fy = np.array([1.0, 2.0, 2.0, 3.0, 4.0, 5.0])
    parts = split(points.replace(Fy=Fy, u_Fy=u_Fy))
    assert parts.paired[4] == "interpolated"
    again = split(points.replace(Fy=np.array([400.0, 200.0, 200.0, 0.0, -400.0, -410.0]), u_Fy=u_Fy))
    assert parts.Fy_odd[4] == pytest.approx(again.Fy_odd[4])
    assert parts.u_Fy_odd[4] == pytest.approx(np.hypot(4.0, 1.0) / 2.0)


def test_a_mirror_names_its_point_and_the_rest_name_none():
    points, _, _ = sweep(np.array([-3.0, -1.0, 0.0, 0.7, 1.0, 5.0]))
    parts = split(points)
    assert list(parts.paired) == ["interpolated", "exact", "exact", "interpolated", "exact", "unpaired"]
    assert list(parts.partner) == [-1, 4, 2, -1, 1, -1]


def test_a_mirror_of_the_same_sweep_is_preferred():
    """Set up anew between two sweeps, each is reflected in itself, even if the other meets the angle more closely."""
    alpha_deg = np.array([-2.0, 2.04, -2.03, 2.0])
    points, _, _ = sweep(alpha_deg, sweep=np.array([0, 0, 1, 1]), sweep_names=("a.csv", "b.csv"))
    assert list(split(points).partner) == [1, 0, 3, 2]


def test_the_closest_mirror_is_taken_camber_and_sideslip_together():
    points, _, _ = sweep(np.array([2.0, -2.04, -2.0]), np.array([10.0, -10.0, -10.1]))
    assert split(points).partner[0] == 1


def test_on_a_straight_path_nothing_is_decomposed_and_nothing_remarked():
    parts = split(sweep(np.array([-1.0, 0.0, 1.0]), phi_t=0.0)[0])
    assert set(parts.paired) == {"unpaired"}
    assert set(parts.partner) == {-1}
    assert parts.unpaired == ()
    assert np.all(np.isnan([parts.Fy_odd, parts.Fy_even, parts.Mz_odd, parts.Mz_even, parts.u_Fy_odd]))


@pytest.mark.parametrize(("count", "more"), [(6, ""), (7, " and 1 more")])
def test_at_most_six_points_without_mirror_are_named(count, more):
    points, _, _ = sweep(1.0 + np.arange(count), 2.0, sweep_names=("camber.csv",))
    (sentence,) = split(points).unpaired
    assert sentence == (
        f"no mirror (-alpha, -gamma) was measured for {count} points, which can only be used raw: {count} in camber.csv; "
        f"(alpha, gamma) = (1, 2), (2, 2), (3, 2), (4, 2), (5, 2), (6, 2){more} deg"
    )


def test_points_without_mirror_of_several_sweeps_are_one_sentence_that_names_each_angle_once():
    alpha_deg = np.array([1.0, 5.0, 5.0])
    points, _, _ = sweep(alpha_deg, sweep=np.array([0, 0, 1]), sweep_names=("a.csv", "b.csv"))
    (sentence,) = split(points).unpaired
    assert "for 3 points" in sentence
    assert sentence.endswith(": 2 in a.csv and 1 in b.csv; (alpha, gamma) = (1, 0), (5, 0) deg")


def test_the_parts_of_the_moment_have_its_uncertainty():
    parts = split(sweep(np.array([-2.0, 2.0]))[0])
    assert parts.u_Mz_odd == pytest.approx(0.6 / np.sqrt(2))


@pytest.mark.parametrize(
    ("name", "value", "tolerance"),
    [
        ("Fz", 1500.0, np.expm1(0.08) * 1500.0),
        ("p", 250e3, 10e3),
        ("V", 6.0, np.expm1(0.08) * 6.0),
        ("alpha", np.radians(-2.0), np.radians(0.05)),
        ("gamma", 0.0, np.radians(0.25)),
    ],
)
@pytest.mark.parametrize(("share", "paired"), [(0.9995, "exact"), (1.0005, "unpaired")])
def test_settings_count_as_the_same_up_to_the_tolerance(name, value, tolerance, share, paired):
    """Of the first point, whose mirror is the second: conditions of one level."""
    condition = {**COMMON, "alpha": np.radians([2.0, -2.0]), "gamma": 0.0, "Fy": np.array([-5.0, 5.0])}
    first = np.radians(2.0) if name == "alpha" else value
    points = make_points(**condition | {name: np.array([first, value + share * tolerance])})
    assert split(points).paired[0] == paired


def test_points_of_different_set_ups_are_no_mirrors():
    """The zeros of a load cell that was set up anew in between would be taken for side force."""
    points, odd, _ = sweep(np.array([-6.0, -3, -1, 0, 1, 3, 6]))
    anew = points.replace(
        setup=1 * (points.alpha > 0.0), setups=("A", "B"), Fy=points.Fy + 20.0 * (points.alpha > 0.0)
    )
    parts = split(anew)
    assert set(parts.paired[points.alpha != 0.0]) == {"unpaired"}
    both = concatenate(
        [anew.replace(setup=0, Fy=points.Fy), points.replace(setups=("B",), Fy=points.Fy + 20.0)]
    )
    np.testing.assert_allclose(split(both).Fy_odd, np.tile(odd, 2), atol=1e-9)
