"""A wheel with play, against the virtual rig, which works its faults out apart from the forward model."""

from __future__ import annotations

import numpy as np
import pytest

import tir
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig.play import settled
from mffit.rig_errors import Faults
from mffit.virtual_rig.machine import Machine, steady
from mffit.virtual_rig.settings import Settings

PLAY, RADIUS = 0.2, 1.323  # deg, m


@pytest.fixture(scope="module")
def tyre():
    return tir.read("samples/rear-190-55/true.tir")


@pytest.fixture(scope="module")
def points():
    """Sideslip in steps far smaller than the play, on either side of where the moment vanishes; two cambers, both directions."""
    alpha, gamma, direction = np.meshgrid(np.radians(np.linspace(-3, 3, 241)), [0.01, 0.5], [1, -1])
    return make_points(
        alpha.ravel(), gamma.ravel(), 1400.0, p=250e3, V=5.0, phi_t=-1.0 / RADIUS, direction=direction.ravel()
    )


@pytest.fixture(scope="module")
def simulation(tyre):
    return Simulation.of(tyre, Faults(backlash_deg=PLAY, path_radius_m=RADIUS, alpha_0_deg=0.03))


def test_the_rig_reads_what_the_virtual_rig_reports(tyre, points, simulation):
    machine = Machine(tyre, Faults(backlash_deg=PLAY, path_radius_m=RADIUS, alpha_0_deg=0.03), -1, 5.0)
    n = len(points)
    settings = Settings(
        points.alpha, points.gamma, points.Fz, points.p, points.V, np.full(n, 25.0), np.zeros(n),
        points.direction, points.mount, np.zeros(n),
    )  # fmt: skip
    expected = steady(machine, settings)
    read = simulation.readings(points)
    assert read.Fy == pytest.approx(expected.Fy, abs=0.05)
    assert read.Mz == pytest.approx(expected.Mz, abs=1e-3)


def test_the_wheel_floats_as_far_as_the_play_reaches(points, simulation):
    """In between neither stop holds it: force stays the same, and there is no moment."""
    Mz = simulation.readings(points).Mz
    forward = (points.direction > 0) & (points.gamma < 0.1)
    floats = forward & (np.abs(Mz) < 1e-9)
    width = np.ptp(points.alpha[floats]) + np.radians(6.0 / 240)
    assert np.degrees(width) == pytest.approx(PLAY, abs=6.0 / 240)
    assert np.ptp(simulation.readings(points).Fy[floats]) == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize("name", ["PKY1", "QDZ1", "PECP1", "gamma_0_deg", "backlash_deg", "alpha_0_deg"])
def test_what_a_floating_wheel_reads_changes_as_the_sensitivity_says(points, simulation, name):
    value = simulation.number(name, points)
    up, down = (simulation.with_numbers({name: value + s}).readings(points) for s in (1e-5, -1e-5))
    out, slope = simulation.sensitivities(points, [name])
    floats = np.abs(out.Mz) < 1e-9
    # A point that comes to rest at a stop within the difference has no slope to compare.
    same = floats & (np.abs(up.Mz) < 1e-9) & (np.abs(down.Mz) < 1e-9)
    assert same.sum() > 10
    expected = (up.Fy - down.Fy)[same] / 2e-5
    assert slope.Fy[same, 0] == pytest.approx(expected, abs=1e-4 * (1.0 + np.max(np.abs(expected))))


def test_a_moment_that_turns_away_from_zero_leaves_the_wheel_at_a_stop():
    """Unstable in the middle: it lies where the moment in the middle turned it."""
    alpha = np.array([0.0005, -0.0005])
    rest = settled(lambda which: lambda at: -at, alpha, 0.002)
    assert not rest.floats.any()
    assert rest.side.tolist() == [-1.0, 1.0]


def test_without_any_moment_the_wheel_stays_where_it_is():
    rest = settled(lambda which: lambda at: 0.0 * at, np.array([0.01]), 0.002)
    assert rest.alpha == pytest.approx([0.01])


def test_the_angle_without_moment_is_found_within_a_few_evaluations():
    """The moment is nearly linear over the play, and a call of the tyre costs far more than the search."""
    calls = []

    def moment_of(which):
        def moment(alpha):
            calls.append(len(alpha))
            return 30.0 * np.tanh(25.0 * (alpha - 0.0012)) + 4e4 * (alpha - 0.0012) ** 3

        return moment

    rest = settled(moment_of, np.array([0.0, 0.0005, 0.002]), 0.0026)
    assert rest.floats.all()
    assert rest.alpha == pytest.approx(0.0012, abs=1e-9)
    assert len(calls) <= 4


@pytest.mark.parametrize("steep", [1.0, 100.0, 300.0])
def test_a_wheel_floats_where_a_strongly_bent_moment_vanishes(steep):
    """Exponential moments whose zeros lie anywhere within a play of 0.02 rad: by bisection, to a hundredth of a millirad."""
    zeros = np.linspace(-0.0095, 0.0095, 23)
    signs = np.where(np.arange(23) % 2, 1.0, -1.0)

    def moment_of(which):
        return lambda alpha: signs[which] * np.expm1(signs[which] * steep * (alpha - zeros[which]))

    found = settled(moment_of, np.zeros(23), 0.01)
    assert np.all(found.floats)
    assert found.alpha == pytest.approx(zeros, abs=1e-5)
