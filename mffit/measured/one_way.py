"""Lag of the force behind the sideslip angle where all moving sweeps go one way, so that no reading shows it.

The force follows the angle over the tyre's relaxation length: at ``dalpha/ds`` rad per metre rolled it belongs to an angle
``length dalpha/ds`` ago. Sweeps up and down lag to either side, which the fit finds; sweeps of one way are all shifted alike, as
by an axis that is misaligned.
"""

from typing import NamedTuple

import numpy as np

from mffit.measured import constants
from mffit.points import Points
from mffit.points.clock import goes_both_ways, sense


class OneWayLag(NamedTuple):
    """The shift of the angle by the lag of a usual tyre."""

    length: float  #: usual relaxation length [m]
    angle: float  #: shift [rad], positive where the angle rises


def one_way_lag(points: Points, unloaded_radius: float) -> OneWayLag | None:
    """The lag of points whose moving sweeps all go one way; None if some go the other way, or none moves."""
    way = sense(points)
    moving = np.isfinite(points.time) & (way != 0.0)
    if not np.any(moving) or goes_both_ways(way[moving]):
        return None
    per_metre = np.zeros(len(points))
    for k in np.unique(points.sweep[moving]):
        rows = np.flatnonzero(moving & (points.sweep == k))
        if len(rows) > 1:
            time = points.time[rows]
            per_metre[rows] = np.gradient(points.alpha[rows], time) / points.V[rows]
    length = float(constants.USUAL_RELAXATION) * unloaded_radius
    return OneWayLag(length, length * float(np.median(per_metre[moving])))
