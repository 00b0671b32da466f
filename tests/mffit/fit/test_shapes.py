"""Starting values have the shapes that their names state, and derivatives to start with."""

from __future__ import annotations

import numpy as np
import pytest
from small_rigs import truth

from mffit.fit.start import ALTERNATIVE_STARTS, NONZERO_STARTS
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


@pytest.mark.parametrize("shape", [*ALTERNATIVE_STARTS, "spin"])
def test_a_start_lies_within_the_bounds(shape):
    for name, value in ALTERNATIVE_STARTS.get(shape, NONZERO_STARTS).items():
        lower, upper = BY_NAME[name].bounds
        assert lower < value < upper


def test_the_path_of_a_disc_costs_a_little_grip_at_the_start(tyre):
    """Without any, no step would change PDYP1; with much, the fit would begin far from every tyre."""
    start = tyre.replace(**NONZERO_STARTS | {"PDYP2": 0.0, "PDYP3": 0.0, "PDYP4": 0.0})
    grip = start.state(1400.0, phi_t=np.array([0.0, -1.0 / 1.3])).zeta2
    assert 0.995 < grip[1] / grip[0] < 0.999
