"""The workflows as calls: rig errors in built files, diagnosis of a build, the source of PECP1."""

from __future__ import annotations

import json
import re

import numpy as np
import pandas as pd
import pytest
from small_rigs import MZ, SAMPLE, disc, flat, simulated, sound, truth

import mffit
import tir
from mffit import as_json, config
from mffit.diagnosis.notes import DirectMethodRedone, ModelFittedFirst
from mffit.effects import CATALOG
from mffit.errors import InputError
from mffit.pipeline.build_output import origin
from mffit.pipeline.diagnosing import last_build
from mffit.pipeline.provenance import fitted_to, rig_of_build
from mffit.pipeline.refining import undistorted
from mffit.progress import remaining

OFFSET = [effect for effect in CATALOG if effect.id in ("loadcell-offset-fy", "camber-misalignment")]
MOMENT = [effect for effect in CATALOG if effect.id in ("loadcell-offset-mz", "residual-torque-camber")]


SAID: list[str] = []
"""Progress of the build."""


def campaign(folder, **changes):
    """The truth of a small campaign simulated into a folder."""
    return simulated(disc(**changes), folder, seed=6).to_json()


@pytest.fixture(scope="module")
def small(tmp_path_factory):
    """A build of a rig whose load cell is 15 N off, and its folder."""
    folder = tmp_path_factory.mktemp("small")
    campaign(folder, faults={"F0_N": 15.0})
    result = mffit.build(folder / "tyre.toml", folder / "out", with_report=False, progress=SAID.append)
    return result, folder


def test_every_step_of_a_build_has_its_share(small):
    shares = [remaining(sentence, 0.0)[0] for sentence in SAID]
    assert len(shares) > 4
    assert shares == sorted(shares)


def test_a_built_file_contains_the_rig_errors_of_its_sweeps(small):
    result, folder = small
    settings = config.load(folder / "tyre.toml")
    file = tir.read(last_build(settings))
    assert fitted_to(file, settings)
    found = rig_of_build(file)
    for name, (value, _) in result.fit.rig.items():
        assert found[name] == pytest.approx(value, rel=1e-6), name
    assert abs(found["F0_N"] - 15.0) < 6.0


def test_a_file_fitted_to_other_sweeps_has_no_rig_errors_for_these(small, tmp_path):
    _, folder = small
    for path in folder.glob("*.*"):
        if path.is_file():
            (tmp_path / path.name).write_bytes(path.read_bytes())
    changed = tmp_path / "sideslip_900.csv"
    changed.write_text(changed.read_text().rstrip("\n") + "\n\n")
    settings = config.load(tmp_path / "tyre.toml")
    assert not fitted_to(tir.read(folder / "out" / "small.tir"), settings)
    assert not fitted_to(truth(), settings)
    assert rig_of_build(truth()) is None


def test_the_build_explains_its_own_points(small):
    """A diagnosis with the file and rig of the build finds nothing; with the true tyre it finds the load cell."""
    _, folder = small
    own = mffit.diagnose(folder / "tyre.toml", effects=OFFSET)
    assert not own.effects
    assert own.gap_before.chi2_per_dof < 1.2
    assert not any(isinstance(note, ModelFittedFirst) for note in own.notes)
    true = mffit.diagnose(folder / "tyre.toml", SAMPLE / "true.tir", effects=OFFSET)
    assert [f.effect.id for f in true.effects] == ["loadcell-offset-fy"]
    assert abs(true.faults["F0_N"] - 15.0) < 2.0


def test_the_json_gives_the_origin_as_the_file_does(small):
    result, folder = small
    on_disk = tir.read(folder / "out" / "small.tir")
    origin = {
        name: entry["origin"] for name, entry in as_json.document(result)["fit"]["coefficients"].items()
    }
    assert len(on_disk.status.keys() & origin.keys()) > 200
    for name in on_disk.status.keys() & origin.keys():
        assert origin[name] == on_disk.status[name], name


def test_the_json_states_the_measured_numbers(small):
    result, folder = small
    text = (folder / "out" / "result.json").read_text(encoding="utf-8")
    spin, fit = json.loads(text)["spin"], json.loads(text)["fit"]
    row = result.measured.nominal
    assert (spin["epsilon_gamma"], spin["u_epsilon_gamma"]) == (row.epsilon_gamma.value, row.epsilon_gamma.u)
    assert spin["alpha_M_deg"] == pytest.approx(np.degrees(row.alpha_M.value))
    assert spin["u_alpha_M_deg"] == pytest.approx(np.degrees(row.alpha_M.u))
    assert spin["coverage_factor"] == 1
    assert [load["load_N"] for load in spin["per_load"]] == [load.load for load in result.measured.per_load]
    assert (spin["F_forward_N"], spin["F_backward_N"]) == (row.F_forward, row.F_backward)
    assert set(fit["files"]) == {"turn-slip", "normal", "ranges"}
    paired = [name for name, entry in fit["coefficients"].items() if entry["correlated_with"]]
    assert paired
    for name, entry in fit["coefficients"].items():
        assert (entry["correlation"] is None) == (name not in paired)
        assert (entry["interval_95"] is None) == entry["fixed"]


def test_the_points_are_written_with_their_parts_and_their_origin(small):
    result, folder = small
    table = pd.read_csv(folder / "out" / "points.csv")
    both = table[["Fy_odd_N", "Fy_even_N"]].notna().all(axis=1)
    assert both.any()
    assert (table.Fy_odd_N + table.Fy_even_N)[both].to_numpy() == pytest.approx(table.Fy_N[both].to_numpy())
    assert (table.Mz_odd_Nm + table.Mz_even_Nm)[both].to_numpy() == pytest.approx(
        table.Mz_Nm[both].to_numpy()
    )
    assert np.std(table.Fy_model_N - table.Fy_N) < 6.0
    assert set(table.file) == {sweep.file for sweep in result.config.sweep}
    assert (table.direction == "backward").tolist() == [name.startswith("backward") for name in table.file]
    assert set(table.path_centre) == {"left"}
    assert table.path_radius_m.to_numpy() == pytest.approx(np.full(len(table), 1.323))
    n = len(result.points)
    flipped = origin(result.points.replace(mount=np.where(np.arange(n) < 2, -1, 1), phi_t=0.5))
    assert flipped["mount"].tolist() == ["flipped"] * 2 + ["normal"] * (n - 2)
    assert set(flipped["path_centre"]) == {"right"}
    assert "path_centre" not in origin(result.points.replace(phi_t=0.0))


def note_of(diagnosis) -> str:
    (note,) = (n.sentence for n in diagnosis.notes if isinstance(n, DirectMethodRedone))
    return note


def test_the_direct_method_is_redone_without_the_fault(tmp_path):
    """60 N on the load cell: eps = 1 + r_e C_gamma / (F R) with F wrong by 60 N, then with the correct F."""
    true = campaign(tmp_path, faults={"F0_N": -60.0})
    found = mffit.diagnose(
        tmp_path / "tyre.toml", SAMPLE / "true.tir", out=tmp_path / "found", effects=OFFSET
    )
    note = note_of(found)
    assert note in json.loads((tmp_path / "found" / "diagnosis.json").read_text())["notes"]
    before, u_before, after, u_after = map(float, re.findall(r"(?<![\w.])-?\d+\.\d+", note)[:4])
    measured = mffit.spin(tmp_path / "tyre.toml").epsilon_gamma
    assert (before, u_before) == (
        pytest.approx(measured.value, abs=0.006),
        pytest.approx(measured.u, abs=0.006),
    )
    assert after == pytest.approx(true["epsilon_gamma"], abs=0.06)
    assert u_after > 0.01
    force = true["F_phit_N"] if "F_phit_N" in true else 1400.0 * -0.22
    assert 1.0 - before == pytest.approx((1.0 - after) / (1.0 + 60.0 / abs(force)), rel=0.05)


def test_a_moment_offset_does_not_change_the_factor(tmp_path):
    """The offset of the moment does not enter the turn-slip force."""
    campaign(tmp_path, faults={"M0_Nm": 10.0 * MZ})
    found = mffit.diagnose(tmp_path / "tyre.toml", SAMPLE / "true.tir", effects=MOMENT)
    assert [f.effect.id for f in found.effects] == ["loadcell-offset-mz"]
    assert note_of(found).startswith("eps_gamma stays ")


def test_where_pecp1_comes_from(small, tmp_path):
    result, _ = small
    assert result.tyre["PECP1"] == result.measured.epsilon_gamma.value == result.measured.pecp1
    held = result.fit.coefficients
    assert held["PECP1"].status == "measured"
    assert held["PECP1"].stderr == pytest.approx(result.measured.epsilon_gamma.u, rel=0.1)  # before the fit
    assert (held["PECP2"].status == "measured") == bool(result.measured.pecp2)
    assert result.measured.epsilon_gamma_model != result.measured.epsilon_gamma.value
    stated = f"PECP1 = {result.tyre['PECP1']:.4f} is eps_gamma as measured."
    assert sum(stated in sentence for sentence in result.fit.explanations) == 1
    campaign(tmp_path, faults={"F0_N": 15.0}, spin={"pecp1": "debiased"})
    debiased = mffit.build(tmp_path / "tyre.toml")
    bias = result.measured.epsilon_gamma.value - result.measured.epsilon_gamma_debiased.value
    assert debiased.tyre["PECP1"] == pytest.approx(result.measured.epsilon_gamma.value - bias, abs=0.005)
    assert debiased.measured.pecp1 == debiased.tyre["PECP1"]
    # The load-cell offset affects eps_gamma but not its bias, so noise-free data without offset have the same bias.
    noise_free = direct_of_truth(tmp_path / "clean")
    assert bias == pytest.approx(noise_free - truth()["PECP1"], abs=0.02)


def direct_of_truth(folder) -> float:
    """eps_gamma of the direct method on noise-free readings of the true tyre."""
    simulated(disc(noise={}), folder, seed=1)
    return mffit.spin(folder / "tyre.toml").epsilon_gamma.value


def test_a_missing_base_file_is_named(tmp_path):
    campaign(tmp_path)
    (tmp_path / "base.tir").unlink()
    with pytest.raises(InputError, match=r"base file .*base\.tir does not exist"):
        mffit.build(tmp_path / "tyre.toml")


def test_alignment_of_a_project_uses_the_measured_stiffness(tmp_path):
    """0.3 deg off: the next correction is -0.3 deg minus ply-steer; the usual stiffness makes it a third too large."""
    campaign(tmp_path, faults={"alpha_0_deg": 0.3})
    found = mffit.align(tmp_path / "tyre.toml")
    assert len(found.steps) == 3
    table = pd.concat(
        [pd.read_csv(tmp_path / f"{way}_1400.csv").assign(direction=way) for way in ("forward", "backward")]
    )
    table.to_csv(tmp_path / "zeros.csv", index=False)
    (alone,) = mffit.align(tmp_path / "zeros.csv", axes="iso", path_centre="left").steps
    (same,) = (s for s in found.steps if s.load == alone.load)
    assert alone.F_slip == pytest.approx(same.F_slip, abs=8.0)  # the sweeps of the project contain zeros too
    assert (alone.source, same.source) == ("guess", "measured")
    off = 0.3 + np.degrees(tir.read(SAMPLE / "true.tir")["PHY1"])
    assert same.correction_deg == pytest.approx(-off, abs=3.0 * same.u_deg)
    assert same.u_deg < 0.02 < alone.u_deg
    assert not found.aligned
    sae = tmp_path / "sae"
    campaign(sae, faults={"alpha_0_deg": 0.3}, rig=disc()["rig"] | {"axes": "sae"})
    assert mffit.align(sae / "tyre.toml").correction_deg == pytest.approx(-found.correction_deg, rel=1e-3)


def test_a_flat_track_has_no_bias_and_one_file():
    result = sound(flat)
    assert undistorted(result.config, result.fit) is None
    assert list(result.files) == ["normal"]
    assert result.tyre is result.tyres["normal"]
    assert np.all(result.parts.paired == "unpaired")
    assert result.measured.epsilon_gamma_debiased is None
    assert not any("PECP1" in sentence for sentence in result.fit.explanations)
