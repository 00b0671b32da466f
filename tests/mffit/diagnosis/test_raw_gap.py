"""The gap before is measured minus simulated at every reading as it was read; what is taken off is said.

The gap is computed by hand from the files and a property file; the files are those of the virtual rig.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import small_rigs
from driven_rig import FX, SAMPLE, against_loaded_radius, driven

import mffit
import tir
from mffit.diagnosis import wording
from mffit.report import text


def gap_by_hand(folder: Path, channel: str, unit: str, sample: Path = SAMPLE) -> float:
    """Root mean square of measured less true tyre at the conditions that the files state."""
    tyre, squares = tir.read(sample / "true.tir"), []
    for path in sorted(folder.glob("*.csv")):
        t = pd.read_csv(path)
        forces = tyre(
            t["Fz_N"].to_numpy(),
            alpha=np.radians(t["alpha_deg"].to_numpy()),
            gamma=np.radians(t["gamma_deg"].to_numpy()),
            kappa=t["kappa"].to_numpy() if "kappa" in t else 0.0,
            p=1e3 * t["p_kPa"].to_numpy(),
            Vx=t["V_mps"].to_numpy(),
            turn_slip=False,
        )
        squares.append(((t[f"{channel}_{unit}"] - getattr(forces, channel)) ** 2).to_numpy())
    return float(np.sqrt(np.mean(np.concatenate(squares))))


def diagnosed(folder: Path, sample: Path = SAMPLE) -> mffit.diagnosis.Diagnosis:
    return mffit.diagnose(folder / "tyre.toml", sample / "true.tir")


def test_a_zero_of_the_slip_is_in_the_gap_and_an_effect(tmp_path):
    """0.008 of slip are 300 N of longitudinal force; the readings are of the rig's zero at every load."""
    driven(tmp_path, kappa_0=0.008)
    found = diagnosed(tmp_path)
    assert gap_by_hand(tmp_path, "Fx", "N") > 15.0 * FX
    assert found.gap_before.rms("Fx") == pytest.approx(gap_by_hand(tmp_path, "Fx", "N"), rel=1e-3)
    (named,) = found.effects
    assert named.effect.id == "slip-zero"
    value, u = named.parameters["kappa_0"]
    assert value == pytest.approx(0.008, abs=4.0 * u)
    assert found.gap_after.rms("Fx") < 1.2 * FX


def test_a_slip_against_the_loaded_radius_is_in_the_gap_and_in_a_line(tmp_path):
    """Wheel speed times loaded radius over speed: no effect of the library has this zero, which falls with load."""
    driven(tmp_path)
    against_loaded_radius(tmp_path)
    found = diagnosed(tmp_path)
    by_hand = gap_by_hand(tmp_path, "Fx", "N")
    assert by_hand > 50.0 * FX
    assert found.gap_before.rms("Fx") == pytest.approx(by_hand, rel=1e-3)
    assert found.gap_before.chi2_per_dof > 100.0 * found.gap_after.chi2_per_dof
    assert any("against the loaded radius" in said and "taken off" in said for said in wording.notes(found))
    printed = " ".join(text.diagnosis_summary(found).split())
    assert f"{by_hand:.0f} N as read" in printed
    assert found.gap_after.rms("Fx") < 1.2 * FX


def test_a_sweep_that_is_left_out_is_in_the_gap(tmp_path):
    """The side force of one sweep was written down in lbf."""
    small_rigs.simulated(small_rigs.flat(), tmp_path)
    path = tmp_path / "sideslip_900.csv"
    table = pd.read_csv(path)
    table.assign(Fy_N=table["Fy_N"] / 4.44822).to_csv(path, index=False)
    found = diagnosed(tmp_path, small_rigs.SAMPLE)
    assert "was left out" in found.headline
    assert found.gap_before.rms("Fy") == pytest.approx(
        gap_by_hand(tmp_path, "Fy", "N", small_rigs.SAMPLE), rel=1e-3
    )
    assert found.gap_after.rms("Fy") < 1.2 * small_rigs.FY
