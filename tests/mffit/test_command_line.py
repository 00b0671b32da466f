"""Every file that build, diagnose and spin write from the command line is read back."""

from __future__ import annotations

import io
import json
import os
import shlex
import subprocess
import sys
import tomllib
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from disc_project import Project, disc_project, rows

import tir
from mffit import config, pipeline
from mffit.cli import main
from mffit.errors import InputError
from mffit.points import read

ROOT = Path(__file__).parents[2]
PNG = b"\x89PNG\r\n\x1a\n"
ADDED = [
    "Fy_odd_N",
    "Fy_even_N",
    "Mz_odd_Nm",
    "Mz_even_Nm",
    "Fy_model_N",
    "Mz_model_Nm",
    "paired",
    "outlier",
    "doubtful",
    "file",
    "line",
    "sweep",
    "direction",
    "mount",
    "path_centre",
    "path_radius_m",
    "excluded",
]


def mffit(*arguments: object) -> int:
    try:
        main([str(argument) for argument in arguments])
    except SystemExit as end:
        return end.code if isinstance(end.code, int) else 1
    return 0


def disc(folder: Path) -> Project:
    """A build whose file is the fitted model itself, so that its model columns can be computed from it."""
    project = disc_project(folder)
    project.config["spin"] = {"exact": "turn-slip"}
    project.each(Mz_Nm=-1, Fy_N=-1, alpha_deg=-1)  # readings in axes other than those inside
    project.config["rig"]["axes"] = "sae"
    return project


@pytest.fixture(scope="module")
def printed(tmp_path_factory) -> tuple[Path, str, str]:
    """The folder of a build, and what the command printed to both streams."""
    folder, out, err = tmp_path_factory.mktemp("built"), io.StringIO(), io.StringIO()
    with redirect_stdout(out), redirect_stderr(err):
        assert mffit("build", disc(folder).write(), "--ensemble", 2) == 0
    return folder, out.getvalue(), err.getvalue()


@pytest.fixture(scope="module")
def built(printed) -> Path:
    return printed[0]


@pytest.fixture(scope="module")
def result(built):
    return json.loads((built / "out" / "result.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def tyre(built):
    return tir.read(built / "out" / "toy.tir")


@pytest.fixture(scope="module")
def points(built):
    return pd.read_csv(built / "out" / "points.csv")


def measured_rows(folder: Path) -> tuple[pd.DataFrame, np.ndarray]:
    """The rows of all sweeps in their order, and the direction of rolling of each."""
    entries = tomllib.loads((folder / "tyre.toml").read_text())["sweep"]
    tables = [pd.read_csv(folder / entry["file"]) for entry in entries]
    signs = [-1.0 if entry.get("direction") == "backward" else 1.0 for entry in entries]
    return pd.concat(tables, ignore_index=True), np.repeat(signs, [len(table) for table in tables])


def simulated(
    tyre: tir.Tyre, table: pd.DataFrame, direction: np.ndarray, result: dict
) -> tuple[np.ndarray, np.ndarray]:
    """Fy and Mz in the rig's SAE axes, with the rig errors that the build states."""
    zeros = dict.fromkeys(
        ("F0_N", "gamma_0_deg", "alpha_0_deg"), 0.0
    )  # as declared, unless the fit finds them
    rig = zeros | {name: entry["value"] for name, entry in result["fit"]["rig"].items()}
    assert set(rig) == {*zeros, "camber_skew_deg", "path_radius_m"}
    gamma = np.radians(table["gamma_deg"] + rig["gamma_0_deg"])
    alpha = np.radians(-table["alpha_deg"] + rig["alpha_0_deg"] + rig["camber_skew_deg"] * np.sin(gamma))
    forces = tyre(
        table["Fz_N"].to_numpy(),
        alpha.to_numpy(),
        gamma.to_numpy(),
        phi_t=-1 / rig["path_radius_m"],
        Vx=direction * table["V_mps"].to_numpy(),
        p=1e3 * table["p_kPa"].to_numpy(),
    )
    return -(forces.Fy + rig["F0_N"]), -forces.Mz


def test_the_file_holds_the_coefficients_of_the_json(tyre, result):
    coefficients = result["fit"]["coefficients"]
    assert {"PCY1", "PDY1", "PKY1", "PKY6", "QBZ1", "PECP1"} <= set(coefficients)
    assert {name: tyre[name] for name in coefficients} == {
        name: entry["value"] for name, entry in coefficients.items()
    }
    assert tyre["FNOMIN"] == 1500.0
    assert tyre["UNLOADED_RADIUS"] == 0.3
    assert tyre["NOMPRES"] == 250e3
    assert tyre.on_reading == ()


def test_the_json_has_the_keys_of_the_contract(result):
    assert {"tyre", "spin", "fit", "tir", "warnings"} <= set(result)
    assert result["tir"] == "toy.tir"
    assert result["tyre"]["name"] == "toy"
    spin = result["spin"]
    quantities = [
        "epsilon_gamma", "C_phit_Nm", "C_gamma_N_per_rad", "C_alpha_N_per_rad", "r_e_m", "R_m", "F_phit_N",
    ]  # fmt: skip
    for key in quantities:
        assert np.isfinite(spin[key]), key
        assert spin[f"u_{key}"] > 0.0, key
    assert {
        "epsilon_gamma_secant",
        "epsilon_gamma_slope",
        "epsilon_gamma_model",
        "epsilon_gamma_moment",
    } <= set(spin)
    assert np.hypot.reduce([row["contribution"] for row in spin["budget"]]) == pytest.approx(
        spin["u_epsilon_gamma"], rel=1e-6
    )
    assert [row["load_N"] for row in spin["per_load"]] == [1000.0, 1500.0]
    for entry in result["fit"]["coefficients"].values():
        assert {"value", "stderr", "stage", "fixed", "at_bound", "status"} <= set(entry)
        assert entry["stderr"] is None or not entry["fixed"]


def test_the_measured_quantities_in_the_file_are_those_of_the_json(tyre, result):
    for key in ("epsilon_gamma", "C_phit_Nm", "r_e_m", "F_phit_N"):
        assert tyre.measured[key].value == pytest.approx(result["spin"][key])
        assert tyre.measured[key].u == pytest.approx(result["spin"][f"u_{key}"])
    u = result["spin"]["u_epsilon_gamma"]
    assert result["fit"]["coefficients"]["PECP1"]["stderr"] == u
    assert tyre.status["PECP1"] == f"measured +- {u:.2g}"


def test_drawn_files_agree_with_their_index(built, tyre, result):
    index = pd.read_csv(built / "out" / "ensemble" / "index.csv")
    assert len(index) == 2
    for row in index.itertuples():
        drawn = tir.read(built / "out" / "ensemble" / row.file)
        assert drawn["PECP1"] == pytest.approx(row.epsilon_gamma)
        stated = result["fit"]["coefficients"]["PDY1"]
        assert 0.0 < abs(drawn["PDY1"] - tyre["PDY1"]) < 4.0 * stated["stderr"]
        small = drawn(drawn["FNOMIN"], alpha=1e-4).Fy - drawn(drawn["FNOMIN"], alpha=-1e-4).Fy
        assert small / 2e-4 == pytest.approx(row.C_alpha_N_per_rad, rel=1e-3)


def test_points_are_the_input_with_parts_and_model(built, points, result):
    given, _ = measured_rows(built)
    assert list(points.columns) == [*given.columns, *ADDED]
    pd.testing.assert_frame_equal(points[list(given.columns)], given, check_dtype=False)
    for name, unit in (("Fy", "N"), ("Mz", "Nm")):
        paired = points[points["paired"] != "unpaired"]
        np.testing.assert_allclose(
            paired[f"{name}_odd_{unit}"] + paired[f"{name}_even_{unit}"], paired[f"{name}_{unit}"], atol=1e-6
        )
        rmse = np.sqrt(np.mean((points[f"{name}_model_{unit}"] - points[f"{name}_{unit}"]) ** 2))
        assert result["fit"]["channels"][name]["rmse"] == pytest.approx(rmse, rel=1e-6)
        assert result["fit"]["channels"][name]["n"] == len(points)
    assert set(points["paired"]) <= {"exact", "interpolated", "unpaired"}
    # The toy's even part of the side force at rest is what the path does: 0.22 of the load, in SAE to the right.
    upright = points[(points["alpha_deg"] == 0.0) & (points["gamma_deg"] == 0.0) & (points["Fz_N"] == 1500.0)]
    assert upright["Fy_even_N"].mean() == pytest.approx(0.22 * 1500.0, abs=10.0)


def test_the_model_columns_are_computed_from_the_file(built, points, tyre, result):
    given, direction = measured_rows(built)
    Fy, Mz = simulated(tyre, given, direction, result)
    # The file is the fitted model to the last digit, so only rounding differs.
    np.testing.assert_allclose(points["Fy_model_N"], Fy, rtol=1e-9, atol=1e-6)
    np.testing.assert_allclose(points["Mz_model_Nm"], Mz, rtol=1e-9, atol=1e-6)


def test_the_resolved_configuration_reads_the_same_points(built):
    """What is built from it is compared in tests/mffit/fit/test_by_hand.py."""
    first, again = (config.load(path) for path in (built / "tyre.toml", built / "out" / "resolved.toml"))
    assert again.tyre == first.tyre
    assert again.rig == first.rig
    assert again.spin == first.spin
    one, other = (read(each).points for each in (first, again))
    pd.testing.assert_frame_equal(one.table, other.table)
    for name in ("alpha", "gamma", "Fz", "phi_t", "p", "V", "Fy", "Mz", "u_Fy", "u_Mz", "direction", "mount"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_pictures_and_page_are_there(built):
    pictures = sorted((built / "out" / "plots").iterdir())
    assert {"camber_reduction.png", "fit_Fy.png", "fit_Mz.png", "residuals.png"} <= {
        path.name for path in pictures
    }
    for path in pictures:
        content = path.read_bytes()
        assert content.startswith(PNG)
        assert content.rstrip().endswith(b"IEND\xaeB`\x82")
    page = (built / "out" / "report.html").read_text(encoding="utf-8")
    assert page.count('<div class="panels"') == page.count('<a class="data" download="') == len(pictures)


@pytest.fixture(scope="module")
def diagnosed(built):
    """The diagnosis of a model whose camber reduction factor is wrong by 0.3.

    The formula misses the toy tyre by more than noise, which no effect names: exit code 3.
    """
    given = tir.read(built / "out" / "toy.tir")
    given.replace(PECP1=given["PECP1"] + 0.3).write(built / "given.tir")
    assert mffit("diagnose", built / "tyre.toml", "--model", built / "given.tir") == 3
    folder = built / "out" / "diagnosis"
    return folder, json.loads((folder / "diagnosis.json").read_text(encoding="utf-8"))


def test_the_diagnosis_has_the_keys_of_the_contract(diagnosed):
    folder, content = diagnosed
    assert {
        "gap_before", "gap_after", "validation", "where", "effects", "alternatives", "unexplained",
        "unexplained_where", "noise_floor", "model_after",
    } <= set(content)  # fmt: skip
    assert "camber-reduction" in [effect["id"] for effect in content["effects"]]
    for effect in content["effects"]:
        assert 0.0 <= effect["confidence"] <= 1.0
        assert {"name", "kind", "parameters", "gap_after", "tied_with", "separate_by"} <= set(effect)
    assert {"method", "gap_before", "gap_after"} <= set(content["validation"])
    assert {"diagnosis.html", "diagnosis.json", "plots", content["model_after"]} <= {
        path.name for path in folder.iterdir()
    }
    assert all(path.read_bytes().startswith(PNG) for path in (folder / "plots").iterdir())


@pytest.mark.parametrize("when", ["before", "after"])
def test_the_gaps_are_those_of_the_given_and_of_the_written_model(built, diagnosed, result, when):
    folder, content = diagnosed
    model = tir.read(built / "given.tir" if when == "before" else folder / content["model_after"])
    assert all(effect["kind"] == "tyre" for effect in content["effects"])
    given, direction = measured_rows(built)
    Fy, Mz = simulated(model, given, direction, result)
    gap = content[f"gap_{when}"]
    assert gap["Fy_rmse_N"] == pytest.approx(np.sqrt(np.mean((Fy - given["Fy_N"]) ** 2)), rel=1e-6)
    assert gap["Mz_rmse_Nm"] == pytest.approx(np.sqrt(np.mean((Mz - given["Mz_Nm"]) ** 2)), rel=1e-6)


def test_the_corrected_model_holds_the_effects_numbers(diagnosed):
    folder, content = diagnosed
    model = tir.read(folder / content["model_after"])
    for effect in content["effects"]:
        for name, number in effect["parameters"].items():
            assert model[name] == pytest.approx(number["value"], rel=1e-12)


def test_a_diagnosis_does_not_change_the_build(built, diagnosed, tyre):
    assert tir.read(built / "out" / "toy.tir") == tyre


def test_spin_writes_the_spin_part_of_the_build(built, result, tmp_path, capsys):
    assert mffit("spin", built / "tyre.toml", "--out", tmp_path / "spin") == 0
    content = json.loads((tmp_path / "spin" / "spin.json").read_text(encoding="utf-8"))
    # what only the finished file can tell
    fitted = {"epsilon_gamma_model", "pecp1", "epsilon_gamma_debiased", "u_epsilon_gamma_debiased"}
    fitted |= {"u_epsilon_gamma", "u_epsilon_gamma_direct", "u_pecp2", "budget", "per_load", "expanded"}
    fitted |= {"made", "trusted", "reasons", "warnings"}  # in result.json beside the part
    fitted |= {"C_alpha_straight_N_per_rad", "u_C_alpha_straight_N_per_rad"}
    assert {k: v for k, v in content.items() if k not in fitted} == {
        k: v for k, v in result["spin"].items() if k not in fitted
    }
    # The bias of finite spin is that of the model in place of the usual one.
    spin = "finite spin of the disc"
    before, after = content["budget"], result["spin"]["budget"]
    for lines in (before, after):
        assert [line["source"] for line in lines].count(spin) == 1
    assert [x for x in before if x["source"] != spin] == [x for x in after if x["source"] != spin]
    assert content["C_alpha_straight_N_per_rad"] is None
    assert result["spin"]["C_alpha_straight_N_per_rad"] != content["C_alpha_N_per_rad"]
    for part, lines in ((content, before), (result["spin"], after)):
        assert part["u_epsilon_gamma"] == pytest.approx(
            np.sqrt(sum(x["contribution"] ** 2 for x in lines)), rel=1e-6
        )
    assert content["epsilon_gamma_model"] is None
    assert f"{abs(content['epsilon_gamma']):.3f}" in capsys.readouterr().out


@pytest.mark.parametrize("case", ["front-1", "rear-3"])
def test_spin_of_the_paper_tables_prints_no_nan(case, tmp_path, capsys):
    assert mffit("spin", ROOT / "samples" / "paper-tables" / case / "tyre.toml", "--out", tmp_path) == 0
    said = capsys.readouterr()
    assert "ply-steer cannot be separated here" in " ".join(said.out.split())
    assert "nan" not in (said.out + said.err).lower()


def test_build_prints_one_screen_and_everything_on_request(printed, result, capsys, monkeypatch):
    """What is explained is read where it is of these settings, and built where it is not."""

    def building(*_, **__):
        raise InputError("it is built")

    monkeypatch.setattr(pipeline, "build", building)
    folder, said, warned = printed
    lines = [*said.splitlines(), *warned.splitlines()]
    assert len(lines) <= 30  # with three warnings, none of which is cut
    assert lines[0].startswith("toy.tir is ")
    assert f"written to {folder / 'out'}: report.html, result.json, points.csv, plots" in said
    assert "toy-normal.tir: for simulators without turn slip" in said
    said_of_road = " ".join(said.split())
    assert said_of_road.index("road, 1500 N") < said_of_road.index("written to")
    assert "toy-normal.tir misses the road by" in said_of_road
    assert "or the other side of the disc" in said_of_road
    assert mffit("build", folder / "tyre.toml", "--ensemble", 2, "--explain") == 0
    whole = capsys.readouterr()
    assert "Tested: " in whole.out
    assert "Tested: " not in said
    assert all(f"warning: {sentence}" in whole.err for sentence in result["warnings"])
    assert mffit("build", folder / "tyre.toml", "--ensemble", 3, "--explain") == 2
    assert "it is built" in capsys.readouterr().err


def next_lines(said: str) -> list[list[str]]:
    """The commands that a text ends with, as a shell splits them."""
    return [shlex.split(line, comments=True) for line in said.partition("Next:\n")[2].splitlines()]


def test_what_a_build_says_to_do_next_does_it(tmp_path, capsys, monkeypatch):
    """Each line as it is printed, also with a folder of its own; what is explained is read, not built again.

    The readings contradict the number that is set, so the build is in doubt and diagnose is among the lines.
    """
    project, out = disc(tmp_path / "my rig").write(), tmp_path / "an other"
    assert mffit("build", project, "--out", out, "--set", "PDY1=1.0", "--no-report") == 0
    following = next_lines(capsys.readouterr().out)
    assert [words[:2] for words in following] == [["mffit", "diagnose"], ["mffit", "build"]]
    assert mffit(*following[0][1:]) == 0
    assert "gap, rms" in capsys.readouterr().out
    before = (out / "result.json").read_bytes()
    monkeypatch.setattr(pipeline, "build", None)
    assert mffit(*following[1][1:]) == 0
    assert "Tested: " in capsys.readouterr().out
    assert (out / "result.json").read_bytes() == before


def test_spin_on_a_flat_track_explains_why_there_is_no_factor(tmp_path, capsys):
    project = disc_project(tmp_path / "rig")
    project.config |= {"rig": {"type": "flat-track", "axes": "iso"}, "rolling_radius": [], "sweep": []}
    project.tables = {}
    angles = np.arange(-8.0, 9.0)
    project.add("sideslip.csv", rows(angles, 0.0, side=0.0))
    project.add("camber.csv", rows(0.0, 4 * angles, side=0.0))
    assert mffit("spin", project.write(), "--out", tmp_path / "out") == 0
    said = capsys.readouterr()
    assert "straight" in said.out
    assert "warning" not in said.out or said.err


def shell(*arguments: object, **keys) -> subprocess.CompletedProcess:
    """The program in a separate process."""
    command = [sys.executable, "-m", "mffit", *map(str, arguments)]
    return subprocess.run(
        command, env=os.environ | {"PYTHONPATH": str(ROOT)}, check=False, timeout=600, **keys
    )


def test_a_process_ends_with_2_on_bad_input_and_writes_nothing(tmp_path):
    ended = shell("build", tmp_path / "nowhere.toml", capture_output=True, text=True)
    assert ended.returncode == 2
    assert ended.stdout == ""
    assert ended.stderr.startswith("mffit: ")
    assert ended.stderr.count("\n") == 1
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(("arguments", "code"), [(["check", "good.tir"], 0), (["check", "bad.tir"], 2)])
def test_a_closed_pipe_is_not_an_error(arguments, code, tmp_path):
    text = (ROOT / "samples" / "front-120-70" / "true.tir").read_text()
    (tmp_path / "good.tir").write_text(text)
    tir.read(tmp_path / "good.tir").replace(PCY1=-1.3).write(tmp_path / "bad.tir")
    read, write = os.pipe()
    os.close(read)
    try:
        ended = shell(*arguments, stdout=write, stderr=subprocess.PIPE, cwd=tmp_path)
    finally:
        os.close(write)
    assert ended.stderr == b""
    assert ended.returncode == code
