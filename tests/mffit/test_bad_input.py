"""On bad input, every command exits with 2 and one sentence with place and remedy, and writes nothing."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from disc_project import CAMBER, Project, rows

import mffit
import tir
from mffit.cli import main
from mffit.errors import InputError

SWEEP = "sideslip_1500.csv"


def run(capsys, *arguments: object) -> tuple[int, str]:
    """Exit code and stderr."""
    try:
        main([str(argument) for argument in arguments])
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 1
    return code, capsys.readouterr().err


def snapshot(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def assert_refused(capsys, project: Project, path: Path, said: str, command: str = "build") -> None:
    """The command exits with 2 and one sentence; a folder with earlier output is unchanged."""
    out = project.folder / "out"
    out.mkdir(exist_ok=True)
    (out / "result.json").write_text("earlier")
    before = snapshot(project.folder)
    code, err = run(capsys, command, path, "--out", out)
    assert code == 2, err
    assert re.fullmatch(r"mffit: [^\n]+\n", err), err
    assert "Traceback" not in err
    assert said in err, err
    assert len(err) < 700
    assert snapshot(project.folder) == before


def edit(line: int, old: str, new: str):
    def change(project: Project) -> Path:
        path = project.write()
        lines = project.text(SWEEP).split("\n")
        assert old in lines[line - 1]
        lines[line - 1] = lines[line - 1].replace(old, new, 1)
        project.overwrite(SWEEP, "\n".join(lines))
        return path

    return change


def content(text: str | bytes):
    def change(project: Project) -> Path:
        path = project.write()
        project.overwrite(SWEEP, text)
        return path

    return change


def setting(table: str, key: str, value: object):
    def change(project: Project) -> Path:
        project.config[table][key] = value
        return project.write()

    return change


def scaled(**factors: float):
    def change(project: Project) -> Path:
        project.each(**factors)
        return project.write()

    return change


def without_file(project: Project) -> Path:
    path = project.write()
    (project.folder / SWEEP).unlink()
    return path


def without_column(project: Project) -> Path:
    project.tables[SWEEP] = project.tables[SWEEP].rename(columns={"Fy_N": "Fy"})
    return project.write()


def in_radians(project: Project) -> Path:
    for table in project.tables.values():
        table["alpha_deg"] = np.radians(table["alpha_deg"])
    return project.write()


def one_sign(column: str):
    def change(project: Project) -> Path:
        for name, table in project.tables.items():
            project.tables[name] = table[table[column] >= 0.0]
        return project.write()

    return change


def without_zero(project: Project) -> Path:
    for name, table in project.tables.items():
        project.tables[name] = table[(table["alpha_deg"].abs() > 0.4) | (table["gamma_deg"].abs() > 1.0)]
    return project.write()


def inward(project: Project) -> Path:
    """A force at (0, 0) towards the centre, which only a wrong path centre gives."""
    for table in project.tables.values():
        table["Fy_N"] += 2.0 * 0.22 * table["Fz_N"]
    return project.write()


def base(text: str):
    def change(project: Project) -> Path:
        project.config["tyre"]["base"] = "base.tir"
        path = project.write()
        (project.folder / "base.tir").write_text(text)
        return path

    return change


WHOLE_TIR = tir.Tyre.from_values({"FNOMIN": 1500.0, "PKY1": -12.0}).text()

CASES = {
    "missing file": (without_file, "there is no file"),
    "missing column": (without_column, "column Fy_N"),
    "unknown key": (setting("tyre", "unloded_radius", 0.3), 'did you mean "unloaded_radius"'),
    "wrong unit in a cell": (edit(4, "1500.0", "1.5 kN"), ":4: column Fz_N"),
    "text in a number": (edit(4, "1500.0", "heavy"), ":4: column Fz_N"),
    "NaN": (edit(5, "1500.0", "nan"), ":5: column Fz_N"),
    "infinity": (edit(5, "1500.0", "-inf"), ":5: column Fz_N"),
    "empty file": (content(""), "is empty"),
    "header only": (content("alpha_deg,gamma_deg,Fz_N,Fy_N\n"), "no data"),
    "ragged rows": (content("alpha_deg,gamma_deg,Fz_N,Fy_N\n0,0,1500\n"), ":2: has 3 cells"),
    "duplicate headings": (content("alpha_deg,alpha_deg,Fz_N,Fy_N\n0,0,1500,1\n"), "twice"),
    "UTF-16": (content("alpha_deg,gamma_deg\n".encode("utf-16")), "no data"),
    "binary": (content(b"\0\1\2alpha_deg,gamma_deg\n"), "binary"),
    "semicolons": (content("alpha_deg;gamma_deg;Fz_N;Fy_N\n0,1;0;1500;eins\n"), ":2: column Fy_N"),
    "radians": (in_radians, "it looks like its sideslip in rad"),
    "zero load": (edit(3, "1500.0", "0.0"), ":3: column Fz_N: the load is zero"),
    "loads of mixed sign": (edit(3, "1500.0", "-1500.0"), ":3: column Fz_N"),
    "loads in kN": (scaled(Fz_N=1e-3), "kN"),
    "side force in kN": (scaled(Fy_N=1e-3), "kN"),
    "wrong axes": (setting("rig", "axes", "adapted-sae"), 'agree with axes = "iso"'),
    "wrong axes, SAE": (setting("rig", "axes", "sae"), 'agree with axes = "iso"'),
    "wrong path centre": (setting("rig", "path_centre", "right"), 'agree with path_centre = "left"'),
    "turn-slip force inwards": (inward, "path_centre"),
    "R in millimetres": (setting("rig", "path_radius", 1323.0), "rig.path_radius"),
    "R of a wheel": (setting("rig", "path_radius", 0.05), "rig.path_radius"),
    "r_e of a diameter": (
        setting("rolling_radius", 0, {"effective_radius": 0.59, "u_effective_radius": 0.001}),
        "rolling_radius",
    ),
    "missing base file": (setting("tyre", "base", "nowhere.tir"), "nowhere.tir"),
    "base file of version 5.2": (base("[MODEL]\nFITTYP = 6\n[VERTICAL]\nFNOMIN = 1500\n"), "base.tir"),
    "base file that is none": (base("to whom it may concern\n"), "base.tir"),
    "truncated base file": (base(WHOLE_TIR[: len(WHOLE_TIR) // 2]), "base.tir"),
    "only one sign of alpha": (one_sign("alpha_deg"), "column alpha_deg"),
    "only one sign of gamma": (one_sign("gamma_deg"), "column gamma_deg"),
    "no point at (0, 0)": (without_zero, "no forward point"),
}


@pytest.mark.parametrize("case", CASES)
def test_build_refuses(project, capsys, case):
    change, said = CASES[case]
    assert_refused(capsys, project, change(project), said)


@pytest.mark.parametrize("command", ["spin", "diagnose"])
@pytest.mark.parametrize("case", ["missing file", "unknown key", "wrong axes", "NaN"])
def test_the_other_commands_refuse_in_the_same_way(project, capsys, command, case):
    change, said = CASES[case]
    assert_refused(capsys, project, change(project), said, command)


def test_align_refuses_in_the_same_way(project, capsys):
    path = CASES["NaN"][0](project)
    code, err = run(capsys, "align", path)
    assert code == 2
    assert ":5: column Fz_N" in err
    code, err = run(capsys, "align", project.folder / SWEEP, "--axes", "iso", "--path-centre", "left")
    assert code == 2
    assert ":5: column Fz_N" in err


@pytest.mark.parametrize("options", [(), ("--axes", "iso", "--path-centre", "left")])
def test_align_says_that_a_mistyped_file_is_missing_before_it_asks_for_axes(project, capsys, options):
    project.write()
    code, err = run(capsys, "align", project.folder / "tyre.tml", *options)
    assert code == 2
    assert err == f"mffit: {project.folder / 'tyre.tml'}: there is no such file; correct its name\n"


def test_a_csv_file_needs_the_axes_option(project, capsys):
    project.write()
    code, err = run(capsys, "align", project.folder / SWEEP)
    assert code == 2
    assert "--axes" in err


def test_no_output_folder_is_created(project, capsys, tmp_path):
    path = CASES["wrong axes"][0](project)
    code, _ = run(capsys, "build", path, "--out", tmp_path / "fresh")
    assert code == 2
    assert not (tmp_path / "fresh").exists()


@pytest.mark.parametrize("arguments", [["build"], ["bild", "x"], ["build", "x", "--uot", "y"]])
def test_bad_usage_exits_with_2(capsys, arguments):
    code, err = run(capsys, *arguments)
    assert code == 2
    assert "Traceback" not in err


def single_load(project: Project) -> None:
    project.keep(*(name for name in project.tables if "1500" in name))


def short_camber(project: Project) -> None:
    """Too short for the secant at 15 deg."""
    project.config["camber_stiffness"] = {"method": "secant"}
    for Fz in (1000.0, 1500.0):
        project.tables[f"camber_{Fz:.0f}.csv"] = rows(0.0, CAMBER[np.abs(CAMBER) <= 10.0], Fz)


def without_moment(project: Project) -> None:
    for table in project.tables.values():
        del table["Mz_Nm"]


def forwards_only(project: Project) -> None:
    project.keep(*(name for name in project.tables if "backward" not in name))


def unpaired(project: Project) -> None:
    table = project.tables[SWEEP]
    project.tables[SWEEP] = table[table["alpha_deg"] != -8.0]


@pytest.mark.parametrize("thin", [single_load, short_camber, without_moment, forwards_only, unpaired])
def test_thin_data_give_a_warning_and_a_result(project, capsys, thin):
    thin(project)
    code, err = run(capsys, "spin", project.write())
    assert code == 0, err
    assert (project.folder / "out" / "spin.json").is_file()


def test_the_undamaged_project_is_fine(project, capsys):
    code, err = run(capsys, "spin", project.write())
    assert code == 0, err


def test_an_uncertainty_of_zero_in_one_row_gives_a_warning(project, capsys):
    """Averaging the forces at zero once divided by it."""
    project.add(
        "zeros.csv", rows(np.linspace(-1.0, 1.0, 9), 0.0).assign(u_Fy_N=[6.0] * 4 + [0.0] + [6.0] * 4)
    )
    code, err = run(capsys, "spin", project.write())
    assert code == 0, err
    assert "zeros.csv:6: column u_Fy_N: 0 is not above zero; treated as not stated" in err


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({}, "does not say the rig's axes"),
        ({"axes": "iso"}, "does not say the rig's path_centre"),
        ({"axes": "iso", "path_centre": "up"}, 'path_centre = "up" is not known'),
    ],
)
def test_align_of_a_csv_file_names_the_missing_option(project, options, said):
    project.write()
    with pytest.raises(InputError, match=said):
        mffit.align(project.folder / SWEEP, **options)
