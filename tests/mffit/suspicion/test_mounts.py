"""Files measured with the tyre turned on its rim, undeclared: several hide each other from every comparison of single ones."""

from __future__ import annotations

import shutil
from pathlib import Path

import pandas as pd

from mffit.pipeline import build

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
