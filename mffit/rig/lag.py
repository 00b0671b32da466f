"""First-order lag of the sideslip angle or of longitudinal slip along continuous sweeps, and of moves between two samples."""

import numpy as np

from mffit.points import Points


def lagged_setting(points: Points, sigma: float, setting: str = "alpha") -> tuple[np.ndarray, np.ndarray]:
    """Lagged sideslip angle or slip (n,) to which the force corresponds [rad or -], and its derivative by the relaxation length.

    ``sigma d(alpha')/ds + alpha' = alpha``; the same for ``setting`` kappa. Exact for an angle that is linear in the rolled
    distance between samples. If the wheel does not roll, the lag stays constant. Every sweep begins settled; steady points have
    no lag.

    Over a step of length d from (alpha_0, alpha_0') to alpha_1, with q = d/sigma and f = (1 - exp(-q))/q, the lag
    b = alpha - alpha' becomes b_1 = f (alpha_1 - alpha_0) + exp(-q) b_0.
    """
    values = getattr(points, setting)
    follows, slope = values.copy(), np.zeros(len(points))
    moving = np.isfinite(points.time)
    for k in np.unique(points.sweep[moving]):
        rows = np.flatnonzero(moving & (points.sweep == k))
        rows = rows[np.argsort(points.time[rows], kind="stable")]
        V = points.V[rows]
        steps = np.diff(points.time[rows]) * 0.5 * (V[:-1] + V[1:])
        lag, by_sigma = _lag(np.diff(values[rows]), steps, sigma)
        follows[rows] -= lag
        slope[rows] = -by_sigma
    return follows, slope


def _lag(moved: np.ndarray, steps: np.ndarray, sigma: float) -> tuple[np.ndarray, np.ndarray]:
    """Lag (m + 1,) [rad] after steps (m,) of angle [rad] and distance [m], and its derivative by sigma [rad/m]."""
    rolls = steps > 0.0
    distance = np.where(rolls, steps, 1.0)
    if sigma > 0.0:
        kept = np.where(rolls, np.exp(-distance / sigma), 1.0)
        share = np.where(rolls, (1.0 - kept) * sigma / distance, 1.0)
        share_slope = np.where(rolls, (share - kept) / sigma, 0.0)
        kept_slope = np.where(rolls, kept * distance / sigma**2, 0.0)
    else:
        kept = share = np.where(rolls, 0.0, 1.0)
        share_slope = np.where(rolls, 1.0 / distance, 0.0)
        kept_slope = np.zeros_like(kept)
    lag, by_sigma = np.zeros(len(moved) + 1), np.zeros(len(moved) + 1)
    rows = zip(moved, share, kept, share_slope, kept_slope, strict=True)
    for i, (move, f, e, f_slope, e_slope) in enumerate(rows):
        lag[i + 1] = f * move + e * lag[i]
        by_sigma[i + 1] = f_slope * move + e_slope * lag[i] + e * by_sigma[i]
    return lag, by_sigma


def lag_of_move(
    row: int, moved: float, rolled: np.ndarray, sigma: float, share: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Change of the lag (n,) if a move between two samples is abrupt instead of linear, and its two derivatives.

    The derivatives are by the relaxation length ``sigma`` [m] and by the share. An abrupt move at share u of the distance d
    leaves the lag exp(-(1 - u) q) with q = d/sigma, a linear one (1 - exp(-q))/q, which is the mean over u. ``row`` is the
    index of the sample before the move, ``moved`` its size [rad or -], ``rolled`` (n,) the distance at every sample [m].
    """
    out = np.zeros((3, len(rolled)))
    q = (rolled[row + 1] - rolled[row]) / sigma
    if q > 0.0:
        at_once, even = np.exp((share - 1.0) * q), -np.expm1(-q) / q
        since = (rolled[row + 1 :] - rolled[row + 1]) / sigma
        added, rise = at_once - even, (np.exp(-q) - even) + q * (1.0 - share) * at_once
        decay = moved * np.exp(-since)
        out[0, row + 1 :] = added * decay
        out[1, row + 1 :] = (added * since + rise) * decay / sigma
        out[2, row + 1 :] = q * at_once * decay
    return out[0], out[1], out[2]
