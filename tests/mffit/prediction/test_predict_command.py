"""`mffit predict`: what it reads, writes and refuses."""

from __future__ import annotations

import json
import os
import re
import shutil
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from conftest import CAMBERS, Built, brush

import mffit
from mffit import prediction
from mffit.cli import main
from mffit.errors import InputError

GOOD = pd.DataFrame(
    {
        "name": ["a", "b", "c"],
        "alpha_deg": [1.0, -4.5, 0.0],
        "gamma_deg": [0.0, 2.0, -3.0],
        "Fz_N": [900.0, 2000.0, 3000.0],
    }
)
ADDED = ["Fy_N", "u_Fy_N", "Fy_best_N", "u_Fy_best_N", "u_Fy_run_N", "u_Fy_setup_N"]


def run(*arguments: object) -> int:
    try:
        main(["predict", *map(str, arguments)])
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1
    return 0


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(table: pd.DataFrame, path: Path = Path("conditions.csv")) -> Path:
    table.to_csv(path, index=False)
    return path


def test_conditions_come_back_with_the_columns_of_every_channel(foreign: Built, here, capsys):
    written(GOOD)
    assert run(foreign.folder, "conditions.csv", "--out", "new/found.csv") == 0
    found = pd.read_csv("new/found.csv")
    assert list(found) == [*GOOD, *ADDED, *(name.replace("Fy", "Mz").replace("_N", "_Nm") for name in ADDED)]
    assert found[list(GOOD)].equals(GOOD)
    assert np.isfinite(found.drop(columns="name").to_numpy(dtype=float)).all()
    assert np.all(found[[name for name in found if name.startswith("u_")]] > 0.0)
    said = capsys.readouterr().out
    assert "Fy: a new run lies within" in said
    assert "found.csv" in said
    pd.testing.assert_frame_equal(found, mffit.predict(foreign.folder, "conditions.csv"))
    assert os.listdir("new") == ["found.csv"]


def test_the_plain_force_is_that_of_the_property_file(foreign: Built):
    import tir

    found = foreign.predict(alpha_deg=[3.0], gamma_deg=[2.0], Fz_N=[1500.0], p_kPa=[210.0], V_mps=[9.5])
    tyre = tir.read(foreign.folder / "brush.tir")
    forces = tyre(1500.0, alpha=np.radians(3.0), gamma=np.radians(2.0), p=210e3, Vx=9.5)
    assert found.Fy_N[0] == pytest.approx(forces.Fy)
    assert found.Mz_Nm[0] == pytest.approx(forces.Mz)


def test_what_was_written_gives_the_same_numbers(foreign: Built):
    """Uncertainties to single precision."""
    known, tyre, fitted = prediction.load(foreign.folder)
    from_file = known.predict(tyre, fitted, GOOD)
    in_memory = foreign.result.prediction.predict(tyre, fitted, GOOD)
    assert from_file.Fy_best_N.to_numpy() == pytest.approx(in_memory.Fy_best_N.to_numpy(), rel=1e-12)
    for name in ("u_Fy_N", "u_Fy_best_N", "u_Mz_run_Nm"):
        assert from_file[name].to_numpy() == pytest.approx(in_memory[name].to_numpy(), rel=1e-5)


def test_a_moved_folder_is_enough(foreign: Built, here):
    shutil.copytree(foreign.folder, here / "moved")
    assert mffit.predict("moved", GOOD).equals(mffit.predict(foreign.folder, GOOD))


def test_the_folder_of_a_project_is_that_of_its_build(foreign: Built):
    """A build writes to out/ in it."""
    assert mffit.predict(foreign.folder.parent, GOOD).equals(mffit.predict(foreign.folder, GOOD))
    same = mffit.compare(foreign.folder.parent, foreign.folder)
    assert not [one for one in same.numbers if one.first != one.second]


def test_a_second_run_replaces_its_own_file_only(foreign: Built, here, capsys):
    written(GOOD)
    Path("mine.csv").write_text("alpha_deg,Fy_best\n")
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv") == 0
    assert run(foreign.folder, written(GOOD[:1]), "--out", "found.csv") == 0
    assert len(pd.read_csv("found.csv")) == 1
    capsys.readouterr()
    assert run(foreign.folder, "conditions.csv", "--out", "mine.csv") == 2
    assert "mine.csv: is there already and no prediction" in capsys.readouterr().err
    assert run(foreign.folder, "found.csv", "--out", "found.csv") == 2
    assert "found.csv: is the table of the conditions" in capsys.readouterr().err
    assert Path("mine.csv").read_text() == "alpha_deg,Fy_best\n"


def test_measured_forces_among_the_conditions_are_replaced(foreign: Built):
    found = foreign.predict(**GOOD, Fy_N=[0.0, 0.0, 0.0], Fx_N=[7.0, 7.0, 7.0])
    assert found.Fy_N.equals(foreign.predict(**GOOD).Fy_N)
    assert found.Fx_N.tolist() == [7.0, 7.0, 7.0]


@pytest.mark.parametrize("rows", [0, 1])
def test_few_rows(foreign: Built, rows):
    found = mffit.predict(foreign.folder, GOOD[:rows])
    assert len(found) == rows
    of_all = mffit.predict(foreign.folder, GOOD)
    assert found.u_Fy_run_N.tolist() == pytest.approx(of_all.u_Fy_run_N[:rows].tolist())


def test_the_index_of_a_table_stays(foreign: Built):
    found = mffit.predict(foreign.folder, GOOD.set_index(pd.Index([7, 5, 5])))
    assert found.index.tolist() == [7, 5, 5]
    assert found.Fy_N.tolist() == mffit.predict(foreign.folder, GOOD).Fy_N.tolist()


def test_an_empty_cell_of_an_optional_column_is_nominal(foreign: Built, here):
    partly = written(GOOD.assign(p_kPa=[np.nan, 180.0, np.nan], kappa=["", "0", ""]))
    found = mffit.predict(foreign.folder, partly)
    plain = mffit.predict(foreign.folder, GOOD.assign(p_kPa=[200.0, 180.0, 200.0]))
    assert found.Fy_N.equals(plain.Fy_N)
    assert np.isnan(found.p_kPa[0])


@pytest.mark.parametrize(
    ("over", "values", "least"),
    [("alpha_deg", (11.0, 12.0, 14.0, 17.0, 20.0), 0.85), ("Fz_N", (200.0, 400.0, 600.0), 0.75)],
)
def test_beyond_the_tested_range_the_uncertainty_grows_as_the_error(foreign: Built, over, values, least):
    """True forces of a tyre that is no Magic Formula, tested up to 10 deg and from 800 N; at the far end the error is large."""
    grid = {"alpha_deg": np.linspace(-9.0, 9.0, 10), "Fz_N": (1000.0, 1800.0, 3000.0), "gamma_deg": CAMBERS}
    if over == "alpha_deg":
        values = (*(-x for x in values), *values)
    at = {
        name: x.ravel() for name, x in zip(grid, np.meshgrid(*(grid | {over: values}).values()), strict=True)
    }
    found = foreign.predict(**at)
    true, _ = brush(np.radians(at["alpha_deg"]), np.radians(at["gamma_deg"]), at["Fz_N"])
    error, u = np.abs(found.Fy_best_N.to_numpy() - true), found.u_Fy_best_N.to_numpy()
    assert np.mean(error < 1.96 * u) >= least
    assert 1.96 * np.sqrt(np.mean(u**2)) < 5.0 * np.sqrt(np.mean(error**2))


def test_conditions_outside_the_ranges_of_the_file_are_said(foreign: Built, here, capsys):
    """A load in kN, or a tyre pressed harder than any that was measured, gives no number without a word."""
    written(GOOD.assign(Fz_N=[900.0, 2.0, 30000.0], alpha_deg=[1.0, 1.0, -45.0]))
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv") == 0
    said = capsys.readouterr().err
    assert "Fz_N is outside the range of the property file" in said
    assert "in 2 of 3 conditions, first in row 2" in said
    assert "alpha_deg is outside" in said
    assert "in 1 of 3 conditions, first in row 3" in said
    assert "gamma_deg" not in said
    written(GOOD)
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv") == 0
    assert "outside" not in capsys.readouterr().err


def test_speeds_that_were_not_tested_are_said(foreign: Built, here, capsys):
    """Grip falls with speed, which most files have no term for; the control of a rig is no other speed."""
    V = foreign.result.prediction.V_range[0]
    written(GOOD.assign(V_mps=[V, 1.05 * V, 2.0 * V]))
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv") == 0
    said = capsys.readouterr().err
    assert (
        f"V_mps is outside the tested speeds, {V:g}, in 1 of 3 conditions, first in row 3: no reading supports"
        in said
    )


@pytest.mark.parametrize("ending", [".csv", ".csv.gz", ".txt", ".xlsx", ".parquet", ".mat"])
def test_conditions_in_every_format_of_sweeps(foreign: Built, here, ending):
    table, path = GOOD.drop(columns="name"), here / f"conditions{ending}"
    if ending == ".xlsx":
        pytest.importorskip("openpyxl")
        table.to_excel(path, index=False)
    elif ending == ".parquet":
        pytest.importorskip("pyarrow")
        table.to_parquet(path)
    elif ending == ".mat":
        from scipy.io import savemat

        savemat(path, {name: table[name].to_numpy()[:, None] for name in table})
    else:
        table.to_csv(path, index=False, sep=";" if ending == ".txt" else ",")
    found = mffit.predict(foreign.folder, path)
    assert found.Fy_best_N.to_numpy() == pytest.approx(
        mffit.predict(foreign.folder, GOOD).Fy_best_N.to_numpy()
    )


def test_units_that_a_file_states_are_converted(foreign: Built, here):
    Path("conditions.csv").write_text("alpha_deg,gamma_deg,Fz_N\nrad,deg,kN\n0.1,2,1.5\n")
    found = mffit.predict(foreign.folder, "conditions.csv")
    assert found.Fz_N.tolist() == [1500.0]
    same = foreign.predict(alpha_deg=[np.degrees(0.1)], gamma_deg=[2.0], Fz_N=[1500.0])
    assert found.Fy_N[0] == pytest.approx(same.Fy_N[0])


TEXT = "alpha_deg,gamma_deg,Fz_N,p_kPa\n1,0,900,200\n"
MISTAKES = {
    "alpha_deg,gamma_deg\n1,2\n": "conditions.csv:1: has no column Fz_N; conditions need alpha_deg, gamma_deg, Fz_N and may have",
    TEXT
    + "2,,900,200\n": "conditions.csv:3: column gamma_deg: this cell is empty; complete it or remove the row",
    TEXT + "2,two,900,200\n": 'conditions.csv:3: column gamma_deg: "two" is not a number [deg]; correct it',
    TEXT + "2,inf,900,200\n": 'conditions.csv:3: column gamma_deg: "inf" is not a number [deg]; correct it',
    "alpha_deg,gamma_deg,Fz_N,phi_t_per_m\n2,1,900,-0.7\n2,1,900,-inf\n": 'conditions.csv:3: column phi_t_per_m: "-inf" is '
    "a wheel that turns on the spot, which no sweep shows; write 1/R [1/m], 0 for a straight path",
    TEXT + "2,1,900,soft\n": 'conditions.csv:3: column p_kPa: "soft" is not a number [kPa]; correct it',
    TEXT + "2,1,900,2.2\n": "conditions.csv:3: column p_kPa: 2.2 is below 20 [kPa]; it looks like bar",
    TEXT
    + "2,1,-900,220\n": "conditions.csv:3: column Fz_N: -900 is not above zero; correct it or remove the row",
    TEXT + "200,1,900,220\n": "conditions.csv:3: column alpha_deg: 200 is above 60 [deg]; correct it",
    "alpha_deg,gamma_deg,Fz_N\ndeg,deg,furlong\n1,2,3\n": "column Fz_N:",
    "alpha_deg,gamma_deg,Fz_N\n": "conditions.csv:1: has headings but no data; add one row per point",
    "": "conditions.csv",
}


@pytest.mark.parametrize("text", MISTAKES, ids=range(len(MISTAKES)))
def test_a_mistake_in_the_conditions_is_a_sentence(foreign: Built, here, capsys, text):
    Path("conditions.csv").write_text(text)
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv") == 2
    said = capsys.readouterr().err
    assert said.startswith("mffit: ")
    assert MISTAKES[text] in said
    assert said.count("\n") == 1
    assert os.listdir() == ["conditions.csv"]


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"Fz_N": [900.0, np.nan, 1.0]}, "column Fz_N: row 2: this cell is empty"),
        ({"gamma_deg": ["0", "1", None]}, "column gamma_deg: row 3: this cell is empty"),
        ({"kappa": [0.0, np.inf, 0.0]}, 'column kappa: row 2: "inf" is not a number'),
        (
            {"phi_t_per_m": [-0.7, -0.7, np.inf]},
            'column phi_t_per_m: row 3: "inf" is a wheel that turns on the spot',
        ),
        ({"V_mps": [0.0, 1.0, 1.0]}, "column V_mps: row 1: 0.0 is not above zero"),
    ],
)
def test_a_mistake_in_a_table_names_its_row(foreign: Built, change: dict[str, Any], sentence):
    with pytest.raises(InputError, match=sentence):
        mffit.predict(foreign.folder, GOOD.assign(**change))


def test_a_column_twice(foreign: Built):
    with pytest.raises(InputError, match="column Fz_N: there are two columns of this name"):
        mffit.predict(foreign.folder, pd.concat([GOOD, GOOD[["Fz_N"]]], axis=1))


@pytest.mark.parametrize(
    ("heading", "meant", "unit"),
    [
        ("p_psi", "p_kPa", "kPa"),
        ("Pressure", "p_kPa", "kPa"),
        ("V_kmh", "V_mps", "m/s"),
        ("T_K", "T_degC", "degC"),
        ("kapa", "kappa", "-"),
        ("kappa_percent", "kappa", "-"),
        ("phi_per_m", "phi_t_per_m", "1/m"),
        ("Fz_kN", "Fz_N", "N"),
        ("gamma_rad", "gamma_deg", "deg"),
        ("Alpha_deg", "alpha_deg", "deg"),
    ],
)
def test_a_condition_in_another_unit_or_misspelt_is_not_ignored(foreign: Built, here, heading, meant, unit):
    """It would be predicted at the nominal value, without a word."""
    table = GOOD.drop(columns=meant, errors="ignore").assign(**{heading: 0.1})
    sentence = f"is no column of conditions; if it is {meant}, rename it and write it in {unit}; else give it another name"
    with pytest.raises(InputError, match=re.escape(f"column {heading}: {sentence}")):
        mffit.predict(foreign.folder, table)
    with pytest.raises(InputError, match=re.escape(f"conditions.csv:1: column {heading}: {sentence}")):
        mffit.predict(foreign.folder, written(table))


def test_columns_of_another_kind_are_repeated(foreign: Built):
    """Also a condition that is there twice, in another unit."""
    others = {
        "note": "wet",
        "id": 7,
        "Fx_N": 3.0,
        "My_Nm": 1.0,
        "Fz_model_N": 5.0,
        "t_s": 1.0,
        "p_kPa": 200.0,
        "p_psi": 29.0,
    }
    found = mffit.predict(foreign.folder, GOOD.assign(**others))
    assert {name: found[name][0] for name in others} == others


@pytest.mark.parametrize(
    ("out", "sentence"),
    [
        ("found.xlsx", "found.xlsx: is written as CSV"),
        (".", "is a folder"),
        ("conditions.csv/found.csv", "is a file"),
    ],
)
def test_an_output_that_cannot_be(foreign: Built, here, capsys, out, sentence):
    written(GOOD)
    assert run(foreign.folder, "conditions.csv", "--out", out) == 2
    assert sentence in capsys.readouterr().err
    assert os.listdir() == ["conditions.csv"]


@pytest.mark.parametrize("failure", [OSError(28, "No space left on device"), KeyboardInterrupt()])
def test_nothing_is_left_of_a_file_that_could_not_be_finished(
    foreign: Built, here, capsys, monkeypatch, failure
):
    written(GOOD)
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv") == 0
    before = Path("found.csv").read_text()

    def fails(*_: object) -> None:
        raise failure

    monkeypatch.setattr("os.replace", fails)
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv") == (
        2 if isinstance(failure, OSError) else 130
    )
    assert Path("found.csv").read_text() == before
    assert sorted(os.listdir()) == ["conditions.csv", "found.csv"]


def test_a_folder_that_is_no_build(here, capsys):
    written(GOOD)
    assert run(here, "conditions.csv", "--out", "found.csv") == 2
    assert "has no prediction.json; name the folder of a build" in capsys.readouterr().err
    assert run("nowhere", "conditions.csv", "--out", "found.csv") == 2


def cut(text: str) -> str:
    return text[: len(text) // 2]


def with_nan(text: str) -> str:
    content = json.loads(text)
    content["channels"]["Fy"]["noise"] = float("nan")
    return json.dumps(content)


def without_weight(text: str) -> str:
    content = json.loads(text)
    content["channels"]["Fy"]["missed"].pop()
    return json.dumps(content)


def of_another_channel(text: str) -> str:
    content = json.loads(text)
    content["channels"]["Fq"] = content["channels"].pop("Fy")
    return json.dumps(content)


def a_list(text: str) -> str:
    return "[1, 2]"


@pytest.mark.parametrize("damage", [cut, with_nan, without_weight, of_another_channel, a_list])
def test_a_damaged_record_is_a_sentence(foreign: Built, here, capsys, damage):
    shutil.copytree(foreign.folder, here / "out")
    path = here / "out" / prediction.FILE
    path.write_text(damage(path.read_text()))
    assert run("out", written(GOOD), "--out", "found.csv") == 2
    assert "prediction.json: is not as a build writes it; build the tyre again" in capsys.readouterr().err
    assert not Path("found.csv").exists()


def test_a_missing_property_file_is_a_sentence(foreign: Built, here, capsys):
    shutil.copytree(foreign.folder, here / "out")
    (here / "out" / "brush.tir").unlink()
    assert run("out", written(GOOD), "--out", "found.csv") == 2
    assert "brush.tir" in capsys.readouterr().err


def test_json_for_programs(foreign: Built, here, capsys):
    written(GOOD)
    assert run(foreign.folder, "conditions.csv", "--out", "found.csv", "--json") == 0
    assert json.loads(capsys.readouterr().out) == {"written": ["found.csv"], "conditions": 3}
