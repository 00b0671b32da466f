"""Readings without the rig's errors and the influence of the environment."""

from __future__ import annotations

from mffit.points import Points
from mffit.rig import Simulation


def corrected_points(points: Points, state: Simulation) -> Points:
    """Points as a faultless rig at reference conditions would have reported them at the same readings of the angles.

    The influence of the faults on a reading is that of the diagnosed model. Shifting the angles instead would break the
    mirror symmetry of the set-points.

    Parameters
    ----------
    points : raw points (n,), angles as read
    state : the simulation after all corrections, backlash included
    """
    faulty, faultless = state.readings(points), state.faultless.readings(points)
    return points.replace(
        Fy=points.Fy - (faulty.Fy - faultless.Fy), Mz=points.Mz - (faulty.Mz - faultless.Mz)
    )
