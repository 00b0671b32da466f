"""First-order lag of the sideslip angle along continuous sweeps."""

from __future__ import annotations

import numpy as np

from mffit.points import Points


def lagged_points(points: Points, relaxation: float) -> Points:
    """The points with the angle that the force answers to: ``sigma d(alpha')/ds + alpha' = alpha``.

    Parameters
    ----------
    points : with ``continuous`` samples; steady points are left alone
    relaxation : relaxation length sigma [m]
    """
    alpha = points.alpha.copy()
    for k in np.unique(points.sweep[points.continuous]):
        rows = np.flatnonzero(points.continuous & (points.sweep == k))
        rows = rows[np.argsort(points.time[rows])]
        distance = np.diff(points.time[rows]) * points.V[rows][1:]
        kept = np.exp(-distance / relaxation)
        lagged = alpha[rows[0]]
        for i, keep in zip(rows[1:], kept, strict=True):
            # exact for an angle that moves linearly between samples
            ramp = (points.alpha[i] - points.alpha[i - 1]) * relaxation / max(distance[0], 1e-12)
            lagged = points.alpha[i] - ramp + keep * (lagged - points.alpha[i - 1] + ramp)
            alpha[i] = lagged
    return points.replace(alpha=alpha)
