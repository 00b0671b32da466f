"""Weights of the points: from their stated uncertainty, the misfit of the model, and outlier rejection.

Residuals beyond the Huber threshold get a reduced weight, because a model may miss a stretch of a sweep by more than the noise.
An outlier, a single reading far from both the model and its neighbours in the sweep, is a measurement error: its weight is zero.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtri

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.fit import constants
from mffit.scatter import robust


def stated_or_nominal(u: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Standard uncertainty (n,) of each point: as stated, else a share of the channel's range; inf without a reading."""
    measured = np.isfinite(values)
    nominal = constants.NOMINAL_NOISE_SHARE * np.ptp(values[measured]) if np.any(measured) else 1.0
    u = np.where(np.isfinite(u) & (u > 0), u, max(nominal, 1e-9))
    return np.where(measured, u, np.inf)


def robust_scale(residual: np.ndarray) -> float:
    """Standard deviation of the core of the residuals, from the median absolute value; zeros are ignored."""
    residual = residual[residual != 0.0]
    return robust(residual) if len(residual) else 1.0


def huber(residual: np.ndarray, scale: float) -> np.ndarray:
    """Factor (n,) >= 1 that enlarges the uncertainty of points beyond the Huber threshold."""
    size = np.abs(residual) / (constants.HUBER_THRESHOLD * scale)
    return np.asarray(np.sqrt(np.maximum(size, 1.0)))


def enlarged(residual: np.ndarray, sweep: np.ndarray, least: np.ndarray | float = 1.0) -> np.ndarray:
    """Factor (n,) on the uncertainty of each point, infinite for outliers.

    Residuals are in units of the uncertainty, 0 where a point is not used; ``sweep`` (n,) is the index of each point's sweep.
    ``least`` (n,) is the smallest scale used to detect outliers.
    """
    scale = max(robust_scale(residual), 1.0)
    factor = scale * huber(residual, scale)
    return np.where(outlying(residual, np.maximum(scale, least), sweep, least), np.inf, factor)


def outlying(
    residual: np.ndarray, scale: np.ndarray | float, sweep: np.ndarray, least: np.ndarray | float = 1.0
) -> np.ndarray:
    """Mask (n,) of single readings that contradict both the model and their neighbours in the sweep.

    Residuals are as in :func:`enlarged`, in the order of measuring; ``scale`` is the standard deviation of their core.
    """
    used = np.flatnonzero(residual != 0.0)
    out = np.zeros(len(residual), dtype=bool)
    if not len(used):
        return out
    used = used[np.argsort(sweep[used], kind="stable")]
    scale, least = (np.broadcast_to(x, len(residual))[used] for x in (scale, least))
    apart = residual[used] - _expected_from_neighbours(residual[used], sweep[used])
    known = np.isfinite(apart)
    # At least the stated uncertainty: without noise, every tiny difference would count as an outlier.
    local = np.maximum(robust_scale(apart[known]), least)
    far = float(-ndtri(PREDICTION_FALSE_ALARM / (2.0 * len(used))))
    out[used] = known & (np.abs(apart) > far * local) & (np.abs(residual[used]) > far * scale)
    return out


def _expected_from_neighbours(residual: np.ndarray, sweep: np.ndarray) -> np.ndarray:
    """Residual (n,) expected from the neighbours in the sweep; NaN with fewer than two neighbours.

    It is their median, or the line through two of them if it is closer to the point's own residual: along a stretch that the
    model misses, residuals follow a line, and at the end of a sweep all neighbours lie on one side.
    """
    n, offsets = len(residual), constants.OUTLIER_NEIGHBOURS
    beside = np.full((n, len(offsets)), np.nan)
    for k, offset in enumerate(offsets):
        there = np.arange(n) + offset
        inside = (there >= 0) & (there < n)
        inside[inside] = sweep[there[inside]] == sweep[inside]
        beside[inside, k] = residual[there[inside]]
    enough = np.sum(np.isfinite(beside), axis=1) >= 2
    out = np.full(n, np.nan)
    out[enough] = np.nanmedian(beside[enough], axis=1)
    far_before, before, after, far_after = beside.T
    between = (before + after) / 2.0
    ahead, behind = 2.0 * before - far_before, 2.0 * after - far_after
    for line in (
        between,
        np.where(np.isnan(after), ahead, np.nan),
        np.where(np.isnan(before), behind, np.nan),
    ):
        out = np.where(np.abs(residual - line) < np.abs(residual - out), line, out)
    return out
