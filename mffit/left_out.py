"""Prediction of left-out groups of points to first order, from one linearised fit.

No second fit is needed. Let J be the derivatives of a group's residuals r in units of their uncertainty, and C the covariance of
the fit. Without the group the covariance is A^-1 with A = C^-1 - J^T J, and the numbers change by A^-1 J^T r (Belsley, Kuh and
Welsch, Regression Diagnostics, 1980, section 2.1, there with the hat matrix J C J^T).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.special import ndtri

from mffit import constants
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True)
class Predicted(ReadOnlyArrays):
    """Sum of squared prediction errors of every left-out group of points."""

    chi2: np.ndarray  #: (s, c) by group and channel

    @property
    def total(self) -> float:
        """Sum over groups and channels."""
        return float(np.sum(self.chi2))

    def falls(self, other: Predicted, channel: int | None = None) -> float:
        """Mean improvement by ``other`` in standard errors over the groups, for all channels or the index ``channel``."""
        change = self.chi2 - other.chi2
        return over_scatter(np.sum(change, axis=1) if channel is None else change[:, channel])


def left_out_errors(
    slopes: np.ndarray, residual: np.ndarray, information: np.ndarray, gradient: np.ndarray, group: np.ndarray
) -> np.ndarray:
    """Errors (m,) of the points when each group is predicted from all others, with all numbers re-estimated.

    ``slopes`` (m, k) are derivatives of the ``residual`` (m,), model less measured in units of the noise. ``information`` (k,
    k) and ``gradient`` (k,), half the derivative of the sum of squares, are of data and priors. ``group`` (m,) is the index of
    each row's.
    """
    error = np.empty_like(residual)
    for k in range(int(group.max(initial=-1)) + 1):
        rows = np.flatnonzero(group == k)
        out, r = np.take(slopes.T, rows, axis=1).T, residual[rows]  # by columns: the memory order of slopes
        error[rows] = r + out @ moved_without(out, r, information, gradient)
    return error


def moved_without(
    slopes: np.ndarray, residual: np.ndarray, information: np.ndarray, gradient: np.ndarray
) -> np.ndarray:
    """Change (k,) of the numbers when a group with these slopes (n, k) and residuals (n,) is left out."""
    return -np.linalg.solve(information - slopes.T @ slopes, gradient - slopes.T @ residual)


def predicted(error: np.ndarray, group: np.ndarray, channel: np.ndarray, *, channels: int = 2) -> Predicted:
    """The misfit of groups from the errors (m,) of their points; ``channel`` (m,) is the index of the channel of each error."""
    count = int(group.max(initial=-1)) + 1
    place = channels * group + channel
    return Predicted(np.bincount(place, error**2, minlength=channels * count).reshape(count, channels))


def needed_fall(candidates: int) -> float:
    """Improvement in standard errors that is significant for the best of several candidates."""
    return float(-ndtri(constants.PREDICTION_FALSE_ALARM / max(candidates, 1)))


def over_scatter(change: np.ndarray) -> float:
    """Mean of the changes (s,) of groups over its standard error from their scatter; 0 without scatter."""
    error = float(np.std(change, ddof=1)) / np.sqrt(len(change))
    return float(np.mean(change)) / error if error > 0.0 else 0.0
