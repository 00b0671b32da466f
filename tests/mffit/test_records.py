"""Records of the laboratory in the output of a build."""

from __future__ import annotations

import hashlib
import json
import re
from datetime import date, datetime

import pandas as pd
import pytest
import tomli_w
from method_figures import compared
from plain_pages import without_pictures
from small_rigs import disc, simulated

import mffit
import tir
from mffit.as_json import plain
from mffit.effects import CATALOG
from mffit.made import METHOD, source
from mffit.report import text

LAB = {
    "order": "T-1234",
    "operator": "Operator 7",
    "instruments": [
        {"name": "Fy load cell", "serial": "F 17", "certificate": "K-3", "calibrated": date(2020, 3, 1), "due": date(2021, 3, 1)},
        {"name": "pressure gauge"},
    ],
}  # fmt: skip
LINES, WHY = "4-5, 9", "belt tracking"


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A build with three readings of a sweep spoilt and excluded, and a fourth spoilt but not excluded."""
    folder = tmp_path_factory.mktemp("records") / "rig"
    simulated(disc(), folder, seed=4)
    sweep = pd.read_csv(folder / "sideslip_1400.csv")
    sweep.loc[[2, 3, 7], "Fy_N"] += 700.0
    sweep.to_csv(folder / "sideslip_1400.csv", index=False)
    other = pd.read_csv(folder / "sideslip_900.csv")
    other.loc[10, "Fy_N"] += 400.0
    other.to_csv(folder / "sideslip_900.csv", index=False)
    path = folder / "tyre.toml"
    text = path.read_text()
    tables = tomli_w.dumps(
        {"fit": {"exclude": [{"file": "sideslip_1400.csv", "lines": LINES, "why": WHY}]}, "lab": LAB}
    )
    path.write_text(text.replace("[rig]", f"{tables}\n[rig]", 1))
    with without_pictures():
        return mffit.build(path, folder / "out")


@pytest.fixture(scope="module")
def built(finished):
    """The folder of the project."""
    return finished.config.folder


@pytest.fixture(scope="module")
def result(built):
    return json.loads((built / "out" / "result.json").read_text())


def test_the_result_states_order_and_instruments_as_given(result):
    assert result["lab"]["order"] == "T-1234"
    first, second = result["lab"]["instruments"]
    assert first == LAB["instruments"][0] | {"calibrated": "2020-03-01", "due": "2021-03-01"}
    assert second == {"name": "pressure gauge", "serial": "", "certificate": ""}
    (said,) = [sentence for sentence in result["warnings"] if "Fy load cell" in sentence]
    assert "due on 2021-03-01, before today" in said


def test_the_result_states_when_by_what_and_from_what_it_was_made(built, result):
    made = result["made"]
    assert abs((datetime.now().astimezone() - datetime.fromisoformat(made["date"])).total_seconds()) < 3600.0
    assert (made["program"], made["version"], made["method"]) == ("mffit", mffit.__version__, METHOD)
    for name, known in made["inputs"].items():
        assert hashlib.sha256((built / name).read_bytes()).hexdigest() == known
    assert {"sideslip_1400.csv", "base.tir"} <= set(made["inputs"])
    file = tir.read(built / "out" / "small.tir")
    assert file.provenance["method"] == str(METHOD)
    assert made["source"].startswith(file.provenance["source"])
    assert made["inputs"]["base.tir"].startswith(file.provenance["input base.tir"])


def test_a_file_states_the_path_curvatures_that_were_run(finished, built):
    """A file has no range for them; the radius is that of the project's disc, its centre to the left."""
    radius = finished.config.rig.path_radius
    for name in finished.files.values():
        stated = tir.read(built / "out" / name).provenance["path curvature"]
        found = re.fullmatch(r"tested at (\S+) 1/m", stated)
        assert found
        assert abs(float(found[1])) == pytest.approx(1.0 / radius, rel=1e-4)


def test_every_reading_without_weight_is_in_one_list_with_reason(result):
    hand, *rules = result["left_out"]
    assert hand == {
        "file": "sideslip_1400.csv", "lines": LINES, "count": 3, "by": "hand", "rule": None, "channel": None, "weight": 0.0,
        "why": WHY,
    }  # fmt: skip
    outlier = next(row for row in rules if row["rule"] == "outlying-reading" and row["channel"] == "Fy")
    assert (outlier["file"], outlier["lines"], outlier["count"]) == ("sideslip_900.csv", "12", 1)
    assert all(row["by"] == "rule" and row["rule"] and row["why"] for row in rules)
    assert all(0.0 < row["weight"] < 1.0 for row in rules if row["rule"] == "huber-weight")
    excluded = [
        row for row in result["outliers"] if row["file"] == "sideslip_1400.csv" and row["channel"] == "Fy"
    ]
    assert not [row for row in excluded if row["line"] in (4, 5, 9)]


def test_excluded_readings_stay_in_the_table_of_points(built, result):
    table = pd.read_csv(built / "out" / "points.csv")
    marked = table[table["excluded"]]
    assert marked["line"].tolist() == [4, 5, 9]
    assert set(marked["file"]) == {"sideslip_1400.csv"}
    assert marked[["Fy_odd_N", "Fy_model_N", "paired"]].isna().all(axis=None)
    assert len(table) - len(marked) == result["fit"]["channels"]["Fy"]["n"]
    of_file = table[table["file"] == "sideslip_1400.csv"]
    source = pd.read_csv(built / "sideslip_1400.csv")
    assert of_file["line"].tolist() == list(range(2, len(source) + 2))
    assert of_file["Fy_N"].to_numpy() == pytest.approx(source["Fy_N"].to_numpy())


def test_the_page_has_a_section_of_records(built, result):
    page = (built / "out" / "report.html").read_text(encoding="utf-8")
    section = page[page.index('id="records"') :]
    for words in ("T-1234", "Operator 7", "load cell", "K-3", "2021-03-01", LINES, WHY, f"method {METHOD}"):
        assert words in section
    assert all(known in section for known in result["made"]["inputs"].values())
    assert re.search(r"rule outlying-reading", section)


def test_the_terminal_says_what_was_left_out_by_hand(finished):
    said = " ".join(text.build_explained(finished).split())
    assert f"left out by hand: 3 readings: sideslip_1400.csv:{LINES} ({WHY})" in said


def test_the_resolved_configuration_gives_every_number_again(built, result, tmp_path):
    again = plain(mffit.build(built / "out" / "resolved.toml", tmp_path / "again", with_report=False))
    for content in (result, again):
        content["fit"].pop("seconds")
    said, said_again = (content["fit"].pop("explanations") for content in (result, again))
    (of_default,) = set(said) - set(said_again)  # resolved.toml states what was a default
    assert "the default of u_slip_alignment_N" in of_default
    assert set(said_again) < set(said)
    found = [row for part in ("spin", "fit") for row in compared(result[part], again[part], part)]
    assert [row.key for row in found if row.size > 0.0] == []
    assert len(found) > 1000


def test_spin_and_diagnosis_state_how_they_were_made(built, tmp_path):
    mffit.spin(built / "tyre.toml", tmp_path / "spin")
    made = json.loads((tmp_path / "spin" / "spin.json").read_text())["made"]
    assert (made["method"], made["source"]) == (METHOD, source())
    assert len(made["inputs"]["base.tir"]) == 64
    mffit.diagnose(built / "tyre.toml", effects=CATALOG[:1], out=tmp_path / "diagnosis")
    content = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text())
    made = content["made"]
    model = built / "out" / "small.tir"
    assert made["inputs"][str(model)] == hashlib.sha256(model.read_bytes()).hexdigest()
    assert made["source"] == source()
    assert content["lab"]["operator"] == LAB["operator"]
    assert {row["why"] for row in content["left_out"] if row["by"] == "hand"} == {WHY}
    page = (tmp_path / "diagnosis" / "diagnosis.html").read_text(encoding="utf-8")
    section = page[page.index('id="records"') :]
    for words in ("T-1234", "Operator 7", "load cell", "K-3", "2021-03-01", LINES, WHY, f"method {METHOD}"):
        assert words in section
    assert all(known in section for known in made["inputs"].values())
