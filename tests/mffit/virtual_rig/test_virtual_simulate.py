"""Files: what is written, that it repeats, and that nothing is half-written."""

from __future__ import annotations

import json
import tomllib

import pandas as pd
import pytest

import tir
from mffit.output import RECORD
from mffit.virtual_rig import load_plan, simulate


@pytest.fixture
def plan(content, folder):
    return load_plan(
        content | {"noise": {"Fy_N": 6.0, "Mz_Nm": 0.6}, "faults": {"draw": True}}, folder=folder
    )


def test_sweeps_configuration_and_truth_are_written(plan, tmp_path, tyre):
    truth = simulate(plan, tmp_path / "out", seed=3)
    names = {path.name for path in (tmp_path / "out").iterdir()} - {RECORD}
    assert names == {"sideslip.csv", "camber.csv", "forward.csv", "backward.csv", "tyre.toml", "truth.json"}
    written = json.loads((tmp_path / "out" / "truth.json").read_text())
    assert written["epsilon_gamma"] == truth.nominal.epsilon_gamma
    assert written["coefficients"]["PKY1"] == tyre["PKY1"]
    assert written["faults"]["alpha_0_deg"] == truth.faults["alpha_0_deg"]
    content = tomllib.loads((tmp_path / "out" / "tyre.toml").read_text())
    assert [sweep["file"] for sweep in content["sweep"]] == [
        "sideslip.csv",
        "camber.csv",
        "forward.csv",
        "backward.csv",
    ]
    table = pd.read_csv(tmp_path / "out" / "camber.csv")
    assert {"alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "Mz_Nm", "p_kPa", "V_mps", "T_degC"} <= set(table)


def test_a_seed_repeats_every_byte(plan, content, folder, tmp_path):
    content["sweep"][0] |= {"file": "sideslip.csv.gz", "recording": {"hold_s": 2}}
    plan = load_plan(content, folder=folder)
    for out in ("first", "second"):
        simulate(plan, tmp_path / out, seed=3)
    for path in (tmp_path / "first").iterdir():
        assert path.read_bytes() == (tmp_path / "second" / path.name).read_bytes()


def test_the_base_file_comes_along(content, folder, tmp_path):
    content["tyre"]["base"] = "base.tir"
    simulate(load_plan(content, folder=folder), tmp_path)
    assert tir.read(tmp_path / "base.tir") == tir.read(folder / "base.tir")


def test_a_failing_run_leaves_the_folder_as_it_was(content, tmp_path):
    out = tmp_path / "out"
    out.mkdir()
    (out / "tyre.toml").write_text("mine")
    with pytest.raises(tir.TirError):
        simulate(load_plan(content | {"truth": {"tyre": "nowhere.tir"}}, folder=tmp_path), out)
    assert [path.name for path in out.iterdir()] == ["tyre.toml"]
    assert (out / "tyre.toml").read_text() == "mine"
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
