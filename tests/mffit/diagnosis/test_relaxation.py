"""Sweeps that never rest lag behind their angle by a rolled distance."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
from blind_set import random_tyre

from mffit.diagnosis import diagnose
from mffit.points import concatenate, make_points
from tir.evaluate import evaluate

SIGMA = 0.28  # m
CONFIG = SimpleNamespace(
    tyre=SimpleNamespace(name="moving"),
    model=SimpleNamespace(turn_slip=True, star=False, u_coefficients=0.0),
    rig=SimpleNamespace(backlash_deg=0.0),
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


def test_a_moving_sweep_without_lag_has_no_relaxation(tyre):
    assert not diagnose(campaign(tyre, 0.0), tyre, CONFIG).effects
