"""Where the moment changes sign within the play, friction decides where the wheel rests, and readings may lie in between."""

from __future__ import annotations

import numpy as np

import tir
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import NO_FAULTS
from tests.mffit.diagnosis.small_programme import TYRE

PLAY = 0.4  # deg


def points():
    alpha = np.radians([-3.0, -0.15, 0.0, 0.15, 3.0])
    return make_points(alpha, 0.0, 1500.0, p=250e3, V=10.0, phi_t=0.0)


def moment(tyre: tir.Tyre, shift_deg: float) -> np.ndarray:
    at = points()
    return tyre(at.Fz, alpha=at.alpha + np.radians(shift_deg), p=at.p, Vx=10.0, turn_slip=False).Mz


def test_the_wheel_floats_where_the_stops_hold_it_with_opposite_moments():
    """The moments at both stops, from the tyre itself."""
    found = Simulation.of(TYRE, NO_FAULTS.replace(backlash_deg=PLAY), turn_slip=False).floats(points())
    assert np.array_equal(found, moment(TYRE, -PLAY / 2.0) * moment(TYRE, PLAY / 2.0) < 0.0)
    assert found[1:4].any()
    assert not found[[0, 4]].any()


def test_a_zero_of_the_moment_channel_turns_no_wheel():
    """The offset is in the reading, not in the moment on the wheel."""
    loose = NO_FAULTS.replace(backlash_deg=PLAY)
    plain, shifted = (
        Simulation.of(TYRE, faults, turn_slip=False).floats(points())
        for faults in (loose, loose.replace(M0_Nm=50.0))
    )
    assert np.array_equal(plain, shifted)


def test_without_play_no_wheel_floats():
    assert not Simulation.of(TYRE).floats(points()).any()
