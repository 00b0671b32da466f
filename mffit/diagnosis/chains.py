"""Errors correlated along chains of readings: a part with a memory, and an independent part beside it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np
from scipy.linalg.lapack import dtbtrs


class MemorySpan(Enum):
    """What errors with a memory run through before they begin anew."""

    SWEEP = "sweep"
    FILE = "file"
    PROGRAMME = "programme"


@dataclass(frozen=True, slots=True)
class Chains:
    """The order of readings (m,) along their chains."""

    order: np.ndarray  #: (m,) positions of the readings, chain after chain
    place: np.ndarray  #: (m,) place of each of these within its chain, from 0

    @classmethod
    def of(cls, chain: np.ndarray, turn: np.ndarray | None = None) -> Chains:
        """The chains of readings, from the number (m,) of the chain of each.

        Within a chain they are ordered by ``turn`` (m,), if that is given, and a turn that is left out begins another chain; else
        they keep their order.
        """
        order = np.argsort(chain, kind="stable") if turn is None else np.lexsort((turn, chain))
        at = np.arange(len(order))
        begins = np.ones(len(order), dtype=bool)
        begins[1:] = chain[order][1:] != chain[order][:-1]
        if turn is not None:
            begins[1:] |= np.diff(turn[order]) != 1
        return cls(order, at - np.maximum.accumulate(np.where(begins, at, 0)))

    def same_as(self, other: Chains) -> bool:
        """Whether other chains of the same readings are these."""
        return np.array_equal(self.order, other.order) and np.array_equal(self.place, other.place)

    @property
    def longest(self) -> int:
        """Readings of the longest chain."""
        return int(self.place.max(initial=-1)) + 1


@dataclass(frozen=True, slots=True)
class Correlation:
    """The correlation of the readings of chains, factorised. Arrays are in the order of the chains.

    The differences d of each reading to ``memory`` times the one before have a tridiagonal covariance, whose lower factor has
    the diagonal ``own`` and ``below`` it the link to the reading before.
    """

    chains: Chains
    memory: (
        np.ndarray
    )  #: (m,) correlation of the part with a memory, to the reading before; 0 at the start of a chain
    own: np.ndarray  #: (m,)
    below: np.ndarray  #: (m,)

    @classmethod
    def along(cls, chains: Chains, parts: Sequence[tuple[np.ndarray, float, float]]) -> Correlation:
        """``parts`` are masks (m,) of readings of whole chains, with their memory and independent share."""
        after, m = chains.place > 0, len(chains.order)
        rho, own, below = np.zeros(m), np.ones(m), np.zeros(m)
        for mask, memory, share in parts:
            some = mask[chains.order] & after
            if memory and some.any():
                roots, links = _factors(memory, share, chains.longest)
                rho[some], place = memory, chains.place[some]
                own[some], below[some] = roots[place], links[place]
        return cls(chains, rho, own, below)

    @property
    def log(self) -> float:
        """Logarithm of the square root of the determinant."""
        return float(np.sum(np.log(self.own)))

    @property
    def trivial(self) -> bool:
        """Whether all readings are independent."""
        return not self.memory.any()

    def whiten(self, z: np.ndarray) -> np.ndarray:
        """Readings (m,) or (m, k) of unit variance, made independent of each other."""
        if self.trivial:
            return z
        order, out = self.chains.order, np.empty_like(z)
        out[order] = self.in_order(z[order])
        return out

    def in_order(self, z: np.ndarray) -> np.ndarray:
        """The same for readings in the order of the chains; fast for columns of Fortran order."""
        if not z.size:  # the slopes of a switch: LAPACK's wrapper writes beyond an array without columns
            return z
        d = z.copy(order="F")
        d[1:] -= (self.memory[1:] * z[:-1].T).T
        if not self.below.any():
            return (d.T / self.own).T
        bands = np.vstack([self.own, np.append(self.below[1:], 0.0)])
        return dtbtrs(bands, d, uplo="L", overwrite_b=1)[0].reshape(d.shape)

    def adjoint(self, slope: np.ndarray) -> np.ndarray:
        """Slopes by the differences d (m, k), from slopes (m, k) by the readings after :meth:`in_order`."""
        if not self.below.any():
            return (slope.T / self.own).T
        bands = np.vstack([self.own, np.append(self.below[1:], 0.0)])
        return dtbtrs(bands, slope, uplo="L", trans="T")[0].reshape(slope.shape)

    def slopes(
        self, z: np.ndarray, white: np.ndarray, by_d: np.ndarray, memory: float, share: float
    ) -> np.ndarray:
        """Slopes (2,) by memory and independent share that all readings have, the logarithm of the determinant included.

        ``z`` are the readings (m, k), ``white`` what :meth:`in_order` makes of them, ``by_d`` the result of :meth:`adjoint`.
        """
        after, place = self.chains.place > 0, self.chains.place
        own, below = (slope[:, place] for slope in _factor_slopes(memory, share, self.chains.longest))
        by_own = 1.0 / self.own - np.einsum("ij,ij->i", by_d, white)
        by_below = -np.einsum("ij,ij->i", by_d[1:], white[:-1])
        by_memory = -float(np.einsum("ij,ij->i", by_d[1:], z[:-1]) @ after[1:])
        return own @ by_own + below[:, 1:] @ by_below + np.array([by_memory, 0.0])

    def sum_of(self, weight: np.ndarray) -> np.ndarray:
        """Weights (m,) of independent unit errors in the sum of readings with these weights."""
        if self.trivial:
            return weight
        order, out = self.chains.order, np.empty(len(weight))
        # The transposed inverse of the differences, then the transposed factor.
        bands = np.vstack([np.ones(len(order)), np.append(-self.memory[1:], 0.0)])
        y = dtbtrs(bands, weight[order], uplo="L", trans="T")[0].ravel()
        out[order] = self.own * y + np.append(self.below[1:] * y[1:], 0.0)
        return out


def _factors(memory: float, share: float, length: int) -> tuple[np.ndarray, np.ndarray]:
    """Diagonal and link of the factor, by place in a chain (length,); they soon become constant."""
    size, link = 1.0 - memory**2 + 2.0 * share * memory**2, -share * memory
    own, below = np.ones(length), np.zeros(length)
    if not share:
        own[1:] = math.sqrt(size)
        return own, below
    last = 1.0
    for k in range(1, length):
        below[k] = link / last
        own[k] = math.sqrt(size - below[k] ** 2)
        if abs(own[k] - last) < 1e-13:
            own[k:], below[k:] = own[k], below[k]
            break
        last = float(own[k])
    return own, below


def _factor_slopes(memory: float, share: float, length: int) -> tuple[np.ndarray, np.ndarray]:
    """Slopes (2, length) of :func:`_factors` by memory and share."""
    own, below = _factors(memory, share, length)
    size = np.array([2.0 * memory * (2.0 * share - 1.0), 2.0 * memory**2])
    link = np.array([-share, -memory])
    of_own, of_below = np.zeros((2, length)), np.zeros((2, length))
    for k in range(1, length):
        of_below[:, k] = (link - below[k] * of_own[:, k - 1]) / own[k - 1]
        of_own[:, k] = (0.5 * size - below[k] * of_below[:, k]) / own[k]
    return of_own, of_below
