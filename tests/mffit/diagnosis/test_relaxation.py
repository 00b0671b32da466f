"""Forces of continuous sweeps lag behind their angle by a rolled distance."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from blind_set import random_tyre
from scipy.integrate import solve_ivp

from mffit.config import RigTable
from mffit.diagnosis import diagnose
from mffit.points import concatenate, make_points
from mffit.rig.lag import lagged_setting
from tir.evaluate import evaluate

SIGMA = 0.28  # m
CONFIG = SimpleNamespace(
    tyre=SimpleNamespace(name="moving", nominal_load=1500.0),
    model=SimpleNamespace(turn_slip=True, star=False, u_coefficients=0.0),
    rig=RigTable(type="flat-track"),
)


def moving_sweep(tyre, load, speed, rate_deg_s, sigma, rng, name):
    """A triangular sideslip sweep, the lag integrated in small steps, reported at 4 Hz."""
    fine = np.arange(0.0, 4 * 8.0 / rate_deg_s, 0.005)
    angle = np.radians(8.0) * np.interp((fine * rate_deg_s / 32.0) % 1.0, (0, 0.25, 0.75, 1), (0, 1, -1, 0))
    lagged = np.empty_like(angle)
    lagged[0] = angle[0]
    for i in range(1, len(fine)):
        lagged[i] = lagged[i - 1] + 0.005 * speed / sigma * (angle[i] - lagged[i - 1]) if sigma else angle[i]
    kept = slice(None, None, 50)
    out, _ = evaluate(tyre.p, load, lagged[kept], 0.0, 0.0, 0.0, speed, 250e3)
    n = len(out.Fy)
    return make_points(
        angle[kept], 0.0, load, p=250e3, V=speed, phi_t=0.0, continuous=True, time=fine[kept], u_Fy=6.0, u_Mz=0.6,
        Fy=out.Fy + rng.normal(0.0, 6.0, n), Mz=out.Mz + rng.normal(0.0, 0.6, n), sweep_names=(name,),
    )  # fmt: skip


@pytest.fixture(scope="module")
def tyre():
    return random_tyre("front", np.random.default_rng(4))


def campaign(tyre, sigma):
    rng = np.random.default_rng(6)
    return concatenate(
        [moving_sweep(tyre, load, 4.0, 2.0, sigma, rng, f"{load}") for load in (900.0, 1500.0, 2200.0)]
    )


def test_the_lag_of_a_moving_sweep_is_named_with_its_length(tyre):
    found = diagnose(campaign(tyre, SIGMA), tyre, CONFIG)
    assert [f.effect.id for f in found.effects] == ["relaxation"]
    value, error = found.effects[0].parameters["relaxation_m"]
    assert value == pytest.approx(SIGMA, abs=max(5.0 * error, 0.03))


def test_a_sweep_that_begins_in_motion_shows_the_lag_and_no_hysteresis(tyre):
    """The wheel steered before the first sample, which therefore lags although no sample before it tells."""
    points = campaign(tyre, SIGMA)
    running = points.select((points.time > 1.0) & (points.time < 13.0))
    found = diagnose(running, tyre, CONFIG)
    assert [f.effect.id for f in found.effects] == ["relaxation"]
    assert found.effects[0].parameters["relaxation_m"][0] == pytest.approx(SIGMA, abs=0.02)


def test_a_moving_sweep_without_lag_has_no_relaxation(tyre):
    assert not diagnose(campaign(tyre, 0.0), tyre, CONFIG).effects


def integrated(time, speed, alpha):
    """alpha' [rad] by a general integrator, sample by sample, the angle linear over each step."""
    behind = [alpha[0]]
    for t0, t1, V, a0, a1 in zip(time, time[1:], speed, alpha, alpha[1:], strict=False):
        found = solve_ivp(
            lambda t, y, t0=t0, t1=t1, V=V, a0=a0, a1=a1: V / SIGMA * (a0 + (a1 - a0) * (t - t0) / (t1 - t0) - y),
            (t0, t1), [behind[-1]], rtol=1e-10, atol=1e-13,
        )  # fmt: skip
        behind.append(found.y[0, -1])
    return np.array(behind)


def moving(alpha, time, V):
    return make_points(alpha, 0.0, 1500.0, p=250e3, V=V, phi_t=0.0, continuous=True, time=time)


def test_the_lag_is_exact_at_uneven_steps_whatever_the_order_of_the_rows():
    rng = np.random.default_rng(7)
    time = np.concatenate([[0.0], np.cumsum(rng.choice([0.01, 0.1, 0.5, 1.5], 60))])
    alpha = np.radians(8.0 * np.sin(1.3 * time) + rng.normal(0.0, 1.0, len(time)))
    expected = integrated(time, np.full(len(time), 1.0), alpha)
    assert np.degrees(np.abs(alpha - expected)).max() > 2.0
    shuffled = rng.permutation(len(time))
    found = lagged_setting(moving(alpha[shuffled], time[shuffled], 1.0), SIGMA)[0]
    assert found == pytest.approx(expected[shuffled], abs=1e-8)


def test_a_wheel_at_rest_keeps_its_lag():
    """The force answers to rolled distance: steering a wheel at rest moves alpha alone."""
    time = np.array([0.0, 0.5, 1.0, 1.0, 2.0])
    alpha = np.radians([1.0, 2.0, 3.0, 3.5, 4.0])
    standing = lagged_setting(moving(alpha, time, 0.0), SIGMA)[0]
    assert np.degrees(standing) == pytest.approx(np.ones(5), abs=1e-12)


def test_steps_without_distance_do_not_change_later_samples():
    time, alpha = np.array([0.0, 0.2, 0.5, 0.9]), np.radians([0.0, 2.0, 3.0, 1.0])
    once = lagged_setting(moving(alpha, time, 2.0), SIGMA)[0]
    twice = lagged_setting(moving(np.repeat(alpha, 2), np.repeat(time, 2), 2.0), SIGMA)[0]
    assert twice[::2] == pytest.approx(once, abs=1e-15)
    assert twice[1::2] == pytest.approx(once, abs=1e-15)
    expected = integrated(time, np.full(4, 2.0), alpha)
    assert once == pytest.approx(expected, abs=1e-9)
