"""What a moving sweep owes to its motion: the lag of the side force, and the hysteresis that is left without it.

A tyre answers to a change of its sideslip angle over its relaxation length, and filters delay channels; both shift the
curve along the angle, up and down in opposite senses. Where the side force is zero nothing else tells the two ways apart:
heat and friction act in proportion to the force. So the shift is read there, and only there.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

NEAR_ZERO = 0.25
"""Side force, per largest of its sweep, within which its curve is straight enough to be read at zero."""
FEWEST = 8
"""Points on each way, within that."""
WORST = 1e8
"""Condition number beyond which the points do not fix the lines: one side of zero is missing."""
BINS = 25


class Lag(NamedTuple):
    """Of one sweep."""

    lag: float  #: rolled distance by which the force lags behind the angle [m]; negative where the angle is delayed more
    u: float  #: its standard uncertainty [m]
    hysteresis: float  #: half the difference of the two ways at one angle, rms over the sweep [N]


UNKNOWN = Lag(np.nan, np.nan, np.nan)


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
        ``UNKNOWN`` where the sweep does not go through zero force both ways.
    """
    if len(alpha) < 4 * FEWEST:
        return UNKNOWN
    rate = np.gradient(uniform_filter1d(alpha, max(smooth, 1), mode="nearest"), s)
    usual = float(np.median(np.abs(rate)))
    ways = [np.sign(rate) == way for way in (1.0, -1.0)]
    near = np.abs(Fy) < NEAR_ZERO * np.max(np.abs(Fy))
    even = np.abs(np.abs(rate) - usual) < 0.5 * usual
    crossings = [_crossing(Fy[way & near & even], alpha[way & near & even]) for way in ways]
    if usual == 0.0 or not all(np.isfinite(value) for value, _ in crossings):
        return UNKNOWN
    (up, u_up), (down, u_down) = crossings
    lag = 0.5 * (up - down) / usual
    # What is left of the difference once the lag is taken off the angle.
    moved = alpha - lag * rate
    edges = np.linspace(moved.min(), moved.max(), BINS + 1)
    means = [_binned(moved[way], Fy[way], edges) for way in ways]
    difference = means[0] - means[1]
    known = np.isfinite(difference)
    hysteresis = float(np.sqrt(np.mean(difference[known] ** 2)) / 2.0) if np.any(known) else np.nan
    return Lag(float(lag), float(0.5 * np.hypot(u_up, u_down) / usual), hysteresis)


def _crossing(Fy: np.ndarray, alpha: np.ndarray) -> tuple[float, float]:
    """Angle at zero force [rad] and its standard error, from the points about it.

    They are met by two lines with a common end at zero, as a way that begins cold and ends hot is steeper on one side.
    """
    if len(Fy) < FEWEST or Fy.min() > 0.0 or Fy.max() < 0.0:
        return np.nan, np.nan
    x = Fy / np.max(np.abs(Fy))
    design = np.column_stack([np.ones(len(Fy)), x.clip(min=0.0), x.clip(max=0.0)])
    found, *_ = np.linalg.lstsq(design, alpha, rcond=None)
    residual = alpha - design @ found
    normal = design.T @ design
    if np.linalg.cond(normal) > WORST:
        return np.nan, np.nan
    variance = float(residual @ residual) / (len(Fy) - 3)
    return float(found[0]), float(np.sqrt(variance * np.linalg.inv(normal)[0, 0]))


def _binned(x: np.ndarray, y: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Means of ``y`` (k,) between the edges (k + 1,); NaN where there is none."""
    where = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, len(edges) - 2)
    count = np.bincount(where, minlength=len(edges) - 1)
    with np.errstate(invalid="ignore"):
        return np.bincount(where, weights=y, minlength=len(edges) - 1) / np.where(count > 0, count, np.nan)


def common(lags: Sequence[Lag]) -> tuple[float, float]:
    """The lag of a recording [m] and its standard uncertainty: one tyre on one rig; NaN where no sweep tells.

    The uncertainty is that of the median of the sweeps, from their scatter.
    """
    known = np.array([found.lag for found in lags if np.isfinite(found.lag)])
    if not len(known):
        return np.nan, np.nan
    if len(known) < 3:
        errors = [found.u for found in lags if np.isfinite(found.lag)]
        return float(np.mean(known)), float(np.hypot.reduce(errors) / len(errors))
    middle = float(np.median(known))
    scatter = 1.4826 * float(np.median(np.abs(known - middle)))
    return middle, float(1.2533 * scatter / np.sqrt(len(known)))
