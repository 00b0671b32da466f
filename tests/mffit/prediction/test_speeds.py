"""A tyre whose friction changes with the speed, tested at two speeds: its law is independent of the project's model."""

from __future__ import annotations

import json
from typing import NamedTuple

import brush
import numpy as np
import pandas as pd
import pytest
from conftest import Built, build

import mffit
import tir
from mffit.constants import COVERAGE_FACTOR_95
from mffit.scatter import rms
from tir.errors import TirWarning

PER_MPS = -0.008
"""Relative change of friction [s/m]."""
FAST = 25.0
TYRE = brush.Brush(b=0.04, carcass=2e5)


def at(V: float) -> brush.Brush:
    return TYRE._replace(mu=TYRE.mu * (1.0 + PER_MPS * (V - 10.0)))


class TwoSpeeds(NamedTuple):
    """Builds of one programme of runs, of which sideslip sweeps were run again at a higher speed."""

    changes: Built  #: of the tyre whose friction changes with the speed
    stays: Built  #: of one whose friction does not


@pytest.fixture(scope="module")
def tested(tmp_path_factory) -> TwoSpeeds:
    found = []
    for fast in (at(FAST), TYRE):
        folder = tmp_path_factory.mktemp("speeds")
        found.append(build(brush.written(TYRE, folder, seed=3, also={FAST: fast}, only="sideslip")))
    return TwoSpeeds(*found)


def asked(**columns: float) -> pd.DataFrame:
    alpha = np.array([-7.0, -5.0, -3.5, -2.5, -1.2, -0.4, 0.4, 1.2, 2.5, 3.5, 5.0, 7.0])
    each = [
        pd.DataFrame({"alpha_deg": alpha, "gamma_deg": gamma, "Fz_N": load})
        for gamma, load in ((0.0, 1000.0), (0.0, 2600.0), (4.0, 1700.0))
    ]
    return pd.concat(each, ignore_index=True).assign(**columns)


def forces(tyre: brush.Brush) -> tuple[np.ndarray, np.ndarray]:
    """Fy [N] and Mz [Nm] (n,) of a tyre at the conditions of :func:`asked`."""
    conditions = asked()
    return tyre.forces(*np.radians(conditions[["alpha_deg", "gamma_deg"]].to_numpy().T), conditions.Fz_N)


def true(V: float) -> np.ndarray:
    """Fy (n,) [N] of the tyre at the conditions of :func:`asked`."""
    return forces(at(V))[0]


def test_no_faultless_sweep_is_accused(tested):
    assert all(built.result.trusted and not built.result.fit.doubts for built in tested)


def test_friction_changes_and_stiffness_stays(tested):
    """Of a brush the slope at zero sideslip is that of its bristles."""
    rig = tested.changes.result.fit.rig
    for name, expected in (("k_V_grip_per_mps", PER_MPS), ("k_V_stiffness_per_mps", 0.0)):
        value, u = rig[name]
        assert abs(value - expected) < 3.0 * u < 0.4 * abs(PER_MPS)
    said = " ".join(tested.changes.result.fit.explanations)
    assert "they hold at 10 m/s" in said
    assert "at 25 m/s take LMUY" in said


@pytest.mark.parametrize("V", [10.0, 17.5, FAST])
def test_the_truth_is_within_the_interval_at_every_tested_speed(tested, V):
    """The file holds at 10 m/s; the best estimate follows the speed, also leaned, where only 10 m/s was run."""
    conditions = asked(V_mps=V)
    found = tested.changes.predict(**conditions)
    error, half = found.Fy_best_N - true(V), COVERAGE_FACTOR_95 * found.u_Fy_best_N
    assert np.mean(np.abs(error) < half) >= 0.92
    changed = rms(true(FAST) - true(10.0))
    assert rms(error) < 0.25 * changed
    assert rms(found.Fy_N - true(10.0)) < 0.35 * changed


def test_a_speed_that_is_not_stated_is_that_of_the_file(tested):
    here, unstated = (tested.changes.predict(**asked(**own)) for own in ({"V_mps": 10.0}, {}))
    np.testing.assert_allclose(unstated.Fy_best_N, here.Fy_best_N, rtol=1e-12)


def test_beyond_the_tested_speeds_the_force_is_that_of_the_nearest(tested):
    with pytest.warns(TirWarning, match="outside the tested speeds, 10 to 25.*that at the nearest of them"):
        beyond = tested.changes.predict(**asked(V_mps=40.0))
    np.testing.assert_allclose(
        beyond.Fy_best_N, tested.changes.predict(**asked(V_mps=FAST)).Fy_best_N, rtol=1e-12
    )


def test_the_file_and_its_result_state_the_speed_at_which_it_holds(tested):
    result, folder = tested.changes
    file = tir.read(folder / "brush.tir")
    assert file.measured["rig.V_ref_mps"].value == 10.0
    assert file.provenance["speed"].startswith("holds at 10 m/s, elsewhere LMUY and LKY times 1 + k (V - 10)")
    stated = json.loads((folder / "result.json").read_text())["fit"]["speed"]
    assert (stated["V_ref_mps"], stated["V_min_mps"], stated["V_max_mps"]) == (10.0, 10.0, FAST)
    value, u = result.fit.rig["k_V_grip_per_mps"]
    assert stated["terms"]["k_V_grip_per_mps"] == {"value": value, "stderr": u, "unit": "s/m"}
    assert stated["without_terms"]["Fy"]["rmse"] > 1.2 * result.fit.channels["Fy"].rmse


def test_what_the_file_says_of_other_speeds_is_the_tyre_there(tested):
    """LMUY and LKY scaled as its comment says take the file to the other speed."""
    file = tir.read(tested.changes.folder / "brush.tir")
    factors = {
        name: 1.0 + file.measured[f"rig.{term}"].value * (FAST - file.measured["rig.V_ref_mps"].value)
        for name, term in (("LMUY", "k_V_grip_per_mps"), ("LKY", "k_V_stiffness_per_mps"))
    }
    there = file.replace(**{name: float(file[name]) * factor for name, factor in factors.items()})
    conditions = asked()
    alpha, gamma = np.radians(conditions[["alpha_deg", "gamma_deg"]].to_numpy().T)
    off, corrected = (
        rms(tyre(conditions.Fz_N.to_numpy(), alpha, gamma).Fy - true(FAST)) for tyre in (file, there)
    )
    assert corrected < 0.5 * off


def test_a_comparison_takes_the_file_to_the_speed_of_every_reading(tested):
    """The fast sweep is as near to the file as the slow one of the same conditions, 15 m/s of speed apart."""
    folder = tested.changes.folder
    found = mffit.compare(folder / "brush.tir", folder.parent / "tyre.toml")
    off = {one.sweep: one.rms for one in found.sweeps if one.channel == "Fy"}
    assert off["sideslip_2600_25"] < 1.3 * off["sideslip_2600"]
    assert any("brush.tir holds at 10 m/s" in note for note in found.notes)


def test_a_tyre_without_it_gets_no_term(tested):
    fit = tested.stays.result.fit
    assert fit.speed is None
    assert not any(name.startswith("k_V") for name in fit.rig)
    here, there = (tested.stays.predict(**asked(V_mps=V)) for V in (10.0, FAST))
    assert np.max(np.abs(here.Fy_best_N - there.Fy_best_N) / here.u_Fy_best_N) < 0.1


def test_friction_that_falls_with_the_sliding_speed_is_followed(tmp_path):
    """It bends the curve where no scaling factor does: the model error is one over the speed too."""
    slides = {V: TYRE._replace(fading=TYRE.fading * V / 10.0) for V in (10.0, FAST)}
    built = build(brush.written(slides[10.0], tmp_path, seed=3, also={FAST: slides[FAST]}))
    assert built.result.trusted
    slow, fast = (built.predict(**asked(V_mps=V)) for V in slides)
    for name, there, here in zip(
        ("Fy_best_N", "Mz_best_Nm"), *map(forces, reversed(slides.values())), strict=True
    ):
        assert rms(fast[name] - slow[name] - (there - here)) < 0.25 * rms(there - here)
