"""`samples/benchmark`: a campaign is made as described, and the score of a file is its distance from the truth."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

import tir
from mffit.conversion import to_old

FOLDER = Path(__file__).parents[1] / "samples" / "benchmark"
NOISE = {"Fy": 16.0, "Mz": 1.6}
ZERO = 12.0


@pytest.fixture(scope="module")
def benchmark():
    sys.path.insert(0, str(FOLDER))
    try:
        import benchmark
    finally:
        sys.path.remove(str(FOLDER))
    return benchmark


@pytest.fixture(scope="module")
def thin(benchmark, tmp_path_factory):
    out = tmp_path_factory.mktemp("benchmark")
    benchmark.make(out, "thin")
    return out


def test_sweeps_held_back_are_not_given(benchmark, thin):
    held = benchmark.CAMPAIGNS["thin"]["held"]
    assert sorted(path.name for path in (thin / "thin" / "held").glob("*.csv")) == held
    given = {path.name for path in (thin / "thin" / "given").glob("*.csv")}
    assert given == {*benchmark.CAMPAIGNS["thin"]["only"]} - {*held}


def test_the_truth_is_off_by_noise_and_zeros_alone(benchmark, thin):
    found = benchmark.score(thin, "thin", thin / "thin" / "true.tir")
    assert found["Fy tested [%]"] == found["Mz beyond [%]"] == 0.0
    slope = 0.1 * np.pi / 180.0 * 30_000.0  # the sideslip axis is 0.1 deg off
    assert NOISE["Fy"] < found["Fy held back [N]"] < np.hypot(NOISE["Fy"], ZERO + slope)
    assert found["Mz held back [Nm]"] == pytest.approx(NOISE["Mz"], rel=0.5)


@pytest.mark.parametrize("form", ["62", "mf52"])
def test_a_stronger_tyre_is_as_far_off_as_it_is_stronger(benchmark, thin, tmp_path, form):
    """LMUY and LKY scale the whole curve of the side force of an upright wheel."""
    tyre = tir.read(thin / "thin" / "true.tir").replace(LMUY=1.05, LKY=1.05, LKYC=1.05)
    tyre.write(tmp_path / "62.tir")
    (tmp_path / "mf52.tir").write_text(to_old(tmp_path / "62.tir", "mf52").text, encoding="ascii")
    found = benchmark.score(thin, "thin", tmp_path / f"{form}.tir")
    assert 2.0 < found["Fy tested [%]"] < 5.5
