"""First-order lag of the sideslip angle along continuous sweeps."""

from __future__ import annotations

import numpy as np

from mffit.points import Points


def lagged_points(points: Points, relaxation: float) -> Points:
    """The points with the angle that the force answers to: ``sigma d(alpha')/ds + alpha' = alpha``.

    Exact for an angle that moves linearly over the rolled distance between samples, however far these are apart. Where
    the wheel stands still the lag stays as it is. Every sweep begins settled.

    Parameters
    ----------
    points : with ``continuous`` samples, in any order; steady points are left alone
    relaxation : relaxation length sigma [m]

    Notes
    -----
    With q the distance of a step over sigma and phi = (1 - exp(-q))/q, the step from (alpha_0, alpha_0') to alpha_1 ends at
    alpha_1' = alpha_1 - phi (alpha_1 - alpha_0) - exp(-q) (alpha_0 - alpha_0').
    """
    alpha = points.alpha.copy()
    for k in np.unique(points.sweep[points.continuous]):
        rows = np.flatnonzero(points.continuous & (points.sweep == k))
        rows = rows[np.argsort(points.time[rows], kind="stable")]
        V, read = points.V[rows], points.alpha[rows]
        q = np.diff(points.time[rows]) * 0.5 * (V[:-1] + V[1:]) / relaxation
        phi = np.where(q > 0.0, -np.expm1(-q) / np.where(q > 0.0, q, 1.0), 1.0)
        behind = 0.0  # alpha - alpha'
        for i, (moved, share, kept) in enumerate(zip(np.diff(read), phi, np.exp(-q), strict=True), start=1):
            behind = share * moved + kept * behind
            alpha[rows[i]] = read[i] - behind
    return points.replace(alpha=alpha)
