"""The file for simulations without turn slip, and what the written file promises."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import mffit
import tir
from tir.check import check

SAMPLES = Path(__file__).parents[3] / "samples"


@pytest.fixture(scope="module")
def result():
    return mffit.build(SAMPLES / "front-120-70" / "tyre.toml")


def test_camber_stiffness_of_the_normal_file_is_the_measured_one(result):
    measured = result.measured
    K = result.tyre.state(measured.F_phit_load, p=250e3).K_yg0
    assert pytest.approx(measured.C_gamma.value, rel=1e-3) == K


def test_pecp1_is_the_measured_eps_gamma(result):
    assert result.tyre["PECP1"] == result.measured.epsilon_gamma.value


def test_limits_hold_over_the_written_ranges(result):
    sentences = [p.sentence for p in check(result.tyre) if p.level == "error" or "E_y" in p.sentence]
    assert not sentences


def test_ranges_are_what_was_tested(result):
    assert np.degrees(result.tyre["CAMMAX"]) == pytest.approx(50.0, abs=0.5)
    assert result.tyre["FZMIN"] < 950 < 2050 < result.tyre["FZMAX"]
    assert int(result.tyre["FITTYP"]) == 62


def test_every_fitted_value_says_so_in_the_file(result, tmp_path):
    result.tyre.write(tmp_path / "t.tir")
    again = tir.read(tmp_path / "t.tir")
    assert again == result.tyre
    assert again.status["PKY1"].startswith("fitted +- ")
    assert again.status["PKX1"] == "from base"
    assert again.measured["epsilon_gamma"].u == pytest.approx(result.measured.epsilon_gamma.u)


def test_a_straight_path_measures_no_spin():
    flat = mffit.build(SAMPLES / "flat-track" / "tyre.toml")
    assert flat.measured.epsilon_gamma is None
    assert flat.fit.coefficients["PECP1"].fixed
    assert all(not row.free for row in flat.fit.coverage if row.stage == "spin")
