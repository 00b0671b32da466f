"""How much each point counts: the measurement uncertainty, the misfit of the model itself, outliers.

Two kinds of residual lose weight. Those beyond four robust standard deviations pull with a constant force instead of one that
grows (Huber), as a model may miss a stretch of a sweep by more than the noise. A single reading that is far from the model and
from its neighbours in the sweep alike is no property of the tyre: it does not count at all.
"""

from __future__ import annotations

import numpy as np
from scipy.special import ndtri

from mffit.scatter import robust

OUTLIER = 4.0
"""Residuals beyond this many robust standard deviations lose weight (Huber)."""


def stated_or_nominal(u: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Uncertainty (n,) per point: as stated, else 1 % of the channel's spread; inf where the channel is missing."""
    measured = np.isfinite(values)
    nominal = 0.01 * np.ptp(values[measured]) if np.any(measured) else 1.0
    u = np.where(np.isfinite(u) & (u > 0), u, max(nominal, 1e-9))
    return np.where(measured, u, np.inf)


def robust_scale(residual: np.ndarray) -> float:
    """Standard deviation of the residuals' core, from the median absolute value."""
    residual = residual[residual != 0.0]
    return robust(residual) if len(residual) else 1.0


def huber(residual: np.ndarray, scale: float) -> np.ndarray:
    """Factor (n,) >= 1 by which the uncertainty of outlying points is enlarged."""
    size = np.abs(residual) / (OUTLIER * scale)
    return np.sqrt(np.maximum(size, 1.0))


FALSE_ALARM = 0.01
"""Probability that noise alone makes any reading of a channel stand out (Bonferroni)."""
NEIGHBOURS = (-2, -1, 1, 2)
"""Rows of the same sweep, before and after, whose residuals a sound reading shares."""


def standing_out(residual: np.ndarray, scale: float, sweep: np.ndarray) -> np.ndarray:
    """Mask (n,) of single readings that neither the model nor the neighbours in their sweep agree with.

    Parameters
    ----------
    residual : (n,) in units of the uncertainty, rows in the order of measuring; 0 where a point is not used
    scale : standard deviation of the residuals' core, at least 1
    sweep : (n,) which sweep each point belongs to
    """
    used = np.flatnonzero(residual != 0.0)
    out = np.zeros(len(residual), dtype=bool)
    if not len(used):
        return out
    used = used[np.argsort(sweep[used], kind="stable")]
    apart = residual[used] - _of_neighbours(residual[used], sweep[used])
    known = np.isfinite(apart)
    # Less than the stated uncertainty is no scatter to judge by: points without noise would all stand out.
    local = max(robust_scale(apart[known]), 1.0)
    far = float(-ndtri(FALSE_ALARM / (2.0 * len(used))))
    out[used] = known & (np.abs(apart) > far * local) & (np.abs(residual[used]) > far * scale)
    return out


def _of_neighbours(residual: np.ndarray, sweep: np.ndarray) -> np.ndarray:
    """What the residuals beside each one in its sweep (n,) let expect; NaN where there are fewer than two.

    Their median, or the straight line through those beside it if that is nearer: on a stretch that the model misses the
    residuals run in a line, and at the end of a sweep all neighbours lie on one side.
    """
    n = len(residual)
    beside = np.full((n, len(NEIGHBOURS)), np.nan)
    for k, step in enumerate(NEIGHBOURS):
        there = np.arange(n) + step
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


def enlarged(residual: np.ndarray, sweep: np.ndarray) -> tuple[np.ndarray, float]:
    """Factor (n,) on the uncertainty of each point, infinite where a reading stands out, and the robust scale, at least 1.

    Parameters
    ----------
    residual : (n,) in units of the stated uncertainty; 0 where a point is not used
    sweep : (n,) which sweep each point belongs to
    """
    scale = max(robust_scale(residual), 1.0)
    factor = scale * huber(residual, scale)
    return np.where(standing_out(residual, scale, sweep), np.inf, factor), scale
