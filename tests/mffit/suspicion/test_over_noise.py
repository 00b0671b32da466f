"""One misfit over noise: of the readings that state their noise, the same in terminal, page, window and result.json.

Campaigns of the virtual rig (3 N and 0.3 Nm of noise), whose files then lose the columns of the uncertainty.
"""

from __future__ import annotations

import base64
import json
import re
import shutil
import zlib
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from plain_pages import without_pictures
from small_rigs import FY, SAMPLE, flat, simulated, sound

import mffit
from mffit.points.noise import OverNoise
from mffit.report import text
from mffit.suspicion.trust import far
from mffit.viewer.project import project_data

Change = Callable[[pd.DataFrame], pd.DataFrame]


def silent(table: pd.DataFrame) -> pd.DataFrame:
    """Without any statement of the noise."""
    return table.drop(columns=[name for name in table if name.startswith("u_")])


def campaign(folder: Path, change: Change, *names: str) -> Path:
    """The project of a campaign of which some files, all without names, are changed."""
    simulated(flat(), folder)
    for path in folder.glob("*.csv"):
        if not names or path.name in names:
            change(pd.read_csv(path)).to_csv(path, index=False)
    return folder / "tyre.toml"


@pytest.fixture(scope="module")
def few(tmp_path_factory):
    """Only the sweep with camber states its noise, and twice what it is; the others scatter by 3 N alike."""
    folder = tmp_path_factory.mktemp("few")
    simulated(flat(), folder)
    for path in folder.glob("*.csv"):
        table = pd.read_csv(path)
        own = table.assign(u_Fy_N=2.0 * FY) if path.name == "coupled.csv" else silent(table)
        own.to_csv(path, index=False)
    with without_pictures():
        return mffit.build(folder / "tyre.toml", folder / "out"), folder / "out"


@pytest.fixture(scope="module")
def unstated(tmp_path_factory):
    return mffit.build(campaign(tmp_path_factory.mktemp("unstated"), silent))


def test_every_place_shows_the_misfit_of_the_readings_that_state_their_noise(few):
    """By hand from points.csv, where all other readings have no u."""
    result, out = few
    points = pd.read_csv(out / "points.csv", dtype={"outlier": str})
    stated = points[points["u_Fy_N"].notna() & ~points["outlier"].fillna("").str.contains("Fy")]
    assert 0 < len(stated) < 0.2 * len(points)
    z = (stated["Fy_model_N"] - stated["Fy_N"]) / stated["u_Fy_N"]
    expected = float(np.sqrt(np.mean(z**2)))
    written = json.loads((out / "result.json").read_text())["fit"]["channels"]["Fy"]["over_noise"]
    assert written == pytest.approx(expected, rel=1e-3)
    shown = f"{expected:.2f}"
    assert re.search(rf"^Fy .* {shown} ", text.build_explained(result), re.MULTILINE)
    page = (out / "report.html").read_text(encoding="utf-8")
    assert f"{shown} × the noise" in page
    assert f">{shown} ×<" in page  # the table of the fit


def noise_in_the_window(result: mffit.BuildResult) -> dict[str, np.ndarray]:
    """Standard uncertainties by channel as the page of a project has them, NaN where a reading states none."""
    points, found, start = project_data(result)["points"], {}, 0
    content = np.frombuffer(zlib.decompress(base64.b64decode(points["bytes"])), dtype=np.uint8)
    for name, kind, count in points["layout"]:
        size = np.dtype(kind).itemsize
        part = content[start : start + size * count].reshape(size, count).T
        found[name] = np.ascontiguousarray(part).view(f"<{kind}")[:, 0]
        start += size * count
    return {name.removeprefix("u."): values for name, values in found.items() if name.startswith("u.")}


def test_the_window_has_the_noise_of_the_same_readings(few):
    stated = few[0].points.u_Fy
    assert noise_in_the_window(few[0])["Fy"] == pytest.approx(stated, rel=1e-5, nan_ok=True)
    assert np.isnan(stated).any()


def test_without_a_stated_noise_no_place_shows_a_ratio(unstated):
    assert np.isnan(unstated.trust.over_noise["Fy"])
    assert re.search(r"^Fy .* N +- ", text.build_explained(unstated), re.MULTILINE)
    assert "Fy" not in noise_in_the_window(unstated)


def test_without_a_stated_noise_the_scatter_is_estimated(unstated):
    """The same readings with their noise stated: uncertainties within a quarter, not several times as large."""
    stated = sound(flat)
    for name in ("PKY1", "PKY2", "PDY1", "PCY1", "QBZ1"):
        u, reference = (fit.fit.coefficients[name].stderr for fit in (unstated, stated))
        assert u == pytest.approx(reference, rel=0.25), name


def test_one_bad_file_without_a_stated_noise_is_not_hidden_by_the_others(tmp_path):
    """Its side force is read a tenth too large: 90 N, where all other files miss by 3 N."""
    result = mffit.build(
        campaign(tmp_path, lambda table: silent(table).assign(Fy_N=1.1 * table["Fy_N"]), "coupled.csv")
    )
    assert result.trust.over_noise["Fy"] < 1.2  # of the others
    assert not result.trusted
    assert "coupled" in result.reasons[0]


def test_files_without_a_stated_noise_are_no_reason_by_themselves(few, unstated):
    assert few[0].trusted
    assert unstated.trusted


def test_a_channel_without_anything_to_explain_is_no_reason(tmp_path):
    """A wheel that rolls upright and straight: Fy and Mz are their zero and the noise, which nothing states."""
    content = flat()
    content["sweep"] = [
        {"file": "rolling.csv", "load_N": [700, 1000, 1400, 1800, 2100], "p_kPa": [200, 250, 300]}
    ]
    content["sweep"] += [
        {"file": "sideslip.csv", "load_N": 1400, "alpha_deg": [-4, -3, -2, -1, 0, 1, 2, 3, 4]}
    ]
    simulated(content, tmp_path)
    for path in tmp_path.glob("*.csv"):
        table = silent(pd.read_csv(path))
        noise = np.random.default_rng(5).normal(0.0, 6.0, len(table))
        table.assign(Mx_Nm=noise).to_csv(path, index=False)
    result = mffit.build(tmp_path / "tyre.toml")
    assert not any("variance of Mx" in reason for reason in result.reasons)


def test_sweeps_of_pressures_that_nobody_states_are_in_doubt(tmp_path):
    """Those at 200 and 300 kPa count as nominal without their column: each is off in its own way, by more than its noise."""
    shutil.copytree(SAMPLE.parent / "flat-track", tmp_path, dirs_exist_ok=True)
    for path in tmp_path.glob("*.csv"):
        pd.read_csv(path).drop(columns="p_kPa").to_csv(path, index=False)
    found = mffit.build(tmp_path / "tyre.toml")
    doubts = [one for one in found.trust.doubts if "misses whole sweeps of" in one]
    assert [re.search(r"sweeps of (\w+)", one)[1] for one in doubts] == ["Fy", "Mz"]
    assert all("pressure (p_kPa)" in one for one in doubts)
    for one in doubts:
        named = re.findall(r"sideslip\w+", one)
        assert named
        assert all("kPa" in name for name in named)


@pytest.mark.parametrize("of_noise", [np.inf, 7])
def test_chance_takes_noise_for_a_misfit_as_rarely_as_its_limit_says(of_noise):
    """Readings that are noise, which is stated, or estimated from few others: beyond two sigma in 2.3 % of the draws."""
    random, n, draws = np.random.default_rng(5), 5, 4000
    known = random.chisquare(of_noise, draws) / of_noise if np.isfinite(of_noise) else np.ones(draws)
    ratios = np.sqrt(random.chisquare(n, draws) / n / known)
    share = np.mean([far(OverNoise(ratio, n, of_noise), 0.0, 2.0) for ratio in ratios])
    assert share == pytest.approx(0.0228, abs=0.009)
