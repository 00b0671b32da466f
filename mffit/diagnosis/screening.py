"""Before anything is explained: single readings that stand apart, and uncertainties that were stated too small."""

from __future__ import annotations

import numpy as np

from mffit.points import Points

APART = 8.0
"""Standard uncertainties by which a reading differs from the line between its neighbours."""
BEND = 0.3
"""Deviation of the neighbours from their own line, relative, above which the sweep really bends there."""
REPEATED = 4.0
"""The same deviation in another sweep at the same angle is structure, no blunder."""
UNDERSTATED = 1.4
"""Scatter over stated uncertainty worth a note; a gap that is still there lets it reach 1.3."""


def outliers(points: Points, residual: np.ndarray) -> np.ndarray:
    """Mask (2n,) of single readings, Fy then Mz, that stand apart from both neighbours in their sweep.

    Parameters
    ----------
    points : with uncertainties; rows of a sweep in the order in which they were taken
    residual : (2n,) measured minus simulated, from which the curve itself has largely gone
    """
    angle = _swept_angle(points)
    return np.concatenate(
        [
            _apart(points, angle, values / u)
            for values, u in zip(np.split(residual, 2), (points.u_Fy, points.u_Mz), strict=True)
        ]
    )


def understated(points: Points, residual: np.ndarray) -> tuple[float, float]:
    """Scatter between neighbours over stated uncertainty, for Fy and Mz; NaN where it cannot be said.

    Third differences along each sweep, with the weights 1, -3, 3, -1 whose squares add up to 20.
    """
    out = []
    for values, u in zip(np.split(residual, 2), (points.u_Fy, points.u_Mz), strict=True):
        relative = values / u
        differences = [
            np.diff(relative[points.sweep == k], 3) / np.sqrt(20.0) for k in np.unique(points.sweep)
        ]
        joined = np.concatenate(differences)
        joined = joined[np.isfinite(joined)]
        out.append(1.4826 * float(np.median(np.abs(joined))) if len(joined) >= 20 else float("nan"))
    return out[0], out[1]


def _apart(points: Points, angle: np.ndarray, z: np.ndarray) -> np.ndarray:
    """Readings (n,) of one channel that stand apart; ``z`` are residuals in units of their uncertainty."""
    bend = np.full(len(z), np.nan)
    suspects = []
    for k in np.unique(points.sweep):
        rows = np.flatnonzero((points.sweep == k) & np.isfinite(z))
        if len(rows) < 5:
            continue
        # the first and the last reading are judged by the line through the two next to them
        x = np.concatenate([[2.0 * z[rows[1]] - z[rows[2]]], z[rows], [2.0 * z[rows[-2]] - z[rows[-3]]]])
        bend[rows] = x[1:-1] - (x[:-2] + x[2:]) / 2.0
        for i in range(2, len(rows) - 2):
            here, before, after = (z[rows[j]] for j in (i, i - 1, i + 1))
            deviation = here - (before + after) / 2.0
            others = (
                before - (z[rows[i - 2]] + (before + after) / 2.0) / 2.0,
                after - (z[rows[i + 2]] + (before + after) / 2.0) / 2.0,
            )
            if abs(deviation) > APART and max(map(abs, others)) < BEND * abs(deviation):
                suspects.append(rows[i])
    mask = np.zeros(len(z), dtype=bool)
    for i in suspects:
        same = (np.abs(angle - angle[i]) < np.radians(0.1)) & (points.sweep != points.sweep[i])
        mask[i] = not np.any(same & (bend * np.sign(bend[i]) > REPEATED))
    return mask


def _swept_angle(points: Points) -> np.ndarray:
    """The angle (n,) that moves within each point's sweep [rad]."""
    angle = points.alpha.copy()
    for k in np.unique(points.sweep):
        rows = points.sweep == k
        if np.ptp(points.gamma[rows]) > np.ptp(points.alpha[rows]):
            angle[rows] = points.gamma[rows]
    return angle
