"""The samples are what `mffit simulate` makes of their rig.toml, and every one says what is true."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

from mffit import config
from mffit.output import RECORD
from mffit.rig_errors import Faults
from mffit.virtual_rig import simulate

SAMPLES = Path(__file__).parents[1] / "samples"
SIMULATED = sorted(path.parent.name for path in SAMPLES.glob("*/rig.toml"))


@pytest.mark.parametrize("name", SIMULATED)
def test_a_sample_can_be_made_again(name, tmp_path):
    simulate(SAMPLES / name / "rig.toml", tmp_path)
    for made in sorted(path for path in tmp_path.iterdir() if path.name != RECORD):
        kept = SAMPLES / name / made.name
        if made.name.endswith((".csv", ".csv.gz")):
            # Another processor may round the last printed digit the other way.
            pd.testing.assert_frame_equal(pd.read_csv(made), pd.read_csv(kept), rtol=0, atol=1.001)
            difference = (pd.read_csv(made) - pd.read_csv(kept)).abs()
            assert (difference > 1e-9).mean(axis=None) < 0.001, (
                f"{name}/{made.name} is not what its rig.toml gives"
            )
        elif made.name == "truth.json":
            kept_truth, made_truth = (json.loads(path.read_text()) for path in (kept, made))
            # A rig error that the program did not know when the sample was made is absent.
            known = {
                name: value for name, value in made_truth["faults"].items() if name in kept_truth["faults"]
            }
            assert known == kept_truth["faults"]
            assert (
                not Faults(**(made_truth["faults"] | {"path_radius_m": 1.0})).disturbed.keys() - known.keys()
            )
            assert made_truth["epsilon_gamma"] == pytest.approx(kept_truth["epsilon_gamma"], abs=1e-7)
        else:
            assert made.read_text() == kept.read_text(), f"{name}/{made.name} is not what its rig.toml gives"


@pytest.mark.parametrize("name", SIMULATED)
def test_a_sample_has_the_files_it_names(name):
    folder = SAMPLES / name
    content = config.load(folder / "tyre.toml")
    files = {sweep.file for sweep in content.sweep}
    assert files == {path.name for path in folder.iterdir() if ".csv" in path.name}
    assert content.base_path is None or content.base_path.is_file()


def test_samples_stay_small():
    size = sum(
        path.stat().st_size for path in SAMPLES.rglob("*") if "out" not in path.parts and path.is_file()
    )
    assert size < 3e6, f"samples/ holds {size / 1e6:.1f} MB; keep it under 3 MB"
