"""Every sheet of a workbook is read, or named as left out with how to take it."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from mffit import config as configuration
from mffit import sweeps
from mffit.errors import InputError
from mffit.pipeline import init_from
from mffit.pipeline.inputs import input_hashes
from mffit.recordings import sniff
from mffit.sheets import file_of, sheet_in, sheet_of

pytest.importorskip("openpyxl")
SAMPLES = Path(__file__).parents[3] / "samples" / "flat-track"
TABLES = {
    name: pd.read_csv(SAMPLES / f"sideslip_{name}.csv") for name in ("900N_0deg", "1400N_0deg", "1400N_10deg")
}
GIVEN = {"unloaded_radius": 0.2992, "nominal_load": 1400.0}
COVER = pd.DataFrame([["Customer", "ACME", ""], ["Loads [N]", 900, 1400]])


def workbook(path: Path, tables, *, hidden=()) -> Path:
    with pd.ExcelWriter(path) as book:
        for name, table in tables.items():
            table.to_excel(book, sheet_name=name, index=False, header=name != "Cover")
            if name in hidden:
                book.book[name].sheet_state = "hidden"
    return path


@pytest.fixture
def book(tmp_path):
    """Two sheets like each other, a cover, a sheet with an unknown force and a hidden copy."""
    odd = TABLES["1400N_10deg"].rename(columns={"Fy_N": "channel 7"})
    tables = {"Cover": COVER, **dict(list(TABLES.items())[:2]), "odd": odd, "raw": TABLES["1400N_10deg"]}
    return workbook(tmp_path / "book.xlsx", tables, hidden=("raw",))


def project(book: Path, **more):
    sniffed, (toml, *_) = init_from([book], book.parent / "p", **GIVEN, **more)
    return sniffed, configuration.load(toml)


def test_init_takes_every_sheet_with_data_as_a_sweep_of_its_own(book):
    sniffed, config = project(book)
    assert [sweep.file for sweep in config.sweep] == ["../book.xlsx#900N_0deg", "../book.xlsx#1400N_0deg"]
    found = sweeps.load(config)
    assert [sweep.name for sweep in found.sweeps] == ["book:900N_0deg", "book:1400N_0deg"]
    for sweep, table in zip(found.sweeps, TABLES.values(), strict=False):
        assert sweep.Fy == pytest.approx(table.Fy_N.to_numpy())
        assert sweep.line.tolist() == list(range(2, len(table) + 2))
    said = " ".join(sniffed.reading.warnings)
    assert "no heading is known to be Fy_N" in said
    assert 'sheets "odd", "raw" have data and are left out' in said
    assert "Cover" not in said


def test_a_build_names_the_sheets_that_it_does_not_read(book):
    _, config = project(book)
    for sheets in (["#900N_0deg"], ["#900N_0deg", "#1400N_0deg", "#odd", "#raw"]):
        entries = [{"file": f"book.xlsx{sheet}"} for sheet in sheets]
        for entry in entries:
            if entry["file"].endswith("odd"):
                entry["columns"] = {"Fy_N": "channel 7"}
        content = config.model_dump(include={"tyre", "rig"}, exclude_none=True) | {"sweep": entries}
        found = sweeps.load(configuration.load(content, folder=book.parent))
        assert found.sweeps[0].Fy == pytest.approx(TABLES["900N_0deg"].Fy_N.to_numpy())
        said = [warning for warning in found.warnings if "left out" in warning]
        if len(sheets) > 1:
            assert not said
        else:
            assert 'sheets "1400N_0deg", "odd", "raw" have data' in said[0]
            assert 'file = "book.xlsx#1400N_0deg"' in said[0]


def test_the_name_of_a_workbook_alone_is_refused_if_it_leaves_a_choice(book, tmp_path):
    _, config = project(book)
    content = config.model_dump(include={"tyre", "rig"}, exclude_none=True) | {
        "sweep": [{"file": "book.xlsx"}]
    }
    with pytest.raises(
        InputError, match=r'data in the sheets "900N_0deg", "1400N_0deg", "odd": .*book\.xlsx#900N_0deg'
    ):
        sweeps.load(configuration.load(content, folder=book.parent))
    only = next(iter(TABLES.items()))
    workbook(book, {"Cover": COVER, only[0]: only[1], "raw": TABLES["1400N_10deg"]}, hidden=("raw",))
    found = sweeps.load(configuration.load(content, folder=book.parent))
    assert found.sweeps[0].Fy == pytest.approx(only[1].Fy_N.to_numpy())
    assert any('sheet "raw" has data and is left out' in said for said in found.warnings)


def test_a_sheet_named_as_rolling_backwards_gets_its_direction(tmp_path):
    tables = {"vorwärts": TABLES["900N_0deg"], "rückwärts": TABLES["900N_0deg"]}
    found = sniff([workbook(tmp_path / "b.xlsx", tables)])
    assert [recording.backward for recording in found.recordings] == [False, True]


def test_lines_are_those_of_the_sheet(book):
    _, config = project(book)
    content = config.model_dump(exclude_none=True, exclude={"fit"})
    content["sweep"] = [{"file": sweep.file} for sweep in config.sweep]
    content["fit"] = {"exclude": [{"file": config.sweep[1].file, "lines": "2-3", "why": "belt"}]}
    found = sweeps.load(configuration.load(content, folder=config.folder))
    assert [len(sweep) for sweep in found.sweeps] == [21, 19]


def test_a_sheet_with_the_list_of_the_runs_is_the_summary_of_the_test(tmp_path):
    runs = pd.DataFrame({"Run": ["900N_0deg", "1400N_0deg"], "Load": [900, 1400], "Valid": ["yes", "no"]})
    runs["No"] = [1, 2]
    path = workbook(tmp_path / "b.xlsx", {"runs": runs, **dict(list(TABLES.items())[:2])})
    (bad,) = sniff([path]).bad_runs
    assert sheet_of(bad.recording) == "1400N_0deg"


def test_a_wrong_sheet_is_answered_with_those_there_are(book):
    with pytest.raises(InputError, match='has no sheet "Lap"; its sheets are "Cover", "900N_0deg"'):
        sniff([sheet_in(book, "Lap")])
    with pytest.raises(InputError, match="channel 7"):  # named by the user, so not left out
        sniff([sheet_in(book, "900N_0deg"), sheet_in(book, "odd")])
    with pytest.raises(InputError, match="there is no such file"):
        sniff([sheet_in(book.with_name("no.xlsx"), "Lap")])


def test_the_workbook_is_one_input(book):
    _, config = project(book)
    assert list(input_hashes(config)) == ["../book.xlsx"]


def test_a_name_may_have_brackets_and_the_mark(book):
    other = Path(shutil.copy(book, book.with_name("run #3 [a].xlsx")))
    name = sheet_in(other, "900N_0deg")
    assert (file_of(name), sheet_of(name)) == (other, "900N_0deg")
    assert np.all(sniff([name]).points.Fz == pytest.approx(900.0, rel=1e-2))


@pytest.mark.parametrize("merged", [["Fz_N"], ["p_kPa"], ["Fz_N", "gamma_deg"]])
def test_a_condition_in_merged_cells_is_refused_with_the_cure(tmp_path, merged):
    """A value that is stated once for many rows: Excel keeps it in the first of the merged cells."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    headings = ["Fz_N", "gamma_deg", "p_kPa", "alpha_deg", "Fy_N"]
    sheet.append(headings)
    for angle in range(-5, 6):
        sheet.append([1000.0, 0.0, 200.0, float(angle), -150.0 * angle])
    for name in merged:
        column = headings.index(name) + 1
        sheet.merge_cells(start_row=2, end_row=12, start_column=column, end_column=column)
    book.save(tmp_path / "a.xlsx")
    with pytest.raises(InputError, match="merged cells hold their value only in the first one") as refused:
        sniff([tmp_path / "a.xlsx"])
    assert (refused.value.column, refused.value.line) in {(name, 3) for name in merged}
