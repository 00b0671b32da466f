"""Records of the laboratory in the output of a build, and the verification of that build."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from datetime import date, datetime

import pandas as pd
import pytest
import tomli_w
from small_rigs import disc, simulated

import mffit
import tir
from mffit.cli import main
from mffit.effects import CATALOG
from mffit.errors import InputError
from mffit.made import METHOD, source
from mffit.report import text
from mffit.results.verification import MISSING, compared

LAB = {
    "order": "T-1234",
    "operator": "Operator 7",
    "instruments": [
        {"name": "Fy load cell", "serial": "F 17", "certificate": "K-3", "calibrated": date(2020, 3, 1), "due": date(2021, 3, 1)},
        {"name": "pressure gauge"},
    ],
}  # fmt: skip
LINES, WHY = "4-5, 9", "belt tracking"


def run(*arguments):
    """The exit code of a command."""
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1
    return 0


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
    return mffit.build(path, folder / "out")


@pytest.fixture(scope="module")
def built(finished):
    """The folder of the project."""
    return finished.config.folder


@pytest.fixture(scope="module")
def result(built):
    return json.loads((built / "out" / "result.json").read_text())


@pytest.fixture
def copy(built, tmp_path):
    """The same project, which a test may change."""
    shutil.copytree(built, tmp_path / "rig")
    return tmp_path / "rig"


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


def test_a_build_from_the_stored_inputs_gives_every_number_again(built, capsys):
    before = {path: path.read_bytes() for path in built.rglob("*") if path.is_file()}
    assert run("build", "--verify", built / "out", "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert found["same"] is True
    assert found["changes"] == []
    assert found["numbers"] > 1000
    assert found["method"] == {"stored": METHOD, "now": METHOD}
    assert found["source"]["stored"] == found["source"]["now"]
    assert found["notes"] == []
    assert before == {path: path.read_bytes() for path in built.rglob("*") if path.is_file()}


def test_numbers_that_do_not_come_out_again_are_listed_largest_first(copy, capsys):
    path = copy / "out" / "result.json"
    stored = json.loads(path.read_text())
    stored["made"]["method"] = METHOD - 1
    stored["made"]["libraries"]["numpy"] = "1.0"
    stored["spin"]["epsilon_gamma"] += 0.01
    path.write_text(json.dumps(stored))
    file = copy / "out" / "small.tir"
    changed = tir.read(file)
    changed.replace(PKY1=1.5 * changed["PKY1"]).write(file)
    path = copy / "out" / "information.json"
    told = json.loads(path.read_text())
    k = told["names"].index("PKY1")
    told["matrix"][k][k] *= 1.01
    told["vector"][k] *= 1.001
    path.write_text(json.dumps(told))
    assert run("build", "--verify", copy / "out") == 3
    said = capsys.readouterr()
    lines = said.out.splitlines()
    assert f"made by method {METHOD - 1}" in lines[0]
    assert "numpy 1.0 (here" in said.out
    assert "4 of" in said.err
    assert said.out.count("information.json") == 2
    assert said.out.index("PKY1.value") < said.out.index("spin.epsilon_gamma")


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda folder: (folder / "base.tir").unlink(), "base.tir: is gone, but the build read it"),
        (lambda folder: (folder / "camber_900.csv").write_text("x"), "camber_900.csv: was changed since the build"),
        (lambda folder: (folder / "out" / "resolved.toml").write_text("x"), "resolved.toml: was changed since the build"),
        (lambda folder: (folder / "out" / "resolved.toml").unlink(), "there is no such file"),
        (lambda folder: (folder / "out" / "information.json").unlink(), "information.json: is missing"),
        (lambda folder: (folder / "out" / "result.json").unlink(), "name a folder that mffit build wrote"),
        (lambda folder: (folder / "out" / "result.json").write_text("[]"), "is not the result of a build"),
        (lambda folder: (folder / "out" / "result.json").write_text("{"), "is not the result of a build"),
    ],
)  # fmt: skip
def test_what_cannot_be_verified_ends_with_a_sentence(copy, capsys, damage, words):
    damage(copy)
    assert run("build", "--verify", copy / "out") == 2
    assert words in capsys.readouterr().err


def test_a_result_of_an_older_version_is_refused(copy):
    path = copy / "out" / "result.json"
    stored = json.loads(path.read_text())
    del stored["made"]
    path.write_text(json.dumps(stored))
    with pytest.raises(InputError, match="is not the result of a build of this version"):
        mffit.verify(copy / "out")


@pytest.mark.parametrize("also", [["tyre.toml"], ["--out", "x"], ["--ensemble", "2"]])
def test_a_verification_takes_nothing_else(built, also, capsys):
    assert run("build", "--verify", built / "out", *also) == 2
    assert "--verify" in capsys.readouterr().err


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


@pytest.mark.parametrize(
    ("old", "new", "key"),
    [
        ({"a": 1.0}, {"a": 1.0 + 1e-9, "b": 2.0}, None),
        ({"a": 1.0}, {"a": 1.0 + 3e-5}, "a"),
        ({"dof": 1465.99479}, {"dof": 1465.99295}, None),
        ({"a": 1.0, "u_a": 0.1}, {"a": 1.0 + 1e-5, "u_a": 0.1}, None),
        ({"a": {"value": 1.0, "stderr": 0.1}}, {"a": {"value": 1.00001, "stderr": 0.1}}, None),
        ({"a": {"value": 1.0, "stderr": 0.1}}, {"a": {"value": 1.001, "stderr": 0.1}}, "a.value"),
        ({"a": {"value": 1.0, "stderr": None}}, {"a": {"value": 1.0, "stderr": 0.1}}, "a.stderr"),
        ({"a": [1.0, 2.0]}, {"a": [1.0]}, "a, length"),
        ({"a": [{"b": 2.0}]}, {"a": [{"b": 3.0}]}, "a[0].b"),
        ({"a": 1.0}, {}, "a"),
        ({"c": [[4.0], [1e-9, 9.0]]}, {"c": [[4.0], [2e-9, 9.0]]}, None),
        ({"c": [[4.0], [0.01, 9.0]]}, {"c": [[4.0], [0.02, 9.0]]}, "c[1][0]"),
        ({"a": None}, {"a": 0.0}, "a"),
        ({"a": True}, {"a": False}, "a"),
        ({"a": "x"}, {"a": "y"}, None),
        ({"c": [[4.0, 1e-9], [1e-9, 9.0]]}, {"c": [[4.0, 2e-9], [2e-9, 9.0]]}, None),
        ({"c": [[4.0, 0.01], [0.01, 9.0]]}, {"c": [[4.0, 0.02], [0.01, 9.0]]}, "c[0][1]"),
        ({"fit": {"seconds": 1.0}, "made": {"method": 1}}, {"fit": {"seconds": 2.0}, "made": {"method": 2}}, None),
    ],
)  # fmt: skip
def test_a_number_comes_out_again_if_no_stated_digit_changes(old, new, key):
    found = compared("result.json", old, new)
    assert [row.key for row in found if row.size > 1.0] == ([] if key is None else [key])
    if key == "a" and new == {}:
        assert found[0].new == MISSING
