"""A linear model of readings whose errors have a memory along chains: what explains them is integrated out with its priors.

Where :mod:`mffit.linearised.mixed` has numbers that each group has of its own, here the errors of a group are correlated.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular
from scipy.linalg.lapack import dpotri

from mffit.linearised import constants


class Memory(NamedTuple):
    """How errors along a chain are correlated."""

    correlation: float = 0.0  #: to the next reading, of the part with a memory
    independent: float = 0.0  #: share of the variance without memory

    def matrix(self, n: int) -> np.ndarray:
        """Correlation (n, n) of the readings of a chain."""
        steps = np.arange(float(n))
        out = _over_steps((1.0 - self.independent) * self.correlation**steps)
        np.fill_diagonal(out, 1.0)
        return out

    def slopes(self, n: int) -> np.ndarray:
        """Derivatives (2, n, n) of the matrix by correlation and independent share."""
        steps = np.arange(float(n))
        by_correlation = (1.0 - self.independent) * steps * self.correlation ** np.maximum(steps - 1.0, 0.0)
        by_share = -(self.correlation**steps)
        by_share[:1] = 0.0
        return np.array([_over_steps(by_correlation), _over_steps(by_share)])


def _over_steps(values: np.ndarray) -> np.ndarray:
    """Matrix (n, n) of the value (n,) at the number of steps between two readings."""
    places = np.arange(len(values))
    out: np.ndarray = values[np.abs(places[:, None] - places)]
    return out


def chains_of(chain: np.ndarray, turn: np.ndarray | None = None) -> list[np.ndarray]:
    """Rows of every chain in their order, from the number (m,) of the chain of each.

    Rows of a chain are ordered by ``turn`` (m,) if that is given, and a turn that is left out begins another chain. Very long
    chains are cut: their ends know nothing of each other.
    """
    order = np.argsort(chain, kind="stable") if turn is None else np.lexsort((turn, chain))
    begins = np.diff(chain[order]) != 0
    if turn is not None:
        begins |= np.diff(turn[order]) != 1
    longest = int(constants.LONGEST_CHAIN)
    whole = np.split(order, np.flatnonzero(begins) + 1)
    return [rows[k : k + longest] for rows in whole for k in range(0, len(rows), longest)]


@dataclass(frozen=True, eq=False)
class ChainedErrors:
    """Errors of unit variance: the chains of all rows, and their memory."""

    chains: Sequence[np.ndarray]
    memory: Memory

    @cached_property
    def root(self) -> np.ndarray:
        """Inverse of the lower factor of the correlation of the longest chain; its upper left part is that of a shorter one."""
        n = max((len(rows) for rows in self.chains), default=0)
        factor = np.linalg.cholesky(self.memory.matrix(n)) if n else np.zeros((0, 0))
        return solve_triangular(factor, np.eye(n), lower=True, check_finite=False) if n else factor

    @property
    def trivial(self) -> bool:
        """Whether all errors are independent."""
        return not self.memory.correlation

    def whiten(self, x: np.ndarray) -> np.ndarray:
        """Rows (m,) or (m, k) made independent of each other."""
        return x if self.trivial else self._by_chain(self.root, x)

    def back(self, x: np.ndarray) -> np.ndarray:
        """The transposed operation."""
        return x if self.trivial else self._by_chain(self.root.T, x)

    def _by_chain(self, matrix: np.ndarray, x: np.ndarray) -> np.ndarray:
        """Rows of every chain multiplied by the upper left part of a matrix."""
        out = np.empty_like(x)
        for rows in self.chains:
            n = len(rows)
            out[rows] = matrix[:n, :n] @ x[rows]
        return out

    def variance_of_sum(self, weight: np.ndarray) -> float:
        """Variance of the sum of all errors with these weights (m,)."""
        if self.trivial:
            return float(weight @ weight)
        whole = self.memory.matrix(len(self.root))
        return float(sum(weight[g] @ whole[: len(g), : len(g)] @ weight[g] for g in self.chains))

    @property
    def log_determinant(self) -> float:
        """Of the correlation of all rows."""
        logs = np.append(0.0, np.cumsum(np.log(np.diag(self.root))))
        return 0.0 if self.trivial else -2.0 * float(sum(logs[len(rows)] for rows in self.chains))

    @property
    def known_from_others(self) -> np.ndarray:
        """Inverse (m,) of the variance of each error as the others of its chain leave it."""
        out = np.ones(sum(len(rows) for rows in self.chains))
        for rows in self.chains if not self.trivial else ():
            n = len(rows)
            out[rows] = np.sum(self.root[:n, :n] ** 2, axis=0)
        return out


class ChainedEvidence(NamedTuple):
    """Logarithm of the probability of the readings, less a constant, and its derivatives."""

    value: float
    sizes: np.ndarray  #: (k,) by the logarithms of the sizes of the columns
    u: np.ndarray  #: (m,) by the logarithms of the uncertainties
    memory: np.ndarray  #: (2,) by correlation and independent share


class Foretold(NamedTuple):
    """Each reading as all others foretell it, in units of its uncertainty."""

    error: np.ndarray  #: (m,)
    variance: np.ndarray  #: (m,) of the error
    own: np.ndarray  #: (m,) the part of it that is the reading's own


@dataclass(frozen=True, eq=False)
class Chained:
    """Readings (m,) = columns @ numbers of unit prior variance + errors with a memory along chains."""

    residual: np.ndarray  #: (m,)
    columns: np.ndarray  #: (m, k)
    chains: Sequence[np.ndarray]

    def evidence(self, u: np.ndarray, sizes: np.ndarray, memory: Memory) -> ChainedEvidence:
        """The evidence of uncertainties (m,), sizes (k,) of the columns and a memory."""
        errors = ChainedErrors(self.chains, memory)
        plain = np.column_stack([self.residual, self.columns * sizes]) / u[:, None]
        mean, inverse, half_log, white = self._explained(errors, plain)
        left = white[:, 0] - white[:, 1:] @ mean
        spread = white[:, 1:] @ inverse
        log = float(np.sum(np.log(u))) + 0.5 * errors.log_determinant + half_log
        away, back = plain[:, 0] - plain[:, 1:] @ mean, errors.back(np.column_stack([left, spread]))
        by_u = back[:, 0] * away - 1.0 + np.einsum("ij,ij->i", back[:, 1:], plain[:, 1:])
        by_memory = np.zeros(2)
        if not errors.trivial:
            slopes = errors.root @ memory.slopes(len(errors.root)) @ errors.root.T
            for rows in self.chains:
                n = len(rows)
                inside = np.outer(left[rows], left[rows]) + spread[rows] @ white[rows, 1:].T - np.eye(n)
                by_memory += 0.5 * np.einsum("kij,ij->k", slopes[:, :n, :n], inside)
        return ChainedEvidence(
            value=-0.5 * float(left @ white[:, 0]) - log,
            sizes=mean**2 + np.diag(inverse) - 1.0,
            u=by_u,
            memory=by_memory,
        )

    def foretold(self, u: np.ndarray, sizes: np.ndarray, memory: Memory) -> Foretold:
        """Every reading from all others."""
        errors = ChainedErrors(self.chains, memory)
        plain = np.column_stack([self.residual, self.columns * sizes]) / u[:, None]
        mean, inverse, _, white = self._explained(errors, plain)
        back = errors.back(np.column_stack([white[:, 0] - white[:, 1:] @ mean, white[:, 1:]]))
        alone = errors.known_from_others
        known = alone - np.einsum("ij,jk,ik->i", back[:, 1:], inverse, back[:, 1:], optimize=True)
        known = np.maximum(known, constants.LEAST_KNOWN * alone)
        return Foretold(back[:, 0] / known, 1.0 / known, 1.0 / alone)

    @staticmethod
    def _explained(
        errors: ChainedErrors, plain: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, float, np.ndarray]:
        """Mean (k,) and covariance (k, k) of the numbers, half the log determinant of its inverse, and the whitened rows."""
        white = errors.whiten(plain)
        root = lower_factor(white[:, 1:])
        inverse = dpotri(root, lower=1)[0] if len(root) else root
        inverse = np.tril(inverse) + np.tril(inverse, -1).T
        mean = inverse @ (white[:, 1:].T @ white[:, 0])
        return mean, inverse, float(np.sum(np.log(np.diag(root)))), white


def lower_factor(A: np.ndarray) -> np.ndarray:
    """Lower Cholesky factor of A'A + 1, also where A is so large that rounding loses the 1 (a model far from the readings)."""
    ones = np.eye(A.shape[1])
    try:
        return np.linalg.cholesky(A.T @ A + ones)
    except np.linalg.LinAlgError:  # slower, and never without a factor
        _, upper = np.linalg.qr(np.vstack([A, ones]))
        return np.asarray((upper * np.where(np.diag(upper) < 0.0, -1.0, 1.0)[:, None]).T)
