"""Likelihood of the scatter of one channel, everything that could explain its residual integrated out."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, cho_solve, cholesky, solve_triangular
from scipy.linalg.lapack import dpotri

from mffit.diagnosis import constants
from mffit.diagnosis.chains import Chains, Correlation, MemorySpan


class MarginalParts(NamedTuple):
    """The numbers of a scatter that its likelihood depends on."""

    log_scale: float
    growth: float
    memory: float
    smooth: float  #: amplitude of smooth structure, relative to the channel
    offsets: float = 0.0  #: size of offsets of runs over the usual one
    independent: float = 0.0  #: share of the variance without memory


@dataclass(frozen=True)
class MarginalChannel:
    """The used readings (m,) of one channel."""

    stated: np.ndarray  #: standard uncertainty
    residual: np.ndarray  #: measured minus simulated
    size: np.ndarray  #: readings in proportion to which the noise may grow
    chain: np.ndarray  #: number of the sweep of each reading
    named: np.ndarray  #: (m, k) changes that effects could bring, one prior standard deviation each
    smooth: np.ndarray  #: (m, k) the same of smooth structure, at amplitude 1
    weight: np.ndarray  #: weight of each reading
    runs: np.ndarray | None = (
        None  #: (m, k) the same of offsets of runs at their usual size; None: they are not considered
    )
    span: MemorySpan = MemorySpan.SWEEP  #: the chains of its memory
    course: np.ndarray | None = None  #: number of the chain of each reading, if that is longer than a sweep
    turn: np.ndarray | None = None  #: place of each reading in time
    least: float = 0.0  #: standard uncertainty that is always added, for readings without noise

    def beside(self, columns: np.ndarray) -> MarginalChannel:
        """The same with offsets of runs, whose changes (m, k) have the usual size."""
        return replace(self, runs=columns)

    def along(self, span: MemorySpan, course: np.ndarray) -> MarginalChannel:
        """The same with errors whose memory runs through other chains (m,)."""
        return replace(self, span=span, course=course)

    def weighing(self, weight: np.ndarray) -> MarginalChannel:
        """The same with other weights (m,) of the readings."""
        return replace(self, weight=weight)

    def condensed(self, smooth: float) -> MarginalChannel:
        """The same with fewer columns, which change as much: smooth structure of this amplitude is among the named changes.

        Directions of hardly any change are left out.
        """
        u = np.hypot(self.stated, self.least)
        both = np.column_stack([self.named, smooth * self.smooth]) / u[:, None]
        axes, size, _ = np.linalg.svd(both, full_matrices=False)
        some = size**2 > constants.NEGLIGIBLE_CHANGE
        named = axes[:, some] * size[some] * u[:, None]
        return replace(self, named=named, smooth=self.smooth[:, :0])

    @property
    def chains(self) -> Chains:
        """The chains of the readings that the likelihood uses."""
        return self._sample[1]

    def likelihood(self, parts: MarginalParts) -> float:
        """Logarithm of the marginal likelihood, with the prior of the scale; of some whole sweeps if there are many."""
        r, A, log = self._white(parts, *self._sample)
        root = lower_factor(A)
        b = solve_triangular(root, A.T @ r, lower=True, check_finite=False)
        log += float(np.sum(np.log(np.diag(root))))
        prior = parts.log_scale / math.log(constants.STATED_NOISE_FACTOR)
        return -0.5 * float(r @ r - b @ b) - log - 0.5 * prior**2

    def likelihood_and_slopes(self, parts: MarginalParts) -> tuple[float, MarginalParts]:
        """The likelihood and its slopes by each of the parts."""
        rows, chains, columns = self._sample
        u, by_scale, by_growth = self._uncertainty(parts, rows)
        z = (columns / u[:, None]) * self._sizes(parts, columns.shape[1])
        memory = max(parts.memory, 1e-12)  # at 0 too the likelihood has a slope
        correlation = Correlation.along(chains, [(np.ones(len(rows), bool), memory, parts.independent)])
        white = correlation.in_order(z)
        r, A = white[:, 0], white[:, 1:]
        root = lower_factor(A)
        log = float(np.sum(np.log(np.diag(root))) + np.sum(np.log(u)) + correlation.log)
        inverse = dpotri(root, lower=1)[0] if len(root) else root
        inverse = np.tril(inverse) + np.tril(inverse, -1).T
        x = inverse @ (A.T @ r)
        # Slopes of half the sum of squares and half the log determinant by the whitened readings: (white @ joint).
        joint = np.empty((len(x) + 1, len(x) + 1))
        joint[0, 0], joint[0, 1:], joint[1:, 0] = 1.0, -x, -x
        joint[1:, 1:] = inverse + x[:, None] * x
        by_white = (joint @ white.T).T
        by_difference = correlation.adjoint(by_white)
        of_memory, of_share = correlation.slopes(z, white, by_difference, memory, parts.independent)
        by_z = by_difference.copy(order="F")
        by_z[:-1] -= (correlation.memory[1:] * by_difference[1:].T).T
        by_u = 1.0 - np.einsum("ij,ij->i", by_z, z)
        by_size, first = np.einsum("ij,ij->j", by_white, white), 1 + self.named.shape[1]
        smooth, offsets = np.split(by_size, [first, first + self.smooth.shape[1]])[1:]
        wide = math.log(constants.STATED_NOISE_FACTOR)
        slopes = MarginalParts(
            log_scale=-float(by_u @ by_scale) - parts.log_scale / wide**2,
            growth=-float(by_u @ by_growth),
            memory=-float(of_memory),
            smooth=-float(np.sum(smooth)) / max(parts.smooth, 1e-300),
            offsets=-float(np.sum(offsets)) / max(parts.offsets, 1e-300),
            independent=-float(of_share),
        )
        return -0.5 * float(r @ by_white[:, 0]) - log - 0.5 * (parts.log_scale / wide) ** 2, slopes

    def standardised(self, parts: MarginalParts) -> np.ndarray:
        """Every reading (m,) against its prediction from all others, in units of their joint uncertainty at weight 1."""
        rows, chains, columns = self._chained(np.arange(len(self.chain)))
        r, A, _ = self._white(parts, rows, chains, columns)
        root = lower_factor(A)
        left = r - A @ cho_solve((root, True), A.T @ r, check_finite=False)
        B = solve_triangular(root, A.T, lower=True, check_finite=False)
        variance = np.maximum(1.0 - np.sum(B * B, axis=0), 1e-3)
        out = np.empty(len(rows))
        if parts.memory:
            out[rows] = left / np.sqrt(variance)
            return out
        own = 1.0 / np.sqrt(self.weight[rows])  # uncertainty of the reading, in units of that at weight 1
        predicted = (1.0 / variance - 1.0) * own**2  # variance of its prediction by all others
        out[rows] = left / variance * own / np.sqrt(1.0 + predicted)
        return out

    @cached_property
    def _sample(self) -> tuple[np.ndarray, Chains, np.ndarray]:
        """Indices of the readings that the likelihood uses, chain after chain, with their chains and columns."""
        return self._chained(_some_sweeps(self.chain))

    def _chained(self, rows: np.ndarray) -> tuple[np.ndarray, Chains, np.ndarray]:
        """Some readings chain after chain, with their chains, and their residual and columns (m, 1 + k) at full size."""
        if self.course is None or self.turn is None:
            rows = rows[np.argsort(self.chain[rows], kind="stable")]
            chains = Chains.of(self.chain[rows])
        else:
            rows = rows[np.lexsort((self.turn[rows], self.course[rows]))]
            chains = Chains.of(self.course[rows], self.turn[rows])
        some = [self.residual[rows, None], self.named[rows], self.smooth[rows]]
        some += [self.runs[rows]] if self.runs is not None else []
        return rows, chains, np.asfortranarray(np.column_stack(some))

    def _white(
        self, parts: MarginalParts, rows: np.ndarray, chains: Chains, columns: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float]:
        """Residual and columns of readings in the order of their sweeps, in units of their scatter, and the log determinant."""
        u = self._uncertainty(parts, rows)[0]
        sizes = self._sizes(parts, columns.shape[1])
        A = (columns / u[:, None]) * sizes
        log = float(np.sum(np.log(u)))
        if parts.memory:
            everywhere = np.ones(len(rows), dtype=bool)
            correlation = Correlation.along(chains, [(everywhere, parts.memory, parts.independent)])
            A = correlation.in_order(A)
            log += correlation.log
        return A[:, 0], A[:, 1:], log

    def _uncertainty(
        self, parts: MarginalParts, rows: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Standard uncertainty of readings (m,), and the slopes of its logarithm by log scale and growth."""
        stated, size = math.exp(parts.log_scale) * self.stated[rows], self.size[rows]
        square = stated**2 + (parts.growth * size) ** 2 + self.least**2
        u = np.sqrt(square / self.weight[rows])
        return u, stated**2 / square, parts.growth * size**2 / square

    def _sizes(self, parts: MarginalParts, columns: int) -> np.ndarray:
        """Size of the residual and of each column, in which they enter the likelihood."""
        sizes, first = np.ones(columns), 1 + self.named.shape[1]
        sizes[first : first + self.smooth.shape[1]] = parts.smooth
        sizes[first + self.smooth.shape[1] :] = parts.offsets
        return sizes


def lower_factor(A: np.ndarray) -> np.ndarray:
    """Lower Cholesky factor of A'A + 1, also where A is so large that rounding loses the 1 (a model far from the readings)."""
    ones = np.eye(A.shape[1])
    try:
        return cholesky(A.T @ A + ones, lower=True, check_finite=False)
    except LinAlgError:  # slower, and never without a factor
        _, upper = np.linalg.qr(np.vstack([A, ones]))
        return np.asarray((upper * np.where(np.diag(upper) < 0.0, -1.0, 1.0)[:, None]).T)


def _some_sweeps(chain: np.ndarray) -> np.ndarray:
    """Indices of every k-th sweep if there are more readings than scale, growth and memory need; else of all."""
    names = np.unique(chain)
    stride = min(
        math.ceil(len(chain) / constants.READINGS_FOR_SCATTER),
        max(len(names) // constants.FEWEST_SWEEPS_FOR_SCATTER, 1),
    )
    return np.flatnonzero(np.isin(chain, names[::stride]))
