"""The arm of the side force in Mx over pressure, as the virtual rig draws it: found beside a file that holds at the mean one."""

from __future__ import annotations

import json

import numpy as np
import pandas as pd
import pytest
import small_rigs

import mffit
import tir

PER_KPA = -4e-4
"""About what a racing tyre on a flat belt has [1/kPa]."""
PRESSURES = (160, 200, 250)
"""Tested [kPa]; the last is nominal."""


def built(folder, faults):
    """Sideslip sweeps at three pressures and loads; the moment has the terms that a fit frees."""
    true = small_rigs.truth().replace(**{f"QSX{k}": 0.0 for k in range(4, 15)})
    true.write(folder / "arm.tir")
    noise = {"Fy_N": small_rigs.FY, "Mz_Nm": small_rigs.MZ, "Mx_Nm": 1.0}
    content = small_rigs.flat(truth={"tyre": str(folder / "arm.tir")}, noise=noise, faults=faults)
    content["sweep"] = [
        {**sweep, "file": f"{pressure}_{sweep['file']}", "p_kPa": pressure}
        for pressure in PRESSURES
        for sweep in content["sweep"]
        if sweep["file"].startswith(("sideslip", "camber_1400"))
    ]
    small_rigs.simulated(content, folder)
    return true, mffit.build(folder / "tyre.toml", folder / "out", with_report=False)


def test_the_arm_over_pressure_is_found_beside_the_file(tmp_path):
    true, result = built(tmp_path, {"k_p_arm_per_kPa": PER_KPA})
    value, u = result.fit.rig["k_p_arm_per_kPa"]
    assert abs(value - PER_KPA) < 3.5 * u < 0.2 * abs(PER_KPA)
    # the file is best where it was measured
    middle, _ = result.fit.rig["p_ref_kPa"]
    assert middle == pytest.approx(np.mean(PRESSURES), abs=0.05)
    arm = result.fit.coefficients["QSX3"]
    assert abs(arm.value - (true["QSX3"] + PER_KPA * (middle - 250.0))) < 3.5 * arm.stderr < 5e-3
    assert tir.read(tmp_path / "out" / "small.tir").measured["rig.p_ref_kPa"].value == pytest.approx(middle)
    assert any(
        "arm of the side force in Mx over pressure is modelled" in note for note in result.fit.explanations
    )
    content = json.loads((tmp_path / "out" / "result.json").read_text())
    assert content["fit"]["rig"]["k_p_arm_per_kPa"] == {"value": value, "stderr": u, "unit": "1/kPa"}
    # the file lacks the term, the best estimate does not
    points = result.points
    hard = points.select(np.flatnonzero((points.p > 240e3) & (np.abs(points.Fy) > 1000.0)))
    asked = {name: hard.condition(name) for name in ("alpha_deg", "gamma_deg", "Fz_N", "p_kPa")}
    found = mffit.predict(tmp_path / "out", pd.DataFrame(asked))
    expected = PER_KPA * (250.0 - middle) * true["UNLOADED_RADIUS"] * hard.Fy
    assert np.all(np.abs(expected) > 5.0)
    of_file, of_best = (np.mean((hard.Mx - found[name]) / expected) for name in ("Mx_Nm", "Mx_best_Nm"))
    assert of_file == pytest.approx(1.0, abs=0.25)
    assert abs(of_best) < 0.25


def test_a_tyre_without_it_gets_no_term(tmp_path):
    _, result = built(tmp_path, {})
    assert "k_p_arm_per_kPa" not in result.fit.rig
