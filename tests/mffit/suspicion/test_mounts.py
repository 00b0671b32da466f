"""Files measured with the tyre turned on its rim, undeclared: several hide each other from every comparison of single ones."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from mffit.pipeline import build
from mffit.suspicion.mounts import _weighted

SAMPLES = Path(__file__).parents[3] / "samples"
TURNED = ("alpha_deg", "gamma_deg", "Fy_N", "Mz_Nm")
PAIR = ("sideslip_1400N_10deg.csv", "sideslip_2100N_20deg.csv")


def test_two_files_with_the_tyre_turned_on_its_rim_are_named(tmp_path):
    path = tmp_path / "belt" / "tyre.toml"
    shutil.copytree(SAMPLES / "flat-track", path.parent)
    for name in PAIR:
        table = pd.read_csv(path.parent / name, comment="#")
        table[list(TURNED)] *= -1.0
        table.to_csv(path.parent / name, index=False)
    (said,) = [one for one in build(path).trust.doubts if "turned on its rim" in one]
    assert said.startswith(" and ".join(PAIR))
    text = path.read_text(encoding="utf-8")
    for name in PAIR:  # declared, they are as good as any
        text = text.replace(f'file = "{name}"', f'file = "{name}"\nmount = "flipped"')
    path.write_text(text, encoding="utf-8")
    assert not build(path).trust.doubts


def test_readings_of_a_file_with_a_common_error_count_as_little_as_that_error_allows():
    """Against the inverse of the whole covariance; a constant in 400 readings with a common error of 3 counts as one of 3."""
    rng = np.random.default_rng(4)
    x, error = rng.normal(size=(30, 4)), rng.normal(size=(30, 6))
    expected = x.T @ np.linalg.solve(np.eye(30) + error @ error.T, x)
    assert _weighted(x, error) == pytest.approx(expected)
    constant = np.ones((400, 1))
    assert _weighted(constant, 3.0 * constant)[0, 0] == pytest.approx(1.0 / 9.0, rel=0.01)
