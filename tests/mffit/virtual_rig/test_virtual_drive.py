"""Drive, brake, combined, free-rolling and step runs of the virtual rig: what its columns and its truth must say."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from mffit import config, points, virtual_rig

SAMPLE = Path(__file__).parents[3] / "samples" / "flat-track-combined"
ALL = {"Fy_N": 0.0, "Mz_Nm": 0.0, "My_Nm": 0.0, "Fx_N": 0.0, "Mx_Nm": 0.0, "RL_m": 0.0, "omega_radps": 0.0}
LOAD, SPEED = 4200.0, 16.7


@pytest.fixture(scope="module")
def tyre():
    return tir.read(SAMPLE / "true.tir")


@pytest.fixture
def table(tyre):
    """The columns of one sweep on a perfect flat track, with changes of the plan."""

    def of(sweep, **changes):
        content = {
            "truth": {"tyre": "true.tir"},
            "tyre": {"name": "x", "unloaded_radius": 0.3185, "nominal_load": LOAD, "nominal_pressure": 240},
            "rig": {"type": "flat-track"},
            "noise": ALL,
            "conditions": {"V_mps": SPEED},
            "sweep": [{"file": "a.csv", "load_N": LOAD, **sweep}],
        }
        plan = virtual_rig.load_plan(content | changes, folder=SAMPLE)
        return virtual_rig.run(plan, tyre, 3).tables["a.csv"]

    return of


def test_slip_sideslip_and_camber_are_run_as_a_grid(table):
    found = table(
        {"kappa": [-0.1, 0.0, 0.1], "alpha_deg": [0, 4], "gamma_deg": [0, 3], "load_N": [2000, 4000]}
    )
    assert len(found) == 24
    assert found["kappa"].tolist()[:4] == [-0.1, 0.0, 0.1, -0.1]
    assert found["Fz_N"].tolist() == [2000.0] * 12 + [4000.0] * 12


def test_every_channel_is_that_of_the_tyre_with_its_faults(table, tyre):
    faults = {
        "kappa_0": 0.004, "gain_Fx": 1.02, "Fx0_N": -14.0, "Mx0_Nm": -35.0, "My0_Nm": 0.6, "M0_Nm": 0.8,
        "crosstalk_Fx_Mz_m": 0.002, "crosstalk_Fx_Mx_m": 0.004, "crosstalk_Fy_Mx_m": -0.003,
        "drag_Fx_N": 9.0,
    }  # fmt: skip
    row = table({"kappa": 0.05, "alpha_deg": 3, "gamma_deg": 2}, faults=faults).iloc[0]
    true = tyre(LOAD, np.radians(3.0), np.radians(2.0), 0.054, Vx=SPEED, p=240e3)
    assert row["Fx_N"] == pytest.approx(1.02 * true.Fx - 14.0 - 9.0, abs=0.01)
    assert row["Fy_N"] == pytest.approx(true.Fy, abs=0.01)
    assert row["Mx_Nm"] == pytest.approx(true.Mx - 35.0 + 0.004 * true.Fx - 0.003 * true.Fy, abs=1e-3)
    assert row["My_Nm"] == pytest.approx(true.My + 0.6, abs=1e-3)
    assert row["Mz_Nm"] == pytest.approx(true.Mz + 0.8 + 0.002 * true.Fx, abs=1e-3)
    state = tyre.state(LOAD, kappa=0.054, Vx=SPEED, p=240e3)
    assert row["omega_radps"] == pytest.approx(1.054 * SPEED / float(state.Re), abs=1e-3)


def test_the_tangent_stiffness_at_nominal_load_is_the_one_of_the_file(table, tyre):
    low, high = (table({"load_N": load, "V_mps": 0.01})["RL_m"][0] for load in (LOAD - 50, LOAD + 50))
    assert 100.0 / (low - high) == pytest.approx(
        tyre["VERTICAL_STIFFNESS"], rel=0.03
    )  # six digits of a metre


def test_a_wheel_without_drive_balances_rolling_resistance_and_drag(table, tyre):
    free = {"free_rolling": True, "load_N": [2000, 4200, 6500], "p_kPa": [200, 280], "V_mps": [8, 30]}
    found = table(free, drive={"drag_Nm": 3.0})
    assert len(found) == 12
    unbalanced = found["Fx_N"] * found["RL_m"] - found["My_Nm"] + 3.0
    assert np.max(np.abs(unbalanced)) < 0.02
    radius = found["V_mps"] / found["omega_radps"]
    re = tyre.state(
        found["Fz_N"].to_numpy(), Vx=found["V_mps"].to_numpy(), p=1e3 * found["p_kPa"].to_numpy()
    ).Re
    assert np.allclose(radius, re / (1.0 + found["kappa"]), atol=1e-5)
    assert np.all(found["kappa"] < 0.0)


def test_slip_against_the_loaded_radius_is_its_definition(table):
    found = table({"kappa": [-0.1, 0.0, 0.1]}, drive={"slip_against": "loaded-radius"})
    expected = found["omega_radps"] * found["RL_m"] / found["V_mps"] - 1.0
    assert np.allclose(found["kappa"], expected, atol=2e-5)


def test_one_more_channel_leaves_the_noise_of_the_others(table):
    sweep = {"kappa": [-0.1, 0.0, 0.1]}
    few = table(sweep, noise={"Fy_N": 10.0, "Mz_Nm": 1.0, "Fx_N": 12.0})
    all_channels = table(sweep, noise=ALL | {"Fy_N": 10.0, "Mz_Nm": 1.0, "Fx_N": 12.0, "Mx_Nm": 2.0})
    for name in ("Fy_N", "Mz_Nm", "Fx_N"):
        assert few[name].equals(all_channels[name])
    assert all_channels["u_Fx_N"].tolist() == [12.0] * 3


@pytest.mark.parametrize(
    ("moved", "to", "force", "lag"),
    [("alpha_deg", 1.0, "Fy_N", "sigma_y"), ("kappa", 0.01, "Fx_N", "sigma_x")],
)
def test_a_step_builds_up_over_the_relaxation_length(table, tyre, moved, to, force, lag):
    step = {
        "rate_Hz": 200, "hold_s": 4, "steering_deg_per_s": 500, "slip_per_s": 5, "correlation_s": 0.0,
        "noise_Fy_N": 0.0, "noise_Fx_N": 0.0,
    }  # fmt: skip
    found = table({moved: [0, to], "V_mps": 1.0, "recording": step})
    reading, time = found[force].to_numpy(), found["time_s"].to_numpy()
    share = np.abs(reading - reading[0]) / abs(reading[-1] - reading[0])
    begun = time[np.argmax(found[moved].to_numpy() > 0.5 * to)]
    sigma = float(getattr(tyre.state(LOAD, Vx=1.0, p=240e3), lag))
    assert time[np.argmax(share > 1.0 - np.exp(-1.0))] - begun == pytest.approx(sigma, abs=0.015)


def test_the_sample_reads_as_its_tyre_with_its_noise(tyre):
    found = points.read(config.load(SAMPLE / "tyre.toml")).points
    assert {"Fx", "Fy", "Mx", "My", "Mz", "RL", "omega"} <= set(found.measured)
    stated = np.isclose(found.u_Fx, 15.0)  # finished points; those of the recordings have other noise
    rows = found.select(stated)
    true = tyre(
        rows.Fz,
        rows.alpha - np.radians(0.04),
        rows.gamma + np.radians(0.08),
        rows.kappa + 5e-4,
        Vx=rows.V,
        p=rows.p,
    )
    for name, zero in {"Fx": -14.0, "Fy": 12.0, "Mx": -35.0, "My": 0.6, "Mz": 0.8}.items():
        left = (rows.channel(name) - getattr(true, name) - zero) / rows.u(name)
        assert np.sqrt(np.mean(left**2)) == pytest.approx(1.0, abs=0.06), name


def test_the_truth_of_a_driven_campaign_has_stiffness_friction_radii_and_lags(tyre):
    truth = virtual_rig.run(virtual_rig.load_plan(SAMPLE / "rig.toml"), tyre).truth.to_json()
    rows = {row["load_N"]: row for row in truth["driven_per_load"]}
    slip = 1e-6
    slope = (tyre(LOAD, kappa=slip, p=240e3).Fx - tyre(LOAD, kappa=-slip, p=240e3).Fx) / (2.0 * slip)
    assert rows[LOAD]["K_x_N"] == pytest.approx(slope, rel=0.01)
    assert rows[LOAD]["mu_drive"] == pytest.approx(1.164, abs=1e-3)
    assert truth["coefficients"]["PKX1"] == tyre["PKX1"]
    assert truth["drive"] == {"slip_against": "free-rolling", "drag_Nm": 1.5}
