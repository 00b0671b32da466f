"""Empty, constant, missing, zero and huge input: a result or one sentence from every command, never a library's warning."""

from __future__ import annotations

import re
import warnings
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from mffit.cli import commands, main
from mffit.export import constants

SAMPLES = Path(__file__).parents[2] / "samples"
TRUE = SAMPLES / "front-120-70" / "true.tir"
TABLE = pd.read_csv(SAMPLES / "front-120-70" / "sideslip_1400N.csv").assign(Mx_Nm=5.0, kappa=0.0)
TYRE = ["--unloaded-radius", "0.3", "--nominal-load", "1400", "--nominal-pressure", "250"]
TABLES = {
    "empty": TABLE[:0],
    "one row": TABLE[:1],
    "constant": pd.concat([TABLE[3:4]] * 20),
    "no force": TABLE.assign(Fy_N=0.0),
    "no moment, slip and temperature": TABLE.assign(Mx_Nm=0.0, kappa=np.nan, T_degC=np.nan),
    "one gap": TABLE.assign(Fy_N=TABLE.Fy_N.where(TABLE.index != 5)),
    "no load": TABLE.assign(Fz_N=0.0),
    "standstill": TABLE.assign(V_mps=0.0),
    "standstill once": TABLE.assign(V_mps=TABLE.V_mps.where(TABLE.index != 5, 0.0)),
    "recording at standstill": TABLE.assign(V_mps=0.0, time_s=0.1 * TABLE.index),
    "huge force": TABLE.assign(Fy_N=1e300),
}
COEFFICIENTS = [
    name
    for name in re.findall(r"^([PQRSL][A-Z]+\d*)\s*=", TRUE.read_text(encoding="utf-8"), re.MULTILINE)
    if name != "LENGTH"
]
FORCES = [name for name in COEFFICIENTS if not name.startswith("L")]
FILES = {
    "no coefficients": dict.fromkeys(FORCES, 0.0),
    "no scaling": dict.fromkeys(COEFFICIENTS, 0.0),
    "no stiffness": dict.fromkeys(("PKY1", "PKX1", "PKY4"), 0.0),
    "no friction": dict.fromkeys(("PDY1", "PDX1"), 0.0),
    "no shape": dict.fromkeys(("PCY1", "PCX1", "QCZ1"), 0.0),
    "no nominal load": {"FNOMIN": 0.0},
    "negative nominal load": {"FNOMIN": -1400.0},
    "no speed": {"LONGVL": 0.0},
    "no pressure": {"NOMPRES": 0.0, "INFLPRES": 0.0},
    "no radius": {"UNLOADED_RADIUS": 0.0},
    "no spring": {"VERTICAL_STIFFNESS": 0.0},
    "no ranges": dict.fromkeys(
        ("FZMIN", "FZMAX", "ALPMIN", "ALPMAX", "KPUMIN", "KPUMAX", "CAMMIN", "CAMMAX"), 0.0
    ),
    "ranges reversed": {"FZMIN": 9000.0, "FZMAX": 100.0},
    "large": dict.fromkeys(COEFFICIENTS, 1e10),
    "huge": {"PDY1": 1e300},
    "huge load": {"FNOMIN": 1e300},
    "tiny": {"FNOMIN": 1e-30, "NOMPRES": 1e-30},
    "no number": {"PDY1": np.nan},
    "nothing": None,
}
OF_FILES = {
    "check": ("check", "{}"),
    "show": ("show", "{}", "--out", "{}.html"),
    "compare": ("compare", "{}", TRUE, "--out", "{}.compared"),
    "convert": ("convert", "{}", "--to", "mf52", "--out", "{}.old.tir"),
    "convert back": ("convert", "{}.old.tir", "--out", "{}.new.tir"),
    "export c": ("export", "c", "{}", "--out", "{}-c"),
    "export matlab": ("export", "matlab", "{}", "--out", "{}-matlab"),
    "export table": ("export", "table", "{}", "--for", "csv", "--error", "90", "--out", "{}.table"),
}
OF_PROJECTS = {
    "build": ("build", "{}", "--no-report"),
    "spin": ("spin", "{}"),
    "plan": ("plan", "{}", "--runs", "1"),
    "watch": ("watch", "{}", "--once"),
    "diagnose": ("diagnose", "{}", "--model", TRUE),
    "show": ("show", "{}", "--out", "{}.html"),
    "compare": ("compare", TRUE, "{}", "--out", "{}.compared"),
    "export tydex": ("export", "tydex", "{}", "--out", "{}.tydex"),
    "sniff": ("sniff", "a.csv"),
    "init": ("init", "--from", "a.csv", "p", *TYRE),
    "align": ("align", "a.csv", "--axes", "iso", "--path-centre", "left"),
}
PROJECT = """[tyre]
name = "x"
unloaded_radius = 0.2992
nominal_load = 1400
nominal_pressure = 250
[rig]
type = "rotating-disk"
path_centre = "left"
path_radius = 1.323
[[rolling_radius]]
load_N = 1400
effective_radius = 0.2924
u_effective_radius = 0.0005
[[sweep]]
file = "a.csv"
"""


def run(*arguments: object) -> int:
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # libraries replace the filters of pytest when they are imported
        try:
            main([str(argument) for argument in arguments])
        except SystemExit as end:
            return int(end.code or 0)
    return 0


def all_run(table, file: Path) -> dict[str, int]:
    """Exit codes by the name of the command line; what reads the output of another one is left out where there is none."""
    found = {}
    for name, words in table.items():
        line = [str(word).replace("{}", str(file)) for word in words]
        if not line[1].startswith(str(file)) or Path(line[1]).exists():
            found[name] = run(*line)
    return found


@pytest.mark.parametrize("kind", TABLES)
def test_no_command_lets_a_warning_through_about_readings(tmp_path, monkeypatch, kind):
    monkeypatch.chdir(tmp_path)
    TABLES[kind].to_csv("a.csv", index=False)
    Path("tyre.toml").write_text(PROJECT, encoding="utf-8")
    found = all_run(OF_PROJECTS, tmp_path / "tyre.toml")
    assert found.keys() == OF_PROJECTS.keys()
    assert set(found.values()) <= {0, 2, 3}
    assert (found["build"] == 2) == (
        kind
        in (
            "empty",
            "one row",
            "constant",
            "no force",
            "one gap",
            "no load",
            "standstill",
            "recording at standstill",
            "huge force",
        )
    )


@pytest.mark.parametrize("kind", FILES)
def test_no_command_lets_a_warning_through_about_coefficients(tmp_path, monkeypatch, kind):
    monkeypatch.setattr(constants, "TABLE_TRIES", 1)  # no table of such a file is near enough
    text = TRUE.read_text(encoding="utf-8")
    for name, value in (FILES[kind] or {}).items():
        text, count = re.subn(rf"^({name}\s*=\s*)\S+", rf"\g<1>{value}", text, flags=re.MULTILINE)
        assert count == 1, name
    (tmp_path / "a.tir").write_text("" if FILES[kind] is None else text, encoding="utf-8")
    found = all_run(OF_FILES, tmp_path / "a.tir")
    assert set(found.values()) <= {0, 2, 3}
    assert not list(tmp_path.glob("*.tmp*"))


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("built")
    TABLE.drop(columns=["Mx_Nm", "kappa"]).to_csv(folder / "a.csv", index=False)
    (folder / "tyre.toml").write_text(PROJECT, encoding="utf-8")
    assert run("build", folder / "tyre.toml", "--no-report") in (0, 3)
    return folder / "out"


@pytest.mark.parametrize("kind", TABLES)
def test_no_prediction_and_no_fleet_lets_a_warning_through(built, tmp_path, kind):
    TABLES[kind].drop(columns="Fy_N").to_csv(tmp_path / "c.csv", index=False)
    assert run("predict", built, tmp_path / "c.csv", "--out", tmp_path / "f.csv") in (0, 2)
    assert run("fleet", tmp_path) == run("fleet", built, built) == 2


@pytest.mark.parametrize(
    ("conditions", "loads"),
    [("", "[1400]"), ("V_mps = 0.0", "[1400]"), ("V_mps = 1e-9", "[1400]"), ("", "[0]"), ("", "[1e300]")],
)
def test_no_simulation_lets_a_warning_through(tmp_path, conditions, loads):
    rig = (
        PROJECT.split("[[rolling_radius]]", maxsplit=1)[0]
        + f"""[truth]
tyre = "{TRUE.as_posix()}"
[conditions]
{conditions}
[[sweep]]
file = "a.csv"
alpha_deg = [0.0]
load_N = {loads}
"""
    )
    (tmp_path / "rig.toml").write_text(rig, encoding="utf-8")
    found = run("simulate", tmp_path / "rig.toml", "--out", tmp_path / "out")
    assert found == (0 if (conditions, loads) == ("", "[1400]") else 2)


def test_every_command_is_asked():
    """The window of ``open`` asks what the others do."""
    tried = {words[0] for table in (OF_FILES, OF_PROJECTS) for words in table.values()}
    assert tried | {"predict", "fleet", "simulate", "open"} == set(commands.commands)
