"""Files of two tyres, or of another tyre than declared, are refused by their radii; one tyre under other conditions is not."""

from __future__ import annotations

import re

import numpy as np
import pandas as pd
import pytest
from flat_belt import drive_recording, loaded_radius, recording, rolling_radius, write_mat73

from mffit import config as configuration
from mffit import pipeline, points
from mffit.errors import InputError
from mffit.suspicion import before_the_fit
from mffit.suspicion.other_tyre import two_tyres

COLUMNS = {
    "time_s": "ET", "alpha_deg": "SA", "gamma_deg": "IA", "Fz_N": "FZ", "Fy_N": "FY", "Mz_Nm": "MZ", "p_kPa": "P", "V_mps": "V",
    "T_degC": "TSTC", "kappa": "SL", "Fx_N": "FX", "RL_m": "RL", "omega_radps": "N",
}  # fmt: skip


def cornering(free: float) -> pd.DataFrame:
    """A sideslip recording with the radii of a tyre of another size."""
    table = recording(pressures=(83.0,), cambers=(0.0,))
    Fz = -table["FZ"].to_numpy()
    noise = 0.01 * np.random.default_rng(4).standard_normal(len(table))
    omega = table["V"] / 3.6 / rolling_radius(Fz, free)
    return table.assign(RL=100.0 * loaded_radius(Fz, free) + noise, N=omega * 60.0 / (2.0 * np.pi))


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    """Points and configuration of some recordings."""

    def of(*tables, radius=0.228, without=()):
        folder = tmp_path_factory.mktemp("runs")
        files = [str(write_mat73(table, folder / f"{k}.mat")) for k, table in enumerate(tables)]
        config = configuration.load(
            {
                "tyre": {
                    "name": "x",
                    "unloaded_radius": radius,
                    "nominal_load": 1500.0,
                    "nominal_pressure": 83.0,
                },
                "rig": {"type": "flat-track", "axes": "sae"},
                "columns": {name: heading for name, heading in COLUMNS.items() if name not in without},
                "sweep": [{"file": file} for file in files],
            }
        )
        return points.read(config).points, config

    return of


@pytest.fixture(scope="module")
def drive():
    return drive_recording(sideslips=(0.0,), cambers=(0.0,))


def test_two_tyres_are_refused_with_both_radii(read, drive):
    with pytest.raises(
        InputError, match=r"two tyres: the loaded radius at .* upright, is (21|20). against 22. mm"
    ):
        before_the_fit(*read(cornering(0.212), drive))


def test_the_speed_of_the_wheel_alone_shows_two_tyres_too(read, drive):
    found = read(cornering(0.212), drive, without=("RL_m",))
    (facts,) = two_tyres.find(*found)
    assert "rolling radius" in facts["words"]


@pytest.mark.parametrize(
    "other",
    [
        pytest.param(
            lambda: drive_recording(sideslips=(0.0,), pressure=97.0, free=0.2295, seed=2), id="pressure"
        ),
        pytest.param(
            lambda: drive_recording(sideslips=(0.0,), cambers=(3.0,), free=0.230, seed=3), id="camber"
        ),
        pytest.param(lambda: drive_recording(sideslips=(0.0,), free=0.225, seed=4), id="worn by 3 mm"),
        pytest.param(lambda: drive_recording(sideslips=(0.0,), loads=(1000.0, 2900.0), seed=5), id="loads"),
    ],
)
def test_one_tyre_under_other_conditions_is_not_refused(read, drive, other):
    assert not list(two_tyres.find(*read(drive, other())))


@pytest.mark.parametrize(("radius", "said"), [(0.2057, "1.0. times"), (0.30, "0.7. times")])
def test_a_declared_radius_that_is_rare_beside_the_readings_is_asked_for(read, drive, radius, said):
    warnings = before_the_fit(*read(drive, radius=radius))
    assert any(re.search(f"loaded radius of the readings is 0.22.* m, {said}", one) for one in warnings)


def test_a_declared_radius_that_the_readings_contradict_is_refused(read, drive):
    """A wheel that is larger loaded than unloaded."""
    with pytest.raises(InputError, match="which no wheel has"):
        before_the_fit(*read(drive, radius=0.2))


def test_init_refuses_a_project_of_two_tyres(drive, tmp_path):
    files = [write_mat73(cornering(0.212), tmp_path / "a.mat"), write_mat73(drive, tmp_path / "b.mat")]
    with pytest.raises(InputError, match="of two tyres"):
        pipeline.init_from(files, tmp_path / "p", unloaded_radius=0.22, nominal_load=1500.0)
    assert not (tmp_path / "p").exists()


def listed(folder, heading, names, *, files=1):
    """A list of finished points of two tyres: 15 readings of each by turns, in one file or in one each."""
    rows = [
        f"{name},{load:.0f},{a},0,{-load * np.tanh(grip * a / 10.0):.1f},200"
        for name, grip in zip(names, (1.2, 1.6), strict=True)
        for load in (1000.0, 2000.0, 3000.0)
        for a in (-6, -3, 0, 3, 6)
    ]
    head = f"{heading},Fz_N,alpha_deg,gamma_deg,Fy_N,p_kPa"
    parts = [rows] if files == 1 else [rows[:15], rows[15:]]
    for k, part in enumerate(parts):
        (folder / f"{k}.csv").write_text("\n".join([head, *part]) + "\n")
    tyre = {"name": "x", "unloaded_radius": 0.3, "nominal_load": 2000.0, "nominal_pressure": 200.0}
    return {
        "tyre": tyre,
        "rig": {"type": "flat-track"},
        "sweep": [{"file": f"{k}.csv"} for k in range(files)],
    }


@pytest.mark.parametrize(
    ("heading", "names"), [("Tyre", "AB"), ("Tire ID", "12"), ("Specimen", ("old", "new"))]
)
def test_a_list_that_names_two_tyres_is_refused_with_the_lines_to_leave_out(tmp_path, heading, names):
    content = listed(tmp_path, heading, names)
    config = configuration.load(content, folder=tmp_path)
    with pytest.raises(
        InputError, match=f'column {heading}: names 2 tyres, "{names[0]}", "{names[1]}"'
    ) as found:
        before_the_fit(points.read(config).points, config)
    assert found.value.line == 17
    entry = {"file": "0.csv", "lines": "17-31", "why": f"tyre {names[1]}"}
    assert ", ".join(f'{key} = "{text}"' for key, text in entry.items()) in str(found.value)
    cured = configuration.load({**content, "fit": {"exclude": [entry]}}, folder=tmp_path)
    read = points.read(cured).points
    before_the_fit(read, cured)
    assert len(read) == 15


def test_files_that_name_a_tyre_each_are_refused(tmp_path):
    config = configuration.load(listed(tmp_path, "Tyre", "AB", files=2), folder=tmp_path)
    with pytest.raises(InputError, match="remove the"):
        before_the_fit(points.read(config).points, config)


@pytest.mark.parametrize("names", [("A", "A"), ("", ""), ("A", "")])
def test_a_list_that_names_one_tyre_is_not(tmp_path, names):
    config = configuration.load(listed(tmp_path, "Tyre", names), folder=tmp_path)
    before_the_fit(points.read(config).points, config)
