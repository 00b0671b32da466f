"""The alternative starting values have the shapes that their names state."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import truth

from mffit.fit.start import ALTERNATIVE_STARTS
from tir.parameters import BY_NAME

SLIP = np.radians(np.linspace(0.1, 30.0, 300))


@pytest.fixture(scope="module")
def tyre():
    """A tyre without load dependence, camber effects and shifts."""
    changes = dict.fromkeys(
        ("PHY1", "PHY2", "PVY1", "PVY2", "PEY3", "QHZ1", "QHZ2", "QDZ6", "QDZ7", "QEZ3", "QEZ4"), 0.0
    )
    return truth().replace(**changes)


def left(tyre, shape: str) -> float:
    """Side force at 30 deg of sideslip over its peak."""
    Fy = np.abs(tyre.replace(**ALTERNATIVE_STARTS[shape])(1400.0, SLIP).Fy)
    return float(Fy[-1] / Fy.max())


def half(tyre, shape: str) -> float:
    """Sideslip at which half the trail is left [deg]."""
    trail = tyre.replace(**ALTERNATIVE_STARTS[shape]).state(1400.0, SLIP).trail
    return float(np.degrees(SLIP[np.argmax(trail < 0.5 * trail[0])]))


def test_a_round_curve_keeps_its_force_and_a_peaked_one_does_not(tyre):
    assert left(tyre, "a round side-force curve") > 0.97
    assert left(tyre, "a peaked side-force curve") < 0.9


def test_a_short_trail_is_gone_at_half_the_sideslip_of_a_long_one(tyre):
    assert 2.0 * half(tyre, "a short trail") < half(tyre, "a long trail")


@pytest.mark.parametrize("shape", ["a short trail", "a long trail"])
def test_the_trail_vanishes_and_hardly_changes_sign(tyre, shape):
    trail = tyre.replace(**ALTERNATIVE_STARTS[shape]).state(1400.0, SLIP).trail
    assert trail.min() < 0.2 * trail[0]
    assert trail.min() > -0.4 * trail[0]


@pytest.mark.parametrize("shape", ALTERNATIVE_STARTS)
def test_a_start_lies_within_the_bounds(shape):
    for name, value in ALTERNATIVE_STARTS[shape].items():
        lower, upper = BY_NAME[name].bounds
        assert lower < value < upper
