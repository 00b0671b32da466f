"""A corpus of broken inputs, each made from a small sound project by one change, with the sentence for each.

What is in tests/mffit/test_bad_input.py is not repeated here. Nothing is fitted: all of these are found on the way in.
"""

from __future__ import annotations

import gzip
import io
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from disc_project import SIDESLIP, Project, rows

import mffit
import tir
from mffit.errors import InputError
from tir.errors import TirError

Change = Callable[[Project], Path]
SWEEP, CAMBER = "sideslip_1500.csv", "camber_1500.csv"
HEAD = "alpha_deg,gamma_deg,Fz_N,Fy_N,Mz_Nm\n"
WHOLE_TIR = tir.Tyre.from_values({"FNOMIN": 1500.0, "PKY1": -12.0}).text()


def toml(old: str, new: str, count: int = 1) -> Change:
    """Replaces words in tyre.toml."""

    def change(project: Project) -> Path:
        path = project.write()
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new, count))
        return path

    return change


def whole_toml(content: bytes) -> Change:
    def change(project: Project) -> Path:
        path = project.write()
        path.write_bytes(content)
        return path

    return change


def under(table: str, key: str) -> Change:
    """Adds a key at the head of a table."""
    return toml(f"[{table}]\n", f"[{table}]\n{key}\n")


def of_sweep(**keys: Any) -> Change:
    """Adds keys to the [[sweep]] of one file."""

    def change(project: Project) -> Path:
        for entry in project.config["sweep"]:
            if entry["file"] == SWEEP:
                entry.update(keys)
        return project.write()

    return change


def csv(content: str | bytes) -> Change:
    """Replaces the content of one file."""

    def change(project: Project) -> Path:
        path = project.write()
        project.overwrite(SWEEP, content)
        return path

    return change


def words(old: str, new: str) -> Change:
    """Replaces words in one file."""

    def change(project: Project) -> Path:
        path = project.write()
        assert old in project.text(SWEEP)
        project.overwrite(SWEEP, project.text(SWEEP).replace(old, new, 1))
        return path

    return change


def column(file: str = SWEEP, columns: dict[str, Any] | None = None, **made: Any) -> Change:
    """Replaces columns of one file by a value, or by a function of the column; ``columns`` are [columns] of tyre.toml."""

    def change(project: Project) -> Path:
        project.config |= {"columns": columns} if columns else {}
        table = project.tables[file]
        for name, value in made.items():
            table[name] = value(table[name]) if callable(value) else value
        return project.write()

    return change


def other(name: str, content: str | bytes) -> Change:
    """Moves one sweep to a file of another name."""

    def change(project: Project) -> Path:
        for entry in project.config["sweep"]:
            if entry["file"] == SWEEP:
                entry["file"] = name
        del project.tables[SWEEP]
        path = project.write()
        project.overwrite(name, content)
        return path

    return change


def base(content: str | bytes) -> Change:
    """Adds a base file with this content."""

    def change(project: Project) -> Path:
        project.config["tyre"]["base"] = "base.tir"
        path = project.write()
        project.overwrite("base.tir", content)
        return path

    return change


def all_forward(project: Project) -> Path:
    for entry in project.config["sweep"]:
        entry.pop("direction", None)
    return project.write()


def in_memory(write: Callable[[io.BytesIO], Any]) -> bytes:
    buffer = io.BytesIO()
    write(buffer)
    return buffer.getvalue()


def as_tyre_toml(content: str) -> Change:
    def change(project: Project) -> Path:
        path = project.write()
        path.write_text(content)
        return path

    return change


SOUND = rows(SIDESLIP, 0.0, 1500.0)
NO_TABLE = in_memory(lambda file: pd.DataFrame().to_excel(file, index=False))
NO_FORCE = in_memory(lambda file: SOUND.drop(columns="Fy_N").to_excel(file, index=False))
HEAVY = in_memory(lambda file: SOUND.assign(Fz_N="heavy").to_parquet(file))
CUT_GZ = gzip.compress(SOUND.to_csv(index=False).encode())[:-30]

CORPUS: dict[str, tuple[Change, str]] = {
    # tyre.toml as a text
    "a key without value": (
        toml("unloaded_radius = 0.3", "unloaded_radius ="),
        "tyre.toml:7: is not valid TOML",
    ),
    "a table that stands twice": (
        toml("[rig]", "[fit]\n[fit]\n[rig]"),
        "has the table [fit] twice; write all its keys under one [fit]",
    ),
    "a property file as tyre.toml": (
        as_tyre_toml(WHOLE_TIR),
        "tyre.toml: is a property file, not a tyre.toml",
    ),
    "a quote that is not closed": (toml('name = "toy"', 'name = "toy'), "tyre.toml:6: is not valid TOML"),
    "a decimal comma": (
        toml("path_radius = 1.323", "path_radius = 1,323"),
        "tyre.toml:15: is not valid TOML",
    ),
    "a decimal comma below zero": (
        toml("path_radius = 1.323", "path_radius = -1,323  # m"),
        "write the number with a decimal point, -1.323",
    ),
    "a key twice": (under("tyre", "nominal_load = 1400.0"), "cannot overwrite a value"),
    "in UTF-16": (whole_toml("[tyre]\n".encode("utf-16")), "tyre.toml: is not UTF-8 text"),
    "an empty file": (whole_toml(b""), "tyre: is missing; add the table [tyre] (also wrong: rig, sweep)"),
    # tyre.toml by its keys
    "sweeps for sweep": (toml("[[sweep]]", "[[sweeps]]", 99), 'sweeps: is unknown; did you mean "sweep"?'),
    "rigg for rig": (toml("[rig]", "[rigg]"), 'tyre.toml:11: rigg: is unknown; did you mean "rig"?'),
    "a key of another table": (under("rig", "nominal_load = 1500.0"), "move it to [tyre]"),
    "a number in quotes": (
        toml("nominal_load = 1500.0", 'nominal_load = "1500"'),
        'nominal_load: "1500" is a text, not a number',
    ),
    "true for a number": (toml("path_radius = 1.323", "path_radius = true"), "true is not a number"),
    "a radius that is no number": (toml("= 1.323", "= nan"), "rig.path_radius: nan is not a finite number"),
    "a negative load": (
        toml("nominal_load = 1500.0", "nominal_load = -1500.0"),
        "tyre.nominal_load: -1500 N is outside 20 to 200000 N",
    ),
    "a pressure in bar": (toml("= 250.0", "= 2.5"), "it looks like bar, write kilopascals"),
    "a pressure in Pa": (toml("= 250.0", "= 250000.0"), "it looks like pascals"),
    "a radius in mm": (toml("radius = 0.3", "radius = 300.0"), "it looks like millimetres, write metres"),
    "an uncertainty in mm": (under("rig", "u_path_radius = 1.8"), "rig.u_path_radius: 1.8 m is outside"),
    "a rim outside its tyre": (
        under("tyre", "rim_radius = 0.4"),
        "is not smaller than the unloaded radius, 0.3 m",
    ),
    "an unknown side": (
        under("tyre", 'side = "links"'),
        "tyre.side: \"links\" is not allowed; write 'left', 'right'",
    ),
    "unknown axes": (toml('"iso"', '"ISO8855"'), "rig.axes: \"ISO8855\" is not allowed; write 'iso', 'sae'"),
    "a name with a path": (toml('"toy"', '"../toy"'), '"../toy" cannot name the output files'),
    "no radius of the path": (toml("path_radius = 1.323\n", ""), "is missing for a rotating disc"),
    "a file listed twice": (toml(CAMBER, "camber_1000.csv"), '"camber_1000.csv" is listed twice'),
    "a file without a name": (toml(CAMBER, ""), 'sweep[6].file: "" is not in a known format'),
    "a folder for a file": (toml(CAMBER, "."), 'sweep[6].file: "." is a folder; name a file in it'),
    "a pattern that fits nothing": (toml(CAMBER, "none/*.csv"), 'matches "none/*.csv"; correct the pattern'),
    "an unknown direction": (of_sweep(direction="astern"), "is not allowed; write 'forward' or 'backward'"),
    "an unknown unit": (
        of_sweep(columns={"Fy_N": {"unit": "furlong"}}),
        '"furlong" cannot be converted to N',
    ),
    "a unit of another kind": (of_sweep(columns={"Fy_N": {"unit": "deg"}}), '"deg" cannot be converted to N'),
    "a column of no contract": (
        of_sweep(columns={"Fy_kN": "Fy_N"}),
        'not a column of a sweep; did you mean "Fy_N"?',
    ),
    "a heading not in the file": (of_sweep(columns={"Fy_N": "FY"}), 'no heading "FY"'),
    # base files
    "an empty base file": (base(""), "base.tir: is empty"),
    "a binary base file": (
        base(b"\0\1\2\3" * 40),
        "base.tir: is UTF-16 without a byte order mark, or binary",
    ),
    "a base file in words": (
        base(WHOLE_TIR.replace("-12", "zwölf")),
        'PKY1 is "zwölf", but a number was expected',
    ),
    "a page for a base file": (
        base("<html><body>404</body></html>"),
        "base.tir: is a web page about the file",
    ),
    # tables as text
    "a row cut off": (csv(HEAD + "0,0,1500,1,1\n1,0,15"), ":3: has 3 cells under 5 headings"),
    "two rows in one line": (
        words("\n-6.0", ",-6.0"),
        ":2: has 14 cells under 7 headings; remove the cells too many",
    ),
    "a quote in a row": (csv(HEAD + '0,0,"1500,1,1\n1,0,1500,1,1\n'), ":2: a quotation mark is not closed"),
    "the headings again": (words("\n-6.0", f"\n{','.join(SOUND)}\n-6.0"), ":3: column alpha_deg"),
    "prose": (csv("the quick brown fox\njumps over\n"), ":2: has 2 cells under 4 headings"),
    "a page for a table": (csv("<!doctype html><html>Not found</html>\n"), "headings but no data"),
    "a property file for a table": (csv(WHOLE_TIR), "cells under 2 headings"),
    "zeros at the end": (csv(HEAD.encode() + b"0,0,1500,1,1\n" + bytes(200)), "is binary, not plain text"),
    "gz that is none": (other("sideslip.csv.gz", HEAD), "is not a complete gzip file"),
    "gz cut off": (other("sideslip.csv.gz", CUT_GZ), "is not a complete gzip file"),
    # cells
    "no load at all": (column(Fz_N=np.nan), ":2: column Fz_N: has no values"),
    "no force at all": (column(Fy_N=np.nan), ":2: column Fy_N: has no values"),
    "n/a for a force": (column(Fy_N="n/a"), ':2: column Fy_N: "n/a" is not a measurement'),
    "400 deg of sideslip": (words("-6.0", "400.0"), ":3: column alpha_deg: 400 deg is outside -60 to 60 deg"),
    "110 deg of camber": (
        column(CAMBER, gamma_deg=lambda x: 2.2 * x),
        ":2: column gamma_deg: -110 deg is outside",
    ),
    "cells in bar": (column(p_kPa=2.5), "2.5 kPa is outside 20 to 2000 kPa; it looks like bar"),
    "cells in Pa": (column(p_kPa=250e3), "it looks like Pa"),
    "cells in another unit than stated": (
        column(columns={"p_kPa": {"column": "p_kPa", "unit": "bar"}}),
        ':2: column p_kPa: 25000 kPa is outside 20 to 2000 kPa; its unit is stated as "bar"; correct the unit',
    ),
    "a negative speed": (column(V_mps=-6.0), "speeds are positive and direction says backward"),
    "a direction in words": (
        column(direction="astern"),
        '"astern" is not a direction; write forward or backward',
    ),
    "negative uncertainties": (column(u_Fy_N=-6.0), "u_Fy_N: is not above zero in any row"),
    "a wild load": (words("1500.0", "1500000.0"), ":2: column Fz_N: 1.5e+06 N is outside"),
    # other formats
    "text for MATLAB": (other("sideslip.mat", HEAD), "is not a readable MATLAB file"),
    "MATLAB's head alone": (
        other("sideslip.mat", b"MATLAB 5.0 MAT-file" + b" " * 200),
        "is not a readable MATLAB file",
    ),
    "text for Excel": (other("sideslip.xlsx", HEAD), "is not a readable Excel workbook"),
    "Excel without force": (other("sideslip.xlsx", NO_FORCE), "sideslip.xlsx:1: column Fy_N: is missing"),
    "an empty workbook": (other("sideslip.xlsx", NO_TABLE), "has no sheet with a table"),
    "text for Parquet": (other("sideslip.parquet", HEAD), "is not a readable Parquet file"),
    "words in Parquet": (other("sideslip.parquet", HEAVY), 'column Fz_N: "heavy" is a text'),
    "TYDEX without channels": (other("sideslip.tdx", "**HEADER\n**END\n"), "add **MEASURCHANNELS"),
    "binary TYDEX": (other("sideslip.tdx", b"**HEADER\n\0\0\0\1"), "belongs to a .tdm file, and not TYDEX"),
    # one sweep that does not belong to the others
    "a tenth of the load": (column(Fz_N=150.0), "Fy_N reaches 8.2 times the load, where no tyre exceeds 4"),
    "a dead force": (column(Fy_N=0.0), "Fy_N: is 0 in every row, so the channel was dead"),
    "force and moment exchanged": (
        lambda project: column(Fy_N=project.tables[SWEEP].Mz_Nm, Mz_Nm=project.tables[SWEEP].Fy_N)(project),
        "column Fy_N: is at most 18.9 N at loads of 1500 N; it looks like side force and moment exchanged",
    ),
    "a force reversed": (column(Fy_N=lambda x: -x), "Fy_N rises with alpha_deg in this file alone"),
    "a moment in Nmm": (column(Mz_Nm=lambda x: 1000.0 * x), "it looks like its moment in N mm"),
    "an angle in radians": (column(alpha_deg=np.radians), "it looks like its sideslip in rad"),
    "backward runs undeclared": (all_forward, "in this file and in backward_1500.csv"),
}


def test_the_corpus_is_as_large_as_it_says():
    assert len(CORPUS) >= 60


@pytest.mark.parametrize("case", CORPUS)
def test_every_broken_input_ends_with_its_sentence(project, case):
    change, said = CORPUS[case]
    path = change(project)
    before = {p: p.read_bytes() for p in project.folder.rglob("*") if p.is_file()}
    with pytest.raises((InputError, TirError)) as refused:
        mffit.spin(path, project.folder / "out")
    sentence = str(refused.value)
    assert said in sentence
    assert "\n" not in sentence
    assert len(sentence.replace(str(project.folder), "")) < 450
    assert {p: p.read_bytes() for p in project.folder.rglob("*") if p.is_file()} == before
