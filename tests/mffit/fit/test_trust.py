"""A fit that ends far from the noise starts again elsewhere, keeps the best, and says that it is not to be trusted."""

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
    """One load on a flat track, scatter of 1.6 times what is stated, and a camber sweep that scatters 20 times as much."""
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


def test_it_says_first_that_it_is_not_to_be_trusted_and_where(rough):
    """Half of all 47 points scatter as stated times 1.6, so the core of the misfit lies above twice the statement."""
    assert "Fy" in rough.fit.warnings[0]
    assert "not to be trusted" in rough.fit.warnings[0]
    assert "most of it in camber_1400;" in rough.fit.warnings[0]
    assert not any("Mz by" in warning for warning in rough.fit.warnings)


def test_it_tries_every_other_shape(rough):
    (said,) = (w for w in rough.fit.warnings if "started again" in w)
    assert all(shape in said for shape in ALTERNATIVE_STARTS)
