"""Whether the residuals of a fit are random: over every condition, and along every sweep."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from scipy.special import chdtrc, log_ndtr

from mffit.constants import PREDICTION_FALSE_ALARM, UPRIGHT
from mffit.diagnosis import constants
from mffit.diagnosis.remainder import Remainder, log_of
from mffit.quantities import CONDITIONS

ALONG_SWEEPS = "the course of the sweeps"
DIRECTION = "direction of rolling"
OTHER_ANGLE = {"alpha_deg": "gamma_deg", "gamma_deg": "alpha_deg", "kappa": "alpha_deg"}
"""The angle whose side splits the bins of a condition; the sign of the force splits those of the others."""


@dataclass(frozen=True, slots=True, eq=False)
class Bin:
    """Mean residual of some readings in units of their uncertainty."""

    middle: float  #: of the condition, in the unit of its column
    side: int  #: 1, -1 or 0: side of the other angle, or sign of the force
    mean: float
    error: float  #: standard deviation of a sound fit's mean
    n: int


@dataclass(frozen=True, slots=True, eq=False)
class ResidualComparison:
    """The residuals of one channel over one condition."""

    channel: str
    over: str  #: column of ``CONDITIONS``, or "direction of rolling", or "the course of the sweeps"
    log_chance: float  #: natural logarithm of the probability in a sound fit
    bins: tuple[Bin, ...] = ()

    @property
    def word(self) -> str:
        """The condition in words."""
        return CONDITIONS[self.over].word if self.over in CONDITIONS else self.over


@dataclass(frozen=True, slots=True, eq=False)
class Structure:
    """All comparisons, the least likely first."""

    comparisons: tuple[ResidualComparison, ...]

    @property
    def found(self) -> tuple[ResidualComparison, ...]:
        """Those that chance does not explain, their number accounted for."""
        limit = math.log(PREDICTION_FALSE_ALARM / max(len(self.comparisons), 1))
        return tuple(c for c in self.comparisons if c.log_chance < limit)

    @property
    def chance(self) -> float:
        """Probability that any comparison of a sound fit is as unlikely as the first, at most 1."""
        first = self.comparisons[0].log_chance if self.comparisons else 0.0
        return min(1.0, len(self.comparisons) * math.exp(first))

    def of(self, channel: str) -> bool:
        """Whether a channel has structure."""
        return any(c.channel == channel for c in self.found)


def structure(left: Remainder) -> Structure:
    """Residuals of each channel over every condition and direction, and along sweeps.

    Means of bins are tested by chi-square, neighbours along sweeps by their covariance (Ljung and Box, Biometrika 65, 1978), both
    with the covariance that fitting leaves. The side of the other angle, or the sign of the force, splits each bin.
    """
    found = []
    n = len(left.points)
    for k, channel in enumerate(left.channels):
        rows = np.flatnonzero(left.used[k * n : (k + 1) * n])
        if not len(rows):
            continue
        for over, middle, label, side in _conditions(left, channel, rows):
            comparison = _binned(left, channel, over, rows + k * n, middle, label, side)
            if comparison is not None:
                found.append(comparison)
        along = _along(left, channel, rows + k * n)
        if along is not None:
            found.append(along)
    return Structure(tuple(sorted(found, key=lambda c: c.log_chance)))


def _conditions(
    left: Remainder, channel: str, rows: np.ndarray
) -> Iterator[tuple[str, np.ndarray, np.ndarray, np.ndarray]]:
    """Condition, its value, number of the bin and side of every used reading (m,); only conditions that vary."""
    points = left.points.select(rows)
    force = np.sign(left.simulation.readings(points, (channel,))[channel])
    driven = not np.all(points.free_rolling)
    for over in CONDITIONS:
        if over != "kappa" or driven:
            other = OTHER_ANGLE.get(over)
            yield from _varying(
                over, points.condition(over), force if other is None else _side(points.condition(other))
            )
    yield from _varying(DIRECTION, points.direction.astype(float), force)


def _side(degrees: np.ndarray) -> np.ndarray:
    return np.sign(degrees) * (np.abs(degrees) > UPRIGHT)


def _varying(
    over: str, values: np.ndarray, side: np.ndarray
) -> Iterator[tuple[str, np.ndarray, np.ndarray, np.ndarray]]:
    if not np.all(np.isfinite(values)):
        return
    label = _bins(values)
    if label.max(initial=0) > 0:
        yield over, values, label, side


def _bins(values: np.ndarray) -> np.ndarray:
    """Number of the bin of each value (m,): its level if there are few, else one of equally filled ranges."""
    most = int(constants.BINS_OF_RESIDUALS)
    distinct = np.unique(np.round(values, 6))
    if len(distinct) <= most:
        return np.searchsorted(distinct, np.round(values, 6))
    edges = np.unique(np.quantile(values, np.arange(1, most) / most))
    return np.searchsorted(edges, values, side="right")


def _binned(
    left: Remainder,
    channel: str,
    over: str,
    rows: np.ndarray,
    values: np.ndarray,
    label: np.ndarray,
    side: np.ndarray,
) -> ResidualComparison | None:
    """Chi-square of the mean residuals of all bins; None with fewer than two bins that are filled."""
    cells, index, counts = np.unique(
        np.column_stack([label, side]), axis=0, return_inverse=True, return_counts=True
    )
    filled = np.flatnonzero(counts >= constants.FEWEST_READINGS_OF_A_REGION)
    if len(np.unique(cells[filled, 0])) < 2:
        return None
    members = (index.reshape(-1)[:, None] == filled).astype(float)
    inside = left.axes[rows].T @ members  # (k, cells)
    covariance = members.T @ members - inside.T @ inside
    sums = members.T @ left.residual[rows]
    power, axes = np.linalg.eigh(covariance / np.sqrt(np.outer(counts[filled], counts[filled])))
    clear = power > constants.IMITATED_SHARE
    turned = axes[:, clear].T @ (sums / np.sqrt(counts[filled]))
    chi2 = float(np.sum(turned**2 / power[clear]))
    bins = tuple(
        Bin(
            middle=float(np.mean(values[members[:, j] > 0.0])),
            side=int(cells[cell, 1]),
            mean=float(sums[j] / counts[cell]),
            error=math.sqrt(max(covariance[j, j], 0.0)) / counts[cell],
            n=int(counts[cell]),
        )
        for j, cell in enumerate(filled)
    )
    return ResidualComparison(channel, over, log_of(chdtrc(max(int(clear.sum()), 1), chi2)), bins)


def _along(left: Remainder, channel: str, rows: np.ndarray) -> ResidualComparison | None:
    """Products of residuals that are neighbours in a sweep against their mean and variance in a sound fit."""
    sweep = left.sweep[rows]
    order = np.argsort(sweep, kind="stable")
    rows, sweep = rows[order], sweep[order]
    pairs = [
        (np.flatnonzero(sweep[lag:] == sweep[:-lag]), lag)
        for lag in range(1, int(constants.NEIGHBOURS_OF_RESIDUALS) + 1)
        if len(sweep) > lag
    ]
    first = np.concatenate([start for start, _ in pairs]) if pairs else np.zeros(0, dtype=int)
    if len(first) < constants.FEWEST_READINGS_OF_A_REGION:
        return None
    second = np.concatenate([start + lag for start, lag in pairs])
    r, A = left.residual[rows], left.axes[rows]
    neighbours = np.zeros_like(A)  # S A, with S symmetric and 1/2 for each pair
    np.add.at(neighbours, first, 0.5 * A[second])
    np.add.at(neighbours, second, 0.5 * A[first])
    inside = A.T @ neighbours
    mean = -float(np.trace(inside))
    variance = (
        len(first) - 4.0 * float(np.sum(neighbours**2)) + 2.0 * float(np.sum(inside**2))
    )  # 2 tr(S M S M), M = 1 - A A'
    z = (float(r[first] @ r[second]) - mean) / math.sqrt(max(variance, 1e-12))
    return ResidualComparison(channel, ALONG_SWEEPS, float(log_ndtr(-z)))
