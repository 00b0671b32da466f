"""Every rig error, in the chain and by the independent formula of the virtual rig."""

from __future__ import annotations

import math

import numpy as np
import pytest

import tir
from mffit.fit.influences.nuisances import NUISANCES
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig.lag import lagged_setting
from mffit.rig_errors import BY_NAME, DECLARED, RIG_ERRORS, AtZero, Faults, Place
from mffit.rig_errors import formulae as chain_formulae
from mffit.virtual_rig.machine import Machine, steady
from mffit.virtual_rig.recording import lagged
from mffit.virtual_rig.settings import Settings
from tir.temperature import SCALED_BY

R, LOAD = 1.323, 1400.0
FORCES = ("Fx", "Fy", "Mx", "My", "Mz")
SIZES = {
    "relaxation_m": 0.4,
    "path_radius_m": 1.40,
    "gain": 1.03,
    "T_ref_degC": 40.0,
    "p_ref_kPa": 180.0,
    "V_ref_mps": 8.0,
    "backlash_deg": 0.3,
    "crosstalk_Fx_Mz_m": 0.02,
    "crosstalk_Fx_Mx_m": 0.02,
}
"""Sizes of those whose double usual size would be no sensible one."""
BESIDE = {
    "T_ref_degC": {"k_T_per_K": 0.002},
    "p_ref_kPa": {"k_p_arm_per_kPa": 1e-3},
    "V_ref_mps": {"k_V_per_mps": 0.005},
}
"""What an error needs beside it to show."""


def size(name: str) -> float:
    return SIZES.get(name, 2.0 * BY_NAME[name].spread)


@pytest.fixture(scope="module")
def tyre():
    return tir.read("samples/front-120-70/true.tir")


@pytest.fixture(scope="module")
def settings() -> Settings:
    """Sideslip up and down at six conditions, all other channels varied; one sweep, times with changing speed."""
    up = np.linspace(-7.0, 7.0, 15)
    alpha = np.radians(np.concatenate([up, up[::-1] + 0.5]))
    n = len(alpha)
    rng = np.random.default_rng(5)
    t = np.sort(rng.uniform(0.0, 900.0, n))
    V = np.where(t < 500.0, 6.0, 9.0)
    rolled = [0.5 * (V[i] + V[i + 1]) * (t[i + 1] - t[i]) for i in range(n - 1)]
    return Settings(
        alpha=alpha,
        gamma=np.radians(rng.uniform(-50.0, 50.0, n)),
        Fz=LOAD + rng.uniform(-500.0, 500.0, n),
        p=230e3 + 30e3 * np.cos(np.arange(n)),
        V=V,
        T=rng.uniform(20.0, 60.0, n),
        t=t,
        direction=np.where(np.arange(n) % 3 == 0, -1, 1),
        mount=np.where(np.arange(n) % 4 == 0, -1, 1),
        rolled_m=t[0] * V[0] + np.cumsum([0.0, *rolled]),
    )


def by_the_chain(tyre, s: Settings, **faults):
    points = make_points(
        s.alpha, s.gamma, s.Fz, p=s.p, V=s.V, phi_t=-1 / R, T=s.T, t=s.t, direction=s.direction, mount=s.mount
    )
    return Simulation.of(tyre, Faults(**faults)).readings(points, FORCES)


def by_the_virtual_rig(tyre, s: Settings, **faults):
    return steady(Machine(tyre, Faults(**{"path_radius_m": R, **faults}), -1, 6.0), s)


FREED = {name for nuisance in NUISANCES for name in nuisance.numbers}
STEADY = [error.name for error in RIG_ERRORS if error.name != "relaxation_m"]


@pytest.mark.parametrize("name", STEADY)
def test_the_chain_agrees_with_the_independent_formula(tyre, settings, name):
    """Away from both ends, where "up" and "down" mean different things at the turning point."""
    faults = {name: size(name), **BESIDE.get(name, {})}
    chain, rig = by_the_chain(tyre, settings, **faults), by_the_virtual_rig(tyre, settings, **faults)
    inside = np.r_[1:14, 16:29] if name == "hysteresis_deg" else slice(None)
    differs = f"{name}: the formulae in mffit/rig_errors and in mffit/virtual_rig/machine.py differ"
    for channel in FORCES:
        a, b = chain[channel][inside], getattr(rig, channel)[inside]
        np.testing.assert_allclose(a, b, rtol=1e-8, atol=1e-5 if "M" in channel else 1e-3, err_msg=differs)


@pytest.mark.parametrize("place", list(Place), ids=lambda place: place.name)
def test_errors_of_one_place_act_in_the_order_of_the_independent_formulae(tyre, settings, place):
    """Together, without hysteresis, compliance and play: their formulae assume that only one of them acts."""
    alone = ("hysteresis_deg", "compliance_deg_per_Nm", "backlash_deg")
    names = [error.name for error in RIG_ERRORS if error.place is place and error.name not in alone]
    faults = {name: size(name) for name in names if name in STEADY}
    chain, rig = by_the_chain(tyre, settings, **faults), by_the_virtual_rig(tyre, settings, **faults)
    differs = f"{', '.join(faults)}: together they act in another order in mffit/virtual_rig/machine.py"
    for channel in FORCES:
        a, b = chain[channel], getattr(rig, channel)
        np.testing.assert_allclose(a, b, rtol=1e-8, atol=1e-5 if "M" in channel else 1e-3, err_msg=differs)


@pytest.mark.parametrize("name", STEADY)
def test_the_comparison_would_see_a_wrong_sign_or_size(tyre, settings, name):
    """Half the error, or its reverse, is far outside the tolerance of the comparison."""
    beside, undisturbed = BESIDE.get(name, {}), BY_NAME[name].undisturbed
    if math.isnan(undisturbed):
        undisturbed = {"path_radius_m": R, "p_ref_kPa": 1e-3 * tyre["NOMPRES"], "V_ref_mps": 6.0}[name]
    whole = by_the_chain(tyre, settings, **{name: size(name), **beside})
    for share in (0.5, -1.0):
        value = undisturbed + share * (size(name) - undisturbed)
        if value < BY_NAME[name].lower:
            continue
        other = by_the_chain(tyre, settings, **{name: value, **beside})
        apart = max(np.max(np.abs(a - b)) for a, b in zip(whole.values(), other.values(), strict=True))
        assert apart > 0.05


def test_the_lag_agrees_with_the_independent_filter():
    rate, V, sigma = 20.0, 6.0, SIZES["relaxation_m"]
    time = np.arange(400) / rate
    alpha = np.radians(5.0 * np.sin(1.3 * time))
    points = make_points(alpha, 0.0, LOAD, p=240e3, V=V, phi_t=0.0, continuous=True, time=time)
    follows, slope = lagged_setting(points, sigma)
    np.testing.assert_allclose(follows, lagged(alpha, V, sigma, rate), atol=1e-12)
    up, down = (lagged(alpha, V, sigma + step, rate) for step in (1e-6, -1e-6))
    np.testing.assert_allclose(slope, (up - down) / 2e-6, atol=1e-8)


@pytest.mark.parametrize("error", RIG_ERRORS, ids=lambda error: error.name)
def test_a_record_is_complete(error):
    assert error.unit
    assert error.meaning
    assert (
        error.lower
        < (error.undisturbed if not math.isnan(error.undisturbed) else R) + error.spread
        < error.upper
    )
    if error.place is None:
        assert error.formula is None
        return
    assert isinstance(error.place, Place)
    assert error.acts_on
    assert error.seen_as or error.declared or error.name in FREED, "no effect shows it, and no fit frees it"


def test_every_formula_belongs_to_an_error_and_every_error_in_the_chain_has_one():
    known = chain_formulae
    in_chain = {error.name: error for error in RIG_ERRORS if error.place is not None}
    assert all(error.formula for error in in_chain.values())
    assert known.FORMULAE.keys() <= in_chain.keys()
    declared = {error.name for error, _ in DECLARED}
    assert {*known.FORCE_AT_ZERO, *known.CAMBER_STIFFNESS, *known.CALIBRATES} <= declared


def test_the_terms_of_temperature_act_on_the_factors_of_the_property_file():
    for name, factor in SCALED_BY.items():
        assert BY_NAME[name].acts_on == (factor,)


def test_an_unknown_error_is_refused_by_name():
    with pytest.raises(KeyError, match="slack is no rig error"):
        Faults(slack=1.0)


def test_faults_compare_by_what_is_disturbed():
    assert Faults(F0_N=3.0) == Faults().replace(F0_N=3.0) != Faults()
    assert repr(Faults(F0_N=3.0)) == "Faults(F0_N=3.0)"
    assert hash(Faults(F0_N=3.0)) == hash(Faults(F0_N=3.0))


@pytest.mark.parametrize("error", RIG_ERRORS, ids=lambda error: error.name)
def test_an_error_acts_if_any_of_its_numbers_is_known_and_not_the_undisturbed_one(error):
    """Of an array with one number per point as of a plain number."""
    usual, other = (
        error.undisturbed,
        (0.0 if math.isnan(error.undisturbed) else error.undisturbed) + error.spread,
    )
    for number, acts in ((usual, False), (math.nan, False), (other, True)):
        assert error.acts(number) is acts
        assert error.acts(np.array([usual, math.nan, number])) is acts


@pytest.mark.parametrize(
    ("name", "number", "turned_deg", "slope"),
    [
        ("backlash_deg", 0.3, 0.15, "C_alpha"),
        ("gamma_0_deg", 0.5, 0.5, "C_gamma"),
        ("disc_tilt_deg_per_kN", 0.2, 0.28, "C_gamma"),
    ],
)
def test_an_angle_adds_the_force_of_its_slope_to_a_zero(name, number, turned_deg, slope):
    """Half the play to the side of the moment, and the tilt of a disc under 1.4 kN."""
    at = AtZero(C_alpha=-20e3, C_gamma=-1500.0, side_of_play=1.0, load=1400.0)
    force = BY_NAME[name].declared.force_at_zero(number, at)
    assert force == pytest.approx(getattr(at, slope) * np.radians(turned_deg))
