"""The tests' own rig and the virtual rig agree on wheels with play; their codes are independent."""

from __future__ import annotations

import numpy as np
import pytest
from blind_rig import resting

from mffit.virtual_rig.machine import taken_up

PLAY = np.radians(0.4)
ALPHA = np.radians(np.linspace(-2.0, 2.0, 81))


@pytest.mark.parametrize("zero_deg", [0.0, 0.13, -0.77])
@pytest.mark.parametrize("sense", [1.0, -1.0])
def test_wheels_with_play_come_to_rest_at_the_same_angles(zero_deg, sense):
    def moment(alpha):
        return sense * np.sin(alpha - np.radians(zero_deg))

    rest = resting(moment, ALPHA, PLAY, moment(ALPHA))
    other = taken_up(moment, ALPHA, PLAY / 2.0)
    decided = moment(ALPHA) != 0.0  # at an unstable point of balance either end will do
    # half the play, halved 16 times after the walk
    assert rest[decided] == pytest.approx(other[decided], abs=PLAY / 2**16)


def test_a_wheel_floats_if_its_moment_changes_sign_within_the_play():
    zero = np.radians(0.05)
    rest = resting(lambda alpha: alpha - zero, ALPHA, PLAY, ALPHA - zero)
    within = np.abs(ALPHA - zero) < PLAY / 2.0
    assert within.sum() > 5
    assert rest[within] == pytest.approx(np.full(within.sum(), zero), abs=PLAY / 2**16)
    assert np.abs(rest - ALPHA)[~within] == pytest.approx(np.full((~within).sum(), PLAY / 2.0))
