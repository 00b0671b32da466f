"""Numbers with standard normal priors, informed by readings: the estimate behind every linear model of this package.

Readings r = X numbers + errors, whitened so that the errors are independent with variance 1, and scaled so that every column of X
is a change by one prior standard deviation. Evidence and posterior follow from the information X'X and the pull X'r alone.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.blas import dtrmm
from scipy.linalg.lapack import dpotrf, dpotrs, dtrtri

from tir.frozen import ReadOnlyArrays


def lower_root(covariance: np.ndarray) -> np.ndarray:
    """Lower triangle (m, m) whose product with its transpose is a covariance; faster than numpy's, which copies twice."""
    root, failed = dpotrf(covariance.T, lower=1)
    if failed:
        raise np.linalg.LinAlgError("the covariance is not positive definite")
    return np.asarray(root)


def lower_inverse(root: np.ndarray) -> np.ndarray:
    """Inverse (m, m) of a lower triangle."""
    return np.asarray(dtrtri(root, lower=1)[0])


def times_lower(matrix: np.ndarray, lower: np.ndarray) -> np.ndarray:
    """A matrix (n, m) times a lower triangle (m, m), in half the time of a full product."""
    return np.asarray(dtrmm(1.0, lower.T, matrix.T).T)


def within_lower(symmetric: np.ndarray, lower: np.ndarray) -> np.ndarray:
    """lower.T @ symmetric @ lower (m, m), for a lower triangle."""
    return times_lower(times_lower(symmetric, lower).T, lower)


class Directions(NamedTuple):
    """Orthonormal directions along which numbers of unit prior variance change readings whose errors have variance 1."""

    axes: np.ndarray  #: (m, k) the directions
    variance: np.ndarray  #: (k,) variances of the changes

    @classmethod
    def of(cls, columns: np.ndarray, least: float = 0.0) -> Directions:
        """The directions of changes (m, j) by every number, without those of less than the ``least`` variance or of rounding."""
        variance, turn = np.linalg.eigh(columns.T @ columns)
        some = variance > max(least, 1e-9 * max(float(np.max(variance, initial=0.0)), 1e-9))
        return cls(columns @ (turn[:, some] / np.sqrt(variance[some])), variance[some])

    def less(self, z: np.ndarray) -> np.ndarray:
        """Differences (m,) or (m, j), whitened for these changes by a symmetric matrix."""
        return self._along(z, 1.0 / np.sqrt(1.0 + self.variance) - 1.0)

    def more(self, z: np.ndarray) -> np.ndarray:
        """The inverse of :meth:`less`."""
        return self._along(z, np.sqrt(1.0 + self.variance) - 1.0)

    def power(self, rows: np.ndarray, z: np.ndarray) -> np.ndarray:
        """Decrease of the sums of squares (j,) by :meth:`less` of differences that are 0 but for the ``rows``, ``z`` (i, j)."""
        return np.asarray((self.variance / (1.0 + self.variance)) @ (self.axes[rows].T @ z) ** 2)

    @property
    def half_log_determinant(self) -> float:
        """Half the log determinant of the covariance of the readings."""
        return 0.5 * float(np.sum(np.log1p(self.variance)))

    def _along(self, z: np.ndarray, gain: np.ndarray) -> np.ndarray:
        return z + self.axes @ (gain * (self.axes.T @ z).T).T if len(gain) else z


@dataclass(frozen=True, eq=False)
class Informed(ReadOnlyArrays):
    """The posterior of numbers (k,) with independent standard normal priors."""

    factor: np.ndarray  #: (k, k) lower Cholesky factor of 1 + information
    pull: np.ndarray  #: (k,) score of the readings at zero

    @classmethod
    def by(cls, information: np.ndarray, pull: np.ndarray, rounding: float = 0.0) -> Informed:
        """The posterior from the information (k, k) of the readings and their pull (k,).

        ``rounding`` is added to the diagonal. It is increased until the information is positive definite, because rounding of a
        difference of large sums can make eigenvalues negative.
        """
        while True:
            precision = information.copy()
            precision.flat[:: len(pull) + 1] += 1.0 + rounding
            # symmetric, and as the library wants it without a copy when transposed
            factor, failed = dpotrf(precision.T, lower=1, overwrite_a=1) if len(pull) else (precision, 0)
            if not failed:
                return cls(factor, pull)
            if not np.all(np.isfinite(information)):
                raise np.linalg.LinAlgError("the information is not finite")
            rounding = 10.0 * rounding or np.finfo(float).eps * float(np.max(np.diag(information)))

    @classmethod
    def of_rows(cls, columns: np.ndarray, residual: np.ndarray) -> Informed:
        """The posterior from whitened columns (m, k) and a whitened residual (m,), even for huge columns."""
        ones = np.eye(columns.shape[1])
        try:
            factor = np.linalg.cholesky(columns.T @ columns + ones)
        except np.linalg.LinAlgError:  # rounding loses the 1; QR is slower, but never fails
            _, upper = np.linalg.qr(np.vstack([columns, ones]))
            factor = (upper * np.where(np.diag(upper) < 0.0, -1.0, 1.0)[:, None]).T
        return cls(factor, columns.T @ residual)

    @cached_property
    def mean(self) -> np.ndarray:
        """Posterior mean (k,)."""
        return np.asarray(dpotrs(self.factor, self.pull, lower=1)[0]) if len(self.pull) else self.pull

    @cached_property
    def root(self) -> np.ndarray:
        """Upper triangular matrix (k, k); root @ root.T is the posterior covariance."""
        k = len(self.pull)
        return np.asarray(dtrtri(self.factor, lower=1)[0].T) if k else np.zeros((0, 0))

    @cached_property
    def covariance(self) -> np.ndarray:
        """Posterior covariance (k, k)."""
        return np.asarray(self.root @ self.root.T)

    @property
    def u(self) -> np.ndarray:
        """Posterior standard deviations (k,)."""
        return np.asarray(np.sqrt(np.sum(self.root**2, axis=1)))

    @property
    def log_determinant(self) -> float:
        """Log determinant of 1 + information."""
        return 2.0 * float(np.sum(np.log(np.diag(self.factor))))

    @property
    def gain(self) -> float:
        """Log evidence of the readings with the numbers, less that without them."""
        return 0.5 * (float(self.pull @ self.mean) - self.log_determinant)
