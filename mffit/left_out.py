"""Numbers without a group of points to first order, from one linearised fit, and what a gain on all groups is worth.

No second fit is needed. Let J be the derivatives of a group's residuals r in units of their uncertainty, and C the covariance of
the fit. Without the group the covariance is A^-1 with A = C^-1 - J^T J, and the numbers change by A^-1 J^T r (Belsley, Kuh and
Welsch, Regression Diagnostics, 1980, section 2.1, there with the hat matrix J C J^T).
"""

import numpy as np
from scipy.special import ndtri

from mffit.constants import PREDICTION_FALSE_ALARM


def moved_without(
    slopes: np.ndarray, residual: np.ndarray, information: np.ndarray, gradient: np.ndarray
) -> np.ndarray:
    """Change (k,) of the numbers when a group with these slopes (n, k) and residuals (n,) is left out."""
    return -np.linalg.solve(information - slopes.T @ slopes, gradient - slopes.T @ residual)


def clearly_above_zero(change: np.ndarray) -> bool:
    """Whether the mean of the changes (s,) of groups exceeds zero by more than their scatter explains."""
    error = float(np.std(change, ddof=1)) / np.sqrt(len(change))
    return bool(np.mean(change) > -ndtri(PREDICTION_FALSE_ALARM) * error > 0.0)
