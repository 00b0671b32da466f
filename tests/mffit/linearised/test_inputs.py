"""Which conditions a formula may miss a tyre over, read off a test."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.linearised.inputs import Input, along, inputs_of, settings_of, swept_of
from mffit.points import Points, make_points

UP = np.linspace(-0.1, 0.1, 21)
LOADS = (1000.0, 2000.0, 3000.0)


def programme(**fields: object) -> Points:
    """Sideslip sweeps at three loads, which wander by 2 %; two cambers, each with its own sweep."""
    random = np.random.default_rng(1)
    sweeps = [(load, gamma) for gamma in (0.0, 0.05) for load in LOADS]
    n = len(UP)
    given = {
        "p": 200e3,
        "V": 10.0,
        "phi_t": 0.0,
        "sweep": np.repeat(np.arange(len(sweeps)), n),
        "sweep_names": [f"s{k}" for k in range(len(sweeps))],
    } | fields
    return make_points(
        np.tile(UP, len(sweeps)),
        np.repeat([gamma for _, gamma in sweeps], n),
        np.repeat([load for load, _ in sweeps], n) * (1.0 + 0.02 * random.standard_normal(n * len(sweeps))),
        **given,
    )


def test_what_varies_is_an_input_with_the_distance_of_its_settings():
    found = {one.name: one for one in inputs_of(programme())}
    assert set(found) == {"alpha", "Fz", "gamma"}
    assert (found["alpha"].lower, found["alpha"].upper) == (-0.1, 0.1)
    assert found["alpha"].spacing == pytest.approx(0.2 / 12.0)  # it is swept
    assert found["Fz"].width / found["Fz"].spacing == pytest.approx(2.0)
    assert found["gamma"].spacing == pytest.approx(0.05)
    assert {name for name, one in found.items() if one.is_held} == {"Fz", "gamma"}


def test_a_setting_that_a_run_holds_does_not_wander_within_it():
    points = programme()
    inputs = inputs_of(points)
    at = settings_of(points, inputs)
    load = [one.name for one in inputs].index("Fz")
    for k in range(6):
        rows = points.sweep == k
        assert np.ptp(at[rows, load]) == 0.0
        assert at[rows, load][0] == pytest.approx(points.Fz[rows].mean())
    assert np.array_equal(at[:, 0], points.alpha)


def test_where_a_run_stands_along_what_it_sweeps():
    points = programme()
    inputs = inputs_of(points)
    assert set(swept_of(points, inputs).values()) == {"alpha"}
    assert along(points, inputs) == pytest.approx(np.tile(np.linspace(0.0, 1.0, 21), 6))


def test_a_prediction_averages_over_the_temperatures_of_a_test():
    warm = inputs_of(programme(T=np.linspace(40.0, 60.0, 126)))[-1]
    assert warm.name == "T"
    assert warm.averaged == pytest.approx((42.0, 50.0, 58.0))


def test_slip_that_goes_there_and_back_has_a_sense_whatever_the_temperature():
    """Nothing but the model error describes the hysteresis of slip, also where a belt gives finished points."""
    there = np.tile(np.r_[np.linspace(-0.1, 0.1, 11), np.linspace(0.1, -0.1, 11)[1:]], 6)
    driven = programme(kappa=there, T=np.linspace(40.0, 60.0, 126)).replace(alpha=np.zeros(126))
    inputs = inputs_of(driven)
    assert [one.name for one in inputs[-2:]] == ["T", "sense"]
    assert inputs[-1].averaged == (-1.0, 1.0)
    senses = settings_of(driven, inputs)[:, -1].reshape(6, 21)
    assert np.all(senses[:, :10] == 1.0)
    assert np.all(senses[:, 11:] == -1.0)


def test_a_temperature_that_was_measured_in_part_is_no_input():
    T = np.linspace(40.0, 60.0, 126)
    T[3] = np.nan
    assert "T" not in [one.name for one in inputs_of(programme(T=T))]


def test_two_paths_and_both_mounts_are_inputs():
    half = np.repeat([1, -1], 63)
    found = [one.name for one in inputs_of(programme(phi_t=0.75 * half, mount=half))]
    assert found[-2:] == ["mount", "phi_t"]


def test_a_wheel_that_rolls_backwards_is_one_turned_on_its_rim_that_rolls_forwards():
    """Backwards, camber and the curvature of the path are reversed in the axes in which the wheel rolls forwards."""
    half = np.repeat([1, -1], 63)
    whole = programme(phi_t=0.75 * half, direction=half)
    ahead = whole.replace(gamma=half * whole.gamma, phi_t=0.75, mount=half, direction=1)
    inputs = inputs_of(ahead)
    assert inputs_of(whole) == inputs
    assert "mount" in [one.name for one in inputs]
    assert settings_of(whole, inputs) == pytest.approx(settings_of(ahead, inputs))


def test_a_condition_that_runs_move_through_is_swept_however_few_its_settings():
    """Five angles in every run are a curve; three loads of a run each are not."""
    found = {
        one.name: one
        for one in inputs_of(programme().replace(alpha=np.resize([-0.1, -0.05, 0.0, 0.05, 0.1], 126)))
    }
    assert found["alpha"].width / found["alpha"].spacing == pytest.approx(12.0)
    assert found["Fz"].width / found["Fz"].spacing == pytest.approx(2.0)


def test_a_disc_was_tested_on_the_other_side_too():
    """With its mirror image each reading has the other sign of sideslip, camber and curvature."""
    found = {one.name: one for one in inputs_of(programme(phi_t=-0.75))}
    ends = {name: (one.lower, one.upper) for name, one in found.items() if one.mirrored}
    assert ends == {"alpha": (-0.1, 0.1), "gamma": (-0.05, 0.05), "phi_t": (-0.75, 0.75)}
    assert found["phi_t"].spacing == 0.75  # the straight road lies between the two settings
    assert not any(one.mirrored for one in inputs_of(programme()))  # a straight path is its own mirror image
    both = np.repeat([0.75, -0.75], 63)
    assert {one.name for one in inputs_of(programme(phi_t=both)) if one.mirrored} == set(ends)


@pytest.mark.parametrize(
    ("name", "lower", "upper"), [("kappa", -0.6, 0.0), ("Fz", 2.0 * np.exp(-0.3) - 1.0, 1.0)]
)
def test_beyond_a_range_a_curve_strays_as_one_whose_slope_wanders_at_random(name, lower, upper):
    """Drawn curves, each continued by the straight line through its values at the end and in the middle of the range."""
    step, n = 0.01, 91
    slope = np.cumsum(np.random.default_rng(3).standard_normal((4000, n)), axis=1) * np.sqrt(step)
    curve = np.cumsum(slope, axis=1) * step
    one, at = Input(name, lower, upper, 0.1), np.array([0.05, 0.15, 0.3])
    end, before = curve[:, 60:61], curve[:, 30:31]
    error = curve[:, [65, 75, 90]] - end - (end - before) / 0.3 * at
    found = one.strayed(upper + at if name == "kappa" else upper * np.exp(at))
    drawn = np.mean(error**2, axis=0)
    assert found / found[-1] == pytest.approx(drawn / drawn[-1], rel=0.1)
    assert not np.any(one.strayed(np.array([lower, 0.5 * (lower + upper), upper, np.nan])))


@pytest.mark.parametrize(("name", "is_angle"), [("alpha", True), ("gamma", True), ("kappa", False)])
def test_of_an_angle_the_mirror_image_of_what_was_tested_is_no_extrapolation(name, is_angle):
    one = Input(name, 0.0, 0.2, 0.02)
    assert np.all((one.strayed(np.array([-0.2, -0.05])) == 0.0) == is_angle)
    assert one.strayed(np.array([-0.25])) > 0.0
