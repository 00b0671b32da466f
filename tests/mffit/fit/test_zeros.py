"""PECP1 from the zeros of a disc without camber sweeps, on the virtual rig, whose formulae are its own."""

from __future__ import annotations

from types import SimpleNamespace

import pytest
import small_rigs

import mffit
import tir
from mffit.fit.rig.zeros import turning_zeros
from mffit.points import make_points
from tir import Quantity


def upright(folder, base):
    """A campaign of sideslip sweeps and zeros only, with a base file."""
    content = small_rigs.disc(loads=(900, 1400, 2100))
    content["sweep"] = [row for row in content["sweep"] if "gamma_deg" not in row]
    content["tyre"].pop("base")
    small_rigs.simulated(content, folder)
    base.write(folder / "base.tir")
    toml = folder / "tyre.toml"
    toml.write_text(toml.read_text().replace("[tyre]\n", '[tyre]\nbase = "base.tir"\n', 1))
    return toml


@pytest.fixture(scope="module")
def wrong_base(tmp_path_factory):
    """The build with a base file that is right but for PECP1."""
    return mffit.build(upright(tmp_path_factory.mktemp("upright"), small_rigs.truth().replace(PECP1=0.5)))


def test_an_upright_campaign_fits_at_the_noise_whatever_pecp1_the_base_file_has(wrong_base):
    assert wrong_base.fit.channels["Fy"].rmse < 1.15 * small_rigs.FY
    assert not wrong_base.reasons


def test_pecp1_carries_the_uncertainty_of_the_camber_stiffness(wrong_base):
    """30 % of camber stiffness is 0.3 (1 - PECP1) of PECP1; the base file's stiffness is right here."""
    found, true = wrong_base.fit.coefficients["PECP1"], small_rigs.truth()["PECP1"]
    assert found.status == "regularised"
    assert found.value == pytest.approx(true, abs=0.08)
    assert found.stderr == pytest.approx(0.3 * (1.0 - true), rel=0.25)
    assert wrong_base.fit.coefficients["PKY6"].status == "base"


def test_the_rigs_errors_are_known_no_worse_than_declared(wrong_base):
    declared = {"F0_N": 10.0, "gamma_0_deg": 0.5}
    for name, u in declared.items():
        value, found = wrong_base.fit.rig[name]
        assert found < 1.05 * u
        assert abs(value) < 3.0 * found


def test_the_contradiction_is_said_with_both_forces_and_the_move(wrong_base):
    (sentence,) = [w for w in wrong_base.warnings if "contradicts the zeros" in w]
    C = wrong_base.measured.nominal.F_phit
    assert f"{C.value:.0f}" in sentence
    assert "PECP1 from 0.50 to" in sentence
    assert "camber sweep separates the two" in sentence


def found_at_zero(values, force):
    """What the zeros at 1400 N say against these values."""
    points = make_points([0.0], [0.0], [1400.0], p=250e3, V=6.0, phi_t=-1.0 / 1.3)
    row = SimpleNamespace(load=1400.0, F_phit=Quantity(force, 10.0, "N"), C_gamma=None)
    measured = SimpleNamespace(epsilon_gamma=None, per_load=(row,))
    return turning_zeros({**tir.read(small_rigs.SAMPLE / "true.tir").values, **values}, points, measured)


def test_the_start_gives_the_measured_force():
    found = found_at_zero({"PECP1": 0.5, "PVY1": 0.0, "PVY2": 0.0}, -400.0)
    after = found_at_zero({**found.start, "PVY1": 0.0, "PVY2": 0.0}, -400.0)
    assert found.contradicted
    assert not after.contradicted
    assert after.expected == pytest.approx(-400.0, rel=0.1)  # to first order


@pytest.mark.parametrize("PKY6", [0.0, -0.05, 0.5])
def test_a_camber_stiffness_that_no_pecp1_makes_up_for_is_moved_too(PKY6):
    found = found_at_zero({"PKY6": PKY6}, -400.0)
    assert {"PECP1", "PKY6"} <= found.start.keys()
    after = found_at_zero({**found.start, "PVY1": 0.0, "PVY2": 0.0}, -400.0)
    assert after.expected == pytest.approx(-400.0, rel=0.1)


def test_a_measured_eps_gamma_needs_no_zeros():
    assert (
        turning_zeros({}, None, SimpleNamespace(epsilon_gamma=Quantity(0.0, 0.1, "-"), per_load=())) is None
    )
    assert turning_zeros({}, None, SimpleNamespace(epsilon_gamma=None, per_load=())) is None
