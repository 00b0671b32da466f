"""The same table reads the same in every format; a broken file is refused in one sentence."""

from __future__ import annotations

import gzip
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io
from flat_belt import UNITS, recording, write_mat, write_mat73

from mffit import config as configuration
from mffit import sweeps
from mffit.errors import InputError
from mffit.sweeps import formats

RECORDINGS = Path(__file__).parents[3] / "docs" / "recordings.md"
TABLE = recording(loads=(1500.0,), cambers=(0.0,), pressures=(83.0,), sweep_s=2.0, rest_s=0.2)


def write_v4(path):
    scipy.io.savemat(path, {name: TABLE[name].to_numpy()[:, None] for name in TABLE}, format="4")


def write_xlsx(path):
    pytest.importorskip("openpyxl")
    units = pd.DataFrame([[UNITS[name] for name in TABLE]], columns=list(TABLE))
    pd.concat([units, TABLE.astype(object)]).to_excel(path, index=False, startrow=2)


def write_parquet(path):
    pa = pytest.importorskip("pyarrow")
    import pyarrow.parquet as parquet

    fields = [pa.field(name, pa.float64(), metadata={"unit": UNITS[name]}) for name in TABLE]
    parquet.write_table(pa.table([TABLE[name].to_numpy() for name in TABLE], schema=pa.schema(fields)), path)


def write_dat(path):
    """A title, names and units between tabs, as Calspan's text files have them."""
    lines = ["Tyre A; 12 psi; 25 mph", "\t".join(TABLE), "\t".join(UNITS[name] for name in TABLE)]
    lines += ["\t".join(repr(float(value)) for value in row) for row in TABLE.to_numpy()]
    path.write_text("\r\n".join(lines))


def write_merged(path):
    """Two rows of headings with merged cells, a title, a column of remarks without a heading, and a blank column."""
    openpyxl = pytest.importorskip("openpyxl")
    book = openpyxl.Workbook()
    sheet = book.active
    first, *rest = TABLE
    sheet.append(["Test 4711"])
    sheet.append([first, "", "", "conditions", *(len(rest) - 1) * [""]])
    sheet.append(["", "", "", *rest])
    sheet.append(["", "", "", *(UNITS[name] for name in rest)])
    for time, *row in TABLE.to_numpy().tolist():
        sheet.append([time, None, "checked", *row])
    sheet.merge_cells(start_row=2, end_row=3, start_column=1, end_column=1)
    sheet.merge_cells(start_row=2, end_row=2, start_column=4, end_column=len(rest) + 3)
    book.save(path)


def in_lines(*head: list[str], blank: int = 0) -> str:
    """The table between tabs under these rows, with a number of empty columns after each."""
    rows = [*head, *([repr(float(value)) for value in row] for row in TABLE.to_numpy())]
    return "\n".join(("\t" * (blank + 1)).join(row) for row in rows)


def tydex(
    *, factor: float = 1.0, offset: float = 0.0, shift: float = 0.0, fixed: bool = True, end: str = "\n"
) -> str:
    lines = ["**HEADER", f"{'RELEASE':<10}{'Release of TYDEX':<30}{'':<10}1.3", "! a remark", "**CONSTANTS"]
    lines += [
        f"{'RIMWIDTH':<10}{'Width of the rim':<30}{'in':<10}7.0",
        f"{'TYRE':<10}{'Name':<30}{'':<10}Tyre A",
        "**MEASURCHANNELS",
    ]
    for name in TABLE:
        row = f"{name:<10}{'a channel':<30}{UNITS[name].replace('none', '-'):<10}{factor:<10}{offset:<10}{shift:<10}"
        lines.append(
            row
            if fixed
            else " ".join([name, "a", "channel", UNITS[name].replace(" ", ""), f"{factor} {offset} {shift}"])
        )
    lines.append("**MEASURDATA")
    raw = (TABLE.to_numpy() - shift) / factor - offset
    lines += [" ".join(repr(float(value)) for value in row) for row in raw]
    return end.join([*lines, "**END", ""])


def german(value: float) -> str:
    """A number with a decimal comma and points between its thousands: -1.500,25."""
    return f"{value:,.12f}".translate(str.maketrans(",.", ".,"))


WRITERS = {
    "five.mat": lambda path: write_mat(TABLE, path),
    "four.mat": write_v4,
    "seven.mat": lambda path: write_mat73(TABLE, path),
    "book.xlsx": write_xlsx,
    "table.parquet": write_parquet,
    "calspan.dat": write_dat,
    "run.tdx": lambda path: path.write_text(tydex()),
    "scaled.tdx": lambda path: path.write_text(tydex(factor=0.25, offset=3.0, shift=-1.0)),
    "free.tdx": lambda path: path.write_text(tydex(fixed=False, end="\r\n"), newline=""),
    "counted.tdx": lambda path: path.write_text(
        tydex().replace("**MEASURDATA", f"**MEASURDATA{len(TABLE):>18}")
    ),
    "run.tdx.gz": lambda path: path.write_bytes(gzip.compress(tydex().encode())),
    "plain.csv": lambda path: TABLE.to_csv(path, index=False),
    "german.csv": lambda path: TABLE.to_csv(path, index=False, sep=";", decimal=","),
    "thousands.csv": lambda path: path.write_text(
        "\n".join([";".join(TABLE), *(";".join(map(german, row)) for row in TABLE.to_numpy())])
    ),
    "merged.xlsx": write_merged,
    "index.csv": lambda path: TABLE.to_csv(path),
    "blank.txt": lambda path: path.write_text(
        in_lines(list(TABLE), [UNITS[name] for name in TABLE], blank=2)
    ),
    "described.txt": lambda path: path.write_text(
        in_lines(list(TABLE), [f"channel {name}" for name in TABLE], [UNITS[name] for name in TABLE])
    ),
    "texts.xlsx": lambda path: TABLE.map(german).to_excel(path, index=False),
    "german.tdx": lambda path: path.write_text(re.sub(r"(?<=\d)\.(?=\d+[ \n])", ",", tydex(factor=0.5))),
}


@pytest.mark.parametrize("name", WRITERS)
def test_every_format_gives_the_same_numbers(tmp_path, name):
    path = tmp_path / name
    WRITERS[name](path)
    raw = formats.read(path)
    assert set(raw.headings) >= set(TABLE)
    for heading in TABLE:
        k = raw.headings.index(heading)
        cells = np.array([float(cell) for cell in raw.cells[k]])
        np.testing.assert_allclose(cells, TABLE[heading], rtol=1e-12, atol=1e-9)
        if raw.units[k]:
            assert raw.units[k].replace(" ", "") in (UNITS[heading].replace(" ", ""), "-")
    assert len(raw.lines) == len(raw)


@pytest.mark.parametrize("name", ["five.mat", "seven.mat"])
def test_the_texts_of_a_recording_are_kept(tmp_path, name):
    WRITERS[name](tmp_path / name)
    raw = formats.read(tmp_path / name)
    assert raw.about["tireid"].startswith("Tyre A")
    assert dict(zip(raw.headings, raw.units, strict=True)) == UNITS


def test_constants_of_a_tydex_file_become_columns(tmp_path):
    (tmp_path / "a.tdx").write_text(tydex())
    raw = formats.read(tmp_path / "a.tdx")
    k = raw.headings.index("RIMWIDTH")
    assert raw.units[k] == "in"
    np.testing.assert_array_equal(raw.cells[k], 7.0)


def test_groups_tell_equal_headings_apart_and_state_units(tmp_path):
    (tmp_path / "a.csv").write_text("t [s];Force [kN];;Moment [Nm]\n;y;z;z\n0;1;2;3\n1;4;5;6\n")
    raw = formats.read(tmp_path / "a.csv")
    assert raw.headings == ("t", "Force y", "Force z", "Moment z")
    assert raw.units == ("s", "kN", "kN", "Nm")
    assert [cells[1] for cells in raw.cells] == [1.0, 4.0, 5.0, 6.0]


def test_an_unknown_unit_among_known_ones_does_not_make_the_row_one_of_data(tmp_path):
    (tmp_path / "a.csv").write_text("SA,FZ,P\n[deg],[N],[kPa abs]\n1,1500,250\n")
    assert formats.read(tmp_path / "a.csv").units == ("deg", "N", "kPa abs")


def test_a_table_of_a_reading_over_two_settings_needs_a_row_per_point(tmp_path):
    path = tmp_path / "a.csv"
    path.write_text("angle,15000.0,30000.0,45000.0\n-12.0,9.49,18.21,26.56\n-8.0,8.31,15.88,22.92\n")
    with pytest.raises(
        InputError, match=r'a\.csv:1: has numbers beside "angle".*one row per point'
    ) as refused:
        formats.read(path)
    assert "transpose" not in str(refused.value)


def test_a_table_on_its_side_is_to_be_transposed(tmp_path):
    (tmp_path / "a.csv").write_text("alpha_deg,-2,0,2\nFy_N,300,0,-300\n")
    with pytest.raises(InputError, match=r'a\.csv:1: has numbers beside "alpha_deg".*transpose the table'):
        formats.read(tmp_path / "a.csv")


CLOCKS = {
    "a time of day": ["12:03:04.5", "12:03:05", "12:04:04,75"],
    "over midnight": ["23:59:59.5", "00:00:00", "00:00:59.75"],
    "the date in the ISO form": ["2026-02-28T23:59:59.5Z", "2026-03-01T00:00:00Z", "2026-03-01T00:00:59.75Z"],
    "an American date": ["2/28/2026 11:59:59.5 PM", "3/1/2026 12:00:00 AM", "3/1/2026 12:00:59.75 AM"],
    "a German date": ["28.02.2026 13:59:59,5", "28.02.2026 14:00:00,0", "28.02.2026 14:00:59,75"],
    "minutes and seconds": ["59:59.5", "00:00.0", "00:59.75"],
    "a duration": ["0:00:04.500000", "0:00:05", "0:01:04.750000"],
}


@pytest.mark.parametrize("kind", CLOCKS)
def test_clock_times_are_seconds(tmp_path, kind):
    rows = [f"{time};{k}" for k, time in enumerate(CLOCKS[kind])]
    (tmp_path / "a.csv").write_text("\n".join(["Zeitstempel;SA", *rows]))
    raw = formats.read(tmp_path / "a.csv")
    assert raw.units[0] == "s"
    np.testing.assert_allclose(raw.cells[0] - raw.cells[0][0], [0.0, 0.5, 60.25])


@pytest.mark.parametrize(
    "cells", [["12:03:04"] * 3, ["1.csv", "2.csv", "3.csv"], ["12:03:04", "late", "12:03:05"]]
)
def test_labels_and_the_time_of_a_test_are_no_clock(tmp_path, cells):
    (tmp_path / "a.csv").write_text("\n".join(["label;SA", *(f"{cell};{k}" for k, cell in enumerate(cells))]))
    assert formats.read(tmp_path / "a.csv").cells[0] == cells


BROKEN = {
    "a.mat": (b"", "MATLAB"),
    "b.mat": (b"MATLAB 5.0 MAT-file" + bytes(120), "MATLAB"),
    "c.mat": (b"\x89HDF\r\n\x1a\nnothing more", "MATLAB"),
    "d.xlsx": (b"PK\x03\x04nothing", "Excel"),
    "e.parquet": (b"PAR1", "Parquet"),
    "f.tdx": (b"\0\1\2\3", "National Instruments"),
    "g.tdx": (b"alpha,beta\n", "**HEADER"),
    "h.tdx": (b"**HEADER\n**MEASURCHANNELS\n**END\n", "no channels"),
    "i.tdx": (b"**HEADER\n**MEASURCHANNELS\nFYW x N\n**MEASURDATA\n1 2\n", "2 values for 1"),
    "j.tdx": (b"**HEADER\n**MEASURCHANNELS\nFYW x N\n**MEASURDATA\none\n", "is not a number"),
    "k.dat": (b"", "empty"),
}


@pytest.mark.parametrize("kind", formats.FORMATS, ids=lambda kind: kind.name)
def test_every_format_has_a_good_and_a_broken_file_and_a_place_in_the_documentation(kind):
    for table, files in (("WRITERS", WRITERS), ("BROKEN", BROKEN)):
        assert any(name.endswith(kind.endings) for name in files), f"{table} has no {kind.name} file"
    plain = [ending for ending in kind.endings if not ending.endswith(".gz")]
    missing = [ending for ending in plain if f"`{ending}`" not in RECORDINGS.read_text(encoding="utf-8")]
    assert not missing, f"docs/recordings.md has no format with the ending {', '.join(missing)}"


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_refused_in_a_sentence(tmp_path, name):
    content, said = BROKEN[name]
    (tmp_path / name).write_bytes(content)
    with pytest.raises(InputError) as caught:
        formats.read(tmp_path / name)
    assert said in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("module", "name"), [("h5py", "seven.mat"), ("openpyxl", "book.xlsx"), ("pyarrow", "table.parquet")]
)
def test_a_missing_library_is_named(tmp_path, monkeypatch, module, name):
    WRITERS[name](tmp_path / name)
    monkeypatch.setitem(__import__("sys").modules, module, None)
    with pytest.raises(InputError, match=r"mffit\[formats\]"):
        formats.read(tmp_path / name)


def config(folder, **changes):
    content = {
        "tyre": {"name": "x", "unloaded_radius": 0.2, "nominal_load": 1500.0, "nominal_pressure": 83.0},
        "rig": {"type": "flat-track", "axes": "calspan"},
        "columns": {
            "alpha_deg": "SA", "gamma_deg": "IA", "Fz_N": "FZ", "Fy_N": "FY", "V_mps": "V", "time_s": "ET", "T_degC": "TSTC",
        },
        "sweep": [{"file": "run*.mat"}],
    }  # fmt: skip
    return configuration.load({**content, **changes}, folder=folder)


def test_one_mapping_and_one_pattern_apply_to_all_files(tmp_path):
    for k in (2, 1, 10):
        write_mat(TABLE, tmp_path / f"run{k}.mat")
    (tmp_path / "runs.txt").write_text("not this one")
    found = sweeps.load(config(tmp_path)).sweeps
    assert [sweep.file for sweep in found] == ["run1.mat", "run10.mat", "run2.mat"]
    np.testing.assert_allclose(found[0].V, TABLE["V"] / 3.6)
    np.testing.assert_allclose(found[0].Fy, -TABLE["FY"])
    np.testing.assert_allclose(found[0].Fz, -TABLE["FZ"])


def test_the_mapping_of_a_file_precedes_the_shared_one(tmp_path):
    write_mat(TABLE.rename(columns={"FY": "FYW"}), tmp_path / "run1.mat")
    found = sweeps.load(config(tmp_path, sweep=[{"file": "run1.mat", "columns": {"Fy_N": "FYW"}}])).sweeps
    np.testing.assert_allclose(found[0].Fy, -TABLE["FY"])


def test_a_file_may_lack_an_optional_column_of_the_shared_mapping(tmp_path):
    write_mat(TABLE.drop(columns="TSTC"), tmp_path / "run1.mat")
    assert np.all(np.isnan(sweeps.load(config(tmp_path)).sweeps[0].T))
    write_mat(TABLE.drop(columns="FY"), tmp_path / "run1.mat")
    with pytest.raises(InputError, match=r'no heading "FY", which \[columns\] gives for Fy_N'):
        sweeps.load(config(tmp_path))


def test_a_pattern_without_files_is_refused_with_its_line(tmp_path):
    path = tmp_path / "tyre.toml"
    path.write_text(
        '[tyre]\nname = "x"\nunloaded_radius = 0.3\nnominal_load = 1500\nnominal_pressure = 250\n'
        '[rig]\ntype = "flat-track"\n[[sweep]]\nfile = "*.mat"\n'
    )
    with pytest.raises(InputError, match=r"no file in .* matches") as caught:
        configuration.load(path)
    assert caught.value.line == 9


def test_lines_are_right_in_a_large_file_with_remarks(tmp_path):
    """pandas reads the file; it skips blank and comment lines without counting them."""
    table = pd.DataFrame({"alpha_deg": 0.0, "gamma_deg": 0.0, "Fz_N": 1500.0, "Fy_N": np.arange(60_000.0)})
    text = table.to_csv(index=False).splitlines()
    text.insert(100, "# a remark")
    text.insert(30_000, "")
    text = [*text, *["#" + 999 * "-"] * 2500]
    (tmp_path / "a.csv").write_text("\n".join(text))
    raw = formats.read(tmp_path / "a.csv")
    assert isinstance(raw.cells[3], np.ndarray)
    for row in (0, 98, 99, 29_997, 29_999, 59_999):
        assert float(text[raw.lines[row] - 1].split(",")[3]) == raw.cells[3][row]
