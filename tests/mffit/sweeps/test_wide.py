"""Tables with the load in the names of their columns, and channels with one value for all rows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import scipy.io

from mffit import config as configuration
from mffit import sweeps
from mffit.errors import InputError
from mffit.pipeline import init_from
from mffit.recordings import sniff
from mffit.sweeps import formats
from mffit.sweeps.wide import LOAD_HEADING, RUN, stacked

LOADS = (400.0, 800.0, 1600.0)
GIVEN = {"unloaded_radius": 0.3, "nominal_load": 800.0, "nominal_pressure": 200.0}


def sweep(load: float, n: int = 33) -> dict[str, np.ndarray]:
    """Sideslip [deg], side force [N] and moment [Nm] in ISO signs; friction falls with the load."""
    alpha = np.linspace(-8.0, 8.0, n)
    force = -1.6 * load * (load / 800.0) ** -0.1 * np.sin(1.5 * np.arctan(8.0 * np.radians(alpha)))
    return {"Sa": alpha, "Fy": force, "Mz": -0.02 * force}


def mat(path: Path, *, end="", factor=1.0, sizes=(33, 34, 35), **more) -> Path:
    """Vectors named after channel and load, each load with a length of its own."""
    named = {
        f"{channel}{factor * load:g}{end}": values[:, None]
        for load, n in zip(LOADS, sizes, strict=True)
        for channel, values in sweep(load, n).items()
    }
    scipy.io.savemat(path, named | more)
    return path


def read_as(path: Path, folder: Path, **headings):
    sniffed, (toml, *_) = init_from([path], folder, headings={"gamma_deg": "0"} | headings, **GIVEN)
    return sniffed, configuration.load(toml)


@pytest.mark.parametrize(
    ("end", "factor", "asks"), [("", 1.0, True), ("N", 1.0, False), ("_kN", 1e-3, False)]
)
def test_the_load_in_the_names_of_vectors_becomes_a_column(tmp_path, end, factor, asks):
    sniffed, config = read_as(mat(tmp_path / "a.mat", end=end, factor=factor), tmp_path / "p")
    found = sweeps.load(config).sweeps
    assert [len(one) for one in found] == [33, 34, 35]
    for one, load in zip(found, LOADS, strict=True):
        known = sweep(load, len(one))
        assert one.Fz == pytest.approx(load)
        assert one.gamma == pytest.approx(0.0)
        assert one.alpha == pytest.approx(np.radians(known["Sa"]))
        assert one.Fy == pytest.approx(known["Fy"])
        assert one.Mz == pytest.approx(known["Mz"])
    asked = [r for r in sniffed.recordings[0].remarks if "load is taken from the names Fy" in r]
    assert bool(asked) == asks
    assert all("is it in N?" in remark for remark in asked)
    assert (sniffed.recordings[0].guesses["Fz_N"].stated == "") == asks


def test_a_text_table_with_shared_angles_is_read_alike(tmp_path):
    columns = {"SA [deg]": sweep(400.0)["Sa"], "IA [deg]": np.zeros(33)}
    columns |= {f"FY {load:g} N [N]": sweep(load)["Fy"] for load in LOADS}
    columns |= {"T1 [degC]": np.full(33, 40.0)}  # the number of a sensor
    pd.DataFrame(columns).to_csv(tmp_path / "a.csv", index=False)
    _, (toml, *_) = init_from([tmp_path / "a.csv"], tmp_path / "p", **GIVEN)
    found = sweeps.load(configuration.load(toml)).sweeps
    assert [float(one.Fz[0]) for one in found] == list(LOADS)
    assert all(one.Fy == pytest.approx(sweep(load)["Fy"]) for one, load in zip(found, LOADS, strict=True))
    assert all(one.line.tolist() == list(range(2, 35)) for one in found)


def test_numbers_of_wheels_are_no_loads(tmp_path):
    wheels = {f"{channel}{k}": values for k in (1, 2) for channel, values in sweep(800.0).items()}
    scipy.io.savemat(tmp_path / "a.mat", {name: values[:, None] for name, values in wheels.items()})
    assert formats.read(tmp_path / "a.mat").headings == tuple(wheels)
    with pytest.raises(InputError, match=r"Fy_N may be Fy1 or Fy2.; give --column 'alpha_deg=Sa1'"):
        sniff([tmp_path / "a.mat"])
    chosen = {"alpha_deg": "Sa2", "Fy_N": "Fy2", "Fz_N": "800", "gamma_deg": "0"}
    assert sniff([tmp_path / "a.mat"], headings=chosen).points.Fz == pytest.approx(800.0)


def test_a_measured_load_is_better_than_its_name(tmp_path):
    named = {
        f"{c}{load:g}": v
        for load in LOADS
        for c, v in (sweep(load) | {"Fz": np.full(33, 1.01 * load)}).items()
    }
    scipy.io.savemat(tmp_path / "a.mat", {name: values[:, None] for name, values in named.items()})
    sniffed, config = read_as(tmp_path / "a.mat", tmp_path / "p")
    assert [float(one.Fz[0]) for one in sweeps.load(config).sweeps] == pytest.approx(
        [1.01 * load for load in LOADS]
    )
    assert not any("names" in remark for remark in sniffed.recordings[0].remarks)


def csv(folder: Path) -> Path:
    """A sweep without camber, its angle in radians."""
    found = sweep(800.0)
    table = pd.DataFrame({"SA": np.radians(found["Sa"]), "FY": found["Fy"], "FZ": 800.0})
    table.to_csv(folder / "a.csv", index=False)
    return folder / "a.csv"


def test_one_value_for_all_rows_stands_for_a_channel_that_the_file_lacks(tmp_path):
    path = csv(tmp_path)
    with pytest.raises(
        InputError, match=r"known to be gamma_deg .*or --column gamma_deg=VALUE for one value"
    ):
        sniff([path])
    sniffed, config = read_as(path, tmp_path / "p", p_kPa="180")
    (one,) = sweeps.load(config).sweeps
    assert one.alpha == pytest.approx(np.radians(sweep(800.0)["Sa"])), "the value states no unit of the file"
    assert (one.gamma[0], one.p[0]) == (0.0, 180e3)
    text = config.path.read_text(encoding="utf-8")
    assert "gamma_deg = 0  # deg, as given for all rows" in text
    assert sniffed.recordings[0].guesses["gamma_deg"].value == 0.0


def configured(folder: Path, shared, **sweep_table):
    tables = {
        "tyre": {"name": "t", **GIVEN},
        "rig": {"type": "flat-track"},
        "columns": shared,
        "sweep": [{"file": "a.csv", **sweep_table}],
    }
    return configuration.load(tables, folder=folder)


def test_a_value_has_a_unit_and_yields_to_a_column_of_all_files(tmp_path):
    csv(tmp_path)
    angles = {
        "alpha_deg": {"column": "SA", "unit": "rad"},
        "Fy_N": "FY",
        "Fz_N": {"value": 0.8, "unit": "kN"},
    }
    (one,) = sweeps.load(configured(tmp_path, angles | {"gamma_deg": 3})).sweeps
    assert one.Fz == pytest.approx(800.0)
    assert one.gamma == pytest.approx(np.radians(3.0))
    table = pd.read_csv(tmp_path / "a.csv").assign(gamma_deg=5.0)
    table.to_csv(tmp_path / "a.csv", index=False)
    (one,) = sweeps.load(configured(tmp_path, angles | {"gamma_deg": 3})).sweeps
    assert one.gamma == pytest.approx(np.radians(5.0))
    (one,) = sweeps.load(configured(tmp_path, angles, columns={"gamma_deg": 3.0})).sweeps
    assert one.gamma == pytest.approx(np.radians(3.0))


def test_a_value_and_a_column_exclude_each_other(tmp_path):
    csv(tmp_path)
    both = {"gamma_deg": {"column": "IA", "value": 0.0}}
    with pytest.raises(InputError, match="given together with column") as refused:
        configured(tmp_path, both)
    assert refused.value.key == "columns.gamma_deg.value"


def test_a_column_of_text_stands_below_one_of_numbers_with_all_its_cells():
    """The pressure of the second load has a gap, so that its cells are text; the sets have two and three rows."""
    columns = {
        "alpha_deg 1000N": np.array([-1.0, 1.0]),
        "Fy_N 1000N": np.array([300.0, -310.0]),
        "p_kPa 1000N": np.array([200.0, 201.0]),
        "alpha_deg 2000N": np.array([-1.0, 0.0, 1.0]),
        "Fy_N 2000N": np.array([580.0, 5.0, -590.0]),
        "p_kPa 2000N": ["202.0", "", "204.0"],
    }
    found = stacked(columns, {})
    assert found is not None
    assert [*found.columns["p_kPa"]] == [200.0, 201.0, "202.0", "", "204.0"]
    assert [*found.columns["Fy_N"]] == [300.0, -310.0, 580.0, 5.0, -590.0]
    assert isinstance(found.columns["Fy_N"], np.ndarray)
    assert [*found.columns[LOAD_HEADING]] == [1000.0] * 2 + [2000.0] * 3
    assert found.columns[RUN] == ["1000"] * 2 + ["2000"] * 3
