"""Lag of the side force in a moving sweep, and the hysteresis that is left without the lag.

A tyre answers to a change of its sideslip angle over its relaxation length, and filters delay channels; both shift the
curve along the angle, in opposite senses on the ways up and down. Heat and friction also separate the two ways, but in
proportion to the force. So the shift is read at zero side force only.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from mffit.points import constants
from mffit.scatter import rms, robust


class Lag(NamedTuple):
    """Lag and hysteresis of one sweep."""

    lag: float  #: rolled distance by which the force lags behind the angle [m]; negative where the angle is delayed more
    u: float  #: its standard uncertainty [m], from the scatter of the points
    u_shape: float  #: the same from the choice of the curve through zero, common to all sweeps [m]
    hysteresis: float  #: half the difference of the two ways at one angle, rms over the sweep [N]


UNKNOWN = Lag(np.nan, np.nan, np.nan, np.nan)


def measure(alpha: np.ndarray, Fy: np.ndarray, s: np.ndarray, smooth: int = 1) -> Lag:
    """Lag and hysteresis of one sweep of the sideslip angle.

    Parameters
    ----------
    alpha : (n,) angle as read [rad]
    Fy : (n,) [N]
    s : (n,) rolled distance [m], rising
    smooth : samples over which the angle is averaged before its rate is taken

    Returns
    -------
    Lag
        ``UNKNOWN`` if the sweep does not go through zero force both ways.
    """
    if len(alpha) < 4 * constants.FEWEST_POINTS:
        return UNKNOWN
    rate = np.gradient(uniform_filter1d(alpha, max(smooth, 1), mode="nearest"), s)
    usual = float(np.median(np.abs(rate)))
    ways = [np.sign(rate) == way for way in (1.0, -1.0)]
    near = np.abs(Fy) < constants.NEAR_ZERO * np.max(np.abs(Fy))
    even = np.abs(np.abs(rate) - usual) < constants.EVEN_RATE * usual
    crossings = [_crossing(Fy[way & near & even], alpha[way & near & even]) for way in ways]
    if usual == 0.0 or not all(np.isfinite(crossing.alpha) for crossing in crossings):
        return UNKNOWN
    up, down = crossings
    lag = 0.5 * (up.alpha - down.alpha) / usual
    one_line = 0.5 * (up.of_one_line - down.of_one_line) / usual
    # The difference of the two ways with the lag taken off the angle.
    moved = alpha - lag * rate
    edges = np.linspace(moved.min(), moved.max(), round(math.sqrt(len(alpha))) + 1)
    means = [_binned(moved[way], Fy[way], edges) for way in ways]
    difference = means[0] - means[1]
    known = np.isfinite(difference)
    hysteresis = rms(difference[known]) / 2.0
    return Lag(
        float(lag),
        float(0.5 * np.hypot(up.u, down.u) / usual),
        float(abs(lag - one_line)),
        hysteresis,
    )


class Crossing(NamedTuple):
    """Angle at which one way of a sweep goes through zero force."""

    alpha: float  #: [rad], by two lines with a common end at zero force
    u: float  #: its standard error [rad]
    of_one_line: float  #: the same angle by one straight line [rad]


def _crossing(Fy: np.ndarray, alpha: np.ndarray) -> Crossing:
    """The angle at zero force, from the points about it.

    A way that begins cold and ends hot is steeper on one side of zero; a single line would show that as a shift.
    """
    if len(Fy) < constants.FEWEST_POINTS or Fy.min() > 0.0 or Fy.max() < 0.0:
        return Crossing(np.nan, np.nan, np.nan)
    x = Fy / np.max(np.abs(Fy))
    design = np.column_stack([np.ones(len(Fy)), x.clip(min=0.0), x.clip(max=0.0)])
    found, _, rank, _ = np.linalg.lstsq(design, alpha, rcond=constants.WEAKEST_DIRECTION_OF_ZERO)
    if rank < 3:  # one side of zero is missing
        return Crossing(np.nan, np.nan, np.nan)
    residual = alpha - design @ found
    variance, normal = float(residual @ residual) / (len(Fy) - 3), design.T @ design
    straight = float(np.polynomial.polynomial.polyfit(x, alpha, 1)[0])
    return Crossing(float(found[0]), float(np.sqrt(variance * np.linalg.inv(normal)[0, 0])), straight)


def _binned(x: np.ndarray, y: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Means of ``y`` (k,) between the edges (k + 1,); NaN in empty bins."""
    where = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.bincount(where, minlength=len(edges) - 1)
    with np.errstate(invalid="ignore"):
        return np.bincount(where, weights=y, minlength=len(edges) - 1) / np.where(count > 0, count, np.nan)


def rolled_distance(time: np.ndarray, V: np.ndarray) -> np.ndarray:
    """Distance (n,) rolled since the first sample [m], at speeds ``V`` (n,)."""
    return np.asarray(np.r_[0.0, np.cumsum(np.diff(time) * 0.5 * (V[1:] + V[:-1]))])


def common(lags: Sequence[Lag]) -> tuple[float, float]:
    """The lag of all sweeps of a recording [m] and its standard uncertainty; NaN if no sweep shows it.

    The uncertainty combines that of the median, from the scatter of the sweeps, and that of the curve's shape.
    """
    sweeps = [found for found in lags if np.isfinite(found.lag)]
    if not sweeps:
        return np.nan, np.nan
    known = np.array([found.lag for found in sweeps])
    shape = float(np.median([found.u_shape for found in sweeps]))
    if len(sweeps) < constants.FEWEST_SWEEPS:
        own = float(np.hypot.reduce([found.u for found in sweeps])) / len(sweeps)
        return float(np.mean(known)), float(np.hypot(own, shape))
    middle = float(np.median(known))
    scatter = robust(known, middle)
    return middle, float(np.hypot(1.2533 * scatter / np.sqrt(len(known)), shape))  # sqrt(pi / 2): of a median
