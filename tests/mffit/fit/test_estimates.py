"""Estimates of what was not measured lie within the range of road tyres."""

from __future__ import annotations

import numpy as np
import pytest

import tir
from mffit.fit.known import estimates

SIZES = {"motorcycle": (1400.0, 0.2992, 0.12), "car": (4000.0, 0.32, 0.205)}


@pytest.fixture(params=SIZES, scope="module")
def tyre(request) -> tir.Tyre:
    """Lateral coefficients of a road tyre; all others are estimates."""
    Fz, R0, width = SIZES[request.param]
    known = tir.Tyre.from_values({}).replace(
        FNOMIN=Fz, UNLOADED_RADIUS=R0, WIDTH=width, PCY1=1.4, PDY1=1.1, PDY2=-0.1, PEY1=-1.0, PKY1=-16.0, PKY2=1.6, QSX2=0.0
    )  # fmt: skip
    return known.replace(**estimates(known.values))


def test_slip_stiffness_is_one_to_two_cornering_stiffnesses(tyre):
    state = tyre.state(tyre["FNOMIN"])
    assert 1.0 < state.K_xk / abs(state.K_ya) < 2.0


@pytest.mark.parametrize(
    ("PKY1", "PKY2", "PKY4"), [(-54.6, 1.41, 0.64), (-12.0, 0.4, 2.0), (-80.0, 6.0, 1.0)]
)
def test_slip_stiffness_is_in_the_published_range_whatever_the_shape_of_the_cornering_stiffness(
    tyre, PKY1, PKY2, PKY4
):
    """Where the cornering stiffness peaks says nothing of it at the nominal load; nor does another inflation pressure."""
    shaped = tyre.replace(PKY1=PKY1, PKY2=PKY2, PKY4=PKY4, PPY1=0.5, INFLPRES=1.3 * tyre["NOMPRES"])
    found = shaped.replace(**estimates(shaped.values)).state(tyre["FNOMIN"], p=tyre["NOMPRES"])
    assert 0.8 < found.K_xk / abs(found.K_ya) < 1.8


def test_the_tyre_brakes_as_hard_as_it_corners(tyre):
    for load in (0.7, 1.0, 1.4):
        Fz = load * tyre["FNOMIN"]
        brake = np.max(np.abs(tyre(Fz, kappa=np.linspace(-0.4, 0.4, 161)).Fx))
        corner = np.max(np.abs(tyre(Fz, np.linspace(-0.35, 0.35, 161)).Fy))
        assert brake == pytest.approx(corner, rel=0.02)
    slip = np.linspace(0.0, 1.0, 101)
    Fx = tyre(tyre["FNOMIN"], kappa=slip).Fx
    assert 0.05 < slip[Fx.argmax()] < 0.3
    assert 0.6 < Fx[-1] / Fx.max() < 1.0


def test_braking_reduces_the_side_force_and_cornering_the_braking_force(tyre):
    Fz = tyre["FNOMIN"]
    alone, both = tyre(Fz, 0.06), tyre(Fz, 0.06, kappa=-0.1)
    assert 0.2 < both.Fy / alone.Fy < 0.95
    assert 0.2 < tyre(Fz, 0.12, kappa=-0.05).Fx / tyre(Fz, kappa=-0.05).Fx < 0.95


def test_its_static_deflection_is_a_twentieth_of_its_radius(tyre):
    sunk = tyre["FNOMIN"] / tyre["VERTICAL_STIFFNESS"]
    assert sunk == pytest.approx(0.05 * tyre["UNLOADED_RADIUS"])
    # Hysteresis of rubber: at 10 Hz, 2 to 10 % of critical stiffness.
    assert 0.02 < 2 * np.pi * 10.0 * tyre["VERTICAL_DAMPING"] / tyre["VERTICAL_STIFFNESS"] < 0.1


def test_the_rolling_radius_lies_between_the_loaded_and_the_unloaded_one(tyre):
    Fz, R0 = tyre["FNOMIN"], tyre["UNLOADED_RADIUS"]
    assert R0 - Fz / tyre["VERTICAL_STIFFNESS"] < tyre.state(Fz).Re < R0
    light, heavy = tyre.state(0.5 * Fz).Re, tyre.state(2.0 * Fz).Re
    assert heavy < light


def test_the_relaxation_length_is_some_tenths_of_a_metre(tyre):
    state = tyre.state(tyre["FNOMIN"])
    assert 0.05 < state.sigma_y < 0.5
    assert 0.02 < state.sigma_x < 0.5


def test_its_rolling_resistance_is_a_hundredth_of_the_load(tyre):
    Fz = tyre["FNOMIN"]
    assert -tyre(Fz, Vx=20.0).My / (Fz * tyre["UNLOADED_RADIUS"]) == pytest.approx(0.01, rel=0.3)


def test_a_cambered_wheel_is_pushed_upright_by_the_width_of_its_tread(tyre):
    """The contact wanders by less than half the width; ISO-W: positive Mx turns a wheel cambered to -y back."""
    Fz = tyre["FNOMIN"]
    arm = (tyre(Fz, gamma=0.2).Mx - tyre(Fz, gamma=-0.2).Mx) / (2.0 * 0.2 * Fz)
    assert 0.05 < abs(arm) / tyre["WIDTH"] < 1.0
