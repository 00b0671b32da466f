"""Starting values, radii and ranges that are read off the data before the fit, against the tyre that made the data."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
from small_rigs import truth

import tir
from mffit.fit import ranges
from mffit.fit.agreement import agreement
from mffit.fit.ranges import plausible_ranges
from mffit.fit.rig.zeros import epsilon_gamma_of_model, zero_points
from mffit.fit.start import camber_stiffness_terms, starting_values
from mffit.points import make_points
from tir import Quantity

LOADS = (900.0, 1400.0, 2100.0)
STEP = 1e-4


@pytest.fixture(scope="module")
def tyre() -> tir.Tyre:
    return truth()


def camber_slope(tyre, Fz, **condition):
    up, down = (tyre(Fz, gamma=s, **{"turn_slip": False, **condition}).Fy for s in (STEP, -STEP))
    return float(up - down) / (2.0 * STEP)


@pytest.mark.parametrize("changes", [{}, {"LKYC": 1.2}, {"LFZO": 1.1}, {"PPY5": -0.3}])
@pytest.mark.parametrize("loads", [LOADS[:1], LOADS[::2], LOADS])
def test_camber_terms_give_the_measured_stiffness(tyre, loads, changes):
    """Specific stiffnesses on a straight line over load, as K_yg0 / Fz is, are all reproduced; PVY3 and PHY terms are zero."""
    model = tyre.replace(PVY3=0.0, PVY4=0.0, PKY7=0.1, **changes)
    specific = -1.1 - 0.2 * (np.array(loads) / 1400.0 - 1.0)
    measured = dict(zip(loads, np.array(loads) * specific, strict=True))
    found = model.replace(**camber_stiffness_terms(model.values, measured, 220e3))
    for load, stiffness in measured.items():
        assert camber_slope(found, load, p=220e3) == pytest.approx(stiffness, rel=1e-3)


def test_no_measured_stiffness_changes_nothing(tyre):
    assert camber_stiffness_terms(tyre.values, {}, 250e3) == {}


def measured_of(C_alpha, C_gamma, r_e=None):
    by = {"C_alpha": C_alpha, "C_gamma": C_gamma}
    return SimpleNamespace(by_load=lambda key: by[key], r_e=r_e)


def campaign(tyre, phi_t=-1 / 1.323):
    alpha = np.tile(np.radians(np.linspace(-8.0, 8.0, 17)), 3)
    Fz = np.repeat(LOADS, 17)
    return make_points(
        alpha, 0.0, Fz, p=250e3, V=6.0, phi_t=phi_t, Fy=tyre(Fz, alpha, phi_t=phi_t or None).Fy
    )


@pytest.mark.parametrize("loads", [(1400.0,), LOADS])
def test_the_start_has_the_measured_cornering_stiffness_and_grip(tyre, loads):
    other = tyre.replace(PKY1=-25.0, PKY2=4.0, PDY1=2.5)
    points = campaign(tyre, 0.0)
    stiffness = {load: float(tyre.state(load).K_ya) for load in loads}
    start = starting_values(other.values, points, measured_of(stiffness, {}))
    begun = other.replace(**{name: start[name] for name in ("PKY1", "PKY2", "PDY1")})
    for load, K in stiffness.items():
        assert begun.state(load).K_ya == pytest.approx(K, rel=0.02)
    assert start["PDY1"] == pytest.approx(np.max(np.abs(points.Fy / points.Fz)))
    assert start["PCY1"] == other["PCY1"]


@pytest.mark.parametrize("phi_t", [-1 / 1.323, 0.0])
def test_the_start_has_the_measured_camber_stiffness_as_the_rig_reads_it(tyre, phi_t):
    """On a disc turn slip is on, and camber acts through the spin of a wheel whose radius is r_e instead of R0."""
    model = tyre.replace(PVY3=0.0, PVY4=0.0, PKYP1=0.0, PDYP1=0.0)
    r_e = Quantity(float(model.state(1400.0, Vx=6.0).Re), 0.0, "m")
    start = starting_values(model.values, campaign(tyre, phi_t), measured_of({}, {1400.0: -1500.0}, r_e))
    begun = model.replace(PKY6=start["PKY6"], PKY7=start["PKY7"])
    condition = {"turn_slip": True} if phi_t else {}
    assert camber_slope(begun, 1400.0, Vx=6.0, **condition) == pytest.approx(-1500.0, rel=5e-3)


def test_the_start_is_not_zero_where_all_derivatives_vanish_at_zero():
    """With trail and slope factor both zero, the moment does not depend on either of them."""
    empty = tir.Tyre.from_values({}).replace(FNOMIN=1400.0, UNLOADED_RADIUS=0.3, QBZ1=0.0, QDZ1=0.0)
    start = starting_values(empty.values, campaign(truth()), measured_of({}, {}))
    assert start["QBZ1"] > 1.0
    assert 0.02 < start["QDZ1"] < 0.3
    kept = starting_values({**empty.values, "QBZ1": 3.0}, campaign(truth()), measured_of({}, {}))
    assert kept["QBZ1"] == 3.0


def test_the_models_own_epsilon_gamma_is_pecp1_where_spin_is_small(tyre):
    """(17) on a wide path: both stiffnesses at zero spin."""
    model = tyre.replace(PHY1=0.0, PHY2=0.0, PVY1=0.0, PVY2=0.0, PECP1=-0.2)
    R = 2000.0
    points = make_points([0.0, 0.0], 0.0, 1400.0, p=250e3, V=6.0, phi_t=-1 / R, direction=[1, -1])
    r_e = float(model.state(1400.0, Vx=6.0).Re)
    assert epsilon_gamma_of_model(model.values, points, 1400.0, r_e) == pytest.approx(-0.2, abs=0.003)


def test_the_models_own_epsilon_gamma_is_that_of_the_mean_slope_at_zero_camber(tyre):
    """(17) by differences; the side force has a kink at zero camber (PKY3 |camber|), where a slope is the mean of both sides."""
    model = tyre.replace(PKY3=1.0, PHY1=0.0, PHY2=0.0)
    condition, step = {"phi_t": -0.7, "Vx": 6.0, "p": 250e3}, 1e-7
    points = make_points([0.0], 0.0, 1400.0, p=250e3, V=6.0, phi_t=-0.7)
    up, zero, down = (float(model(1400.0, gamma=g, **condition).Fy) for g in (step, 0.0, -step))
    assert abs((up - zero) - (zero - down)) > 0.01 * abs(up - zero)
    expected = 1.0 + 0.29 * (up - down) / (2.0 * step) / (zero / -0.7)
    assert epsilon_gamma_of_model(model.values, points, 1400.0, 0.29) == pytest.approx(expected, abs=1e-6)


def test_the_model_is_evaluated_at_zero_under_the_conditions_of_the_data(tyre):
    points = make_points(
        [0.1, 0.05], 0.3, [900.0, 1400.0], p=[200e3, 250e3], V=6.0, phi_t=-0.7, direction=[1, -1]
    )
    zero = zero_points(points, 1500.0)
    assert list(zero.direction) == [1, -1]
    assert np.all(zero.alpha == 0.0)
    assert np.all(zero.gamma == 0.0)
    assert np.all(zero.Fz == 1500.0)
    assert np.all(zero.p == 250e3)
    assert len(zero_points(points.select(points.direction > 0), 1500.0)) == 1


def test_tested_ranges_are_those_of_the_set_points():
    points = make_points(
        np.radians([-3.0, 8.0]),
        np.radians([-40.0, 10.0]),
        [900.0, 2100.0],
        p=[240e3, 260e3],
        V=6.0,
        phi_t=0.0,
    )
    found = ranges.tested_ranges(points)
    assert found["ALPMAX"] == -found["ALPMIN"] == pytest.approx(np.radians(8.0))
    assert found["CAMMAX"] == -found["CAMMIN"] == pytest.approx(np.radians(40.0))
    assert (found["FZMIN"], found["FZMAX"], found["PRESMIN"], found["PRESMAX"]) == (
        900.0,
        2100.0,
        240e3,
        260e3,
    )
    assert ranges.covered_ranges(points) == found
    alone = ranges.covered_ranges(points.replace(p=250e3))
    assert (alone["PRESMIN"], alone["PRESMAX"]) == (pytest.approx(225e3), pytest.approx(275e3))
    limits = ranges.envelope(found)
    assert limits == ((900.0, 2100.0), found["CAMMAX"], found["ALPMAX"], (240e3, 260e3), 0.0)


TESTED = {
    "PRESMIN": 200e3, "PRESMAX": 300e3, "FZMIN": 900.0, "FZMAX": 2100.0, "ALPMIN": -0.14, "ALPMAX": 0.14,
    "CAMMIN": -0.5, "CAMMAX": 0.5,
}  # fmt: skip


def test_a_sound_model_gets_the_wished_ranges(tyre):
    sound = tyre.replace(PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0)
    found = plausible_ranges(sound.values, TESTED, turn_slip=False)
    assert found["FZMIN"] == pytest.approx(90.0)
    assert found["FZMAX"] == pytest.approx(3150.0)
    assert (found["PRESMIN"], found["PRESMAX"]) == (pytest.approx(160e3), pytest.approx(360e3))
    assert found["ALPMAX"] == -found["ALPMIN"] == pytest.approx(math.radians(20.0))
    assert found["CAMMAX"] == -found["CAMMIN"] == pytest.approx(0.75)


@pytest.mark.parametrize(("tested", "written"), [(0.3, 0.45), (0.7, math.radians(45.0)), (0.9, 0.9)])
def test_camber_grows_by_half_to_45_degrees_and_never_shrinks(tyre, tested, written):
    sound = tyre.replace(PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0)
    found = plausible_ranges(sound.values, {**TESTED, "CAMMAX": tested, "CAMMIN": -tested}, turn_slip=False)
    assert found["CAMMAX"] == pytest.approx(written)


def test_the_load_range_ends_before_the_grip_is_lost(tyre):
    """mu = 1.2 - 0.96 (Fz/1400 - 1): d ln mu / d ln Fz = -0.96 Fz / (1400 mu) is -2 at 2100 N, -3 at 2362 N."""
    weak = tyre.replace(PDY1=1.2, PDY2=-0.96, PEY1=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0)
    found = plausible_ranges(weak.values, TESTED, turn_slip=False)
    assert found["FZMAX"] == pytest.approx(2100.0 + 0.25 * 1050.0)
    assert found["FZMIN"] == pytest.approx(90.0)


@pytest.mark.parametrize("off", [{"QBZ2": 1.7, "QBZ3": -4.9}, {"QBZ3": -3.0}])
def test_the_load_range_ends_where_the_moment_leaves_the_slope_over_the_tested_loads(tyre, off):
    """Slope factors that fall with the square of the load: at 3150 N the largest moment would be twice that of the sound tyre."""
    sound = tyre.replace(PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0)
    model = sound.replace(**off)

    def arm(Fz):
        return (
            max(abs(model(Fz, alpha=x).Mz - model(Fz, alpha=-x).Mz) for x in np.linspace(0.0, 0.14, 57)) / Fz
        )

    def above_the_line(Fz):
        return (arm(Fz) - arm(2100.0) - (arm(2100.0) - arm(900.0)) / 1200.0 * (Fz - 2100.0)) / arm(2100.0)

    found = plausible_ranges(model.values, TESTED, turn_slip=False)
    assert found["FZMAX"] < 3150.0
    assert above_the_line(found["FZMAX"]) < 0.06  # 0.05 on the grid of sideslips
    assert above_the_line(found["FZMAX"] + 0.25 * 1050.0) > 0.04
    assert found["FZMIN"] == pytest.approx(90.0)


def off_the_line(c, p):
    """By how much c(p) has changed since 262.5 kPa beyond what the line from c(212.5 kPa) allows, over c(262.5 kPa), by hand."""
    low, end = c(212.5e3), c(262.5e3)
    return abs(c(p) - end - (end - low) / 50e3 * (p - 262.5e3)) / end


@pytest.mark.parametrize(
    ("linear", "quadratic"),
    [("PPY3", "PPY4"), ("PPX3", "PPX4"), ("PPX1", "PPX2")],
    ids=["mu_y", "mu_x", "K_xk"],
)
def test_the_pressure_range_ends_where_grip_or_stiffness_leaves_the_slope_over_the_tested_pressures(
    tyre, linear, quadratic
):
    """The sweeps cover 0.85 to 1.05 of the nominal pressure; at 1.26 the steepest of the three has 0.57 of grip or stiffness."""
    sound = tyre.replace(
        PDX1=1.1, PKX1=20.0, PDX2=0.0, PKX2=0.0, PKX3=0.0, PDX3=0.0, PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0,
    )  # fmt: skip
    tested = {**TESTED, "PRESMIN": 212.5e3, "PRESMAX": 262.5e3}
    whole = plausible_ranges(sound.values, tested, turn_slip=False)
    assert (whole["PRESMIN"], whole["PRESMAX"]) == (pytest.approx(170e3), pytest.approx(315e3))
    for quadratically, cut in ((-4.0, True), (-2.0, True), (-0.2, False)):
        model = sound.replace(**{linear: -0.6, quadratic: quadratically})
        found = plausible_ranges(model.values, tested, turn_slip=False)

        def c(p, second=quadratically):
            return 1.0 - 0.6 * (p / 250e3 - 1.0) + second * (p / 250e3 - 1.0) ** 2

        assert (found["PRESMAX"] < 315e3) == cut
        assert found["PRESMAX"] >= tested["PRESMAX"]
        assert off_the_line(c, found["PRESMAX"]) < 0.05
        if cut:
            assert off_the_line(c, found["PRESMAX"] + 0.25 * (315e3 - tested["PRESMAX"])) > 0.05
        assert {name: found[name] for name in ("FZMIN", "FZMAX", "CAMMAX")} == {
            name: whole[name] for name in ("FZMIN", "FZMAX", "CAMMAX")
        }


@pytest.mark.parametrize("stiffer", [-0.9, 0.9])
def test_a_stiffness_over_load_that_follows_the_tested_loads_does_not_end_the_range(tyre, stiffer):
    """Its fall with the load flattens out beyond them, or goes on as fast: neither is a cliff."""
    sound = tyre.replace(
        PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0, PKX2=0.0, PKX3=0.0, PKY2=1.6 + stiffer
    )
    assert plausible_ranges(sound.values, TESTED, turn_slip=False)["FZMAX"] == pytest.approx(3150.0)


def test_the_camber_range_ends_before_grip_falls_faster_than_in_public_tyres(tyre):
    """mu_y = mu0 (1 - 1.9 gamma^2): d ln mu_y / d gamma is -2.9 per rad at 0.45 and -3.1 at 0.47; at 0.6 a third is left."""
    sound = tyre.replace(PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0)
    tested = {**TESTED, "CAMMAX": 0.4, "CAMMIN": -0.4}
    assert plausible_ranges(sound.values, tested, turn_slip=False)["CAMMAX"] == pytest.approx(0.6)
    found = plausible_ranges(sound.replace(PDY3=1.9).values, tested, turn_slip=False)
    assert found["CAMMAX"] == pytest.approx(0.45)
    assert found["CAMMIN"] == -found["CAMMAX"]


def test_two_signs_that_are_the_same_curve_count_as_one(tyre):
    """D sin(C ...) with both signs reversed; public files have such pairs."""
    sound = tyre.replace(PDX1=1.1, PKX1=20.0, PDX2=-0.1, PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0)
    other = sound.replace(PDX1=-1.1, PDX2=0.1, PCX1=-sound["PCX1"])
    both = (plausible_ranges(one.values, TESTED, turn_slip=False) for one in (sound, other))
    assert next(both) == next(both)


def test_a_side_force_that_reverses_ends_the_sideslip_range(tyre):
    """sin(C atan(...)) with C = 2.4 returns to zero: at 20 deg the force is below half its peak."""
    hunched = tyre.replace(PCY1=2.4, PEY1=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0, PDY2=0.0)
    found = plausible_ranges(hunched.values, TESTED, turn_slip=False)
    assert TESTED["ALPMAX"] <= found["ALPMAX"] < math.radians(20.0)
    fine = hunched.replace(PCY1=1.3)
    assert plausible_ranges(fine.values, TESTED, turn_slip=False)["ALPMAX"] == pytest.approx(
        math.radians(20.0)
    )


def test_agreement_in_numbers():
    found = agreement(np.array([1.0, 2.0, 3.0, np.nan, 9.0]), np.array([0.0, 2.0, 5.0, 4.0, np.nan]))
    assert found.n == 3
    assert found.rmse == pytest.approx(math.sqrt(5.0 / 3.0))
    assert found.nrmse == pytest.approx(math.sqrt(5.0 / 3.0) / 5.0)
    assert found.max_abs == 2.0
    assert found.r2 == pytest.approx(1.0 - (5.0 / 3.0) / np.var([0.0, 2.0, 5.0]))
    flat = agreement(np.array([1.0, 2.0]), np.array([0.0, 0.0]))
    assert flat.rmse == pytest.approx(math.sqrt(2.5))
    assert math.isnan(flat.nrmse)
    assert math.isnan(flat.r2)
    nothing = agreement(np.array([1.0]), np.array([np.nan]))
    assert nothing.n == 0
    assert math.isnan(nothing.rmse)


def test_no_written_range_is_empty(tyre):
    """Upright sweeps of one load at one pressure, without a base: 2 deg, and a tenth to either side."""
    tested = TESTED | {"CAMMIN": -0.0, "CAMMAX": 0.0, "FZMIN": 900.0, "FZMAX": 900.0}
    found, origin = ranges.with_room(tyre.values, tested, {})
    assert (found["CAMMIN"], found["CAMMAX"]) == (-math.radians(2.0), math.radians(2.0))
    assert (found["FZMIN"], found["FZMAX"]) == (pytest.approx(810.0), pytest.approx(990.0))
    assert (found["PRESMIN"], found["ALPMAX"]) == (tested["PRESMIN"], tested["ALPMAX"])
    assert set(origin) == {"camber", "load"}
    assert not [p for p in tir.check(tyre.replace(**found)) if p.level == "error"]


def test_what_was_not_varied_gets_the_range_of_the_base_if_the_model_allows_it(tyre):
    sound = tyre.replace(PDY2=0.0, PEY2=0.0, PEY4=0.0, PEY5=0.0, PDY3=0.0)
    tested, base = TESTED | {"CAMMIN": 0.0, "CAMMAX": 0.0}, {"CAMMIN": -0.9, "CAMMAX": 0.9}
    found, origin = ranges.with_room(sound.values, tested, base)
    assert (found["CAMMIN"], found["CAMMAX"]) == (-0.9, 0.9)
    assert "base" in origin["camber"]
    slippery = sound.replace(PDY3=10.0)  # no grip left beyond 18 deg of camber
    assert ranges.with_room(slippery.values, tested, base)[0]["CAMMAX"] == math.radians(2.0)
    assert ranges.with_room(sound.values, TESTED, base) == (TESTED, {})
