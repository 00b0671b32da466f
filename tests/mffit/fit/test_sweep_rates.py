"""Carcass stiffness from sweeps of the sideslip angle at several rates, beside hysteresis."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from mffit import config, virtual_rig
from mffit.fit.posterior import Posterior
from mffit.fit.relaxation import relaxation, relaxation_sentences
from mffit.fit.sweep_rates import of_rates
from mffit.points.lag import Lag
from mffit.points.loading import read
from mffit.rig import Simulation

SAMPLE = Path(__file__).parents[3] / "samples" / "flat-track-combined"
NONE_KNOWN = Posterior((), np.zeros((0, 0)))
C, HYSTERESIS = 130e3, np.radians(0.05)


def lags(rates_deg_per_m, loads=(2000.0, 4000.0), V=2.0):
    """Sweeps whose ways differ by lag and hysteresis, and their slip stiffness [N]."""
    conditions = [(load, np.radians(rate)) for load in loads for rate in rates_deg_per_m]
    K = np.array([20.0 * load for load, _ in conditions])
    rows = [
        Lag(k / C + HYSTERESIS / r, 0.004, 0.0, 20.0, rate=r, way=50.0, load=load, pressure=240e3, speed=V)
        for k, (load, r) in zip(K, conditions, strict=True)
    ]
    return rows, K


def test_two_rates_separate_the_length_from_hysteresis():
    found = of_rates(*lags((0.4, 2.0)))
    assert found.stiffness == pytest.approx(C, rel=1e-6)
    assert found.hysteresis == pytest.approx(HYSTERESIS, rel=1e-6)
    assert found.u < 0.05 * C


def test_loads_do_not_stand_in_for_rates():
    """At one rate the lag grows with the load as the length does, and yet hysteresis may do the same."""
    assert not np.isfinite(of_rates(*lags((0.4, 0.4), loads=(1000.0, 2000.0, 4000.0))).u)


def test_a_delay_of_the_channels_counts_more_at_speed():
    slow, fast = (of_rates(*lags((0.4, 2.0), V=V)).u for V in (2.0, 20.0))
    assert fast > 3.0 * slow


@pytest.fixture(scope="module")
def sweeps(tmp_path_factory):
    """Recordings at two rates, of a rig with hysteresis."""
    common = {"load_N": 4200, "V_mps": 10, "faults": {"hysteresis_deg": 0.05}}
    recording = {"rate_Hz": 100, "hold_s": 0, "noise_Fy_N": 15, "correlation_s": 0.05}
    plan = {
        "truth": {"tyre": "true.tir"},
        "tyre": {"name": "x", "unloaded_radius": 0.3185, "nominal_load": 4200, "nominal_pressure": 240},
        "rig": {"type": "flat-track"},
        "sweep": [
            {**common, "file": f"{rate}.csv", "alpha_deg": [-8, 8] * turns + [-8],
             "recording": {**recording, "steering_deg_per_s": rate}}
            for rate, turns in ((4, 1), (20, 3))
        ],
    }  # fmt: skip
    folder = tmp_path_factory.mktemp("rates")
    virtual_rig.simulate(virtual_rig.load_plan(plan, folder=SAMPLE), folder)
    return read(config.load(folder / "tyre.toml")).lags


@pytest.fixture(scope="module")
def truth():
    return tir.read(SAMPLE / "true.tir")


def test_recordings_at_two_rates_give_the_stiffness_of_the_tyre(sweeps, truth):
    start = Simulation.of(truth.replace(LATERAL_STIFFNESS=300e3), turn_slip=False)
    sideways = relaxation({}, start, NONE_KNOWN, (), sweeps)[0]
    q = sideways.found["LATERAL_STIFFNESS"]
    assert q.value == pytest.approx(truth["LATERAL_STIFFNESS"], rel=0.03)
    assert 0.03 < q.u / q.value < 0.1  # 3 ms of delay are 30 mm of 540 mm
    assert np.degrees(sideways.rates.hysteresis) == pytest.approx(0.05, abs=0.01)
    assert "2 sweeps of the sideslip angle at 4 to 20 deg/s" in relaxation_sentences([sideways])[0]
    assert "PCFY1, PCFY2, PCFY3 need steps" in sideways.coverage.missing[0]


def test_one_rate_leaves_the_stiffness_and_says_what_to_run(sweeps, truth):
    start = Simulation.of(truth, turn_slip=False)
    sideways = relaxation({}, start, NONE_KNOWN, (), sweeps[:1])[0]
    assert not sideways.found
    assert (
        "the sweeps (4 deg/s) do not separate lag from hysteresis, sweeps at 1"
        in sideways.coverage.missing[0]
    )


def test_a_stiffness_held_by_hand_stays(sweeps, truth):
    held = {"LATERAL_STIFFNESS"}
    sideways = relaxation({}, Simulation.of(truth, turn_slip=False), NONE_KNOWN, held, sweeps)[0]
    assert not sideways.found
