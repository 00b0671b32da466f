"""Every channel of the forward model against direct calls of the tyre, its zero, and its derivatives."""

from __future__ import annotations

import numpy as np
import pytest

import tir
from mffit.points import make_points
from mffit.rig import SIMULATED, Readings, Simulation
from mffit.rig_errors import BY_NAME, Faults

CHANNELS = ("Fx", "Fy", "Mx", "My", "Mz", "omega")
ZEROS = {"Fx": "Fx0_N", "Fy": "F0_N", "Mx": "Mx0_Nm", "My": "My0_Nm", "Mz": "M0_Nm"}


@pytest.fixture(scope="module")
def tyre():
    return tir.read("samples/front-120-70/true.tir").replace(QSX1=0.01, QSX2=0.4, QSX3=0.05, PDX1=1.3)


@pytest.fixture(scope="module")
def points():
    rng = np.random.default_rng(3)
    n = 20
    return make_points(
        rng.uniform(-0.1, 0.1, n), rng.uniform(-0.4, 0.4, n), rng.uniform(800.0, 2000.0, n), p=250e3, V=9.0, phi_t=0.0,
        kappa=rng.uniform(-0.2, 0.2, n),
    )  # fmt: skip


def test_every_channel_is_that_of_the_tyre_under_the_slip_of_the_points(tyre, points):
    read = Simulation.of(tyre, turn_slip=False).readings(points, CHANNELS)
    at = (points.Fz, points.alpha, points.gamma, points.kappa)
    how = {"Vx": 9.0, "p": 250e3, "turn_slip": False}
    forces, state = tyre(*at, **how), tyre.state(*at, **how)
    assert list(read) == list(CHANNELS)
    for name in CHANNELS:
        expected = getattr(forces, name) if hasattr(forces, name) else getattr(state, name)
        assert read[name] == pytest.approx(expected, rel=1e-9), name
    assert not np.allclose(
        read.Fy, Simulation.of(tyre, turn_slip=False).readings(points.replace(kappa=0.0)).Fy
    )


@pytest.mark.parametrize("channel", ZEROS)
def test_the_zero_of_a_channel_adds_to_its_reading_alone(tyre, points, channel):
    sound, off = Simulation.of(tyre), Simulation.of(tyre, Faults(**{ZEROS[channel]: 7.0}))
    for name, values in off.readings(points, CHANNELS).items():
        difference = values - sound.readings(points, CHANNELS)[name]
        assert difference == pytest.approx(7.0 if name == channel else 0.0, abs=1e-9)
    error = BY_NAME[ZEROS[channel]]
    assert [error.shows_in((name,)) for name in ZEROS] == [name == channel for name in ZEROS]


@pytest.mark.parametrize("name", ["QSX2", "PDX1", "PKX1", "QSY1", "Mx0_Nm", "Fx0_N", "alpha_0_deg"])
def test_the_derivative_of_every_channel_is_its_slope(tyre, points, name):
    simulation = Simulation.of(tyre)
    value, step = simulation.number(name, points), 1e-5
    up, down = (simulation.with_numbers({name: value + s}).predict(points, CHANNELS) for s in (step, -step))
    slope = simulation.sensitivities(points, [name], CHANNELS)[1].stacked[:, 0]
    expected = (up - down) / (2.0 * step)
    assert np.max(np.abs(expected)) > 0.5
    assert slope == pytest.approx(expected, abs=1e-5 * np.max(np.abs(expected)))


def test_readings_keep_the_order_of_the_channels_and_come_back_from_one_row():
    some = Readings(Mz=np.array([3.0, 4.0]), Fx=np.array([1.0, 2.0]))
    assert list(some) == ["Fx", "Mz"]
    assert some.stacked.tolist() == [1.0, 2.0, 3.0, 4.0]
    again = Readings.split(some.stacked, some)
    assert again.Mz.tolist() == [3.0, 4.0]
    with pytest.raises(AttributeError, match="no readings of Fy"):
        _ = some.Fy
    with pytest.raises(KeyError, match="Fv is no channel"):
        Readings(Fv=np.zeros(1))


def test_the_loaded_radius_is_measured_and_not_yet_simulated():
    assert set(CHANNELS) <= set(SIMULATED)
