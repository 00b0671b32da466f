"""A build that ends far above the noise tries alternative starting values and says everywhere that it is not to be trusted."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
import pytest
from plain_pages import without_pictures
from small_rigs import FY, LOADS, MZ, SAMPLE, flat

import tir
from mffit import virtual_rig
from mffit.cli import main


class Ended(NamedTuple):
    """What a build left."""

    code: int | str | None
    out: Path
    result: dict[str, Any]


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
    with without_pictures(), pytest.raises(SystemExit) as end:
        main(["build", str(folder / "tyre.toml")])
    out = folder / "out"
    return Ended(end.value.code, out, json.loads((out / "result.json").read_text(encoding="utf-8")))


def test_the_first_warning_is_distrust_and_names_the_sweep(rough):
    """Half of the 47 points have 1.6 times the stated noise, the rest more, so that the misfit is far above 1.5."""
    first, *others = rough.result["warnings"]
    assert "Fy" in first
    assert "not to be trusted" in first
    assert "camber_1400" in first
    assert not any("Mz by" in warning for warning in others)


def test_the_result_says_so_everywhere(rough):
    """Exit code 3; first keys of the JSON, first box of the page, first comment of the file."""
    assert rough.code == 3
    assert list(rough.result)[:2] == ["trusted", "reasons"]
    assert rough.result["trusted"] is False
    reasons = rough.result["reasons"]
    assert "camber_1400" in reasons[0]
    assert any("misses Fy of camber_1400 by" in reason for reason in reasons)
    page = (rough.out / "report.html").read_text(encoding="utf-8")
    assert page.index("NOT TO BE TRUSTED") < page.index("Which file goes where")
    tyre = tir.read(rough.out / rough.result["tir"])
    assert "misses Fy of camber_1400" in tyre.provenance["NOT TO BE TRUSTED"]


def test_the_misfit_over_the_stated_noise_is_that_of_the_points(rough):
    """Fy and Mz of every reading with a weight against its own uncertainty."""
    points = pd.read_csv(rough.out / "points.csv", dtype={"outlier": str})
    for channel, unit in (("Fy", "N"), ("Mz", "Nm")):
        kept = ~points["outlier"].fillna("").str.contains(channel)
        z = (points[f"{channel}_model_{unit}"] - points[f"{channel}_{unit}"]) / points[f"u_{channel}_{unit}"]
        stated = rough.result["fit"]["channels"][channel]["over_noise"]
        assert stated == pytest.approx(np.sqrt(np.mean(z[kept] ** 2)), rel=1e-3)
