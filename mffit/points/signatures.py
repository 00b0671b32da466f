"""Slopes and forces whose sign or size every tyre shares, read off the points; knows no declaration.

For any tyre in ISO-W, rolling forwards: side force falls with sideslip and with camber, the aligning moment
rises with sideslip, and the turn-slip force has the sign of phi_t, away from the path's centre. Rolling
backwards, side force rises with the sideslip reading.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from mffit.points.points import Points
from mffit.points.requirements import at_zero

SMALL_SLIP = np.radians(4.0)
SMALL_CAMBER = np.radians(25.0)
SMALL_SLIP_OF_MOMENT = np.radians(3.0)
"""The aligning moment turns back earlier than the side force."""
UPRIGHT = np.radians(5.0)
STRAIGHT = np.radians(1.5)
LARGE_CAMBER = np.radians(20.0)
DOUBT = 3e-5
"""Probability of a slope of the other sign (Student's t) below which its sign counts; 4 standard errors of many points."""
SMALLEST_RANGE = np.radians(0.02)
"""A smaller range of angles [rad] has no slope."""
WEAK_FORCE = 0.01
"""A turn-slip force below this share of the load has no direction."""
FEWEST = 4


class Slope(NamedTuple):
    """A slope with its standard error; NaN where the points do not tell."""

    value: float
    error: float
    freedom: int  #: degrees of freedom of the scatter behind the error
    scatter: float  #: standard deviation about the line

    @property
    def sign(self) -> int:
        """+1 or -1 if beyond doubt, else 0."""
        clear = float(-stdtrit(max(self.freedom, 1), DOUBT)) * self.error
        return int(np.sign(self.value)) if abs(self.value) > clear else 0


UNKNOWN = Slope(np.nan, np.nan, 0, np.nan)


def pooled(slopes: Sequence[Slope]) -> list[Slope]:
    """The slopes of several files with the scatter that they have in common: five points alone hardly know theirs."""
    known = [s for s in slopes if s.freedom]
    freedom = sum(s.freedom for s in known)
    if not freedom:
        return list(slopes)
    scatter = math.sqrt(sum(s.freedom * s.scatter**2 for s in known) / freedom)
    return [
        Slope(s.value, s.error * scatter / s.scatter, freedom, scatter)
        if s.freedom and s.scatter > 0.0
        else s
        for s in slopes
    ]


class Signatures(NamedTuple):
    """What the data look like under some declaration, per unit of load."""

    cornering: Slope  #: dFy/dalpha forwards [1/rad]; negative
    camber: Slope  #: dFy/dgamma [1/rad]; negative
    aligning: Slope  #: dMz/dalpha forwards [m/rad]; positive
    backward: Slope  #: dFy/dalpha backwards [1/rad]; positive
    outward: float  #: turn-slip force along phi_t, share of the load; positive; NaN if unknown
    thrust: float  #: -Fy/Fz over tan(gamma) at large camber; 0.3 to 1.2


def signatures(points: Points) -> Signatures:
    """Read the signatures off steady points in normal mount."""
    points = points.select(points.mount > 0) if np.any(points.mount > 0) else points
    forward = points.direction > 0
    upright = (np.abs(points.alpha) <= SMALL_SLIP) & (np.abs(points.gamma) <= UPRIGHT)
    straight = (np.abs(points.alpha) <= STRAIGHT) & (np.abs(points.gamma) <= SMALL_CAMBER)
    gentle = np.abs(points.alpha) <= SMALL_SLIP_OF_MOMENT
    return Signatures(
        cornering=slope(points, points.Fy, "alpha", forward & upright),
        camber=slope(points, points.Fy, "gamma", forward & straight),
        aligning=slope(points, points.Mz, "alpha", forward & upright & gentle),
        backward=slope(points, points.Fy, "alpha", ~forward & upright),
        outward=_outward(points),
        thrust=_thrust(points),
    )


def slope(points: Points, response: np.ndarray, angle: str, used: np.ndarray) -> Slope:
    """Slope at the origin of ``response`` per load over an angle, beside the other angle.

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
    # Two points make no slope with an error, and equal angles none at all.
    if len(x) < FEWEST or np.ptp(x) < SMALLEST_RANGE:
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
    return Slope(float(solution[1]), error, freedom, scatter)


def _outward(points: Points) -> float:
    """Mean of forward and backward zeros, which sideslip misalignment and ply-steer leave alone."""
    zero = at_zero(points) & (points.phi_t != 0.0)
    outward = points.Fy * np.sign(points.phi_t) / points.Fz
    ways = [outward[zero & (points.direction == way)] for way in (1, -1)]
    means = [float(np.mean(way)) for way in ways if len(way)]
    return float(np.mean(means)) if means else float("nan")


def _thrust(points: Points) -> float:
    """Odd camber thrust at large camber; NaN without both signs of it."""
    used = (np.abs(points.alpha) <= STRAIGHT) & (np.abs(points.gamma) > LARGE_CAMBER) & (points.direction > 0)
    Fy, Fz, gamma = points.Fy[used], points.Fz[used], points.gamma[used]
    if not (np.any(gamma > 0) and np.any(gamma < 0)):
        return float("nan")
    thrust = -Fy / Fz / np.tan(gamma)
    return float((thrust[gamma > 0].mean() + thrust[gamma < 0].mean()) / 2.0)
