"""Broken sweeps that only the fit shows: impossible ones are named, odd ones doubted, sound ones left alone."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import tomli_w

import mffit
import tir
from mffit import virtual_rig
from mffit.errors import InputError
from mffit.linearised import constants
from mffit.suspicion import others

SAMPLES = Path(__file__).parents[3] / "samples"


class Campaign:
    """A sample's campaign on a rig of its own, open to damage; recorded sweeps as finished points."""

    def __init__(self, folder: Path, sample: str, seed: int) -> None:
        content = tomllib.loads((SAMPLES / sample / "rig.toml").read_text(encoding="utf-8"))
        content["faults"] = {"draw": True}
        for entry in content["sweep"]:
            entry.pop("recording", None)
        virtual_rig.simulate(virtual_rig.load_plan(content, folder=SAMPLES / sample), folder, seed=seed)
        self.folder = folder
        self.config = tomllib.loads((folder / "tyre.toml").read_text(encoding="utf-8"))
        self.tables = {entry["file"]: pd.read_csv(folder / entry["file"]) for entry in self.config["sweep"]}

    def build(self, out: Path | None = None):
        for name, table in self.tables.items():
            table.to_csv(self.folder / name, index=False)
        path = self.folder / "tyre.toml"
        path.write_text(tomli_w.dumps(self.config), encoding="utf-8")
        return mffit.build(path, out, with_report=False)


def refused(campaign: Campaign) -> InputError:
    with pytest.raises(InputError) as error:
        campaign.build()
    return error.value


CASES = [
    (
        "flat-track",
        "sideslip_900N_20deg.csv",
        {"alpha_deg": "gamma_deg", "gamma_deg": "alpha_deg"},
        "exchanged",
    ),
    ("flat-track", "sideslip_2100N_10deg.csv", {"Fy_N": 1.0 / 9.80665}, "kgf"),
    ("flat-track", "sideslip_2100N_20deg.csv", {"gamma_deg": -1.0}, "its camber reversed"),
    ("rear-190-55", "camber_1650N.csv", {"Mz_Nm": -1.0}, "moment reversed"),
    # Most of its five readings would be outliers of a fit without them.
    ("front-120-70", "zero_1400N_backward.csv", {"Mz_Nm": -1.0}, "its moment reversed"),
]


@pytest.mark.parametrize(("sample", "file", "change", "looks"), CASES, ids=[case[3] for case in CASES])
def test_a_sweep_that_all_others_contradict_is_named_with_what_it_looks_like(
    tmp_path, sample, file, change, looks
):
    campaign = Campaign(tmp_path, sample, seed=5)
    table = campaign.tables[file]
    for column, to in change.items():
        if isinstance(to, float):
            table[column] = table[column] * to
    if all(isinstance(to, str) for to in change.values()):
        campaign.tables[file] = table.rename(columns=change)
    error = refused(campaign)
    assert error.file == tmp_path / file
    assert looks in str(error)


def test_a_sweep_that_no_mistake_explains_is_still_named(tmp_path):
    campaign = Campaign(tmp_path, "flat-track", seed=6)
    table = campaign.tables["sideslip_1400N_10deg.csv"]
    table["Fy_N"] = np.abs(table["Fy_N"])
    error = refused(campaign)
    assert error.file == tmp_path / "sideslip_1400N_10deg.csv"


def test_a_file_with_a_zero_offset_is_doubted_and_the_offset_named(tmp_path):
    campaign = Campaign(tmp_path, "flat-track", seed=3)
    campaign.tables["sideslip_1400N_20deg.csv"]["Fy_N"] += 120.0
    result = campaign.build()
    (doubt,) = result.fit.doubts
    assert (doubt.file, doubt.worst.channel) == ("sideslip_1400N_20deg.csv", "Fy")
    assert doubt.looks.startswith("a zero offset of +1")
    assert any("sideslip_1400N_20deg" in sentence for sentence in result.warnings)


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return Campaign(tmp_path_factory.mktemp("sound"), "flat-track", seed=31).build()


def test_a_sound_campaign_raises_no_doubt(sound):
    assert (sound.fit.doubts, sound.fit.outliers) == ((), ())


def test_single_outliers_are_listed_and_do_not_move_the_model(sound, tmp_path):
    campaign = Campaign(tmp_path / "hit", "flat-track", seed=31)
    rng = np.random.default_rng(7)
    planted = set()
    for name, table in campaign.tables.items():
        for column, noise in (("Fy_N", 8.0), ("Mz_Nm", 0.8)):
            for row in np.flatnonzero(rng.random(len(table)) < 0.02):
                table.loc[row, column] += 100.0 * noise * rng.choice([-1.0, 1.0])
                planted.add((name, int(row) + 2, column[:2]))
    out = tmp_path / "out"
    hit = campaign.build(out)
    assert len(planted) >= 8
    assert {(o.file, o.line, o.channel) for o in hit.fit.outliers} == planted
    marked = pd.read_csv(out / "points.csv")["outlier"].fillna("")
    assert np.sum(marked != "") == len({(name, line) for name, line, _ in planted})
    true = tir.read(SAMPLES / "front-120-70" / "true.tir")
    errors = [_error(result.fit.tyre, true) for result in (sound, hit)]
    # Without its weight a 50th of the points costs a hundredth of the accuracy; 25 % is far outside of that chance.
    assert errors[1] < 1.25 * errors[0] + 1.0


def _error(model: tir.Tyre, true: tir.Tyre) -> float:
    """Rms difference of side force [N] between the measured conditions."""
    alpha = np.radians(np.linspace(-9.0, 9.0, 37))
    loads, gamma = np.array([900.0, 1400.0, 2100.0])[:, None, None], np.radians([0.0, 15.0, 30.0])[:, None]
    a, b = (tyre(1.03 * loads, alpha, gamma, Vx=10.0, p=250e3).Fy for tyre in (model, true))
    return float(np.sqrt(np.mean((a - b) ** 2)))


def test_readings_that_a_thinned_channel_leaves_unexamined_are_no_outliers(tmp_path, monkeypatch):
    """Of a long recording a part of the readings is examined; a sweep that agrees is no suspect because of that."""
    monkeypatch.setattr(constants, "POINTS_EXAMINED", 60)
    suspected, suspects = [], others._suspects
    monkeypatch.setattr(
        others, "_suspects", lambda *given: suspected.append(suspects(*given)) or suspected[-1]
    )
    Campaign(tmp_path, "front-120-70", 3).build()
    assert suspected == [[]]
