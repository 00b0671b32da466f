"""Moments whose readings do not differ from noise: they count as not measured."""

import numpy as np
from scipy.special import fdtrc

from mffit.constants import FALSE_ALARM
from mffit.points import constants
from mffit.points.noise import neighbour_noise
from mffit.points.points import Points
from mffit.quantities import CHANNELS
from mffit.scatter import EFFICIENCY

MAY_BE_SILENT = ("Mx", "Mz")
"""Moments that a result can do without, and that a zero of the load cell shifts: a constant reading is not a signal."""


def without_silent_moments(points: Points) -> tuple[Points, tuple[str, ...]]:
    """The points without the moments that are noise at all conditions, and a sentence about each."""
    said = []
    for name in MAY_BE_SILENT:
        readings = points.channel(name)
        if _is_noise(points, readings):
            points = points.replace(**{name: np.full(len(points), np.nan)})
            said.append(
                f"{name} is not measured beyond its noise ({np.nanstd(readings):.2g} {CHANNELS[name].unit}): its readings follow "
                "neither load, angles and slip nor forces, so its coefficients are held"
            )
    return points, tuple(said)


def _is_noise(points: Points, readings: np.ndarray) -> bool:
    """Whether the scatter of a moment (n,) is that of neighbouring readings, and no condition or force explains part of it."""
    known = np.isfinite(readings)
    y, causes = readings[known], _causes(points)[known]
    n, k = causes.shape
    noise = neighbour_noise(points, readings)
    if n < k + constants.FEWEST_POINTS or noise == 0.0 or not np.ptp(y) > 0.0:
        return False
    y = y - np.mean(y)
    if np.isfinite(noise) and fdtrc(n, EFFICIENCY * n, np.mean(y**2) / noise**2) < FALSE_ALARM:
        return False
    explained = y @ causes @ np.linalg.pinv(causes) @ y
    left = y @ y - explained
    return bool(fdtrc(k, n - k - 1, explained / k / (left / (n - k - 1))) > FALSE_ALARM)


def _causes(points: Points) -> np.ndarray:
    """Conditions and forces (n, k) that moments follow in first order, each with mean 0 and size 1."""
    Fz, Fx = points.Fz, np.nan_to_num(points.Fx)
    settings = (points.alpha, points.gamma, points.kappa)
    columns = np.column_stack([Fz, *settings, *(Fz * x for x in settings), np.nan_to_num(points.Fy), Fx])
    columns = columns - np.mean(columns, axis=0)
    size = np.std(columns, axis=0)
    return np.asarray(columns[:, size > 0.0] / size[size > 0.0])
