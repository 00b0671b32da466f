"""The faults act as their definitions say; tests/mffit/rig/test_chain.py compares them with the forward model."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mffit.rig_errors import Faults
from mffit.virtual_rig.machine import Machine, at_the_tyre, steady, taken_up, true_alpha
from mffit.virtual_rig.settings import Settings

R = 1.323


def settings(alpha_deg, gamma_deg=0.0, direction=1, mount=1, T=25.0, V=6.0, t=0.0) -> Settings:
    rows = np.broadcast_arrays(alpha_deg, gamma_deg, direction, mount, T, V, t)
    alpha, gamma, direction, mount, T, V, t = (np.atleast_1d(row).astype(float) for row in rows)
    n = len(alpha)
    return Settings(
        np.radians(alpha),
        np.radians(gamma),
        np.full(n, 1400.0),
        np.full(n, 240e3),
        V,
        T,
        t,
        direction,
        mount,
        np.zeros(n),
    )


def machine(tyre, usual_speed=6.0, **faults) -> Machine:
    return Machine(tyre, Faults(**{"path_radius_m": R} | faults), -1, usual_speed)


def test_reported_forces_follow_the_stated_formula(tyre):
    s = settings(2.0, 10.0, T=45.0, V=8.0, t=1000.0)
    forces = tyre(1400.0, np.radians(2.5), np.radians(10.2), phi_t=-1 / 1.4, Vx=8.0, p=240e3)
    out = steady(
        machine(
            tyre, usual_speed=6.0, alpha_0_deg=0.5, gamma_0_deg=0.2, gain=1.1, F0_N=7.0, crosstalk=0.02,
            M0_Nm=0.4, path_radius_m=1.4, k_T_per_K=0.001, k_V_per_mps=0.01, k_t_per_s=1e-4,
        ),
        s,
    )  # fmt: skip
    surroundings = 1.02 * 1.02 * 1.1
    assert out.Fy[0] == pytest.approx(1.1 * surroundings * forces.Fy + 7.0 + 0.02 * 1400.0)
    assert out.Mz[0] == pytest.approx(surroundings * forces.Mz + 0.4)


def test_the_moment_takes_up_the_play(tyre):
    seen = settings([-3.0, 3.0])
    held = true_alpha(machine(tyre, backlash_deg=0.2), seen)
    Mz = at_the_tyre(machine(tyre), seen, seen.alpha).Mz
    assert Mz[0] < 0 < Mz[1]
    np.testing.assert_allclose(np.degrees(held - seen.alpha), [0.1, -0.1], atol=1e-12)


def test_a_wheel_floats_in_its_play_at_zero_moment(tyre):
    grid = settings(np.linspace(-1.0, 2.0, 61))
    mc = machine(tyre, backlash_deg=0.4)
    held = true_alpha(mc, grid)
    play = math.radians(0.2)
    floating = np.abs(held - grid.alpha) < play * 0.999
    assert floating.any()
    slope = 500.0  # Nm/rad, the tyre's: what a millionth of the play leaves of the moment
    assert np.abs(at_the_tyre(mc, grid, held).Mz[floating]).max() < slope * play * 1e-4
    assert np.all(np.diff(held) >= -1e-9)  # never jumps back


def test_play_holds_at_the_end_where_the_moment_says_so():
    rising = taken_up(lambda x: x, np.array([-1.0, 0.05, 1.0]), 0.1)
    np.testing.assert_allclose(rising, [-0.9, 0.0, 0.9], atol=1e-6)
    falling = taken_up(lambda x: -x, np.array([-1.0, -0.05, 0.05, 1.0]), 0.1)
    np.testing.assert_allclose(falling, [-1.1, -0.15, 0.15, 1.1], atol=1e-12)


def test_turn_slip_pushes_outwards_in_both_directions(tyre):
    out = steady(machine(tyre), settings(0.0, direction=[1, -1]))
    assert np.all(out.Fy < -300.0)


def test_the_slip_force_changes_sign_with_the_direction_and_camber_thrust_does_not(tyre):
    symmetric = tyre.replace(PHY1=0.0, PHY2=0.0, PVY1=0.0, PVY2=0.0, PEY3=0.0)
    mc = machine(symmetric)
    zero, slip = (steady(mc, settings(a, direction=[1, -1])).Fy for a in (0.0, 1.0))
    camber = steady(mc, settings(0.0, 3.0, direction=[1, -1])).Fy
    forward, backward = slip - zero
    assert forward < -200.0
    assert backward > 200.0
    assert np.all(camber - zero < -60.0)


def test_only_conicity_changes_with_the_mount(tyre):
    s = settings(0.0, mount=[1, -1])
    change = np.diff(steady(machine(tyre), s).Fy)[0]
    conicity = 2 * tyre["PVY1"] * 1400.0
    # Spin weakens conicity by zeta2, a few per cent here; QDZ6 and PEY3 do not show in Fy at small angles.
    assert change == pytest.approx(-conicity, rel=0.1)
    ply_steer = tyre.replace(PVY1=0.0, PVY2=0.0, PEY3=0.0)
    assert np.diff(steady(machine(ply_steer), s).Fy)[0] == pytest.approx(0.0, abs=1e-9)


def test_a_round_tread_that_leans_to_the_centre_rolls_on_a_smaller_circle(tyre):
    """The centre is to the left, to which the top leans at negative camber: the contact point follows it."""
    read = steady(machine(tyre, crown_m=0.08), settings(0.0, [-30.0, 30.0])).Fy
    for Fy, lean, radius in zip(read, (-30.0, 30.0), (R - 0.04, R + 0.04), strict=True):
        there = tyre(1400.0, 0.0, np.radians(lean), phi_t=-1.0 / radius, Vx=6.0, p=240e3)
        assert Fy == pytest.approx(there.Fy)


def test_a_disc_that_gives_way_slopes_outwards_under_the_wheel(tyre):
    """Seen from a surface that slopes to the right, an upright wheel leans to the left: negative camber."""
    read = steady(machine(tyre, disc_tilt_deg_per_kN=0.5), settings(0.0)).Fy
    assert read[0] == pytest.approx(tyre(1400.0, 0.0, np.radians(-0.7), phi_t=-1 / R, Vx=6.0, p=240e3).Fy)


def test_a_load_cell_that_leans_further_than_the_wheel_reads_part_of_the_load(tyre):
    """Its axis is turned by a share of the sine of camber: the component of the whole force along that axis."""
    lean = np.radians([-40.0, 25.0])
    true = steady(machine(tyre), settings(0.0, np.degrees(lean)))
    read = steady(machine(tyre, crosstalk_camber=1e-3), settings(0.0, np.degrees(lean)))
    turned = 1e-3 * np.sin(lean)
    np.testing.assert_allclose(read.Fy, true.Fy * np.cos(turned) + 1400.0 * np.sin(turned), atol=1e-3)
    assert np.max(np.abs(read.Fy - true.Fy)) > 0.5


def test_a_zero_that_turns_with_the_rolling_looks_like_a_sideslip_force(tyre):
    way = np.array([1, -1])
    read = steady(machine(tyre, F0_direction_N=10.0), settings(0.0, direction=way)).Fy
    np.testing.assert_allclose(read - steady(machine(tyre), settings(0.0, direction=way)).Fy, 10.0 * way)
