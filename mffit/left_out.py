"""Prediction of left-out groups of points to first order, from one linearised fit; and the rule by which numbers are chosen.

No second fit is needed. With J the derivatives of a group's residuals r in units of their weight, and C the covariance of the
fit, the others leave the covariance A^-1 with A = C^-1 - J^T J, and the numbers move by A^-1 J^T r when the group is taken out
(Belsley, Kuh and Welsch, Regression Diagnostics, 1980, section 2.1, there with the hat matrix J C J^T).

Further numbers are chosen by the likelihood of the joint fit of all groups, beside what differs from group to group. The gain
over its scatter among the groups would not do: one group that carries most of it raises the scatter as much as the mean.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from scipy.special import fdtrc, ndtri

from mffit import constants


@dataclass(frozen=True, slots=True)
class Predicted:
    """Misfit of every group of points when it is predicted from all others."""

    chi2: np.ndarray  #: (s, c) by group and channel

    @property
    def total(self) -> float:
        """Sum over groups and channels."""
        return float(np.sum(self.chi2))

    def falls(self, other: Predicted, channel: int | None = None) -> float:
        """By how many standard errors over the groups ``other`` predicts better, in all channels or in one by number."""
        change = self.chi2 - other.chi2
        return _z(np.sum(change, axis=1) if channel is None else change[:, channel])

    def raised(
        self, other: Predicted, channels: Collection[int] | None = None, loss: np.ndarray | float = 0.0
    ) -> bool:
        """Whether ``other`` predicts one of the channels, or of these by number, worse beyond chance and by more than ``loss``.

        The loss [-] is one of chi-square, for each channel (c,) or all of them. Beyond chance is a loss in standard errors over
        the groups, or a misfit larger than that of as many independent groups scatters: one group may hold all of it.
        """
        allowed = np.broadcast_to(loss, self.chi2.shape[1])
        looked_at = range(self.chi2.shape[1]) if channels is None else channels
        return any(
            float(np.sum(there - here)) > allowed[k]
            and (_z(here - there) < -constants.WORSE_PREDICTION or _larger(here, there))
            for k in looked_at
            for here, there in [(self.chi2[:, k], other.chi2[:, k])]
        )

    def keeps(self, other: Predicted, share: float) -> bool:
        """Whether ``other`` predicts every channel as well: no misfit larger by this share, none worse beyond chance.

        Each channel counts by itself: in the sum over several channels, a clear loss in one of them is small.
        """
        before, after = np.sum(self.chi2, axis=0), np.sum(other.chi2, axis=0)
        return bool(np.all(after <= (1.0 + share) * before)) and not self.raised(other)


def left_out_errors(
    slopes: np.ndarray,
    residual: np.ndarray,
    information: np.ndarray,
    gradient: np.ndarray,
    group: np.ndarray,
) -> np.ndarray:
    """Errors (m,) of the points when each group is predicted from all others, all numbers estimated again.

    Parameters
    ----------
    slopes : (m, k) derivatives of the residuals by the numbers
    residual : (m,) model less measured in units of the noise
    information : (k, k) of data and priors
    gradient : (k,) half the derivative of the sum of squares of data and priors; zero at its minimum
    group : (m,) number of the group of each row, from 0
    """
    error = np.empty_like(residual)
    for k in range(int(group.max(initial=-1)) + 1):
        rows = np.flatnonzero(group == k)
        out, r = np.take(slopes.T, rows, axis=1).T, residual[rows]  # by columns, as derivatives are in memory
        error[rows] = r - out @ np.linalg.solve(information - out.T @ out, gradient - out.T @ r)
    return error


def covariance_without(axes: np.ndarray, least: float) -> np.ndarray:
    """Covariance (k, k) of the numbers from all points but those of a group, in units in which that of all points is 1.

    Parameters
    ----------
    axes : (m, k) derivatives of the group's residuals by the numbers in these units, over the noise
    least : smallest share of the information about a direction that is left; less makes its prediction meaningless
    """
    share, directions = np.linalg.eigh(axes.T @ axes)
    return (directions / np.maximum(1.0 - share, least)) @ directions.T


def predicted(error: np.ndarray, group: np.ndarray, channel: np.ndarray, *, channels: int = 2) -> Predicted:
    """The misfit of groups from the errors (m,) of their points; ``channel`` (m,) counts the channels from 0."""
    count = int(group.max(initial=-1)) + 1
    place = channels * group + channel
    return Predicted(np.bincount(place, error**2, minlength=channels * count).reshape(count, channels))


def needed_fall(candidates: int) -> float:
    """Standard errors by which a prediction must fall if the best of several candidates is taken."""
    return float(-ndtri(constants.FALSE_ALARM / max(candidates, 1)))


@dataclass(frozen=True, slots=True)
class Support:
    """What further numbers of a model explain, by the joint fit of all points."""

    chi2: float  #: by which the sum of squares falls, in units of the noise and of what differs from group to group
    removed: float  #: by which it falls in units of the noise alone
    numbers: int  #: how many there are
    freedom: float  #: degrees of freedom of the scatter among the groups, over the square of its share; infinite without any

    @property
    def chance(self) -> float:
        """Probability that numbers without effect explain as much."""
        freedom = min(self.freedom, 1.0 / np.finfo(float).eps)
        return float(fdtrc(self.numbers, freedom, max(self.chi2, 0.0) / self.numbers))

    def beyond_chance(self, candidates: int = 1) -> bool:
        """Whether they explain more than the best of several candidates does by chance."""
        return self.chance < constants.FALSE_ALARM / max(candidates, 1)


def alone(information: np.ndarray, gradient: np.ndarray, more: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Information (k, k) and gradient (k,) of some numbers, by their index (k,), after all others are estimated."""
    rest = np.setdiff1d(np.arange(len(gradient)), more)
    through = np.linalg.solve(information[np.ix_(rest, rest)], information[np.ix_(rest, more)])
    own = information[np.ix_(more, more)] - information[np.ix_(more, rest)] @ through
    return own, gradient[more] - through.T @ gradient[rest]


def improves(
    before: Predicted,
    after: Predicted,
    support: Support,
    *,
    candidates: int = 1,
    least: float = 0.0,
    channels: Collection[int] | None = None,
) -> bool:
    """Whether further numbers belong into a model: they explain more than chance, and no channel is predicted worse for it.

    Without them left-out groups are predicted as ``before``, with them as ``after``. The sum of squares must fall by more than
    ``least``. With ``channels`` only these, by number, must not be worse. That all are predicted better is not asked for: a
    group at the end of the tested range is predicted so badly without its own readings that it hides a gain in all others.
    """
    loss = constants.LEAST_PREDICTED_SHARE * np.sum(before.chi2, axis=0)
    seen = support.beyond_chance(candidates) and support.removed > least
    return seen and not before.raised(after, channels, loss)


def _larger(before: np.ndarray, after: np.ndarray) -> bool:
    """Whether the second misfit (s,) is the larger one beyond chance, if each group counts as one reading."""
    ratio = float(np.sum(after)) / max(float(np.sum(before)), np.finfo(float).tiny)
    return bool(fdtrc(len(before), len(before), ratio) < constants.FALSE_ALARM)


def _z(change: np.ndarray) -> float:
    error = float(np.std(change, ddof=1)) / np.sqrt(len(change))
    return float(np.mean(change)) / error if error > 0.0 else 0.0
