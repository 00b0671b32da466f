"""A linear Gaussian mixed model of residuals: numbers common to all groups, random effects of each group, and noise.

Evidence and posterior are computed from sums of products over groups, so their cost hardly depends on the number of readings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import cho_factor, cho_solve
from scipy.linalg.blas import dtrmm

from mffit.linearised.gaussian import Informed, times_lower, within_lower
from mffit.rig import successive
from tir.frozen import ReadOnlyArrays

ROUNDING = 1e-13
"""Rounding error of a difference of sums of products relative to the sums; such a difference can become negative."""

HELD = -60.0
"""Log variance of a number that is practically held."""


class Variances(NamedTuple):
    """Log variances of the priors and of the noise."""

    common: np.ndarray  #: (m,) of the common numbers
    own: np.ndarray  #: (q,) of the random effects
    noise: float  #: of the noise, relative to the stated variance


class MixedEvidence(NamedTuple):
    """Log marginal likelihood of the residuals, up to a constant, its derivatives by :class:`Variances`, and their information.

    That is how fast the derivatives are expected to fall, if neither the kinds of variances nor the groups told of each other;
    of covariances, it follows from what is ``told``.
    """

    value: float
    common: np.ndarray
    """(m, m) derivative by the covariance of the common numbers, over their variances; its diagonal is by their logarithms."""
    own: np.ndarray  #: (q,)
    noise: float
    told: (
        np.ndarray
    )  #: (m, m) one less the posterior covariance of the common numbers over their prior variances
    of_own: np.ndarray  #: (q, q)
    of_noise: float


@dataclass(frozen=True, eq=False)
class Mixed(ReadOnlyArrays):
    """Residuals (n,) = common @ common numbers + own @ random effects of the group + noise, in units of the stated noise."""

    residual: np.ndarray  #: (n,)
    common: np.ndarray  #: (n, m)
    own: np.ndarray  #: (n, q)
    groups: Sequence[np.ndarray]  #: rows of every group

    @cached_property
    def _sums(self) -> _Sums:
        parts = [(self.common[g], self.own[g]) for g in map(successive, self.groups)]
        rows = self._rows
        common = self.common[rows]
        return _Sums(
            common=common.T @ common,
            across=np.array([z.T @ x for x, z in parts]),
            own=np.array([z.T @ z for _, z in parts]),
            readings=len(common),
            **self._sums_of(self.residual),
        )

    @cached_property
    def _rows(self) -> slice | np.ndarray:
        """The rows of all groups."""
        return successive(np.concatenate([np.zeros(0, dtype=int), *self.groups]))

    def _sums_of(self, residual: np.ndarray) -> dict[str, Any]:
        """The sums of products that hold the residuals (n,)."""
        all_rows = residual[self._rows]
        return {
            "pull": self.common[self._rows].T @ all_rows,
            "own_pull": np.array([self.own[g].T @ residual[g] for g in map(successive, self.groups)]),
            "square": float(all_rows @ all_rows),
        }

    def of(self, residual: np.ndarray) -> Mixed:
        """The same model of other residuals (n,), without summing the products of the columns again."""
        other = replace(self, residual=residual)
        vars(other)["_sums"] = self._sums._replace(**self._sums_of(residual))
        return other

    def only(self, rows: np.ndarray) -> Mixed:
        """The same model of some ``rows`` (k,), of which groups may have none."""
        place = np.full(len(self.residual), -1)
        place[rows] = np.arange(len(rows))
        groups = [there[there >= 0] for there in (place[g] for g in self.groups)]
        return Mixed(
            self.residual[rows], self.common[rows], self.own[rows], [one for one in groups if len(one)]
        )

    def alike(self, common: np.ndarray, noise: float = 0.0) -> Variances:
        """Log variances without random effects, with ``common`` (m,) of the common numbers."""
        return Variances(common, np.full(self.own.shape[1], HELD), noise)

    @cached_property
    def _group_of(self) -> np.ndarray:
        """Index (n,) of the group of every row; -1 for rows in no group."""
        out = np.full(len(self.residual), -1)
        for k, g in enumerate(self.groups):
            out[g] = k
        return out

    def evidence(self, given: Variances, turn: np.ndarray | None = None) -> MixedEvidence:
        """The log marginal likelihood for given variances; with a lower triangle ``turn`` (m, m), if the common columns are
        ``common @ turn``.
        """
        sums = self._sums if turn is None else self._sums.turned(turn)
        found = sums.posterior(given)
        w, gain = np.exp(-given.noise), found.gain
        own_size = np.exp(given.own)
        alone = np.einsum("gqr,gr->gq", found.own, sums.own_pull)
        own = w * (alone - np.einsum("gqr,gr->gq", found.half, found.halfway @ found.mean))
        rows = found.halfway.reshape(own.size, len(found.mean))
        # transposed, rows lie as the library wants them; the product takes their place, as new memory costs more than it
        turned = dtrmm(1.0, found.root, rows.T, trans_a=1, overwrite_b=1).T.reshape(found.halfway.shape)
        spread = found.half @ (turned @ np.swapaxes(turned, 1, 2)) @ np.swapaxes(found.half, 1, 2)
        own_covariance = found.own + w * w * spread
        own_variance = np.diagonal(own_covariance, axis1=1, axis2=2)
        square = w * sums.square - found.mean @ found.pull - w * w * np.sum(sums.own_pull * alone)
        scaled = found.scaled
        own_share = (own_variance + own**2) / own_size
        misfit = square - scaled @ scaled - np.sum(own**2 / own_size)
        effective = np.sum(1.0 - gain) + np.sum(1.0 - own_variance / own_size)
        log_size = found.log_determinant + sums.readings * given.noise
        root, size = found.root / np.exp(0.5 * given.common)[:, None], np.exp(0.5 * given.own)
        told = np.eye(len(gain)) - root @ root.T
        own_told = np.eye(len(size)) - own_covariance / np.outer(size, size)
        return MixedEvidence(
            value=-0.5 * float(square + log_size),
            common=0.5 * (np.outer(scaled, scaled) - told),
            own=0.5 * np.sum(own_share - 1.0, axis=0),
            noise=-0.5 * float(sums.readings - misfit - effective),
            told=told,
            of_own=0.5 * np.sum(own_told**2, axis=0),
            of_noise=0.5 * max(float(sums.readings - effective), 0.0),  # but for rounding
        )

    def posterior(self, given: Variances) -> MixedPosterior:
        """The posterior of the common numbers for given variances."""
        return self._sums.posterior(given)

    def further(self, given: Variances, columns: np.ndarray) -> FurtherColumns:
        """The information of the residuals about coefficients of further columns (n, j), with all other numbers marginalised."""
        found, w = self.posterior(given), float(np.exp(-given.noise))
        j, m = columns.shape[1], self.common.shape[1]
        information, pull, across = np.zeros((j, j)), np.zeros(j), np.zeros((j, m))
        for k, g in enumerate(self.groups):
            z = self.own[g]
            here = w * (columns[g] - w * z @ (found.own[k] @ (z.T @ columns[g])))
            information += columns[g].T @ here
            pull += here.T @ (self.residual[g] - self.common[g] @ found.mean)
            across += here.T @ self.common[g]
        through = across @ found.root
        outside = columns - self.common @ (found.root @ through.T)
        return FurtherColumns(information - through @ through.T, pull, outside)

    def left_out(self, given: Variances, rows: Sequence[np.ndarray]) -> list[LeftOutReadings]:
        """Prediction of each set of rows from all other rows; remaining rows of a group inform about its random effects.

        Uses the inverse of the covariance of all readings: the inverse of its block for the left-out rows is the covariance of
        their prediction errors.
        """
        found, w = self.posterior(given), float(np.exp(-given.noise))
        return [self._predicted(found, w, np.sort(one)) for one in rows]

    def predict_further(
        self, found: MixedPosterior, noise: float, k: int, further: Mixed
    ) -> tuple[np.ndarray, np.ndarray]:
        """Errors (m,) and variances (m,), without noise, of the predictions of ``further`` readings of the group ``k``.

        ``found`` is the posterior of this model for the log variance ``noise``.
        """
        w, z, x = float(np.exp(-noise)), further.own, further.common
        error = further.residual - x @ found.mean - w * z @ found.own[k] @ self._left_to_group(found, k)
        spread = np.einsum("ij,ij->i", z @ found.own[k], z)
        through = (x - w * z @ found.half[k] @ found.halfway[k]) @ found.root
        return error, spread + np.sum(through**2, axis=1)

    def _left_to_group(self, found: MixedPosterior, k: int) -> np.ndarray:
        """Products (q,) of the random effects' columns and what the common numbers leave of a group's residuals."""
        return np.asarray(self._sums.own_pull[k] - self._sums.across[k] @ found.mean)

    def _predicted(self, found: MixedPosterior, w: float, rows: np.ndarray) -> LeftOutReadings:
        block = np.zeros(2 * (len(rows),))
        whitened, moved = [], []
        begin, order = 0, []
        of_rows = self._group_of[rows]
        for k in np.unique(of_rows[of_rows >= 0]).tolist():
            out = rows[of_rows == k]
            z, x, r = self.own[out], self.common[out], self.residual[out]
            own = w * z @ found.own[k]
            end = begin + len(out)
            block[begin:end, begin:end] = w * (np.eye(len(out)) - own @ z.T)
            begin = end
            whitened.append(w * (x - w * z @ found.half[k] @ found.halfway[k]))
            moved.append(w * (r - x @ found.mean - own @ self._left_to_group(found, k)))
            order.append(out)
        through = np.concatenate(whitened) @ found.root
        covariance = np.linalg.inv(block - through @ through.T)
        covariance = 0.5 * (covariance + covariance.T)
        return LeftOutReadings(
            rows=np.concatenate(order), error=covariance @ np.concatenate(moved), covariance=covariance
        )


class _Sums(NamedTuple):
    """Sums of products over the rows."""

    common: np.ndarray  #: (m, m)
    pull: np.ndarray  #: (m,)
    across: np.ndarray  #: (groups, q, m)
    own: np.ndarray  #: (groups, q, q)
    own_pull: np.ndarray  #: (groups, q)
    square: float
    readings: int

    def turned(self, turn: np.ndarray) -> _Sums:
        """The sums if the common columns are ``common @ turn``; ``turn`` (m, m) is a lower triangle."""
        # one product is faster than many small ones
        across = times_lower(self.across.reshape(self.own_pull.size, len(turn)), turn)
        return self._replace(
            common=within_lower(self.common, turn),
            pull=turn.T @ self.pull,
            across=across.reshape(self.across.shape),
        )

    def posterior(self, given: Variances) -> MixedPosterior:
        """The posterior of the common numbers for given variances."""
        w = float(np.exp(-given.noise))
        size, own_size = np.exp(0.5 * given.common), np.exp(0.5 * given.own)
        inner = np.linalg.cholesky(np.eye(len(own_size)) + w * own_size[:, None] * self.own * own_size)
        half = np.swapaxes(np.linalg.inv(inner) * own_size, 1, 2)
        halfway = np.swapaxes(half, 1, 2) @ self.across
        flat = halfway.reshape(self.own_pull.size, len(size))
        information = flat.T @ flat  # a product with its own transpose is half the work
        information *= -w * w
        information += w * self.common
        information *= size[:, None] * size
        pull = w * self.pull - w * w * np.einsum("gq,gqr->gr", self.own_pull, half).ravel() @ flat
        rounding = ROUNDING * float(np.max(w * np.diag(self.common) * size**2, initial=0.0))
        found = Informed.by(information, size * pull, rounding)
        return MixedPosterior(
            mean=size * found.mean,
            root=size[:, None] * found.root,
            pull=pull,
            scaled=found.mean,
            gain=np.einsum("ij,ij->i", found.root, found.root),
            own=half @ np.swapaxes(half, 1, 2),
            half=half,
            halfway=halfway,
            log_determinant=found.log_determinant
            + 2.0 * float(np.sum(np.log(np.diagonal(inner, axis1=1, axis2=2)))),
        )


class MixedPosterior(NamedTuple):
    """Posterior of the common numbers, with intermediate results for the prediction of left-out groups."""

    mean: np.ndarray  #: (m,)
    root: np.ndarray  #: (m, m) upper triangular; root @ root.T is the covariance
    pull: np.ndarray  #: (m,) score of the residuals at zero
    scaled: np.ndarray  #: (m,) mean over the prior standard deviation
    gain: np.ndarray  #: (m,) posterior variance over prior variance
    own: np.ndarray  #: (groups, q, q) covariance of the random effects given the common numbers
    half: np.ndarray  #: (groups, q, q) a root of that covariance
    halfway: np.ndarray  #: (groups, q, m) its transpose times the products of own and common columns
    log_determinant: float


class FurtherColumns(NamedTuple):
    """Information of residuals about coefficients of further columns; their best estimate is information^-1 @ pull."""

    information: np.ndarray  #: (j, j) information matrix
    pull: np.ndarray  #: (j,) score at zero
    outside: np.ndarray  #: (n, j) the columns less the part that the common numbers reproduce


class LeftOutReadings(NamedTuple):
    """Prediction errors of left-out readings, in units of their stated noise."""

    rows: np.ndarray  #: (k,) indices of the readings
    error: np.ndarray  #: (k,) measured less predicted
    covariance: np.ndarray  #: (k, k) of the error: from prediction, random effects and noise

    def only(self, rows: np.ndarray) -> LeftOutReadings:
        """The same of some of the readings."""
        which = np.isin(self.rows, rows)
        return LeftOutReadings(self.rows[which], self.error[which], self.covariance[np.ix_(which, which)])

    def chi2(self, left: np.ndarray) -> float:
        """Sum of squares of remaining errors (k,) in units of the covariance."""
        return float(left @ np.linalg.solve(self.covariance, left))

    @property
    def log_density(self) -> float:
        """Log predictive density of the readings, up to a constant."""
        factor = cho_factor(self.covariance, lower=True)
        return -0.5 * float(self.error @ cho_solve(factor, self.error)) - float(
            np.sum(np.log(np.diag(factor[0])))
        )
