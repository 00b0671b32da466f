"""A moment that is only noise counts as not measured; one with a faint signal, or none but a drift, does not."""

from __future__ import annotations

import re

import numpy as np
import pytest

from mffit.points.points import Points, make_points
from mffit.points.silent import without_silent_moments

N = 60
SWEEPS = 8
SWEEP = np.repeat(np.arange(SWEEPS), N)
ALPHA = np.tile(np.radians(8.0) * np.sin(np.linspace(0.0, 2.0 * np.pi, N)), SWEEPS)
FZ = np.repeat([600.0, 600.0, 900.0, 900.0, 1200.0, 1200.0, 1500.0, 1500.0], N)
GAMMA = np.repeat(np.radians([0.0, 4.0] * 4), N)
FY = -1.5 * FZ * np.sin(1.4 * np.arctan(12.0 * ALPHA))


def points(seed: int = 0, noise: float = 0.5, **moments: np.ndarray) -> Points:
    random = np.random.default_rng(seed)
    read = {name: values + noise * random.normal(size=len(FZ)) for name, values in moments.items()}
    names = tuple(f"s{k}" for k in range(SWEEPS))
    return make_points(
        ALPHA, GAMMA, FZ, Fy=FY, p=2e5, V=11.0, phi_t=0.0, sweep=SWEEP, sweep_names=names, **read
    )


@pytest.mark.parametrize("seed", range(10))
@pytest.mark.parametrize("zero", [0.0, 7.0])
def test_a_moment_of_noise_is_not_measured_whatever_the_zero_of_its_load_cell(seed, zero):
    found, said = without_silent_moments(points(seed, Mx=zero + 0.0 * FZ, Mz=-0.03 * FY))
    assert found.measured == ("Fy", "Mz")
    assert len(said) == 1
    assert re.match(r"Mx is not measured beyond its noise \(0\.[45]\d? Nm\)", said[0])


@pytest.mark.parametrize(
    "Mx",
    [
        -0.004 * FZ * GAMMA,  # a quarter of the noise
        2e-4 * FY,
        0.5 * np.sin(np.linspace(0.0, 9.0, len(FZ))),  # a drift: no tyre, but no noise either
    ],
    ids=["camber", "side force", "drift"],
)
def test_a_faint_signal_is_measured(Mx):
    found, said = without_silent_moments(points(Mx=Mx))
    assert "Mx" in found.measured
    assert not said


def test_few_points_and_a_dead_channel_are_left_to_other_rules():
    few = points(Mx=0.0 * FZ).select(np.arange(0, len(FZ), 40))
    dead = points(noise=0.0, Mx=np.full(len(FZ), 3.7))
    for one in (few, dead):
        assert without_silent_moments(one) == (one, ())
