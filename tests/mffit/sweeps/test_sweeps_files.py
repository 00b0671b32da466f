"""Files written by rigs and spreadsheets are read correctly, or refused with file, line, column and remedy."""

from __future__ import annotations

import gzip
import re
from dataclasses import replace

import numpy as np
import pytest

from mffit import config as configuration
from mffit import sweeps
from mffit.errors import InputError
from mffit.sweeps import formats, loading
from mffit.sweeps.columns import read_columns
from mffit.sweeps.raw_table import RawTable

NAME = "sideslip_1500.csv"


def load(path):
    return sweeps.load(configuration.load(path))


def refusal(path) -> InputError:
    with pytest.raises(InputError) as caught:
        load(path)
    assert "\n" not in str(caught.value)
    return caught.value


def sweep_named(found, name):
    return next(sweep for sweep in found.sweeps if sweep.file == name)


def test_units_and_signs_arrive_in_iso_si(project):
    table = project.tables[NAME]
    found = sweep_named(load(project.write()), NAME)
    np.testing.assert_allclose(np.degrees(found.alpha), table["alpha_deg"])
    np.testing.assert_allclose(found.p, 250e3)
    np.testing.assert_array_equal(found.Fy, table["Fy_N"])
    assert np.all(np.isnan(found.My))
    assert list(found.line) == list(range(2, 2 + len(table)))
    assert list(found.table.columns) == list(table.columns)
    assert not found.is_series


@pytest.mark.parametrize(
    "rewrite",
    [
        lambda text: text.replace("\n", "\r\n").encode(),
        lambda text: b"\xef\xbb\xbf" + text.encode(),
        lambda text: ("# rig 7, \u00e9t\u00e9\n\n" + text + "\n\n").encode("latin-1"),
        lambda text: text.replace(",", " , ").encode(),
        lambda text: re.sub(r"([^,\n]+)", r'"\1"', text).encode(),
        lambda text: text.replace("\n", ",\n").replace("V_mps,", "V_mps,note").encode(),
        lambda text: text.replace(",", ";").replace(".", ",").encode(),
        lambda text: text.replace(",", "\t").encode(),
        lambda text: text.replace(",", "|").encode(),
        lambda text: re.sub(r",", "   ", text).encode(),
        lambda text: ("# rig 7\n" + re.sub(r",", "   ", text) + "\n  # end\n\n").encode(),
        lambda text: text.encode("utf-16"),
        lambda text: ("Rig 7, summer\n" + text).encode(),
        lambda text: re.sub("(V_mps.*\n)", r"\1deg,deg,N,N,N-m,kPa,m/s\n", text).encode(),
        lambda text: re.sub("Fz_N", "Fz_N [N]", text).encode(),
        lambda text: (text + "# " + "x" * 3_000_000 + "\n").encode(),
    ],
    ids=[
        "CRLF", "BOM", "Latin-1 comment", "blanks", "quotes", "empty extra column", "semicolons and decimal commas",
        "tabs", "bars", "blanks only", "blanks and comments", "UTF-16", "title", "units", "unit in a heading", "large",
    ],
)  # fmt: skip
def test_harmless_variants_read_the_same(project, rewrite):
    path = project.write()
    reference = sweep_named(load(path), NAME)
    content = rewrite(project.text(NAME))
    project.overwrite(NAME, content)
    found = sweep_named(load(path), NAME)
    np.testing.assert_array_equal(found.Fy, reference.Fy)
    np.testing.assert_array_equal(found.Fz, reference.Fz)
    lines = content.decode("utf-16" if content[0] == 0xFF else "latin-1").replace(",", ".").splitlines()
    assert all(
        repr(float(force)) in lines[line - 1] for force, line in zip(found.Fy, found.line, strict=True)
    )


def test_compressed_files_read_the_same(project):
    path = project.write()
    reference = sweep_named(load(path), NAME)
    (project.folder / f"{NAME}.gz").write_bytes(gzip.compress(project.text(NAME).encode()))
    path.write_text(path.read_text().replace(NAME, f"{NAME}.gz"))
    found = sweep_named(load(path), f"{NAME}.gz")
    np.testing.assert_array_equal(found.Fy, reference.Fy)
    assert found.name == reference.name


def line_changed(text: str, line: int, old: str, new: str) -> str:
    lines = text.split("\n")
    assert old in lines[line - 1]
    lines[line - 1] = lines[line - 1].replace(old, new, 1)
    return "\n".join(lines)


CELLS = {
    "unit": (4, "1500.0", "1.5 kN", "Fz_N", 'unit = "kN"'),
    "text": (3, "1500.0", "heavy", "Fz_N", "text"),
    "decimal comma": (5, "1500.0", '"1500,5"', "Fz_N", "write 1500.5"),
    "NaN": (2, "1500.0", "NaN", "Fz_N", "is not a measurement"),
    "infinity": (6, "1500.0", "inf", "Fz_N", "is not a measurement"),
    "blank": (7, "1500.0", "", "Fz_N", "empty"),
    "zero load": (7, "1500.0", "0", "Fz_N", "zero"),
    "mixed sign": (8, "1500.0", "-1500", "Fz_N", "another sign"),
    "pressure in bar": (4, "250.0", "2.5", "p_kPa", "bar"),
    "negative speed": (4, ",6.0", ",-6.0", "V_mps", "direction"),
    "angle beyond reason": (2, "-8.0", "-180", "alpha_deg", "outside"),
}


@pytest.mark.parametrize("case", CELLS)
def test_a_bad_cell_is_refused_with_line_and_column(project, case):
    line, old, new, column, said = CELLS[case]
    path = project.write()
    project.overwrite(NAME, line_changed(project.text(NAME), line, old, new))
    error = refusal(path)
    assert (error.file.name, error.line, error.column) == (NAME, line, column)
    assert said in str(error)


WHOLE = {
    "empty": (b"", None, "is empty"),
    "blank lines": (b"\n\n  \n", None, "is empty"),
    "binary": (b"\x00\x01\x02", None, "binary"),
    "header only": (b"alpha_deg,gamma_deg,Fz_N,Fy_N\n", 1, "no data"),
    "ragged": (b"alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,1500,-300\n0,0,1500\n", 3, "3 cells under 4 headings"),
    "too many cells": (b"alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,1500,-300,7\n", 2, "5 cells under 4 headings"),
    "ragged behind the first lines": (
        b"alpha_deg,gamma_deg,Fz_N,Fy_N\n" + b"0,0,1500,-300\n" * 9000 + b"0,0,1500\n" * 2, 9002, "3 cells under 4 headings",
    ),
    "a cell more behind the first lines": (
        b"alpha_deg,gamma_deg,Fz_N,Fy_N\n" + b"0,0,1500,-300\n" * 9000 + b"0,0,1500,-300,7\n", 9002, "5 cells under 4 headings",
    ),
    "open quotation mark": (
        b'alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,1500,-300\n0,0,"1500,-300\n0,0,1500,1\n', 3, "quotation mark is not closed",
    ),
    "line break within a cell": (
        b'alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,1500,-300\n0,0,"15\n00",-300\n', 3, "quotation mark is not closed in its line",
    ),
    "duplicate headings": (b"alpha_deg,gamma_deg,Fz_N,Fy_N,Fz_N\n0,0,1500,-300,1\n", 1, "twice"),
    "empty heading": (b"alpha_deg,,Fz_N,Fy_N\n0,0,1500,-300\n", 1, "alpha_deg, column 2, Fz_N"),
    "decimal commas between commas": (
        b"alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,0,0,1500,0,-300,0\n1,0,0,0,1500,0,-500,0\n",
        2,
        "has 8 cells under 4 headings; remove the cells too many, or the row, or write decimal points",
    ),
    "no headings": (b"0,0,1500,-300\n1,0,1500,-500\n", 1, "numbers instead of headings"),
    "missing column": (b"alpha_deg,gamma_deg,Fz_N,FY\n0,0,1500,-300\n", 1, 'column = "FY"'),
    "kilonewtons": (b"alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,1.5,-300\n", 2, "kN"),
    "all loads negative": (b"alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,-1500,-300\n", 2, 'axes = "sae"'),
    "no direction": (b"alpha_deg,gamma_deg,Fz_N,Fy_N,direction\n0,0,1500,-300,left\n", 2, "write forward"),
}  # fmt: skip


@pytest.mark.parametrize("case", WHOLE)
def test_a_bad_file_is_refused_with_its_name_and_line(project, case):
    content, line, said = WHOLE[case]
    path = project.write()
    project.overwrite(NAME, content)
    error = refusal(path)
    assert (error.file.name, error.line) == (NAME, line)
    assert said in str(error)


def test_a_broken_gzip_file_is_refused(project):
    path = project.write()
    whole = gzip.compress(project.text(NAME).encode())
    path.write_text(path.read_text().replace(NAME, f"{NAME}.gz"))
    for content in (b"plain text", whole[: len(whole) // 2]):
        project.overwrite(f"{NAME}.gz", content)
        assert "gzip" in str(refusal(path))


def test_a_missing_file_is_refused_where_it_is_named(project):
    path = project.write()
    (project.folder / NAME).unlink()
    error = refusal(path)
    assert error.file == path
    assert NAME in path.read_text().splitlines()[error.line - 1]
    assert NAME in str(error)


def test_another_format_is_refused(project):
    project.config["sweep"][0]["file"] = "sweep.docx"
    assert "export it as CSV" in str(refusal(project.write()))


def test_headings_units_and_signs_are_mapped(project):
    path = project.write()
    reference = sweep_named(load(path), NAME)
    table = project.tables[NAME]
    table["FY"] = -1e-3 * table.pop("Fy_N")
    table["SA"] = np.radians(table.pop("alpha_deg"))
    entry = next(entry for entry in project.config["sweep"] if entry["file"] == NAME)
    entry["columns"] = {
        "Fy_N": {"column": "FY", "unit": "kN", "scale": -1.0},
        "alpha_deg": {"column": "SA", "unit": "rad"},
        "Fz_N": "Fz_N",
    }
    found = sweep_named(load(project.write()), NAME)
    np.testing.assert_allclose(found.Fy, reference.Fy, rtol=1e-12)
    np.testing.assert_allclose(found.alpha, reference.alpha, rtol=1e-12)
    assert {"Fy_N", "alpha_deg"} <= set(found.table)
    assert "FY" not in found.table


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({"Fy": "Fy_N"}, 'did you mean "Fy_N"'),
        ({"Fy_N": "FY"}, 'no heading "FY", which [sweep.columns] gives for Fy_N'),
        ({"Fy_N": {"unit": "kPa"}}, "cannot be converted to N"),
        ({"Fy_N": {"unit": "stone throws"}}, "is not a unit"),
    ],
)
def test_a_bad_mapping_is_refused(project, columns, said):
    project.config["sweep"][0]["columns"] = columns
    error = refusal(project.write())
    assert said in str(error)
    assert error.line is not None


def test_a_misspelt_optional_column_is_pointed_out(project):
    project.tables[NAME] = project.tables[NAME].rename(columns={"Mz_Nm": "Mz_nm"})
    warnings = load(project.write()).warnings
    assert any("Mz_nm" in w and "Mz_Nm" in w for w in warnings)


def test_columns_without_a_channel_are_kept_as_text(project):
    project.tables[NAME]["operator"] = "J"
    found = sweep_named(load(project.write()), NAME)
    assert set(found.table["operator"]) == {"J"}


def test_the_direction_column_is_used_and_a_contradiction_is_warned_about(project):
    table = project.tables[NAME]
    table["direction"] = np.where(table["alpha_deg"] > 0, "backward", "forward")
    assert np.array_equal(
        sweep_named(load(project.write()), NAME).direction, np.where(table["alpha_deg"] > 0, -1, 1)
    )
    next(entry for entry in project.config["sweep"] if entry["file"] == NAME)["direction"] = "forward"
    found = load(project.write())
    assert any("6 rows" in w for w in found.warnings)
    assert np.sum(sweep_named(found, NAME).direction < 0) == 6


@pytest.mark.parametrize(("up", "down"), [("-1", "+1"), ("-1", "1"), ("Backward", "FORWARD")])
def test_a_direction_is_a_word_or_a_sign(project, up, down):
    table = project.tables[NAME]
    table["direction"] = np.where(table["alpha_deg"] > 0, up, down)
    found = sweep_named(load(project.write()), NAME).direction
    assert np.array_equal(found, np.where(table["alpha_deg"] > 0, -1, 1))


def test_each_run_is_a_sweep(project):
    table = project.tables[NAME]
    table["run"] = np.where(table["alpha_deg"] > 0, "left", "right")
    found = [sweep for sweep in load(project.write()).sweeps if sweep.file == NAME]
    assert [sweep.name for sweep in found] == ["sideslip_1500:right", "sideslip_1500:left"]
    assert sum(len(sweep) for sweep in found) == len(table)


def test_sae_loads_may_have_either_sign(project):
    project.config["rig"]["axes"] = "sae"
    reference = sweep_named(load(project.write()), NAME)
    project.each(Fz_N=-1.0)
    found = sweep_named(load(project.write()), NAME)
    np.testing.assert_array_equal(found.Fz, reference.Fz)
    assert np.all(found.Fz > 0.0)


def with_uncertainties(project, *u):
    """The sweep with ``u_Fy_N``: the given values in its first rows, 6 N in all others."""
    table = project.tables[NAME]
    column = [*u, *[6.0] * (len(table) - len(u))]
    project.tables[NAME] = table.assign(u_Fy_N=column)
    return project.write()


@pytest.mark.parametrize(("u", "more"), [((6.0, 0.0), ""), ((6.0, -999.0, 0.0), "1 more")])
def test_an_uncertainty_not_above_zero_is_treated_as_not_stated(project, u, more):
    found = load(with_uncertainties(project, *u))
    u_Fy = sweep_named(found, NAME).u_Fy
    np.testing.assert_array_equal(np.isfinite(u_Fy), [k == 0 or k >= len(u) for k in range(len(u_Fy))])
    (warning,) = found.warnings
    assert re.search(rf"{NAME}:3: column u_Fy_N: {u[1]:g} is not above zero; treated as not stated", warning)
    assert more in warning


@pytest.mark.parametrize("u", [1e-12, 1e-4, 5e-3])
def test_an_uncertainty_that_would_outweigh_all_others_is_treated_as_not_stated(project, u):
    found = load(with_uncertainties(project, 6.0, u))
    u_Fy = sweep_named(found, NAME).u_Fy
    np.testing.assert_array_equal(np.isfinite(u_Fy), np.arange(len(u_Fy)) != 1)
    (warning,) = found.warnings
    said = rf"{NAME}:3: column u_Fy_N: {u:g} is not above 0.006, so this point would outweigh all others"
    assert re.search(said, warning)


def test_uncertainties_of_very_unlike_points_hold(project):
    found = load(with_uncertainties(project, 6.0, 0.007))
    assert sweep_named(found, NAME).u_Fy[1] == 0.007
    assert not found.warnings


def test_a_column_below_a_ten_millionth_of_the_readings_is_refused(project):
    error = refusal(with_uncertainties(project, *[1e-12] * len(project.tables[NAME])))
    assert (error.line, error.column) == (2, "u_Fy_N")
    assert re.search(
        r"is not above [\d.e-]+, a ten-millionth of the largest reading, in any row", error.sentence
    )


@pytest.mark.parametrize(
    ("readings", "mapped", "size"),
    [
        ({"column": "F", "unit": "daN"}, "uF", 20.0),
        ({"column": "F", "scale": -10.0}, "uF", 20.0),
        ({"column": "F", "unit": "daN"}, {"column": "uF", "unit": "N"}, 2.0),
        ({"column": "F", "unit": "daN"}, {"column": "uF", "scale": 5.0}, 10.0),
        ({"column": "F"}, "uF", 2.0),
    ],
)
def test_an_uncertainty_without_a_unit_is_in_that_of_its_readings(project, readings, mapped, size):
    """2 beside a force in daN is 20 N, which is said; a stated unit or scale holds, and newtons need no words."""
    table = project.tables[NAME].rename(columns={"Fy_N": "F"})
    project.tables[NAME] = table.assign(uF=2.0)
    entry = next(entry for entry in project.config["sweep"] if entry["file"] == NAME)
    entry["columns"] = {"Fy_N": readings, "u_Fy_N": mapped}
    found = load(project.write())
    np.testing.assert_allclose(sweep_named(found, NAME).u_Fy, size)
    said = [warning for warning in found.warnings if "column uF: states no unit; read as F is" in warning]
    assert len(said) == (size == 20.0)


def test_a_blank_uncertainty_is_not_stated(project):
    found = load(with_uncertainties(project, np.nan))
    assert np.isnan(sweep_named(found, NAME).u_Fy[0])
    assert not found.warnings


def test_a_column_of_zero_uncertainties_is_refused(project):
    error = refusal(with_uncertainties(project, *[0.0] * len(project.tables[NAME])))
    assert (error.line, error.column) == (2, "u_Fy_N")
    assert "not above zero in any row" in error.sentence


def numbers(path):
    """A reader of another format: numbers instead of text, with the unit beside each heading."""
    return RawTable(
        headings=("alpha_deg", "gamma_deg", "Fz_N", "Fy_N", "Mz_Nm", "iteration", "run"),
        units=("rad", "", "kN", "kN", "", "", ""),
        cells=(
            np.array([0.0, 0.1]),
            np.zeros(2),
            np.array([1.5, 1.5]),
            [0.2, -0.3],
            np.full(2, np.nan),
            np.array([np.nan, 2.0]),
            np.array([1.0, 1.0]),
        ),
        lines=(7, 8),
        path=path,
        heading_line=5,
    )


def test_a_new_format_is_a_reader_and_a_record(project, monkeypatch):
    path = project.write()
    path.write_text(path.read_text().replace(NAME, "rig.raw"))
    (project.folder / "rig.raw").write_bytes(b"")
    assert "is not in a known format (.csv .csv.gz" in refusal(path).sentence
    extended = (*formats.FORMATS, formats.Format("RAW", (".raw",), numbers))
    monkeypatch.setattr(formats, "FORMATS", extended)
    monkeypatch.setattr(loading, "ENDINGS", (*formats.ENDINGS, ".raw"))
    found = sweep_named(load(path), "rig.raw")
    np.testing.assert_allclose(found.alpha, [0.0, 0.1])
    np.testing.assert_allclose(found.Fz, 1500.0)
    np.testing.assert_allclose(found.Fy, [200.0, -300.0])
    assert np.all(np.isnan(found.Mz))
    np.testing.assert_array_equal(found.iteration, [np.nan, 2.0])
    np.testing.assert_array_equal(found.line, [7, 8])
    assert found.name == "rig.raw:1"


def test_an_unknown_unit_in_the_file_is_refused(project):
    raw = formats.read(project.write().parent / NAME)
    strange = replace(raw, units=("furlong per", *raw.units[1:]))
    with pytest.raises(InputError, match=f"{NAME}:1: column alpha_deg: .*furlong"):
        read_columns(strange, {})


def test_the_name_of_a_sweep_is_that_of_its_file_without_the_ending():
    assert [formats.stem(name) for name in ("a/b.csv", "b.csv.gz", "b.c.odt", "B.MAT")] == [
        "b",
        "b",
        "b.c.odt",
        "B",
    ]


def test_rows_that_are_no_readings_are_skipped_and_listed(project):
    """The mean below the readings, and a cell where a spreadsheet found no value."""
    path = project.write()
    reference = sweep_named(load(path), NAME)
    text = line_changed(project.text(NAME), 5, "1500.0", "#NV").rstrip("\n")
    width = text.split("\n")[0].count(",") + 1
    project.overwrite(NAME, text + "\nMittelwert" + ",1.0" * (width - 1) + "\n")
    found = load(path)
    np.testing.assert_array_equal(sweep_named(found, NAME).Fy, np.delete(reference.Fy, 3))
    said = " ".join(found.warnings)
    assert f'{NAME}:5: column Fz_N: "#NV" is no reading; the row is skipped' in said
    last = len(reference.Fy) + 2
    assert f'{NAME}:{last}: column alpha_deg: "Mittelwert" is no reading; the row is skipped' in said


def test_a_missing_value_of_a_recording_costs_only_its_cell(project):
    path = project.write()
    text = project.text(NAME).split("\n")
    rows = [text[0] + ",time_s", *(f"{row},{0.01 * k:.2f}" for k, row in enumerate(text[1:]) if row)]
    rows[5] = rows[5].replace("1500.0", "#DIV/0!", 1)
    project.overwrite(NAME, "\n".join(rows))
    found = load(path)
    Fz = sweep_named(found, NAME).Fz
    assert list(np.flatnonzero(np.isnan(Fz))) == [4]
    assert any('"#DIV/0!" is no reading; treated as missing' in warning for warning in found.warnings)


def with_times(project, times):
    """The project's sweep as a recording whose samples have these cells as times, from the first row on."""
    text = project.text(NAME).split("\n")
    rows = [
        text[0] + ",time_s",
        *(f"{row},{time}" for row, time in zip(text[1:], times, strict=False) if row),
    ]
    project.overwrite(NAME, "\n".join(rows))


def test_empty_times_of_samples_between_stated_ones_are_interpolated(project):
    path = project.write()
    times = [f"{2.0 + 0.01 * k:.2f}" for k in range(200)]
    with_times(project, [*times[:2], "", *times[3:5], "", "", *times[7:]])
    found = load(path)
    time = sweep_named(found, NAME).time
    np.testing.assert_allclose(time, 2.0 + 0.01 * np.arange(len(time)), atol=1e-9)
    assert any(
        f"{NAME}:4: column time_s: empty in lines 4, 7-8; interpolated at the rate of the recording" in said
        for said in found.warnings
    )


@pytest.mark.parametrize(
    ("empty", "later", "lines"),
    [((2, 5), 5, "line 7"), ((0, 3), 99, "line 2"), ((1, 2, 5), 6, "line 7"), ((0, 1, 4), 5, "lines 2-3, 6")],
    ids=["at a pause", "the first one", "only the one at a pause", "all of them"],
)
def test_empty_times_that_no_others_tell_are_refused_all_at_once(project, empty, later, lines):
    """``later``: the sample from which on the clock is 0.3 s ahead."""
    path = project.write()
    with_times(project, ["" if k in empty else f"{0.01 * k + 0.3 * (k >= later):.2f}" for k in range(200)])
    assert f": column time_s: empty in {lines}, where the times before and after" in str(refusal(path))


@pytest.mark.parametrize(
    ("cells", "values"),
    [
        (("1.500,0", "999,5"), (1500.0, 999.5)),
        (("1.500", "1.499,5"), (1500.0, 1499.5)),
        (("1.500", "999.5"), (1.5, 999.5)),
    ],
)
def test_points_between_thousands_are_read_where_a_comma_follows(tmp_path, cells, values):
    path = tmp_path / "a.csv"
    path.write_text("Fz_N;Fy_N\n" + "".join(f"{cell};1\n" for cell in cells))
    raw = formats.read(path)
    assert tuple(map(float, raw.cells[0])) == values


def test_a_kind_of_warning_is_given_once_with_the_other_files(project):
    """A row of means in every file of a campaign is one warning; two files are named one by one."""
    names = sorted(project.tables)
    path = project.write()
    for count in (2, len(names)):
        for name in names[:count]:
            text = project.tables[name].to_csv(index=False)
            project.overwrite(name, text + "Mittelwert" + "," * text.splitlines()[0].count(",") + "\n")
        said = [warning for warning in load(path).warnings if "Mittelwert" in warning]
        assert len(said) == (2 if count == 2 else 1)
    assert f"; {len(names) - 1} more of this kind, in " in said[0]


def test_decimal_commas_in_quotation_marks_between_commas_are_numbers(tmp_path):
    rows = ['"1,5","0,0","2000,0","-500,5"', '"-2,5",0,"2010,0","700,25"']
    path = tmp_path / "a.csv"
    path.write_text("\n".join(["alpha_deg,gamma_deg,Fz_N,Fy_N", *rows]) + "\n", encoding="utf-8")
    raw = formats.read(path)
    read = [[float(cell) for cell in raw.column(name)] for name in raw.headings]
    assert read == [[1.5, -2.5], [0.0, 0.0], [2000.0, 2010.0], [-500.5, 700.25]]
