"""Rig faults and environment terms taken off the points, for the direct method to be redone."""

from __future__ import annotations

from mffit.points import Points
from mffit.rig import Simulation


def corrected_points(points: Points, state: Simulation) -> Points:
    """Points as a faultless rig at reference conditions would have reported them at the same readings.

    What the faults do to a reading is taken from the diagnosed model: with and without them. So the set-points stay
    mirror images of each other, which shifted angles would not.

    Parameters
    ----------
    points : raw points (n,), angles as read
    state : the simulation after all corrections, backlash included
    """
    influence = state.predict(points) - state.faultless.predict(points)
    n = len(points)
    return points.replace(Fy=points.Fy - influence[:n], Mz=points.Mz - influence[n:])
