"""The rig's errors enter the fit with what [rig] declares of them, no more and no less."""

from __future__ import annotations

import math
from types import SimpleNamespace

import numpy as np
import pytest
import small_rigs

from mffit import config
from mffit.fit.by_hand import NO_HAND
from mffit.fit.plan import fit_plan
from mffit.fit.rig.rig_numbers import held_rig, known_faults, known_zeros, rig_numbers, unseen_zeros
from mffit.fit.wording import alignment_sentence
from mffit.points import make_points
from mffit.rig import Simulation
from tir import Quantity
from tir.parameters import TABLE

DOUBTS = {
    "u_loadcell_offset_N": 8.0, "u_camber_alignment_deg": 0.3, "u_slip_alignment_N": 20.0, "backlash_deg": 0.2,
    "u_backlash_deg": 0.05, "u_camber_skew_deg": 0.15,
}  # fmt: skip
AT_ZERO = make_points(0.0, 0.0, 1400.0, p=250e3, V=6.0, phi_t=0.0)
ALPHA_M = Quantity(math.radians(0.7), math.radians(0.02), "rad")


def rig(**changes):
    return config.load(
        {
            "tyre": {"name": "t", "unloaded_radius": 0.3, "nominal_load": 1500.0, "nominal_pressure": 250.0},
            "rig": {"path_radius": 1.3, "u_path_radius": 0.002} | DOUBTS | changes,
            "sweep": [{"file": "a.csv"}],
        }
    )


def direct(**changes):
    """What the direct method found: 18 kN/rad of cornering stiffness."""
    found = dict(
        misaligned=False, alpha_M=ALPHA_M, C_alpha=Quantity(-18000.0, 100.0, "N/rad"), R=Quantity(1.3, 0.002, "m"),
        epsilon_gamma=Quantity(-0.1, 0.05, "-"), nominal=SimpleNamespace(load=1500.0),
        per_load=(SimpleNamespace(F_phit=Quantity(-400.0, 20.0, "N")),),
        camber_skew=None, misaligned_setups={}, carried=None, lag=None,
    )  # fmt: skip
    return SimpleNamespace(**found | changes)


def by_name(config, measured):
    return {number.name: number for number in rig_numbers(config, measured)}


def test_the_default_of_the_alignment_is_said_as_an_angle():
    """25 N of a car tyre of 99 kN/rad assert 0.014 deg; what [rig] states is not repeated."""
    car = direct(C_alpha=Quantity(-99e3, 500.0, "N/rad"))
    given = rig().model_dump(exclude_unset=True)
    assert not alignment_sentence(config.load(given), car)
    del given["rig"]["u_slip_alignment_N"]
    assert "is taken as aligned to 0.014 deg" in alignment_sentence(config.load(given), car)


def test_every_declared_doubt_is_a_prior_of_that_width():
    found = by_name(rig(), direct())
    assert {name: (n.expected, n.spread) for name, n in found.items()} == {
        "F0_N": (0.0, 8.0),
        "gamma_0_deg": (0.0, 0.3),
        "alpha_0_deg": (0.0, pytest.approx(math.degrees(20.0 / 18000.0))),
        "path_radius_m": (1.3, 0.002),
        "camber_skew_deg": (0.0, 0.15),
        "backlash_deg": (0.2, 0.05),
    }
    for number in found.values():
        assert number.start == number.expected
        assert number.upper - number.expected > 5.0 * number.spread
        assert number.expected - number.lower > 5.0 * number.spread or number.name == "backlash_deg"
    assert found["backlash_deg"].lower == 0.0


def test_a_misalignment_is_known_as_it_was_measured():
    """True sideslip is the reading plus alpha_M; what was declared was too tight then, and ply-steer may have its share."""
    number = by_name(rig(), direct(misaligned=True))["alpha_0_deg"]
    assert (number.expected, number.spread) == (0.0, pytest.approx(0.7))
    assert known_faults(rig(), direct(misaligned=True))["alpha_0_deg"] == pytest.approx(0.7)


@pytest.mark.parametrize(("found", "spread"), [(0.25, 0.15), (-0.6, 0.6)])
def test_a_camber_skew_that_contradicts_its_declaration_widens_the_prior(found, spread):
    number = by_name(rig(), direct(camber_skew=Quantity(found, 0.05, "deg")))["camber_skew_deg"]
    assert (number.expected, number.spread) == (0.0, pytest.approx(spread))


def test_what_the_alignment_leaves_is_not_taken_off_beforehand():
    faults = known_faults(rig(), direct())
    assert faults["alpha_0_deg"] == 0.0
    assert faults["backlash_deg"] == 0.2


def test_without_backward_runs_nothing_is_known_of_the_misalignment():
    measured = direct(alpha_M=None)
    assert known_faults(rig(), measured)["alpha_0_deg"] == 0.0
    assert by_name(rig(), measured)["alpha_0_deg"].expected == 0.0


def test_without_a_sideslip_sweep_ten_per_load_turns_the_force_into_an_angle():
    number = by_name(rig(), direct(C_alpha=None))["alpha_0_deg"]
    assert number.spread == pytest.approx(math.degrees(20.0 / 15000.0))


@pytest.mark.parametrize(
    ("key", "name"),
    [("u_loadcell_offset_N", "F0_N"), ("u_camber_alignment_deg", "gamma_0_deg"), ("u_slip_alignment_N", "alpha_0_deg"),
     ("u_backlash_deg", "backlash_deg"), ("u_camber_skew_deg", "camber_skew_deg")],
)  # fmt: skip
def test_what_is_exact_is_no_number_of_the_fit(key, name):
    assert name not in by_name(rig(**{key: 0.0}), direct())


def test_every_set_up_has_zeros_of_its_own_as_declared():
    """The zero of Mz, which no key declares, has its usual size; what is no zero is of the rig."""
    measured = direct(setup_scatter=None)
    alone = by_name(rig(), measured)
    found = {n.name: n for n in rig_numbers(rig(), measured, ("A", "B"))}
    zeros = ("F0_N", "gamma_0_deg", "alpha_0_deg")
    for setup in "AB":
        for name in zeros:
            one, several = alone[name], found[f"{name}@{setup}"]
            assert (several.expected, several.spread) == (one.expected, one.spread)
        assert found[f"M0_Nm@{setup}"].spread == 1.0
    assert set(found) - {f"{n}@{s}" for n in (*zeros, "M0_Nm") for s in "AB"} == set(alone) - set(zeros)


def test_a_straight_path_with_several_set_ups_has_their_zeros_only():
    """Ply-steer and conicity can absorb the zeros of one set-up, not those of two."""
    flat = rig(type="flat-track", path_radius=None, u_path_radius=None)
    measured = direct(epsilon_gamma=None, setup_scatter=None)
    names = {number.name.partition("@")[0] for number in rig_numbers(flat, measured, ("A", "B"))}
    assert names == {"F0_N", "gamma_0_deg", "alpha_0_deg", "M0_Nm"}


def test_the_misalignment_of_a_set_up_is_its_own():
    measured = direct(setup_scatter=None, misaligned_setups={"B": math.radians(0.7)}, misaligned=False)
    assert known_zeros(measured, ("A", "B")) == {"alpha_0_deg@B": pytest.approx(0.7)}
    assert known_zeros(measured, ("A",)) == {}
    assert known_faults(rig(), direct(misaligned=True), ("A", "B"))["alpha_0_deg"] == 0.0
    found = {n.name: n.spread for n in rig_numbers(rig(), measured, ("A", "B"))}
    assert found["alpha_0_deg@B"] == pytest.approx(0.7)
    assert found["alpha_0_deg@A"] == pytest.approx(math.degrees(20.0 / 18000.0))


def test_a_straight_path_has_its_zeros_and_a_disc_without_any_has_none():
    flat = rig(type="flat-track", path_radius=None, u_path_radius=None)
    found = {name: n.spread for name, n in by_name(flat, direct(setup_scatter=None)).items()}
    assert found == {"F0_N": 8.0, "M0_Nm": 1.0}
    turned = rig_numbers(flat, direct(setup_scatter=None), unseen=("alpha_0_deg",))
    assert {n.name: n.spread for n in turned} == {**found, "gamma_0_deg": 0.3}
    assert held_rig(flat, direct())["gamma_0_deg"] == 0.3
    several = held_rig(flat, direct(), ("A", "B"))
    assert "gamma_0_deg" not in {**held_rig(flat, direct(), unseen=()), **several}
    assert "alpha_0_deg" not in several
    assert rig_numbers(rig(), direct(per_load=(SimpleNamespace(F_phit=None),))) == ()


@pytest.mark.parametrize("mount", [1, [1, -1, 1]])
def test_the_sideslip_zero_of_one_set_up_stays_with_the_tyre(mount):
    """Ply-steer shifts every run of one set-up as the zero does, however the tyre is mounted."""
    alpha = np.radians([-8.0, 0.0, 8.0])
    points = make_points(alpha, 0.0, 1400.0, Fy=0.0, p=250e3, V=8.0, phi_t=0.0, mount=mount)
    flat = rig(type="flat-track", path_radius=None, u_path_radius=None)
    measured = direct(setup_scatter=None)
    unseen = unseen_zeros(points)
    assert "alpha_0_deg" not in {n.name for n in rig_numbers(flat, measured, unseen=unseen)}
    angle = math.degrees(20.0 / 18000.0)
    assert held_rig(flat, measured, unseen=unseen)["alpha_0_deg"] == pytest.approx(angle)
    lagging = direct(setup_scatter=None, lag=SimpleNamespace(angle=math.radians(0.2)))
    assert held_rig(flat, lagging, unseen=unseen)["alpha_0_deg"] == pytest.approx(math.hypot(angle, 0.2))


def test_calibrations_are_held_wherever_they_show_and_a_declared_compliance_is_a_number_of_the_fit():
    """Nothing but a certificate tells a factor of Fy from the tyre's own grip."""
    flat = {"type": "flat-track", "path_radius": None, "u_path_radius": None}
    disc = {
        name: held_rig(rig(u_Fy_gain=0.01, u_Fz_gain=0.0, **of), direct()).get(name)
        for of in ({}, flat)
        for name in ("gain", "gain_alpha", "gain_Fz", "gain_Fx")
    }
    assert disc == {"gain": 0.01, "gain_alpha": 0.002, "gain_Fz": None, "gain_Fx": None}
    assert held_rig(rig(), direct(), channels=("Fy", "Fx"))["gain_Fx"] == 0.005
    yielding = {"u_steering_compliance_deg_per_Nm": 0.005}
    without_zeros = direct(per_load=(SimpleNamespace(F_phit=None),))
    for given, measured in (
        (rig(**yielding), direct()),
        (rig(**yielding), without_zeros),
        (rig(**flat, **yielding), direct(setup_scatter=None)),
    ):
        assert by_name(given, measured)["compliance_deg_per_Nm"].spread == 0.005
        assert not any("gain" in name for name in by_name(given, measured))
        assert "compliance_deg_per_Nm" not in held_rig(given, measured)


def test_on_a_flat_track_the_uncertainty_of_shifts_contains_the_zeros_of_the_rig(tmp_path):
    """All four are half as large again as declared; without them among the errors PHY1 and QDZ6 would be 8 and 20 u away."""
    off = {"alpha_0_deg": 0.11, "gamma_0_deg": 0.75, "F0_N": 15.0, "M0_Nm": 1.5}
    build, true = small_rigs.built(small_rigs.flat(faults=off), tmp_path), small_rigs.truth()
    assert build.trusted
    for name in ("PHY1", "PVY1", "PVY2", "QHZ1", "QDZ6", "QDZ7"):
        row = build.fit.coefficients[name]
        assert abs(row.value - true[name]) < 2.5 * row.stderr
    for name in ("F0_N", "M0_Nm"):
        value, u = build.fit.rig[name]
        assert abs(value - off[name]) < 2.5 * u
    assert any("ply-steer, conicity and residual torque" in text for text in build.fit.explanations)
    assert build.fit.bands.half_of_exact_zeros < build.fit.bands.half
    simulation = Simulation.of(build.fit.tyre, turn_slip=False)
    known = build.fit.prediction.forces(simulation, simulation, AT_ZERO)["Fy"]
    off_tyre = build.fit.tyre(1400.0, Vx=6.0).Fy - true(1400.0, Vx=6.0).Fy
    assert abs(off_tyre) < 2.5 * np.sqrt(known.variance[0])
    # A new run has the zeros of the same rig.
    assert np.sqrt(known.of_run[0]) < 0.5 * np.sqrt(known.variance[0])


def test_zeros_show_the_rigs_errors_without_camber_sweeps_too():
    assert by_name(rig(), direct(epsilon_gamma=None)).keys() == by_name(rig(), direct()).keys()


@pytest.mark.parametrize(("declared", "spread"), [({}, 0.003), ({"u_conicity": 0.01}, 0.01)])
def test_a_declared_conicity_is_the_prior_of_its_coefficient(declared, spread):
    start = {row.name: row.default or 0.0 for row in TABLE if row.stage}
    known = SimpleNamespace(origin=dict.fromkeys(start, "default"), hand=NO_HAND)
    points = make_points(np.radians([-2.0, 0.0, 2.0]), 0.0, 1500.0, p=250e3, V=6.0, phi_t=-0.77, Fy=0.0)
    found = fit_plan(rig(**declared), points, direct(), known, start, {})
    assert found.scatter["PVY1"] == spread
