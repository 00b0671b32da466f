"""Lookup tables, read by other programs and compared with the tyre off their nodes."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from scipy.interpolate import interpn
from scipy.io import loadmat, savemat

import tir
from mffit.cli import main
from mffit.export import constants, write_table
from mffit.export.grid import grid_of

SAMPLES = Path(__file__).parents[3] / "samples"
CAR = SAMPLES / "flat-track-combined/true.tir"
MOTORCYCLE = SAMPLES / "front-120-70/true.tir"
NARROW = {"Fz_N": (1000.0, 3000.0), "alpha_deg": (-8.0, 8.0), "gamma_deg": (-3.0, 5.0), "kappa": (-0.2, 0.2)}
"""So that a test takes seconds; camber is not symmetric, so that a wrong order of axes shows."""
OPTIONS = [x for name, (low, high) in NARROW.items() for x in ("--range", f"{name}={low:g}:{high:g}")]


def conditions(axes: dict[str, np.ndarray], n: int = 3000) -> dict[str, np.ndarray]:
    random = np.random.default_rng(7)
    return {name: random.uniform(x.min(), x.max(), n) for name, x in axes.items()}


def force(tyre: tir.Tyre, channel: str, at: dict[str, np.ndarray], turn_slip: bool) -> np.ndarray:
    angles = {name: np.deg2rad(at.get(f"{name}_deg", 0.0)) for name in ("alpha", "gamma")}
    return getattr(tyre(at["Fz_N"], **angles, kappa=at.get("kappa", 0.0), turn_slip=turn_slip), channel)


def misses(table: np.ndarray, exact: np.ndarray, largest: float) -> float:
    """Its largest miss over the largest force that the command states, which the conditions must not exceed."""
    assert np.abs(exact).max() <= 1.002 * largest
    assert np.abs(exact).max() > 0.7 * largest
    return float(np.abs(table - exact).max()) / largest


def stated(tables: list[dict], name: str) -> tuple[float, float]:
    """Error and largest force."""
    one = next(table for table in tables if table["name"] == name)
    return one["error"], next(value for key, value in one.items() if key.startswith("largest_"))


def export(capsys, *arguments: str) -> dict:
    main(["export", "table", *arguments, "--json"])
    return json.loads(capsys.readouterr().out)


def test_a_csv_table_interpolated_by_pandas_and_scipy_is_the_tyre(tmp_path, capsys):
    said = export(capsys, str(CAR), "--for", "csv", "--out", str(tmp_path), *OPTIONS)
    tyre = tir.read(CAR)
    assert len(said["written"]) == len(said["tables"]) == 8
    for path in map(Path, said["written"]):
        text = path.read_text(encoding="utf-8")
        name = path.stem.removeprefix("true-").replace("-", "_")
        channel = name.split("_")[0]
        table = pd.read_csv(path, comment="#")
        *names, heading = table.columns
        assert heading.startswith(channel)
        if name.endswith("combined"):
            assert names == list(NARROW)
        axes = {key: np.unique(table[key]) for key in names}
        for key, x in axes.items():
            assert (x[0], x[-1]) == NARROW[key]
            assert 0.0 in x or key == "Fz_N"
        values = table.sort_values(names)[heading].to_numpy().reshape([len(x) for x in axes.values()])
        at = conditions(axes)
        found = interpn(list(axes.values()), values, np.stack(list(at.values()), axis=1))
        error, largest = stated(said["tables"], name)
        off = misses(found, force(tyre, channel, at, False), largest)
        assert 0.0 < off <= error * 1.02 <= 0.005
        assert f"misses {100 * error:.2f} % of the largest {heading}" in text
        assert "turn slip off" in text
        assert f"{float(tyre['INFLPRES']) / 1000:g} kPa;" in text


def test_a_mat_file_is_the_tyre_in_octave(tmp_path, capsys):
    options = [*OPTIONS, "--range", "gamma_deg=-20:40"]
    said = export(capsys, str(MOTORCYCLE), "--for", "mat", "--out", str(tmp_path), *options)
    file, tyre = Path(said["written"][0]), tir.read(MOTORCYCLE)
    assert said["turn_slip"]
    content = loadmat(file, simplify_cells=True)
    assert "turn slip on" in content["about"]
    asked, exact = {}, {}
    for one in said["tables"]:
        name = one["name"]
        heading = next(key for key in content[name] if key[:2] == name[:2])
        axes = {key: content[name][key] for key in one["axes"]}
        assert content[name][heading].shape == tuple(len(x) for x in axes.values())
        at = conditions(axes, 500)
        asked[name] = {"at": np.stack(list(at.values()), axis=1), "axes": list(axes), "values": heading}
        exact[name] = force(tyre, name[:2], at, True)
        found = interpn(list(axes.values()), content[name][heading], asked[name]["at"])
        error, largest = stated(said["tables"], name)
        assert np.abs(found - exact[name]).max() <= 1.02 * error * largest <= 0.005 * largest
    if shutil.which("octave") is None:
        pytest.skip("GNU Octave is not installed")
    savemat(tmp_path / "asked.mat", {"asked": asked})
    script = f"""
        t = load('{file.name}'); load('asked.mat'); r = struct();
        for name = fieldnames(asked)'
          n = name{{1}}; q = asked.(n); x = cellfun(@(a) t.(n).(strtrim(a)), cellstr(q.axes), 'UniformOutput', false);
          p = num2cell(q.at, 1);
          r.(n) = interpn(x{{:}}, t.(n).(strtrim(q.values)), p{{:}});
        end
        save('-v7', 'octave.mat', 'r');
    """
    subprocess.run(["octave", "-qf", "--eval", script], cwd=tmp_path, check=True, timeout=120)
    for name, found in loadmat(tmp_path / "octave.mat", simplify_cells=True)["r"].items():
        error, largest = stated(said["tables"], name)
        assert np.abs(found - exact[name]).max() <= 1.02 * error * largest


def test_a_parabola_has_the_nodes_that_theory_says():
    """The chord over a step h of x^2 misses h^2/4, so 2/(2 sqrt(goal)) steps from -1 to 1 suffice."""
    goal = 0.01
    grid = grid_of(lambda x, y: x**2 + 0.0 * y, {"x": (-1.0, 1.0), "y": (0.0, 5.0)}, goal)
    assert list(grid.axes) == ["x"]
    assert 11 <= len(grid.axes["x"]) <= 13
    assert grid.held == {"y": 0.0}
    assert 0.6 * goal < grid.error <= goal


def test_too_many_nodes_are_refused_with_the_error_reached(tmp_path, monkeypatch):
    monkeypatch.setattr(constants, "TABLE_NODES", 60)
    made = write_table(CAR, tmp_path, form="csv", ranges=NARROW)
    assert all(10 < one.grid.values.size <= 60 for one in made.tables)
    poor = [one for one in made.tables if one.grid.error > 0.005]
    assert len(poor) > 3
    for one, sentence in zip(poor, made.warnings, strict=True):
        assert (
            f"{one.name} misses {100 * one.grid.error:.3g} % instead of 0.5 %, as a table has at most 60 nodes"
            in sentence
        )
        assert "--range alpha_deg=-12:12" in sentence


@pytest.mark.parametrize(
    ("options", "sentence"),
    [
        (["--for", "excel"], "excel"),
        (
            ["--for", "csv", "--range", "beta=1:2"],
            "no such condition, only Fz_N, alpha_deg, gamma_deg, kappa",
        ),
        (["--for", "csv", "--range", "alpha_deg=5"], "is not NAME=LOW:HIGH"),
        (
            ["--for", "csv", "--range", "alpha_deg=-40:40"],
            "is not a range within -20.0535:20.0535 of the file",
        ),
        (["--for", "csv", "--error", "0"], "is not between 0 and 100 %"),
        (["--for", "carsim"], "carsim"),
    ],
)
def test_a_mistake_is_one_sentence_and_no_file(tmp_path, capsys, options, sentence):
    with pytest.raises(SystemExit) as ended:
        main(["export", "table", str(CAR), "--out", str(tmp_path / "out"), *options])
    assert ended.value.code == 2
    assert sentence in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_tyre_without_a_force_gets_no_table_of_it_and_an_estimated_one_is_named(tmp_path, capsys):
    values = {"FNOMIN": 1500.0, "UNLOADED_RADIUS": 0.3, "FZMAX": 3000.0, "PKX1": 0.0, "PDX1": 0.0}
    guessed = {"PKX1": "estimate, not measured"}
    tir.Tyre.from_values(values).annotate(status=guessed).write(tmp_path / "a.tir")
    main(
        ["export", "table", str(tmp_path / "a.tir"), "--for", "csv", "--out", str(tmp_path / "out"), *OPTIONS]
    )
    said = capsys.readouterr()
    assert "Fx does not depend on Fz_N, gamma_deg, kappa: no table" in said.err
    table = (tmp_path / "out/a-Fy.csv").read_text()
    assert "Fy_N" in table
    assert "Fx is estimated" in table.splitlines()[0]
    assert not (tmp_path / "out/a-Fx.csv").exists()


def test_the_slope_at_zero_slip_and_the_lowest_load_are_stated(tmp_path):
    """By interpolation of the written table around zero slip, against the stiffness of the tyre."""
    found = write_table(CAR, tmp_path, form="csv", ranges={k: x for k, x in NARROW.items() if k != "Fz_N"})
    tyre = tir.read(CAR)
    for name, slip, state in (("Fy", "alpha_deg", "K_ya"), ("Fx", "kappa", "K_xk")):
        (table,) = (one for one in found.tables if one.name == name)
        axes, (off, load) = table.grid.axes, table.slope
        assert axes["Fz_N"][0] == 0.0
        assert f"off by up to {100.0 * off:.1f} %, at {load:.0f} N" in table.sentence
        ends = np.zeros((2, len(axes)))
        ends[:, 0], ends[1, [*axes].index(slip)] = load, 1e-3 * axes[slip].max()
        both = []
        for side in (1.0, -1.0):
            ends[1, [*axes].index(slip)] *= side
            low, high = interpn([*axes.values()], table.grid.values, ends)
            both.append((high - low) / ends[1, [*axes].index(slip)])
        scale = 180.0 / np.pi if slip == "alpha_deg" else 1.0
        wanted = float(getattr(tyre.state(load), state)) / scale
        assert off == pytest.approx(max(abs(slope / wanted - 1.0) for slope in both), abs=2e-3)


def test_a_table_has_the_switches_of_a_call(tmp_path):
    """With ``star`` the formula takes the tangent of the sideslip: 0.5 % more slip at 7 deg."""
    ranges = {"Fz_N": (3000.0, 3000.0), "alpha_deg": (0.0, 7.0), "gamma_deg": (0.0, 0.0), "kappa": (0.0, 0.0)}
    made = write_table(CAR, tmp_path, form="csv", ranges=ranges, star=True)
    Fy = next(one.grid for one in made.tables if one.name == "Fy")
    exact = tir.read(CAR)(3000.0, np.radians(Fy.axes["alpha_deg"]), star=True).Fy
    plain = tir.read(CAR)(3000.0, np.tan(np.radians(Fy.axes["alpha_deg"]))).Fy
    assert Fy.values == pytest.approx(exact, abs=0.01)
    assert exact == pytest.approx(plain, abs=1e-6)
    assert "tan(alpha)" in next(path for path in made.written if path.stem.endswith("-Fy")).read_text()
