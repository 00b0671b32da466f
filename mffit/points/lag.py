"""Lag of the side force in moving sweeps.

A tyre answers to a change of its sideslip angle over its relaxation length, and filters delay channels; both shift the
curve along the angle, in opposite senses on the ways up and down. Heat and friction also separate the two ways, but in
proportion to the force. So the shift is read at zero side force only. What is left between the two ways is a number of the fit.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from mffit.points import constants
from mffit.scatter import robust


class Lag(NamedTuple):
    """Rolled distance by which the force of a sweep lags behind the angle [m]; negative where the angle is delayed more."""

    lag: float
    u: float  #: its standard uncertainty [m], from the scatter of the points
    u_shape: float = 0.0  #: the same from the choice of the curve through zero, common to all sweeps [m]


UNKNOWN = Lag(np.nan, np.nan, np.nan)


def measure(alpha: np.ndarray, Fy: np.ndarray, s: np.ndarray, smooth: int = 1) -> Lag:
    """The lag of one sweep of the sideslip angle.

    Near zero force the angle as read is that without force, the lag times the rate of the angle, and for either way and
    either sign of the force a slope of its own: a way that begins cold and ends hot is steeper on one side of zero. One slope
    for either way gives another lag, which shows how much it hangs on the shape of the curve.

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
    near = (np.abs(Fy) < constants.NEAR_ZERO * np.max(np.abs(Fy))) & (rate != 0.0)
    x, rate = Fy[near] / np.max(np.abs(Fy)), rate[near]
    parts = [x * (way * rate > 0.0) * (side * x > 0.0) for way in (1.0, -1.0) for side in (1.0, -1.0)]
    if any(np.sum(part != 0.0) < 2 for part in parts) or len(x) < 2 * constants.FEWEST_POINTS:
        return UNKNOWN
    (lag, u), (of_lines, _) = (
        _first_of_line(np.column_stack([rate, np.ones(len(x)), *slopes]), alpha[near])
        for slopes in (parts, (parts[0] + parts[1], parts[2] + parts[3]))
    )
    return Lag(lag, u, abs(lag - of_lines))


def _first_of_line(design: np.ndarray, y: np.ndarray) -> tuple[float, float]:
    """The first coefficient of a linear model and its standard error."""
    found, *_ = np.linalg.lstsq(design, y, rcond=None)
    residual = y - design @ found
    variance = float(residual @ residual) / (len(y) - len(found))
    return float(found[0]), float(np.sqrt(variance * np.linalg.pinv(design.T @ design)[0, 0]))


def rolled_distance(time: np.ndarray, V: np.ndarray) -> np.ndarray:
    """Distance (n,) rolled since the first sample [m], at speeds ``V`` (n,)."""
    return np.asarray(np.r_[0.0, np.cumsum(np.diff(time) * 0.5 * (V[1:] + V[:-1]))])


def common(lags: Sequence[Lag]) -> Lag:
    """The lag of all sweeps of a recording: their median; ``UNKNOWN`` if no sweep shows it."""
    known = np.array([found for found in lags if np.isfinite(found.lag)])
    if not len(known):
        return UNKNOWN
    lag, shape = float(np.median(known[:, 0])), float(np.median(known[:, 2]))
    u = 1.2533 * robust(known[:, 0], lag) / np.sqrt(len(known))  # sqrt(pi / 2): of a median
    if len(known) < constants.FEWEST_SWEEPS:  # too few to show their scatter
        u = float(np.hypot.reduce(known[:, 1])) / len(known)
    return Lag(lag, float(np.hypot(u, shape)))
