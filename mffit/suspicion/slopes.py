"""Slopes and forces whose sign and size all tyres share, read from points alone.

For every tyre in ISO-W that rolls forwards, side force falls with sideslip and with camber, the aligning moment
rises with sideslip, and the turn-slip force has the sign of phi_t: it points away from the path's centre. Rolling
backwards, side force rises with the sideslip reading.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from mffit.constants import ZERO_CAMBER, ZERO_SIDESLIP
from mffit.points import Points
from mffit.suspicion import constants


class Slope(NamedTuple):
    """A slope with its standard error; NaN where the points do not determine it."""

    value: float
    error: float
    freedom: int  #: degrees of freedom of the scatter behind the error
    scatter: float  #: standard deviation about the line

    @property
    def sign(self) -> int:
        """+1 or -1 if the sign is significant, else 0."""
        clear = float(-stdtrit(max(self.freedom, 1), constants.CHANCE_OF_OTHER_SIGN)) * self.error
        return int(np.sign(self.value)) if abs(self.value) > clear else 0


UNKNOWN = Slope(value=np.nan, error=np.nan, freedom=0, scatter=np.nan)


def pooled(slopes: Sequence[Slope]) -> list[Slope]:
    """The slopes of several files with the scatter of all: five points alone hardly determine theirs."""
    known = [s for s in slopes if s.freedom]
    freedom = sum(s.freedom for s in known)
    if not freedom:
        return list(slopes)
    scatter = math.sqrt(sum(s.freedom * s.scatter**2 for s in known) / freedom)
    return [
        Slope(value=s.value, error=s.error * scatter / s.scatter, freedom=freedom, scatter=scatter)
        if s.freedom and s.scatter > 0.0
        else s
        for s in slopes
    ]


class Signatures(NamedTuple):
    """Slopes and forces per unit of load, under some declaration."""

    cornering: Slope  #: dFy/dalpha forwards [1/rad]; negative
    camber: Slope  #: dFy/dgamma [1/rad]; negative
    aligning: Slope  #: dMz/dalpha forwards [m/rad]; positive
    backward: Slope  #: dFy/dalpha backwards [1/rad]; positive
    outward: float  #: turn-slip force along phi_t, share of the load; positive; NaN if unknown
    thrust: float  #: -Fy/Fz over tan(gamma) at large camber; 0.3 to 1.2


def signatures(points: Points) -> Signatures:
    """The signatures of steady points in normal mount."""
    points = points.select(points.mount > 0) if np.any(points.mount > 0) else points
    forward = points.direction > 0
    sideslip, camber = np.abs(points.alpha), np.abs(points.gamma)
    upright = (sideslip <= constants.SIDESLIP_OF_SLOPES.rad) & (camber <= constants.UPRIGHT_FOR_SLOPES.rad)
    straight = (sideslip <= constants.STRAIGHT_FOR_SLOPES.rad) & (camber <= constants.CAMBER_OF_SLOPES.rad)
    gentle = sideslip <= constants.SIDESLIP_OF_MOMENT_SLOPE.rad
    return Signatures(
        cornering=slope(points, points.Fy, "alpha", forward & upright),
        camber=slope(points, points.Fy, "gamma", forward & straight),
        aligning=slope(points, points.Mz, "alpha", forward & upright & gentle),
        backward=slope(points, points.Fy, "alpha", ~forward & upright),
        outward=_outward(points),
        thrust=_thrust(points),
    )


def slope(points: Points, response: np.ndarray, angle: str, used: np.ndarray) -> Slope:
    """Slope of ``response`` per load over an angle, with a linear term of the other angle.

    Parameters
    ----------
    points : (n,)
    response : (n,) force or moment
    angle : "alpha" or "gamma"
    used : mask (n,)
    """
    used = used & np.isfinite(response)
    other = points.gamma if angle == "alpha" else points.alpha
    x, y = getattr(points, angle)[used], (response / points.Fz)[used]
    if len(x) < constants.FEWEST_POINTS_OF_SLOPE or np.ptp(x) < constants.SMALLEST_RANGE_OF_SLOPE.rad:
        return UNKNOWN
    columns = [np.ones_like(x), x]
    if np.ptp(other[used]) > 0.0:
        columns.append(other[used])
    design = np.column_stack(columns)
    solution, _, rank, _ = np.linalg.lstsq(design, y, rcond=1e-8)
    freedom = len(x) - rank
    if rank < design.shape[1] or freedom < 1:
        return UNKNOWN
    scatter = float(np.sqrt(np.sum((y - design @ solution) ** 2) / freedom))
    error = scatter * float(np.sqrt(np.linalg.inv(design.T @ design)[1, 1]))
    return Slope(value=float(solution[1]), error=error, freedom=int(freedom), scatter=scatter)


def at_zero(points: Points) -> np.ndarray:
    """Mask (n,) of the points at zero sideslip and camber."""
    upright = np.abs(np.degrees(points.gamma)) <= ZERO_CAMBER
    return upright & (np.abs(np.degrees(points.alpha)) <= ZERO_SIDESLIP)


def _outward(points: Points) -> float:
    """Mean of forward and backward zeros, which sideslip misalignment and ply-steer do not change."""
    zero = at_zero(points) & (points.phi_t != 0.0)
    outward = points.Fy * np.sign(points.phi_t) / points.Fz
    ways = [outward[zero & (points.direction == way)] for way in (1, -1)]
    means = [float(np.mean(way)) for way in ways if len(way)]
    return float(np.mean(means)) if means else float("nan")


def _thrust(points: Points) -> float:
    """Odd camber thrust at large camber; NaN without both signs of camber."""
    straight = np.abs(points.alpha) <= constants.STRAIGHT_FOR_SLOPES.rad
    leaning = np.abs(points.gamma) > constants.CAMBER_OF_THRUST.rad
    used = straight & leaning & (points.direction > 0)
    Fy, Fz, gamma = points.Fy[used], points.Fz[used], points.gamma[used]
    if not (np.any(gamma > 0) and np.any(gamma < 0)):
        return float("nan")
    thrust = -Fy / Fz / np.tan(gamma)
    return float((thrust[gamma > 0].mean() + thrust[gamma < 0].mean()) / 2.0)
