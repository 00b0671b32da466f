"""Vertical load over loaded radius with camber and side force: the forward equation, inverted by bisection."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import tir
from tir.equations import vertical

FRONT = Path(__file__).parent / "vectors" / "moto_front.tir"
CAMBER = {"Q_CAM1": 1.0, "Q_CAM2": 2.0, "Q_CAM3": 0.5}
SIDE = {"Q_FCX": 0.1, "Q_FCY": 0.4, "Q_FCY2": 0.2, "Q_FYS1": 200.0, "Q_FYS2": -100.0, "Q_FYS3": 50.0}


def tyre(**values: float) -> tir.Tyre:
    return tir.read(FRONT).replace(PFZ1=0.7, Q_FZ2=12.0, **values)


def carried(p, RL, Fx=0.0, Fy=0.0, gamma=0.0):
    return vertical.load(p, RL, vertical.Rolling(Fx, Fy, gamma, 0.0, 0.1))[0]


@pytest.mark.parametrize("values", [CAMBER, SIDE, CAMBER | SIDE])
@pytest.mark.parametrize("gamma", [0.0, 0.4, -0.8])
def test_the_loaded_radius_carries_the_load(values, gamma):
    p = tyre(**values).p
    for Fz, Fx, Fy in ((400.0, 0.0, 0.0), (1500.0, -800.0, 1200.0), (3000.0, 1500.0, -1800.0)):
        free = float(vertical.free_radius(p, 0.0))
        found = float(vertical.loaded_radius(p, Fz, vertical.Rolling(Fx, Fy, gamma, 0.0, 0.1)))
        radii = np.linspace(1.1 * free, 0.6 * free, 800)
        first = next(k for k, RL in enumerate(radii) if carried(p, RL, Fx, Fy, gamma) >= Fz)
        low, high = radii[first], radii[first - 1]
        for _ in range(50):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if carried(p, middle, Fx, Fy, gamma) >= Fz else (low, middle)
        assert found == pytest.approx(low, abs=1e-9), (Fz, Fx, Fy)


def test_the_slope_of_the_load_is_its_difference():
    p, h = tyre(**CAMBER, **SIDE).p, 1e-6
    for RL, gamma in ((0.28, 0.5), (0.285, -0.7)):
        slope = vertical.load(p, RL, vertical.Rolling(300.0, 900.0, gamma, 0.0, 0.1))[1]
        ends = (carried(p, RL + s, 300.0, 900.0, gamma) for s in (h, -h))
        assert slope == pytest.approx(np.subtract(*ends) / (2.0 * h), rel=1e-5)


def test_side_force_on_a_soft_sidewall_lowers_the_wheel():
    """A load cell reads what the deflection carries times 1 less the square of Q_FCY Fy over FNOMIN, where Q_FCY2 is 0."""
    soft = tyre(Q_FCY=0.6, Q_FCY2=0.0, Q_FYS1=0.0, Q_FYS2=0.0, Q_FYS3=0.0).p
    free, Fy = float(vertical.free_radius(soft, 0.0)), 1200.0
    alone = carried(soft, free - 0.012)
    assert carried(soft, free - 0.012, Fy=Fy) == pytest.approx(alone * (1.0 - (0.6 * Fy / soft.FNOMIN) ** 2))
    upright, pushed = (vertical.Rolling(0.0, force, 0.0, 0.0, 0.1) for force in (0.0, Fy))
    lower = vertical.loaded_radius(soft, 1500.0, pushed)
    assert lower < vertical.loaded_radius(soft, 1500.0, upright) - 5e-4
