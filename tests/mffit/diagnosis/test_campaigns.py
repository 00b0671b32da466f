"""A diagnosis of several campaigns of one tyre: each with the errors of its own rig, and a surface of its own."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mffit
import tir
from mffit import config, points, virtual_rig
from mffit.diagnosis import wording
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.scatter import ExplainingColumns, learned
from mffit.pipeline.correcting import write_corrected
from mffit.points import concatenate, make_points
from mffit.rig import Simulation

TRUE = Path(__file__).parents[3] / "samples" / "flat-track-combined" / "true.tir"
GRIP = 0.9
"""Friction of the second surface over that of the first."""
TYRE = {
    "name": "t",
    "unloaded_radius": 0.3185,
    "nominal_load": 4200,
    "nominal_pressure": 240,
    "nominal_speed": 16.7,
}
SIDESLIP = [-9, -5, -3, -1.5, 0, 1.5, 3, 5, 9]
SLIP = [-0.15, -0.07, -0.03, 0, 0.03, 0.07, 0.15]


def simulated(folder: Path, name: str, axes: str, faults: dict[str, float], slip: bool) -> None:
    sweeps = [
        {"file": f"side_{load}.csv", "load_N": load, "alpha_deg": SIDESLIP, "gamma_deg": [0, 4]}
        for load in (2500, 5000)
    ]
    drive = [
        {"file": f"drive_{load}.csv", "load_N": load, "kappa": SLIP, "alpha_deg": [0, 3]}
        for load in (2500, 5000)
    ]
    plan = {
        "seed": 3,
        "truth": {"tyre": str(TRUE)},
        "faults": faults,
        "noise": {"Fy_N": 12.0, "Mz_Nm": 1.5, **({"Fx_N": 15.0} if slip else {})},
        "tyre": TYRE,
        "rig": {"type": "flat-track", "axes": axes},
        "sweep": sweeps + (drive if slip else []),
    }
    virtual_rig.simulate(virtual_rig.load_plan(plan), folder / name)


@pytest.fixture(scope="module")
def project(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("campaigns")
    simulated(folder, "one", "iso", {"F0_N": -20.0}, slip=False)
    simulated(folder, "two", "sae", {"F0_N": 15.0, "gain_Fx": 1.06, "surface_grip": GRIP - 1.0}, slip=True)
    path = folder / "one" / "tyre.toml"
    path.write_text(path.read_text() + '\n[[campaign]]\ntoml = "../two/tyre.toml"\n')
    return path


@pytest.fixture(scope="module")
def found(project):
    return mffit.diagnose(project, TRUE)


def test_the_rig_of_one_campaign_is_blamed_and_named(found):
    (effect,) = found.effects
    assert (effect.effect.id, effect.effect.campaign) == (
        "loadcell-gain-fx@../two/tyre.toml",
        "../two/tyre.toml",
    )
    value, u = effect.parameters["gain_Fx@../two/tyre.toml"]
    assert value == pytest.approx(1.06, abs=3.0 * u)
    assert "calibration of Fx, ../two/tyre.toml" in found.headline
    assert found.gap_after.chi2_per_dof == pytest.approx(1.0, abs=0.25)


def test_the_ratio_of_grips_and_the_zeros_of_both_rigs_are_found(found):
    value, u = found.coefficients["surface_grip@../two/tyre.toml"]
    assert 1.0 + value == pytest.approx(GRIP, abs=3.0 * u)
    for name, true in (("F0_N@tyre.toml", -20.0), ("F0_N@../two/tyre.toml", 15.0)):
        zero, u = found.coefficients[name]
        assert zero == pytest.approx(true, abs=3.0 * u)
    said = " ".join(wording.notes(found))
    assert "36 points of tyre.toml and 64 points of ../two/tyre.toml" in said


def test_the_corrected_campaigns_are_those_of_one_surface(project, found, tmp_path):
    others = {"../two/tyre.toml": config.load(project.parent / "../two/tyre.toml")}
    write_corrected(found, config.load(project), tmp_path, tmp_path, others)
    again = config.load(tmp_path / "corrected.toml")
    assert [row.toml for row in again.campaign] == ["campaign-1/corrected.toml"]
    read, _ = points.load(config.load(tmp_path / "campaign-1" / "corrected.toml"))
    true = Simulation.of(tir.read(TRUE), turn_slip=False).readings(read, ("Fx", "Fy"))
    driven = ~read.free_rolling
    assert np.sqrt(np.mean((read.Fx - true.Fx)[driven] ** 2)) < 25.0
    assert np.sqrt(np.mean((read.Fy - true.Fy) ** 2)) < 20.0


def test_a_number_of_one_campaign_acts_there_alone():
    """Readings and derivatives of joined points are those of the campaigns by themselves, whatever their order."""
    tyre = tir.read(TRUE)
    alpha = np.radians(SIDESLIP)
    one, two = (
        make_points(alpha, 0.02, 3000.0, kappa=0.01, p=240e3, V=16.0, phi_t=0.0, campaigns=(name,))
        for name in "ab"
    )
    mixed = concatenate([one, two]).select(np.argsort(np.tile(np.arange(len(alpha)), 2), kind="stable"))
    names = ["F0_N", "F0_N@b", "gain@b", "surface_grip@b"]
    sim = Simulation.of(tyre, turn_slip=False).with_numbers(
        {"F0_N@b": 7.0, "gain@b": 1.1, "surface_grip@b": 0.2}
    )
    readings, slopes = sim.sensitivities(mixed, names)
    plain = Simulation.of(tyre, turn_slip=False).readings(one).Fy
    grip = tyre.replace(LMUX=1.2, LMUY=1.2, LXAL=1 / 1.2, LYKA=1 / 1.2)
    other = 1.1 * Simulation.of(grip, turn_slip=False).readings(one).Fy + 7.0
    np.testing.assert_allclose(readings.Fy[0::2], plain)
    np.testing.assert_allclose(readings.Fy[1::2], other)
    np.testing.assert_allclose(slopes.Fy[0::2], np.tile([1.0, 0.0, 0.0, 0.0], (len(alpha), 1)))
    np.testing.assert_allclose(slopes.Fy[1::2, :2], np.tile([0.0, 1.0], (len(alpha), 1)))
    assert sim.number("gain@b", mixed) == 1.1
    step = sim.with_numbers({"surface_grip@b": 0.2 + 1e-6}).readings(mixed).Fy
    np.testing.assert_allclose(slopes.Fy[:, 3], (step - readings.Fy) / 1e-6, rtol=1e-4, atol=1e-2)
    np.testing.assert_allclose(sim.felt(mixed.replace(Fy=readings.Fy)).Fy[1::2], plain, atol=1e-8)


@pytest.mark.parametrize("size", [2.0, 0.5, 1.0])
def test_a_campaign_that_scatters_otherwise_has_a_scale_of_its_own(size):
    """300 readings of Fy and 100 of Mz per campaign; the second scatters ``size`` times the first one's Fy."""
    n, rng = 600, np.random.default_rng(4)
    of = np.repeat([0, 1], n // 2)
    Fy = rng.standard_normal(n) * np.where(of == 1, size, 1.0)
    Mz = np.where(np.arange(n) % 3 == 0, rng.standard_normal(n), np.nan)
    u = np.concatenate([np.ones(n), np.where(np.isfinite(Mz), 1.0, np.inf)])
    noise = Noise(u=u, stated=u, chain=np.tile(np.arange(n) // 20, 2), origin=None)
    nothing = np.zeros((2 * n, 0))
    found = learned(
        noise, np.concatenate([Fy, Mz]), ExplainingColumns(nothing, {}, nothing), 100.0 * np.ones(2 * n), of
    )
    in_Fy, in_Mz = np.split(found.u, 2)
    assert in_Fy[-1] / in_Fy[0] == pytest.approx(size, rel=0.15)
    assert found.scatter["Fy"].scale == pytest.approx(np.sqrt(size), rel=0.1)
    np.testing.assert_allclose(in_Mz[np.isfinite(in_Mz)], 1.0, rtol=0.2)
