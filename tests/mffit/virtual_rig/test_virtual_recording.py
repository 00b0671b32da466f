"""Recorded sweeps: their plateaus hold what the finished points would."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.virtual_rig.plan import RecordingTable
from mffit.virtual_rig.recording import course, lagged, noise
from mffit.virtual_rig.settings import Settings

QUIET = {"noise_Fy_N": 0, "noise_Mz_Nm": 0}


def recorded(run, content, **recording):
    sweep = content["sweep"][0] | {"recording": recording}
    return run(sweep=[sweep]).tables["sideslip.csv"]


def test_a_held_angle_ends_at_the_steady_force(run, content):
    points = run().tables["sideslip.csv"]
    series = recorded(run, content, hold_s=10, **QUIET)
    for _, point in points.iterrows():
        held = series[series["alpha_deg"] == point["alpha_deg"]]
        assert held["Fy_N"].iloc[-1] == pytest.approx(point["Fy_N"], abs=0.6)  # recorded to 1 N
        assert held["Mz_Nm"].iloc[-1] == pytest.approx(point["Mz_Nm"], abs=0.06)


def test_a_sweep_that_never_stops_lags_by_the_relaxation_length(run, content, tyre):
    rate = 4.0
    series = recorded(run, content, hold_s=0, rate_Hz=200, steering_deg_per_s=rate, **QUIET)
    points = run(sweep=[content["sweep"][0] | {"alpha_deg": {"from": -6, "to": 6, "step": 0.1}}]).tables
    steady = points["sideslip.csv"]
    behind = np.interp(-series["Fy_N"], -steady["Fy_N"], steady["alpha_deg"])
    sigma = float(tyre.state(1400.0, Vx=6.0).sigma_y)
    middle = np.abs(series["alpha_deg"]) < 2.0
    lag = (series["alpha_deg"] - behind)[middle].mean()
    # A ramp lags by sigma/V seconds; half a sample more or less is a few per cent.
    assert lag == pytest.approx(rate * sigma / 6.0, rel=0.1)


def test_the_angle_moves_at_the_steering_rate_and_rests_at_every_point():
    alpha = np.radians([0.0, 2.0, 1.0])
    n = len(alpha)
    settings = Settings(alpha, *(np.ones(n) for _ in range(9)))
    time, moved, *_ = course(settings, RecordingTable(rate_Hz=10.0, hold_s=3.0, steering_deg_per_s=1.0))
    assert time[-1] == pytest.approx(3.0 * 3 + 2.0 + 1.0)
    assert np.degrees(np.abs(np.diff(moved))).max() == pytest.approx(0.1)
    assert np.sum(np.isclose(moved, alpha[1])) == 31


@pytest.mark.parametrize("rate_Hz", [20.0, 200.0])
def test_the_lag_is_that_of_a_first_order_system_whose_input_moves_between_samples(rate_Hz):
    """Against steps a hundred times as fine: a coarse logger must not make the tyre slower."""
    V, sigma, finer = 6.0, 0.3, 100
    time = np.arange(int(3.0 * rate_Hz) + 1) / rate_Hz
    alpha = np.interp(time, (0.0, 0.4, 1.4, 2.0, 3.0), np.radians((0.0, 0.0, 4.0, 4.0, -2.0)))
    fine = np.linspace(0.0, time[-1], finer * (len(time) - 1) + 1)
    angle = np.interp(fine, time, alpha)
    slow = np.empty_like(angle)
    slow[0], gain = angle[0], 0.5 * V / (sigma * finer * rate_Hz)
    for i in range(1, len(fine)):  # trapezoidal rule
        slow[i] = ((1.0 - gain) * slow[i - 1] + gain * (angle[i - 1] + angle[i])) / (1.0 + gain)
    follows = lagged(alpha, V=V, sigma=sigma, rate_Hz=rate_Hz)
    assert np.abs(alpha - follows).max() > np.radians(0.19)
    # the rule's own error is gain^2/3, some 1e-5, of a lag of 0.3 deg
    assert np.degrees(follows) == pytest.approx(np.degrees(slow[::finer]), abs=1e-5)


def test_noise_has_the_size_and_the_memory_asked_for():
    table = RecordingTable(rate_Hz=20.0, correlation_s=0.5)
    values = noise(np.zeros(400_000), 25.0, table, np.random.default_rng(1))
    # 400000 samples of 10 correlated ones each: 1 % of the size, 0.01 of the correlation
    assert values.std() == pytest.approx(25.0, rel=0.03)
    assert np.corrcoef(values[:-10], values[10:])[0, 1] == pytest.approx(np.exp(-1), abs=0.03)


def test_noise_is_as_large_at_the_first_sample_as_later():
    table = RecordingTable(rate_Hz=20.0, correlation_s=5.0)
    rng = np.random.default_rng(3)
    first = [noise(np.zeros(2), 1.0, table, rng)[0] for _ in range(4000)]
    assert np.std(first) == pytest.approx(1.0, rel=0.05)
