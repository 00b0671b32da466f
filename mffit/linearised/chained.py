"""A linear Gaussian model of readings with errors that are autocorrelated along chains; its numbers are integrated out.

In :mod:`mffit.linearised.mixed` each group has random effects; here instead the errors of a group are correlated.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg import solve_triangular

from mffit.linearised import constants
from mffit.linearised.gaussian import Informed
from mffit.linearised.search import share_of
from tir.frozen import ReadOnlyArrays


class Memory(NamedTuple):
    """Autocorrelation of errors along a chain: an exponential part and an independent part."""

    correlation: float = 0.0  #: correlation of neighbouring readings in the exponential part
    independent: float = 0.0  #: share of the variance that is independent

    @classmethod
    def of(cls, x: Mapping[str, float]) -> Memory:
        """The memory from the log odds of its fields; a missing one is 0."""
        return cls(*(share_of(x.get(name, -math.inf)) for name in cls._fields))

    def matrix(self, n: int) -> np.ndarray:
        """Correlation matrix (n, n) of the readings of a chain."""
        steps = np.arange(float(n))
        out = _over_steps((1.0 - self.independent) * self.correlation**steps)
        np.fill_diagonal(out, 1.0)
        return out

    def slopes(self, n: int) -> np.ndarray:
        """Derivatives (2, n, n) of the correlation matrix by correlation and independent share."""
        steps = np.arange(float(n))
        by_correlation = (1.0 - self.independent) * steps * self.correlation ** np.maximum(steps - 1.0, 0.0)
        by_share = -(self.correlation**steps)
        by_share[:1] = 0.0
        return np.array([_over_steps(by_correlation), _over_steps(by_share)])


NO_MEMORY = Memory()


def _over_steps(values: np.ndarray) -> np.ndarray:
    """Matrix (n, n) of the value (n,) at the number of steps between two readings."""
    places = np.arange(len(values))
    out: np.ndarray = values[np.abs(places[:, None] - places)]
    return out


def chains_of(chain: np.ndarray, turn: np.ndarray | None = None) -> list[np.ndarray]:
    """Row indices of every chain in order; ``chain`` (m,) is the index of the chain of each row.

    If ``turn`` (m,) is given, rows of a chain are ordered by it, and a gap in it starts a new chain. Very long chains are cut,
    because distant errors are practically independent.
    """
    order = np.argsort(chain, kind="stable") if turn is None else np.lexsort((turn, chain))
    begins = np.diff(chain[order]) != 0
    if turn is not None:
        begins |= np.diff(turn[order]) != 1
    longest = int(constants.LONGEST_CHAIN)
    whole = np.split(order, np.flatnonzero(begins) + 1)
    return [rows[k : k + longest] for rows in whole for k in range(0, len(rows), longest)]


@dataclass(frozen=True, eq=False)
class ChainedErrors(ReadOnlyArrays):
    """Errors of unit variance in chains, and their autocorrelation."""

    chains: Sequence[np.ndarray]
    memory: Memory

    @cached_property
    def root(self) -> np.ndarray:
        """Inverse Cholesky factor of the longest chain's correlation matrix; its upper left block serves shorter chains."""
        n = max((len(rows) for rows in self.chains), default=0)
        factor = np.linalg.cholesky(self.memory.matrix(n)) if n else np.zeros((0, 0))
        return solve_triangular(factor, np.eye(n), lower=True, check_finite=False) if n else factor

    @property
    def trivial(self) -> bool:
        """Whether all errors are independent."""
        return not self.memory.correlation

    def whiten(self, x: np.ndarray) -> np.ndarray:
        """Rows (m,) or (m, k) multiplied by the inverse Cholesky factor, so that their errors become independent."""
        return x if self.trivial else self._by_chain(self.root, x)

    def back(self, x: np.ndarray) -> np.ndarray:
        """Rows (m,) or (m, k) multiplied by the transposed inverse Cholesky factor."""
        return x if self.trivial else self._by_chain(self.root.T, x)

    @cached_property
    def tables(self) -> list[np.ndarray]:
        """Rows of chains of similar length side by side, (longest, chains) each; below a shorter chain, a row after the last."""
        similar: dict[int, list[np.ndarray]] = {}
        for rows in self.chains:
            similar.setdefault(len(rows).bit_length(), []).append(rows)
        after, out = sum(len(rows) for rows in self.chains), []
        for some in similar.values():
            table = np.full((max(len(rows) for rows in some), len(some)), after)
            for k, rows in enumerate(some):
                table[: len(rows), k] = rows
            out.append(table)
        return out

    def _by_chain(self, matrix: np.ndarray, x: np.ndarray) -> np.ndarray:
        """The rows of every chain multiplied by the upper left block of a triangular matrix."""
        x = _with_zeros(x)
        out = np.empty_like(x)
        for table in self.tables:
            n, own = len(table), x[table]
            out[table] = (matrix[:n, :n] @ own.reshape(n, -1)).reshape(own.shape)
        return out[:-1]

    def products(self, x: np.ndarray, y: np.ndarray) -> np.ndarray:
        """Sum over chains of the products (longest, longest) of the rows (m, k) of a chain in x and in y."""
        x, y, out = _with_zeros(x), _with_zeros(y), np.zeros_like(self.root)
        for table in self.tables:
            n = len(table)
            out[:n, :n] += x[table].reshape(n, -1) @ y[table].reshape(n, -1).T
        return out

    def variance_of_sum(self, weight: np.ndarray) -> float:
        """Variance of the sum of all errors with these weights (m,)."""
        if self.trivial:
            return float(weight @ weight)
        whole = self.memory.matrix(len(self.root))
        return float(sum(weight[g] @ whole[: len(g), : len(g)] @ weight[g] for g in self.chains))

    @property
    def log_determinant(self) -> float:
        """Log determinant of the correlation matrix of all rows."""
        logs = np.append(0.0, np.cumsum(np.log(np.diag(self.root))))
        return 0.0 if self.trivial else -2.0 * float(sum(logs[len(rows)] for rows in self.chains))

    @property
    def known_from_others(self) -> np.ndarray:
        """Inverse (m,) of each error's conditional variance given the other errors of its chain."""
        out = np.ones(sum(len(rows) for rows in self.chains))
        for rows in self.chains if not self.trivial else ():
            n = len(rows)
            out[rows] = np.sum(self.root[:n, :n] ** 2, axis=0)
        return out


def _with_zeros(x: np.ndarray) -> np.ndarray:
    """Rows (m,) or (m, k) with a row of zeros after the last."""
    return np.concatenate([x, np.zeros((1, *x.shape[1:]))])


@dataclass(frozen=True, eq=False)
class Chained(ReadOnlyArrays):
    """Readings (m,) as a sum of declared terms: numbers of unit prior variance, and errors that are autocorrelated along chains.

    A parameter with the name of a term is the logarithm of its size; a term without one has size 1. The parameters
    ``correlation`` and ``independent`` are the log odds of the memory's; without them the errors are independent.
    """

    residual: np.ndarray  #: (m,)
    columns: Mapping[str, np.ndarray]  #: by term, changes (m, k) of the readings by its numbers at size 1
    noise: Mapping[str, np.ndarray]  #: by term, variance (m,) of a part of the errors at size 1 and weight 1
    chains: Sequence[np.ndarray]
    weight: np.ndarray  #: (m,) usual variance of each reading's error over its own

    def uncertainty(self, x: Mapping[str, float]) -> np.ndarray:
        """Standard deviation (m,) of the errors."""
        return np.asarray(np.sqrt(sum(self._parts(x).values()) / self.weight))

    def _parts(self, x: Mapping[str, float]) -> dict[str, np.ndarray]:
        return {name: math.exp(2.0 * x.get(name, 0.0)) * part for name, part in self.noise.items()}

    def evidence(self, x: Mapping[str, float]) -> tuple[float, dict[str, float]]:
        """The log marginal likelihood of the readings, up to a constant, and its derivatives by the parameters ``x``."""
        errors, u, plain, white = self._rows(x)
        found = Informed.of_rows(white[:, 1:], white[:, 0])
        mean, inverse = found.mean, found.covariance
        left = white[:, 0] - white[:, 1:] @ mean
        spread = white[:, 1:] @ inverse
        log = float(np.sum(np.log(u))) + 0.5 * (errors.log_determinant + found.log_determinant)
        away, back = plain[:, 0] - plain[:, 1:] @ mean, errors.back(np.column_stack([left, spread]))
        by_u = back[:, 0] * away - 1.0 + np.einsum("ij,ij->i", back[:, 1:], plain[:, 1:])
        by_size = np.split(mean**2 + np.diag(inverse) - 1.0, np.cumsum(self._counts)[:-1])
        slopes = {name: float(np.sum(by)) for name, by in zip(self.columns, by_size, strict=True)}
        total = u**2 * self.weight
        slopes |= {name: float(by_u @ (part / total)) for name, part in self._parts(x).items()}
        if not errors.trivial:
            inside = errors.products(np.column_stack([left, spread]), np.column_stack([left, white[:, 1:]]))
            lengths = np.array([len(rows) for rows in self.chains])
            inside -= np.diag(np.sum(lengths > np.arange(len(inside))[:, None], axis=1))
            turned = errors.root.T @ inside @ errors.root
            by_memory = 0.5 * np.einsum("kij,ij->k", errors.memory.slopes(len(turned)), turned)
            for name, share, by in zip(Memory._fields, errors.memory, by_memory.tolist(), strict=True):
                slopes[name] = by * share * (1.0 - share)
        return -0.5 * float(left @ white[:, 0]) - log, {name: slopes[name] for name in x}

    def standardised(self, x: Mapping[str, float]) -> np.ndarray:
        """Error (m,) of every reading's prediction from all others, over its standard deviation if the reading had weight 1."""
        errors, _, _, white = self._rows(x)
        found = Informed.of_rows(white[:, 1:], white[:, 0])
        back = errors.back(np.column_stack([white[:, 0] - white[:, 1:] @ found.mean, white[:, 1:]]))
        alone = errors.known_from_others
        known = alone - np.sum((back[:, 1:] @ found.root) ** 2, axis=1)
        known = np.maximum(known, constants.LEAST_KNOWN * alone)
        return np.asarray(back[:, 0] / known / np.sqrt(1.0 / known + (self.weight - 1.0) / alone))

    @property
    def _counts(self) -> list[int]:
        """Numbers of every term."""
        return [one.shape[1] for one in self.columns.values()]

    def _rows(self, x: Mapping[str, float]) -> _Rows:
        errors, u = ChainedErrors(self.chains, Memory.of(x)), self.uncertainty(x)
        sizes = np.repeat([math.exp(x.get(name, 0.0)) for name in self.columns], self._counts)
        plain = (
            np.column_stack([self.residual, np.column_stack([*self.columns.values()]) * sizes]) / u[:, None]
        )
        return _Rows(errors, u, plain, errors.whiten(plain))


class _Rows(NamedTuple):
    """Residual and columns (m, 1 + k) of a model."""

    errors: ChainedErrors
    u: np.ndarray  #: (m,)
    plain: np.ndarray  #: over their uncertainties
    white: np.ndarray  #: also whitened along the chains
