"""Slopes and forces whose sign all tyres share, computed from points alone. Their sizes differ between tyres.

For every tyre that rolls forwards, in ISO-W axes, side force falls with sideslip and with camber, the aligning moment rises with
sideslip, and the turn-slip force has the sign of phi_t: it points away from the path's centre. Rolling backwards, side force
rises with the sideslip reading.
"""

import math
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy.special import stdtrit

from mffit.constants import CAMBER_OF_SLOPES, FALSE_ALARM, FEWEST, STRAIGHT, UPRIGHT
from mffit.points import Points, levels
from mffit.suspicion import constants
from mffit.suspicion.rule import Facts, Outcome, Rule, rule
from tir.constants import NEGLIGIBLE_SHARE


class SlopeWithError(NamedTuple):
    """A slope with its standard error; NaN where the points do not determine it."""

    value: float
    error: float
    freedom: int  #: degrees of freedom of the scatter behind the error
    scatter: float  #: standard deviation about the line

    @property
    def clear(self) -> float:
        """Smallest significant difference of the slope from a given number (Student's t)."""
        return float(-stdtrit(max(self.freedom, 1), FALSE_ALARM / 2.0)) * self.error

    @property
    def sign(self) -> int:
        """+1 or -1 if the sign is significant, else 0."""
        return int(np.sign(self.value)) if abs(self.value) > self.clear else 0


UNKNOWN = SlopeWithError(value=np.nan, error=np.nan, freedom=0, scatter=np.nan)


def pooled(slopes: Sequence[SlopeWithError]) -> list[SlopeWithError]:
    """The slopes of several files with standard errors from their pooled scatter, as few points of one file hardly show it."""
    known = [s for s in slopes if s.freedom]
    freedom = sum(s.freedom for s in known)
    if not freedom:
        return list(slopes)
    scatter = math.sqrt(sum(s.freedom * s.scatter**2 for s in known) / freedom)
    return [
        SlopeWithError(value=s.value, error=s.error * scatter / s.scatter, freedom=freedom, scatter=scatter)
        if s.freedom and s.scatter > 0.0
        else s
        for s in slopes
    ]


class Signatures(NamedTuple):
    """Slopes and forces per unit of load, under one declaration."""

    cornering: SlopeWithError  #: dFy/dalpha forwards [1/rad]; negative
    camber: SlopeWithError  #: dFy/dgamma [1/rad]; negative; unknown where camber stands still
    aligning: SlopeWithError  #: dMz/dalpha forwards [m/rad]; positive
    backward: SlopeWithError  #: dFy/dalpha backwards [1/rad]; positive
    outward: float  #: turn-slip force along phi_t, share of the load; positive; NaN if unknown
    thrust: float  #: -Fy/Fz over tan(gamma) at large camber


def signatures(points: Points) -> Signatures:
    """The signatures of steady points in normal mount at which the wheel rolls freely."""
    free = points.free_rolling
    normal = free & (points.mount > 0)
    points = points.select(normal if np.any(normal) else free, with_table=False)
    forward = points.direction > 0
    sideslip, camber = np.abs(points.alpha), np.abs(points.gamma)
    upright = (sideslip <= constants.SIDESLIP_OF_SLOPES.rad) & (camber <= UPRIGHT.rad)
    straight = (sideslip <= STRAIGHT.rad) & (camber <= CAMBER_OF_SLOPES.rad)
    return Signatures(
        cornering=slope(points, points.Fy, "alpha", forward & upright),
        camber=slope(points, points.Fy, "gamma", forward & straight),
        aligning=slope(points, points.Mz, "alpha", forward & upright),
        backward=slope(points, points.Fy, "alpha", ~forward & upright),
        outward=_outward(points),
        thrust=_thrust(points),
    )


def overturning_slope(points: Points) -> SlopeWithError:
    """dMx/dgamma per load [m/rad], rolling forwards, also driven; negative for every tyre, because the load moves with the lean.

    The slope of Mx over sideslip is not used: depending on QSX3 it has either sign.
    """
    points = points.select((points.mount > 0) & (points.direction > 0))
    sideslip, camber = np.abs(points.alpha), np.abs(points.gamma)
    straight = (sideslip <= STRAIGHT.rad) & (camber <= CAMBER_OF_SLOPES.rad)
    return slope(points, points.Mx, "gamma", straight)


STILL = {"alpha": STRAIGHT.rad, "gamma": UPRIGHT.rad}
"""Range [rad] within which an angle stands still: a slope over its deflection and noise shows those of the rig."""


def slope(
    points: Points, response: np.ndarray, angle: str, used: np.ndarray, still: Mapping[str, float] = STILL
) -> SlopeWithError:
    """Slope of ``response`` (n,) per load over "alpha" or "gamma" at some points, with a linear term of the other angle.

    Every level of load has its own intercept: ply-steer, conicity and deflections of the rig change with the load. The slope is
    unknown where the angle is ``still``, that is varies within this range [rad].
    """
    x, other = (points.alpha, points.gamma) if angle == "alpha" else (points.gamma, points.alpha)
    used = used & np.isfinite(response)
    if not np.any(used) or np.ptp(x[used]) <= still[angle]:
        return UNKNOWN
    return line(x, response / points.Fz, used, other, levels.nearest_labels(points.Fz, levels.LOAD))


def line(
    x: np.ndarray,
    y: np.ndarray,
    used: np.ndarray,
    other: np.ndarray | None = None,
    group: np.ndarray | None = None,
) -> SlopeWithError:
    """Slope of y (n,) over x (n,) at the ``used`` finite values, with a linear term of another variable (n,) if it varies.

    ``group`` (n,) are labels of points that share an intercept; without it all do.
    """
    used = used & np.isfinite(y)
    if np.sum(used) < FEWEST:
        return UNKNOWN
    own = np.zeros(int(np.sum(used))) if group is None else group[used]
    columns = [x[used], *(1.0 * (own == k) for k in np.unique(own))]
    if other is not None and np.ptp(other[used]) > 0.0:
        columns.append(other[used])
    design, y = np.column_stack(columns), y[used]
    solution, _, rank, _ = np.linalg.lstsq(design, y, rcond=1e-8)
    freedom = len(y) - rank
    if rank < design.shape[1] or freedom < 1:
        return UNKNOWN
    scatter = float(np.sqrt(np.sum((y - design @ solution) ** 2) / freedom))
    error = scatter * float(np.sqrt(np.linalg.inv(design.T @ design)[0, 0]))
    return SlopeWithError(value=float(solution[0]), error=error, freedom=int(freedom), scatter=scatter)


def at_zero(points: Points) -> np.ndarray:
    """Mask (n,) of the points at zero sideslip and camber."""
    return np.asarray((np.abs(points.gamma) <= UPRIGHT.rad) & (np.abs(points.alpha) <= STRAIGHT.rad))


def _outward(points: Points) -> float:
    """Turn-slip force over load: mean of forward and backward zeros, which cancels sideslip misalignment and ply-steer."""
    zero = at_zero(points) & (points.phi_t != 0.0)
    outward = points.Fy * np.sign(points.phi_t) / points.Fz
    ways = [outward[zero & (points.direction == way)] for way in (1, -1)]
    means = [float(np.mean(way)) for way in ways if len(way)]
    return float(np.mean(means)) if means else float("nan")


def _thrust(points: Points) -> float:
    """Odd camber thrust at large camber; NaN without both signs of camber."""
    straight = np.abs(points.alpha) <= STRAIGHT.rad
    leaning = np.abs(points.gamma) > CAMBER_OF_SLOPES.rad
    used = straight & leaning & (points.direction > 0)
    Fy, Fz, gamma = points.Fy[used], points.Fz[used], points.gamma[used]
    if not (np.any(gamma > 0) and np.any(gamma < 0)):
        return float("nan")
    thrust = -Fy / Fz / np.tan(gamma)
    return float((thrust[gamma > 0].mean() + thrust[gamma < 0].mean()) / 2.0)


def _of_sign(found: Signatures, slope: str, sign: int, column: str) -> Iterator[Facts]:
    if getattr(found, slope).sign == sign:
        yield {"column": column}


def contradictions(found: Signatures) -> list[str]:
    """Contradictions of the signatures to every tyre, as clauses; empty for plausible signatures."""
    return [rule.said(facts) for rule in NO_TYRE for facts in rule.find(found)]


@rule(
    id="turn-slip-force-inwards",
    outcome=Outcome.CONTRADICTION,
    sentence="Fy_N at alpha = gamma = 0 points towards the declared centre of the path",
)
def turn_slip_inwards(found: Signatures) -> Iterator[Facts]:
    """Fy per load at alpha = gamma = 0, outwards, mean of both directions."""
    if found.outward < -NEGLIGIBLE_SHARE:
        yield {"column": "Fy_N"}


SIGNS = tuple(
    Rule(
        id=id,
        looks_at=looks_at,
        outcome=Outcome.CONTRADICTION,
        sentence=sentence,
        find=partial(_of_sign, slope=slope, sign=sign, column=column),
    )
    for id, slope, sign, column, sentence, looks_at in (
        ("force-rises-with-sideslip", "cornering", 1, "alpha_deg", "Fy_N rises with alpha_deg",
         "Slope of Fy over sideslip, rolling forwards"),
        ("force-rises-with-camber", "camber", 1, "gamma_deg", "Fy_N rises with gamma_deg",
         "Slope of Fy over camber, rolling forwards"),
        ("moment-falls-with-sideslip", "aligning", -1, "Mz_Nm", "Mz_Nm falls with alpha_deg",
         "Slope of Mz over sideslip, rolling forwards"),
        ("force-falls-with-sideslip-backwards", "backward", -1, "alpha_deg",
         "Fy_N falls with alpha_deg in backward runs", "Slope of Fy over sideslip, rolling backwards"),
    )
)  # fmt: skip
NO_TYRE = (*SIGNS, turn_slip_inwards)
"""Rules on signs that no tyre has."""
