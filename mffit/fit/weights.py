"""Weights of the points: from their stated uncertainty, the misfit of the model, and outlier rejection.

Residuals beyond the Huber threshold get a reduced weight, because a model may miss a stretch of a sweep by more than the noise.
An outlier, a single reading far from both the model and its neighbours in the sweep, is a measurement error: its weight is zero.
"""

from __future__ import annotations

import itertools
import math
from typing import NamedTuple

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


def enlarged(
    residual: np.ndarray, sweep: np.ndarray, place: np.ndarray, least: np.ndarray | float = 1.0
) -> np.ndarray:
    """Factor (n,) on the uncertainty of each point, infinite for outliers.

    Residuals are in units of the uncertainty, 0 where a point is not used; ``sweep`` (n,) is the index of each point's sweep,
    ``place`` (n, d) its conditions, over the tested ranges. ``least`` (n,) is the smallest scale used to detect
    outliers.
    """
    scale = max(robust_scale(residual), 1.0)
    factor = scale * huber(residual, scale)
    return np.where(outlying(residual, sweep, place, least), np.inf, factor)


def outlying(
    residual: np.ndarray, sweep: np.ndarray, place: np.ndarray, least: np.ndarray | float = 1.0
) -> np.ndarray:
    """Mask (n,) of single readings that contradict their neighbours in the sweep.

    What a formula misses is smooth over the conditions (a Matern covariance of order 5/2), with the size and the length with
    which neighbours predict best: a reading at the end of a sweep, after a long last step, is hardly predicted. Arrays are as in
    :func:`enlarged`, in the order of measuring.
    """
    out = np.zeros(len(residual), dtype=bool)
    used = np.flatnonzero(residual != 0.0)
    used = used[np.argsort(sweep[used], kind="stable")]
    # At least the stated uncertainty: without noise, every tiny difference would count as an outlier.
    noise = np.broadcast_to(least, len(residual))
    far = float(-ndtri(PREDICTION_FALSE_ALARM / (2.0 * max(len(used), 1))))
    miss: np.ndarray | None = None
    while True:
        beside = _Beside.of(residual[used], sweep[used], place[used], noise[used])
        rows = np.flatnonzero(np.sum(beside.inside, axis=1) >= 2)
        if not len(rows):
            return out
        if miss is None:
            miss = np.empty((len(residual), 2))
            miss[used] = beside.likeliest(rows, sweep[used])
        length, size = miss[used[rows]].T
        error, u = beside.predicted(rows, size, beside.alike(rows, length))
        z = np.zeros(len(used))
        z[rows] = np.abs(error) / u
        z[z <= far * max(robust_scale(z), 1.0)] = 0.0
        # An outlier is a wrong neighbour too, so of neighbours only the worst is one, and the others are asked again.
        worst = (z > 0.0) & (z >= np.max(np.where(beside.inside, z[beside.there], 0.0), axis=1))
        if not np.any(worst):
            return out
        out[used[worst]] = True
        used = used[~worst]


class _Beside(NamedTuple):
    """Readings (n,) with their neighbours (n, k)."""

    residual: np.ndarray
    noise: np.ndarray
    there: np.ndarray  #: indices of the neighbours
    inside: np.ndarray  #: whether there is such a neighbour
    across: np.ndarray  #: (n, k) distances to the neighbours
    among: np.ndarray  #: (n, k, k) distances of the neighbours from one another

    @classmethod
    def of(cls, residual: np.ndarray, sweep: np.ndarray, place: np.ndarray, noise: np.ndarray) -> _Beside:
        """The readings of sweeps (n,), in order."""
        n = len(residual)
        there = np.arange(n)[:, None] + np.array(constants.OUTLIER_NEIGHBOURS, dtype=int)
        inside = (there >= 0) & (there < n)
        there = np.clip(there, 0, max(n - 1, 0))
        beside = place[there]
        return cls(
            residual=residual,
            noise=noise,
            there=there,
            inside=inside & (sweep[there] == sweep[:, None]),
            across=_distances(place[:, None, :], beside),
            among=_distances(beside[:, :, None, :], beside[:, None, :, :]),
        )

    def likeliest(self, rows: np.ndarray, sweep: np.ndarray) -> np.ndarray:
        """Length and size (n, 2) of what the formula misses, by the predictions of some of the ``rows``.

        They are those of all sweeps (n,), but for a sweep that others clearly suit better.
        """
        some = rows[:: max(1, len(rows) // int(constants.READINGS_OF_A_LENGTH))]
        sizes = robust_scale(self.residual) * np.array(constants.SIZES_OF_A_MISS)
        tried = list(itertools.product(constants.LENGTHS_OF_A_MISS, sizes.tolist()))
        alike = {length: self.alike(some, length) for length in constants.LENGTHS_OF_A_MISS}
        each = np.array([self._log_likelihood(some, size, alike[length]) for length, size in tried])
        names, of_sweep = np.unique(sweep[some], return_inverse=True)
        own = np.array([np.bincount(of_sweep, row, len(names)) for row in each])
        common = int(np.argmax(own.sum(axis=1)))
        best = np.argmax(own, axis=0)
        gain = own[best, np.arange(len(names))] - own[common]
        best = np.where(gain > constants.GAIN_OF_OWN_MISS, best, common)
        at = np.searchsorted(names, sweep).clip(0, len(names) - 1)
        found: np.ndarray = np.array(tried)[np.where(names[at] == sweep, best[at], common)]
        return found

    def alike(self, rows: np.ndarray, length: np.ndarray | float) -> tuple[np.ndarray, np.ndarray]:
        """Correlations of what the formula misses, for its ``length`` (m,): of some rows with their neighbours (m, k), and among
        the neighbours (m, k, k).
        """
        inside, length = self.inside[rows], np.broadcast_to(length, len(rows))[:, None]
        across = _matern(self.across[rows] / length) * inside
        among = _matern(self.among[rows] / length[:, :, None])
        return across, among * (inside[:, :, None] & inside[:, None, :])

    def predicted(
        self, rows: np.ndarray, size: np.ndarray | float, alike: tuple[np.ndarray, np.ndarray]
    ) -> tuple[np.ndarray, np.ndarray]:
        """Errors (m,) of the predictions of some rows from their neighbours, and their standard deviations (m,).

        ``size`` (m,) is that of what the formula misses, ``alike`` are its correlations.
        """
        there, inside = self.there[rows], self.inside[rows]
        variance = np.broadcast_to(size, len(rows))[:, None] ** 2
        across, among = variance * alike[0], variance[:, :, None] * alike[1]
        own = np.arange(there.shape[1])
        among[:, own, own] = np.where(inside, variance + self.noise[there] ** 2, 1.0)
        weights = np.linalg.solve(among, across[:, :, None])[:, :, 0]
        error = self.residual[rows] - np.sum(weights * self.residual[there] * inside, axis=1)
        left = variance[:, 0] + self.noise[rows] ** 2 - np.sum(weights * across, axis=1)
        return error, np.sqrt(left)

    def _log_likelihood(
        self, rows: np.ndarray, size: float, alike: tuple[np.ndarray, np.ndarray]
    ) -> np.ndarray:
        """Log likelihood (m,) of the predictions of some rows, with tails so heavy that outliers do not count."""
        error, u = self.predicted(rows, size, alike)
        return np.asarray(-np.log(u) - constants.TAILS_OF_A_MISS * np.log1p((error / u) ** 2 / 3.0))


def _distances(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Distances of places, with d conditions on the last axis: over so short an axis, numpy sums in three times as long."""
    return np.asarray(np.sqrt(sum((a[..., k] - b[..., k]) ** 2 for k in range(a.shape[-1]))))


def _matern(distance: np.ndarray) -> np.ndarray:
    """Matern correlation of order 5/2 over a distance in lengths."""
    d = math.sqrt(5.0) * distance
    return np.asarray((1.0 + d + d**2 / 3.0) * np.exp(-d))
