"""Sweeps of longitudinal slip become points with every channel that was measured, in ISO-W."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest
from flat_belt import RATE, SPEED, drive_recording, rolling_radius, write_mat73

from mffit import config as configuration
from mffit import points
from mffit.points import make_points
from mffit.points.averaging import _blocks, grid_of
from mffit.points.stretch import SWEEP

SWEEP_S, REST_S = 6.0, 3.0
SLIPS, LOADS = (0.0, 3.0, 6.0), (500.0, 1600.0)
COLUMNS = {
    "time_s": "ET", "alpha_deg": "SA", "gamma_deg": "IA", "Fz_N": "FZ", "Fx_N": "FX", "Fy_N": "FY", "Mz_Nm": "MZ",
    "Mx_Nm": "MX", "My_Nm": "MY", "RL_m": {"column": "RL", "unit": "cm"}, "omega_radps": {"column": "N", "unit": "rpm"},
    "p_kPa": "P", "V_mps": "V", "kappa": "SL",
}  # fmt: skip


def recording() -> pd.DataFrame:
    """Drive and brake 0 -> 0.15 -> 0 -> -0.15 -> 0 at three sideslips and two loads, as a machine in SAE axes writes it."""
    random = np.random.default_rng(2)
    swept, resting = round(SWEEP_S * RATE), round(REST_S * RATE)
    triangle = 0.15 * (1.0 - np.abs((4.0 * np.arange(swept) / swept + 1.0) % 4.0 - 2.0))
    parts = [(slip, load) for slip in SLIPS for load in LOADS]
    kappa = np.concatenate([np.r_[np.zeros(resting), triangle] for _ in parts])
    alpha, Fz = (np.repeat([part[k] for part in parts], resting + swept) for k in (0, 1))
    n = len(kappa)
    Fx = 20.0 * Fz * kappa / (1.0 + 80.0 * kappa**2) + 5.0 * random.standard_normal(n)
    return pd.DataFrame(
        {
            "ET": np.arange(n) / RATE,
            "V": 3.6 * SPEED + 0.01 * random.standard_normal(n),
            "SA": -(alpha + 0.01 * random.standard_normal(n)),
            "IA": 0.01 * random.standard_normal(n),
            "P": 83.0 + 0.1 * random.standard_normal(n),
            "SL": kappa + 1e-3 * random.standard_normal(n),
            "FX": Fx,
            "FY": 0.2 * alpha * Fz + 5.0 * random.standard_normal(n),
            "FZ": -Fz + 3.0 * random.standard_normal(n),
            "MX": -40.0 + 3e-3 * (Fz - np.mean(LOADS)) + random.standard_normal(n),
            "MY": 6.0 + 0.1 * random.standard_normal(n),
            "MZ": 4e-3 * alpha * Fz + random.standard_normal(n),
            "RL": 22.0 - 2e-4 * Fz,
            "N": 60.0 / (2.0 * np.pi) * (1.0 + kappa) * SPEED / 0.225,
        }
    )


@pytest.fixture(scope="module")
def read(tmp_path_factory):
    file = write_mat73(recording(), tmp_path_factory.mktemp("slip") / "run.mat")

    def reading(columns=COLUMNS):
        tyre = {"name": "x", "unloaded_radius": 0.22, "nominal_load": 1500.0, "nominal_pressure": 83.0}
        content = {"tyre": tyre, "rig": {"type": "flat-track", "axes": "calspan"}, "columns": columns}
        return points.read(configuration.load(content | {"sweep": [{"file": str(file)}]}), may_be_empty=True)

    return reading


def test_every_condition_is_a_sweep_of_slip_with_all_channels(read):
    found = read()
    sweeps = [note for note in found.stretches if note.kind == SWEEP and not note.dropped]
    assert len(sweeps) == len(SLIPS) * len(LOADS)
    p = found.points
    assert p.measured == ("Fx", "Fy", "Mx", "My", "Mz", "RL", "omega")
    for k in np.unique(p.sweep[np.isfinite(p.time)]):  # the others are the rests before the sweeps
        rows = p.sweep == k
        assert (p.kappa[rows].min(), p.kappa[rows].max()) == pytest.approx((-0.15, 0.15), abs=0.012)
        assert np.ptp(np.degrees(p.alpha[rows])) < 0.05
    assert not any("lag" in sentence for sentence in found.warnings)


def test_slip_from_speeds_is_zero_where_the_force_is(read):
    """The mean radius of all sweeps is 0.0023 off that of the wheel straight ahead: its speed follows the road's at any angle."""
    found = read({name: heading for name, heading in COLUMNS.items() if name != "kappa"})
    p = found.points
    straight = np.abs(p.alpha) < np.radians(1.0)
    truth = p.omega * 0.225 / p.V - 1.0
    assert np.ptp(p.kappa[straight]) > 0.2
    assert np.max(np.abs(p.kappa - truth)[straight]) < 6e-4
    assert any("zero at Fx = 0" in said for said in (*found.notes, *found.warnings))


def slipping(rate: float) -> SimpleNamespace:
    """Two seconds of slip that rises by ``rate`` per second, at 100 samples a second."""
    time = np.arange(200) / 100.0
    settings = {"alpha": 0.0 * time, "gamma": 0.0 * time, "kappa": rate * time}
    return SimpleNamespace(time=time, omega=np.nan * time, V=np.full(200, 11.0), **settings)


def test_a_fast_sweep_is_averaged_over_no_more_of_slip_than_of_sideslip():
    """At a slip of 0.35 per second a tenth of a second would be 0.035; at 0.05 per second it is a turn of the wheel, if known."""
    for rate, radius, samples in ((0.35, 0.225, 2), (0.05, 0.225, 13), (0.05, np.nan, 10)):
        sweep = slipping(rate)
        first, gives = _blocks(sweep.time, grid_of(sweep, np.arange(200), radius))
        assert first[1] == samples
        assert gives[:-1].all()


def test_a_mean_may_lack_half_of_its_samples_but_no_end_of_a_turn():
    def gives(rows, radius):
        sweep, rows = slipping(0.05), np.asarray(rows)
        return _blocks(sweep.time[rows], grid_of(sweep, rows, radius))[1].tolist()

    assert gives(range(25), 0.225) == [True, True]  # turns of 12.85 samples
    assert gives(range(24), 0.225) == [True, False]
    assert gives(np.delete(range(26), [2, 4, 6, 8, 15, 17]), 0.225) == [True, True]
    assert gives(range(15), np.nan) == [True, True]  # means of ten samples
    assert gives(range(14), np.nan) == [True, False]
    for rows in ([7], np.r_[0:8, 150:158]):  # one sample, and both sides of what was left out
        assert not any(gives(rows, 0.225))


def test_signs_and_units_of_the_channels_are_those_of_iso_w(read):
    p = read().points
    driven = p.kappa > 0.05
    assert np.all(p.Fx[driven] > 0.0)
    assert np.all(p.alpha[p.sweep == p.sweep.max()] > 0.0)
    assert np.all(p.Fy[p.sweep == p.sweep.max()] < 0.0)
    assert np.mean(p.Mx) == pytest.approx(-40.0, abs=0.2)
    assert np.mean(p.My) == pytest.approx(-6.0, abs=0.1)
    assert pytest.approx(0.22 - 2e-6 * p.Fz, abs=1e-4) == p.RL
    assert p.omega == pytest.approx((1.0 + p.kappa) * SPEED / 0.225, rel=0.01)


def test_without_a_longitudinal_force_only_free_rolling_is_used(read):
    found = read({name: heading for name, heading in COLUMNS.items() if name != "Fx_N"})
    assert "Fx" not in found.points.measured
    assert np.all(found.points.free_rolling)
    assert any(entry.rule == "driven-or-braked" for entry in found.left_out)


def test_the_speed_of_the_wheel_has_the_sign_of_its_rolling(tmp_path):
    table = "alpha_deg,gamma_deg,Fz_N,Fy_N,omega_radps,direction\n1,0,1500,-300,{0},forward\n1,0,1500,-300,{0},backward\n"
    for reading in (30.0, -30.0):
        (tmp_path / "a.csv").write_text(table.format(reading))
        found = points.load_table(tmp_path / "a.csv", axes="sae", path_centre="left")
        assert found.omega.tolist() == [30.0, -30.0]


def test_a_point_without_slip_rolls_freely():
    some = make_points(
        0.0,
        0.0,
        1500.0,
        p=2e5,
        V=10.0,
        phi_t=0.0,
        kappa=[0.0, 0.019, -0.021, 0.1],
        Mx=[1.0, np.nan, 2.0, 3.0],
    )
    assert some.free_rolling.tolist() == [True, True, False, False]
    assert some.measured == ("Mx",)
    assert some.channel("Mx")[2] == 2.0
    assert np.all(np.isnan(some.u("Mx")))


@pytest.fixture
def by_speeds(tmp_path):
    """Points of a recording of the machine with speeds of wheel and road, and with slip only if its heading is given."""

    def reading(table, *without, **more):
        columns = {
            "time_s": "ET", "alpha_deg": "SA", "gamma_deg": "IA", "Fz_N": "FZ", "Fy_N": "FY", "Fx_N": "FX",
            "V_mps": {"column": "V", "unit": "km/h"}, "omega_radps": {"column": "N", "unit": "rpm"},
            "RL_m": {"column": "RL", "unit": "cm"}, "p_kPa": "P", **more,
        }  # fmt: skip
        table.to_csv(tmp_path / "run.csv", index=False)
        tyre = {"name": "x", "unloaded_radius": 0.228, "nominal_load": 1500.0, "nominal_pressure": 83.0}
        content = {"tyre": tyre, "rig": {"type": "flat-track", "axes": "sae"}, "sweep": [{"file": "run.csv"}]}
        content["columns"] = {name: heading for name, heading in columns.items() if name not in without}
        return points.read(configuration.load(content, folder=tmp_path), may_be_empty=True)

    return reading


def test_slip_that_was_not_recorded_follows_from_the_speeds(by_speeds):
    """The recorded slip against free rolling is the truth; without it, driven points counted as rolling freely."""
    table = drive_recording()
    true = by_speeds(table, kappa="SL").points
    found = by_speeds(table)
    assert len(found.points) == len(true)
    assert np.max(np.abs(true.kappa)) > 0.13
    np.testing.assert_allclose(found.points.kappa, true.kappa, atol=0.006)
    assert np.std(found.points.kappa - true.kappa) < 0.002
    assert any("no slip was recorded" in sentence for sentence in found.warnings)
    blind = by_speeds(table, "Fx_N")
    assert any(entry.rule == "driven-or-braked" for entry in blind.left_out)


def test_a_wheel_that_rolls_freely_has_no_slip_from_its_speeds(by_speeds):
    """Its radius changes by a twelfth from load to load, which is no slip."""
    table = drive_recording(loads=(300.0, 1500.0, 2400.0))
    table["N"] = SPEED / (rolling_radius(-table["FZ"]) + table["FZ"] / 1.2e5) * 30.0 / np.pi
    found = by_speeds(table.assign(FX=0.0))
    assert np.all(found.points.kappa == 0.0)
    assert not any("slip" in sentence for sentence in found.warnings)
