"""Sweeps on other paths: the forward model and the virtual rig, made apart, read the same."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import SAMPLE, disc, truth

from mffit import config as configuration
from mffit import virtual_rig
from mffit.config import path_curvature
from mffit.errors import InputError
from mffit.pipeline.build_output import origin
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import Faults

DECLARED, TRUE = 1.323, 1.330  # m
PATHS = ({}, {"path_centre": "right"}, {"path_radius": 0.9}, {"path_centre": "right", "path_radius": 1.6})


def sweeps():
    return [
        {"file": f"{k}.csv", "load_N": 1400, "alpha_deg": [-2, 0, 3], "gamma_deg": [0, 10], **path}
        for k, path in enumerate(PATHS)
    ]


def test_both_forward_models_run_every_path():
    faults = {
        "path_radius_m": TRUE, "F0_N": 7.0, "gamma_0_deg": 0.3, "crown_m": 0.08, "disc_tilt_deg_per_kN": 0.3,
    }  # fmt: skip
    content = disc(faults=faults, noise={}, sweep=sweeps())
    campaign = virtual_rig.run(virtual_rig.load_plan(content, folder=SAMPLE), truth())
    assert [{k: v for k, v in e.items() if k != "file"} for e in campaign.configuration["sweep"]] == list(
        PATHS
    )
    simulation = Simulation.of(truth(), Faults(**faults))
    for entry in campaign.configuration["sweep"]:
        table = campaign.tables[entry["file"]]
        rig = configuration.load(campaign.configuration, folder=SAMPLE).rig
        sweep = configuration.models.SweepTable(**entry)
        points = make_points(
            np.radians(table.alpha_deg), np.radians(table.gamma_deg), table.Fz_N, p=1e3 * table.p_kPa, V=table.V_mps,
            phi_t=path_curvature(rig, sweep),
        )  # fmt: skip
        read = Simulation(simulation.values, simulation.faults, radius_m=DECLARED).readings(points)
        assert read.Fy == pytest.approx(table.Fy_N.to_numpy(), abs=0.01)
        assert read.Mz == pytest.approx(table.Mz_Nm.to_numpy(), abs=0.001)


def test_an_error_of_the_radius_is_common_to_all_paths():
    points = make_points(0.0, 0.0, 1400.0, p=250e3, V=6.0, phi_t=np.array([-1.0 / DECLARED, 1.0 / 0.9]))
    off = Simulation.of(truth(), Faults(path_radius_m=TRUE))
    moved = points.replace(phi_t=np.array([-1.0 / TRUE, 1.0 / (0.9 + TRUE - DECLARED)]))
    again = Simulation(off.values, off.faults, radius_m=DECLARED).readings(points)
    assert again.Fy == pytest.approx(Simulation.of(truth()).readings(moved).Fy)


def test_a_flat_track_has_no_other_path():
    content = disc(rig={"type": "flat-track"}, rolling_radius=[])
    declared = {name: content[name] for name in ("tyre", "rig")}
    with pytest.raises(InputError, match="straight"):
        configuration.load(declared | {"sweep": [{"file": "a.csv", "path_centre": "right"}]}, folder=SAMPLE)


def test_points_csv_names_the_path_of_every_point():
    phi_t = np.array([-1.0 / DECLARED, 1.0 / 0.9])
    said = origin(make_points(0.0, 0.0, 1400.0, p=250e3, V=6.0, phi_t=phi_t))
    assert list(said["path_centre"]) == ["left", "right"]
    assert said["path_radius_m"] == pytest.approx([DECLARED, 0.9])
    assert "path_radius_m" not in origin(
        make_points(0.0, 0.0, np.array([1400.0, 900.0]), p=250e3, V=6.0, phi_t=0.0)
    )
