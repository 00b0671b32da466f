"""A fit that ends far above the noise tries alternative starting values and warns that it is not to be trusted."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from small_rigs import FY, LOADS, MZ, SAMPLE, flat

import mffit
from mffit import virtual_rig
from mffit.fit.start import ALTERNATIVE_STARTS


@pytest.fixture(scope="module")
def rough(tmp_path_factory):
    """One load on a flat track, noise of 1.6 times the stated one, and in the camber sweep of 20 times the stated one."""
    folder = tmp_path_factory.mktemp("rough")
    content = flat(noise={"Fy_N": 1.6 * FY, "Mz_Nm": 0.9 * MZ})
    content["sweep"] = [s for s in content["sweep"] if s["load_N"] == LOADS[1]]
    virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLE), folder, seed=2)
    for path in folder.glob("*.csv"):
        table = pd.read_csv(path)
        table["u_Fy_N"], table["u_Mz_Nm"] = FY, MZ
        if path.name.startswith("camber"):
            table["Fy_N"] += 20.0 * FY * np.random.default_rng(1).standard_normal(len(table))
        table.to_csv(path, index=False)
    return mffit.build(folder / "tyre.toml")


def test_the_first_warning_is_distrust_and_names_the_sweep(rough):
    """Half of the 47 points have 1.6 times the stated noise, the rest more, so that the misfit is far above 1.5."""
    assert not rough.trusted
    assert "Fy" in rough.warnings[0]
    assert "not to be trusted" in rough.warnings[0]
    assert "most of it in camber_1400;" in rough.warnings[0]
    assert not any("Mz by" in warning for warning in rough.warnings)


def test_all_alternative_starts_are_tried(rough):
    (said,) = (w for w in rough.fit.warnings if "started again" in w)
    assert all(shape in said for shape in ALTERNATIVE_STARTS)
