"""Rolling resistance beside the zero of My, from readings that this file computes with its own formula."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import tir
from mffit.config import Declaration
from mffit.fit.wheel.rolling import coasting, rolling_resistance
from mffit.points import Points, make_points

R0, FNOMIN, NOMPRES, LONGVL, ZERO, U = 0.3, 4000.0, 200e3, 16.0, 3.0, 0.05
TRUTH = {"QSY1": 0.009, "QSY3": 0.0008, "QSY4": 6e-5, "QSY7": 0.9, "QSY8": -0.4}
VALUES = dict(tir.Tyre.from_values({}).values) | {
    "UNLOADED_RADIUS": R0, "FNOMIN": FNOMIN, "NOMPRES": NOMPRES, "LONGVL": LONGVL,
}  # fmt: skip


def rolling(loads=(1000.0, 2500.0, 4000.0, 6000.0), speeds=(8.0, 16.0, 30.0), zero=ZERO, **others) -> Points:
    Fz, p, V = (x.ravel() for x in np.meshgrid(loads, (150e3, 200e3, 250e3), speeds))
    s = V / LONGVL
    share = TRUTH["QSY1"] + TRUTH["QSY3"] * s + TRUTH["QSY4"] * s**4
    My = -R0 * FNOMIN * share * (Fz / FNOMIN) ** TRUTH["QSY7"] * (p / NOMPRES) ** TRUTH["QSY8"]
    My = My + zero + U * np.random.default_rng(3).standard_normal(len(Fz))
    return make_points(0.0, 0.0, Fz, p=p, V=V, phi_t=0.0, Fy=0.0, My=My, u_My=U, **others)


def test_all_terms_are_recovered_beside_a_zero_of_the_rig():
    result = rolling_resistance(VALUES, rolling(), Declaration(0.0, 5.0))
    assert set(result.found) == set(TRUTH)
    for name, true in TRUTH.items():
        value, u, *_ = result.found[name]
        assert abs(value - true) < 3.0 * u, name
    assert result.found["QSY1"].u < 0.05 * TRUTH["QSY1"]
    value, u = result.zeros["My0_Nm"]
    assert value == pytest.approx(ZERO, abs=3.0 * u)
    assert u < 0.5


def test_every_set_up_has_a_zero_of_its_own():
    points = rolling(setups=("one", "two"), setup=np.arange(36) % 2)
    points = replace(points, My=points.My + np.where(points.setup == 1, 2.0, 0.0))
    zeros = rolling_resistance(VALUES, points, Declaration(0.0, 5.0)).zeros
    assert list(zeros) == ["My0_Nm@one", "My0_Nm@two"]
    assert zeros["My0_Nm@two"][0] - zeros["My0_Nm@one"][0] == pytest.approx(2.0, abs=0.1)


def test_one_load_does_not_separate_the_zero_and_the_uncertainty_says_so():
    result = rolling_resistance(VALUES, rolling(loads=(4000.0,), speeds=(16.0,)), Declaration(0.0, 5.0))
    assert not result.zeros
    assert "QSY7" not in result.found
    value, u, *_ = result.found["QSY1"]
    assert u == pytest.approx(5.0 / (R0 * FNOMIN), rel=0.3)
    assert abs(value - 0.00986) < 2.0 * u


def test_points_with_slip_and_coefficients_held_by_hand_stay_out():
    assert not rolling_resistance(VALUES, rolling(kappa=0.1), Declaration(0.0, 5.0)).found
    held = rolling_resistance(VALUES, rolling(), Declaration(0.0, 0.0), held=("QSY1",))
    assert "QSY1" not in held.found
    assert not held.zeros


def test_a_coasting_wheel_shows_rolling_resistance_by_its_longitudinal_force():
    """The moments about the axis of a wheel that nothing drives balance; a sweep with slip or sideslip says nothing of that."""
    measured = rolling()
    radius = 0.29 - measured.Fz / 200e3
    force = measured.replace(My=np.nan, Fx=measured.My / radius, u_Fx=U / radius, RL=radius)
    found = rolling_resistance(VALUES, coasting(force, VALUES), Declaration(0.0, 20.0 * R0)).found
    assert abs(found["QSY1"].value - TRUTH["QSY1"]) < 3.0 * found["QSY1"].u < 0.15 * TRUTH["QSY1"]
    stiffness = {**VALUES, "VERTICAL_STIFFNESS": 200e3}
    estimated = coasting(force.replace(RL=np.nan), stiffness).My
    assert estimated == pytest.approx(coasting(force, VALUES).My * (radius + 0.01) / radius)
    slipping = force.replace(kappa=np.where(np.arange(len(force)) == 5, 0.1, 0.0))
    assert not len(coasting(slipping, VALUES))
    assert not len(coasting(force.replace(alpha=0.05), VALUES))
