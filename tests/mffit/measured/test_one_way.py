"""The lag of the force where all moving sweeps go one way."""

from __future__ import annotations

import math

import numpy as np
import pytest

from mffit import config as configuration
from mffit.fit.rig.rig_numbers import held_rig
from mffit.measured import measure
from mffit.measured.one_way import one_way_lag
from mffit.parts import split
from mffit.points import make_points
from mffit.suspicion import JudgedMeasurement, judge

RATE, V, R0 = 5.0, 8.0, 0.3  # deg/s, m/s, m


def ramps(*ways, moving=True):
    """Ramps of sideslip from -8 to 8 deg, or back where the way is -1, at the rate; or the same angles held."""
    alpha = np.linspace(-8.0, 8.0, 33)
    time = (alpha + 8.0) / RATE
    n = len(alpha)
    angles = np.radians(np.concatenate([way * alpha for way in ways]))
    return make_points(
        angles, 0.0, 1400.0, Fy=-15000.0 * angles, Mz=np.nan, p=250e3, V=V, phi_t=0.0,
        time=np.tile(time, len(ways)) if moving else np.nan, sweep=np.repeat(np.arange(len(ways)), n),
        sweep_names=tuple(f"s{k}" for k in range(len(ways))),
    )  # fmt: skip


@pytest.mark.parametrize("way", [1, -1])
def test_ramps_of_one_way_are_shifted_by_the_length_times_the_angle_per_metre(way):
    lag = one_way_lag(ramps(*[way] * 4), R0)
    assert lag.angle == pytest.approx(way * lag.length * math.radians(RATE) / V)
    assert 0.5 * R0 < lag.length < 2.0 * R0


def test_ramps_of_both_ways_and_held_angles_have_no_unseen_lag():
    assert one_way_lag(ramps(1, -1, 1, -1), R0) is None
    assert one_way_lag(ramps(1, 1, 1, 1, moving=False), R0) is None


def test_an_unseen_lag_is_a_doubt_and_in_the_uncertainty_of_the_zero():
    found = []
    for ways in ((1, 1, 1, 1), (1, -1, 1, -1)):
        points = ramps(*ways)
        config = configuration.load(
            {
                "tyre": {
                    "name": "x",
                    "unloaded_radius": R0,
                    "nominal_load": 1400.0,
                    "nominal_pressure": 250.0,
                },
                "rig": {"type": "flat-track", "axes": "iso"},
                "sweep": [{"file": "none.csv"}],
            }
        )
        measured = measure(config, points, split(points))
        doubts = judge(JudgedMeasurement(points=points, lag=measured.lag)).doubts
        zero = held_rig(config, measured)["alpha_0_deg"]
        found.append((doubts, zero, measured.lag))
    ((said,), wide, lag), (none, usual, _) = found
    assert "one way" in said
    assert none == ()
    assert wide == pytest.approx(math.hypot(usual, math.degrees(lag.angle)))
