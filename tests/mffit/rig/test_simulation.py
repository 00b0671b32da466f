"""Derivatives of a rig's readings by every number in the simulation, against differences of the readings."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import tir
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME, NO_FAULTS, Faults

SAMPLES = Path(__file__).parents[3] / "samples"
FAULTS = Faults(
    alpha_0_deg=0.3,
    camber_skew_deg=0.4,
    gamma_0_deg=-0.4,
    load_camber=-0.05,
    gain=1.02,
    nonlinearity_per_kN=0.02,
    F0_N=8.0,
    crosstalk=0.01,
    M0_Nm=0.5,
    backlash_deg=0.2,
    path_radius_m=1.31,
    hysteresis_deg=0.1,
    k_T_per_K=1e-3,
    k_T_grip_per_K=1e-3,
    k_T_stiffness_per_K=-1e-3,
    k_V_per_mps=2e-3,
    k_t_per_s=1e-6,
    wear_per_km=1e-3,
    warm_up=0.02,
)
YIELDING = FAULTS.replace(backlash_deg=0.0, compliance_deg_per_Nm=0.006)
"""A steering that gives way to the moment; without play, whose side is held while derivatives are taken."""
STEPS = {"k_t_per_s": 1e-9, "k_T_per_K": 1e-6, "k_T_grip_per_K2": 1e-7, "crosstalk": 1e-5}


@pytest.fixture(scope="module")
def points():
    rng = np.random.default_rng(8)
    n = 50
    return make_points(
        rng.uniform(-0.12, 0.12, n), rng.uniform(-0.7, 0.7, n), rng.uniform(800.0, 2000.0, n), p=250e3,
        V=rng.choice([6.0, 9.0], n), T=rng.uniform(20.0, 60.0, n), t=rng.uniform(0.0, 4000.0, n), phi_t=-1 / 1.323,
        direction=rng.choice([1, -1], n), mount=rng.choice([1, -1], n),
    )  # fmt: skip


@pytest.fixture(scope="module")
def simulation():
    return Simulation.of(tir.read("samples/front-120-70/true.tir"), FAULTS)


@pytest.mark.parametrize("name", [*BY_NAME, "PKY1", "PECP1", "PHY1", "QDZ8", "PVY1"])
def test_a_sensitivity_is_the_slope_of_the_readings(points, simulation, name):
    step = STEPS.get(name, 1e-5)
    value = simulation.number(name, points)
    up, down = (simulation.with_numbers({name: value + s}).predict(points) for s in (step, -step))
    _, slope = simulation.sensitivities(points, [name])
    expected = (up - down) / (2.0 * step)
    assert slope.stacked[:, 0] == pytest.approx(expected, abs=1e-5 * (1.0 + np.max(np.abs(expected))))


@pytest.mark.parametrize("name", ["compliance_deg_per_Nm", "alpha_0_deg", "k_T_grip_per_K", "PKY1", "QDZ1"])
def test_a_yielding_steering_passes_every_slope_on(points, simulation, name):
    """The angle at which moment and steering agree moves with every number that moves the moment."""
    yielding = replace(simulation, faults=YIELDING)
    value = yielding.number(name, points)
    up, down = (yielding.with_numbers({name: value + s}).predict(points) for s in (1e-5, -1e-5))
    expected = (up - down) / 2e-5
    slope = yielding.sensitivities(points, [name])[1].stacked[:, 0]
    assert slope == pytest.approx(expected, abs=1e-5 * (1.0 + np.max(np.abs(expected))))


def test_a_wheel_on_a_yielding_steering_stands_where_moment_and_steering_agree(points):
    tyre = tir.read("samples/front-120-70/true.tir")
    normal = points.replace(mount=1)
    plain, soft = (Simulation.of(tyre, Faults(compliance_deg_per_Nm=k)) for k in (0.0, 0.01))
    Mz = soft.readings(normal).Mz
    turned = normal.replace(alpha=normal.alpha + np.radians(0.01 * Mz))
    assert plain.readings(turned).Mz == pytest.approx(Mz, abs=1e-4)


def test_sensitivities_come_with_the_readings(points, simulation):
    out, slope = simulation.sensitivities(points, ["PKY1", "F0_N"])
    # The angle that play and compliance leave is found step by step: that far and no further.
    assert out.stacked == pytest.approx(simulation.predict(points), rel=1e-6)
    assert slope.Fy.shape == slope.Mz.shape == (50, 2)
    assert np.all(slope.Fy[:, 1] == 1.0)
    assert np.all(slope.Mz[:, 1] == 0.0)


def test_the_lag_of_a_continuous_sweep_has_a_slope_too(simulation):
    time = np.cumsum(np.random.default_rng(1).uniform(0.05, 0.2, 80))
    sweep = make_points(
        0.1 * np.sin(time), 0.0, 1400.0, p=250e3, V=2.0, phi_t=-1 / 1.323, continuous=True, time=time
    )
    lagging = simulation.with_numbers({"relaxation_m": 0.3})
    up, down = (lagging.with_numbers({"relaxation_m": 0.3 + s}).predict(sweep) for s in (1e-4, -1e-4))
    _, slope = lagging.sensitivities(sweep, ["relaxation_m"])
    expected = (up - down) / 2e-4
    assert slope.stacked[:, 0] == pytest.approx(expected, abs=2e-3 * np.max(np.abs(expected)))


def test_a_perfect_rig_reads_the_tyre(points):
    tyre = tir.read("samples/front-120-70/true.tir")
    normal = points.replace(mount=1)
    forces = tyre(normal.Fz, normal.alpha, normal.gamma, phi_t=normal.phi_t, Vx=normal.Vx, p=normal.p)
    read = Simulation.of(tyre, NO_FAULTS).readings(normal)
    assert read.Fy == pytest.approx(forces.Fy)
    assert read.Mz == pytest.approx(forces.Mz)


def test_points_as_the_tyre_felt_them():
    """Readings of the rig's own formulae; what the tyre had and what it gave come back, as plain numbers of the faults."""
    tyre = tir.read(SAMPLES / "front-120-70" / "true.tir")
    faults = Faults(alpha_0_deg=0.3, gamma_0_deg=-0.5, F0_N=25.0, crosstalk=0.01, M0_Nm=2.0)
    points = make_points(
        np.radians([-4.0, 1.0, 6.0]),
        np.radians([-20.0, 0.0, 30.0]),
        [900.0, 1400.0, 2100.0],
        p=250e3,
        V=6.0,
        phi_t=-0.75,
    )
    simulation = Simulation.of(tyre, faults)
    readings = simulation.readings(points)
    felt = simulation.felt(points.replace(Fy=readings.Fy + 7.0, Mz=readings.Mz))
    assert felt.alpha == pytest.approx(points.alpha + math.radians(0.3))
    assert felt.gamma == pytest.approx(points.gamma - math.radians(0.5))
    forces = tyre(felt.Fz, felt.alpha, felt.gamma, phi_t=felt.phi_t, Vx=6.0, p=250e3, turn_slip=True)
    assert felt.Fy == pytest.approx(forces.Fy + 7.0)
    assert felt.Mz == pytest.approx(forces.Mz)
    assert readings.Fy == pytest.approx(forces.Fy + 25.0 + 0.01 * points.Fz)
