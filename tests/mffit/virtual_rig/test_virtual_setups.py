"""The virtual rig set up several times: zeros of every set-up, given or drawn."""

from __future__ import annotations

import json
import tomllib

import numpy as np
import pandas as pd
import pytest
from small_rigs import SAMPLE, disc, simulated

from mffit.errors import InputError
from mffit.virtual_rig import load_plan, run
from mffit.virtual_rig.campaign import faults_in_setups
from tir import read


@pytest.fixture(scope="module")
def tyre():
    return read(SAMPLE / "true.tir")


def both_sides(**changes):
    """One load on either side of the disc without noise."""
    content = disc((1400,), noise={}, **changes)
    content["sweep"] = content["sweep"][:4]
    other = [{**s, "file": f"right_{s['file']}", "path_centre": "right"} for s in content["sweep"]]
    content["sweep"] = content["sweep"] + other
    return content


def planned(**changes):
    return load_plan(both_sides(**changes), folder=SAMPLE)


def test_a_given_error_acts_in_its_set_up_only(tyre):
    without = run(planned(), tyre).tables
    with_it = run(planned(setup={"right": {"F0_N": -9.0}}), tyre).tables
    for file, table in with_it.items():
        expected = -9.0 if file.startswith("right") else 0.0
        assert (table.Fy_N - without[file].Fy_N).to_numpy() == pytest.approx(expected, abs=1e-9)


def test_an_error_of_a_set_up_adds_to_that_of_the_rig(tyre):
    found = faults_in_setups(
        planned(faults={"F0_N": 5.0}, setup={"right": {"F0_N": -9.0}}), tyre, np.random.default_rng(0)
    )
    assert {name: faults["F0_N"] for name, faults in found.items()} == {"left": 5.0, "right": -4.0}


def test_zeros_are_drawn_for_every_set_up_and_the_rest_once(tyre):
    plan = planned(faults={"draw": True})
    drawn = [faults_in_setups(plan, tyre, np.random.default_rng(seed)) for seed in range(600)]
    for name, u in (("F0_N", 10.0), ("gamma_0_deg", 0.5)):
        left, right = np.array([[rig[setup][name] for setup in ("left", "right")] for rig in drawn]).T
        assert np.std(right) == pytest.approx(u, rel=0.1)
        assert abs(np.corrcoef(left, right)[0, 1]) < 0.15
    for rig in drawn[:5]:
        assert rig["left"]["camber_skew_deg"] == rig["right"]["camber_skew_deg"] != 0.0
        assert rig["left"]["path_radius_m"] == rig["right"]["path_radius_m"] != 1.323


def test_the_first_set_up_has_the_errors_of_a_rig_with_one(tyre):
    one = both_sides(faults={"draw": True})
    for sweep in one["sweep"]:
        sweep["setup"] = "A"
    alone = faults_in_setups(load_plan(one, folder=SAMPLE), tyre, np.random.default_rng(3))
    several = faults_in_setups(planned(faults={"draw": True}), tyre, np.random.default_rng(3))
    assert dict(alone["A"]) == pytest.approx(dict(several["left"]), nan_ok=True)


def test_truth_and_tyre_toml_name_the_set_ups(tmp_path):
    content = both_sides(setup={"may": {"gamma_0_deg": 0.3}})
    for sweep in content["sweep"][:4]:
        sweep["setup"] = "may"
    known = simulated(content, tmp_path / "rig")
    written = json.loads((tmp_path / "rig" / "truth.json").read_text())
    assert written["faults_of_setups"]["may"]["gamma_0_deg"] == 0.3
    assert written["faults_of_setups"]["right"]["gamma_0_deg"] == 0.0
    assert known.faults["gamma_0_deg"] == 0.3
    sweeps = tomllib.loads((tmp_path / "rig" / "tyre.toml").read_text())["sweep"]
    assert [sweep.get("setup") for sweep in sweeps] == ["may"] * 4 + [None] * 4
    assert len(pd.read_csv(tmp_path / "rig" / "camber_1400.csv"))


def test_errors_of_a_set_up_that_no_sweep_has_are_refused(tyre):
    with pytest.raises(InputError, match=r"setup\.Right.*set-ups of the sweeps: left, right"):
        run(planned(setup={"Right": {"F0_N": 1.0}}), tyre)
