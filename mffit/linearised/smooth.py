"""Smooth functions of several conditions: a Gaussian process, described by its values at some of the readings.

Each condition has a Matern covariance of order 5/2: model error bends fast where a tyre begins to slide and slowly elsewhere,
which the single length of a squared exponential cannot describe. Along a slip that sweeps move, lengths are shorter around zero.
Half of the variance at the middle load is of functions that grow with the load, as forces do, half of functions that do not: a
zero of the rig cannot be told from these by their loads. Between the nodes the process has its expected value (Quinonero-Candela
and Rasmussen 2005, Journal of Machine Learning Research 6, 1939). Nodes lie only where readings are, so a test that never moves
two conditions together needs few.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg.blas import dtrmm

from mffit.linearised import constants
from mffit.linearised.gaussian import lower_inverse, lower_root
from mffit.linearised.inputs import Input
from tir.constants import SMALLEST_LOAD
from tir.frozen import ReadOnlyArrays

SINGULAR = 1e-6
"""Added to correlations, so that those of close settings can be inverted."""

BLOCK = 64
"""Conditions of which covariances are computed together."""


class _Places(NamedTuple):
    """Places of n conditions on d scales; of the equal values along a scale, covariances are computed once."""

    many: int  #: n
    usual: Sequence[Sequence[float]]
    """(d,) values over which correlations of a place that is NaN are averaged; empty if it stays NaN."""
    values: list[np.ndarray]  #: (d,) different values along every scale
    which: list[np.ndarray]  #: (d, n) index of each place's value

    @classmethod
    def of(cls, at: np.ndarray, inputs: Sequence[Input]) -> _Places:
        """The places (n, d) of conditions on the scales of ``inputs``."""
        each = [np.unique(x, return_inverse=True) for x in at.T]
        usual = [one.averaged for one in inputs]
        return cls(len(at), usual, [values for values, _ in each], [which for _, which in each])

    def correlation(self, others: np.ndarray, lengths: np.ndarray) -> np.ndarray:
        """Correlation (n, m) with places ``others`` (m, d)."""
        alike = np.ones((self.many, len(others)))
        scales = zip(self.values, self.which, self.usual, others.T, lengths, strict=True)
        for values, which, usual, other, length in scales:
            rows = matern(np.abs(values[:, None] - other), length)
            if usual and np.isnan(values[-1]):  # they are sorted
                rows[-1] = np.mean(matern(np.abs(np.array(usual)[:, None] - other), length), axis=0)
            alike *= rows[which]
        return alike

    def falls(self, others: np.ndarray, lengths: np.ndarray) -> Iterator[np.ndarray]:
        """Derivatives (n, m) of the logarithm of the correlation by that of each length."""
        for values, which, other, length in zip(self.values, self.which, others.T, lengths, strict=True):
            yield _falls(np.abs(values[:, None] - other), length)[which]


@dataclass(frozen=True, eq=False)
class SmoothFunctions(ReadOnlyArrays):
    """m functions of d conditions, whose weights are independent and have the variance of the process."""

    inputs: tuple[Input, ...]  #: (d,)
    nodes: np.ndarray  #: (m, d) conditions at which values of the process determine it
    lengths: np.ndarray  #: (d,) length scales [unit of the input]
    sign: int = 1  #: by which a mirror multiplies the functions

    @classmethod
    def over(
        cls,
        inputs: tuple[Input, ...],
        settings: np.ndarray,
        lengths: Sequence[float],
        sign: int = 1,
        enough: float = 0.0,
    ) -> SmoothFunctions:
        """The functions with nodes among the ``settings`` (n, d) of readings: each where the others tell least.

        ``enough`` is the share of the variance that the nodes need not tell.
        """
        most = int(constants.FUNCTIONS)
        process = cls.with_all(inputs, settings[:: -(-len(settings) // (4 * most))], lengths, sign)
        places = process.nodes
        scaled, load = process._placed(places), process._load(places)
        at = _Places.of(scaled, inputs)
        untold, known, chosen = process.variance(places), np.zeros((most, len(places))), list[int]()
        while len(chosen) < min(most, len(places)):
            k, i = len(chosen), int(np.argmax(untold.round(6)))  # rounding must not choose between equal ones
            if chosen and untold[i] <= max(enough, SINGULAR):
                break
            whole = _of_loads(load, load[i]) * process._correlation(at, scaled[[i]])[:, 0]
            left = whole - known[:k, i] @ known[:k]
            known[k] = left / np.sqrt(untold[i])
            untold = untold - known[k] ** 2
            chosen.append(i)
        return cls(inputs, places[chosen], process.lengths, sign)

    @classmethod
    def with_all(
        cls, inputs: tuple[Input, ...], settings: np.ndarray, lengths: Sequence[float], sign: int = 1
    ) -> SmoothFunctions:
        """The functions with nodes at all ``settings`` (n, d), equal ones once."""
        lower, width = (np.array([getattr(one, name) for one in inputs]) for name in ("lower", "width"))
        # rounding of means must not order the nodes
        _, first = np.unique(((settings - lower) / width).round(6), axis=0, return_index=True)
        return cls(inputs, settings[first], np.array(lengths, dtype=float), sign)

    @cached_property
    def back(self) -> np.ndarray:
        """Lower triangle (m, m) of the weights by the values at the nodes."""
        return lower_inverse(lower_root(self.at_nodes(self.lengths)[0]))

    def at_nodes(self, lengths: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        """Covariance (m, m) of the values at the nodes for other lengths (d,), and its derivatives by the log of each."""
        at = self._placed(self.nodes)
        places, whole = _Places.of(at, self.inputs), SINGULAR * np.eye(len(at))
        by_lengths = [np.zeros(whole.shape) for _ in lengths]
        for sign, image in self._images(at):
            alike = sign * self._by_load * places.correlation(image, lengths)
            whole += alike
            for slope, falls in zip(by_lengths, places.falls(image, lengths), strict=True):
                slope += alike * falls
        return whole, by_lengths

    @cached_property
    def _by_load(self) -> np.ndarray:
        """Factors (m, m) of the covariance at the nodes for their loads."""
        return _of_loads(self._load(self.nodes)[:, None], self._load(self.nodes))

    def columns(self, at: np.ndarray) -> np.ndarray:
        """Values (n, m) at conditions (n, d), which are clipped to the tested range.

        Of a condition that is NaN, and over which predictions average, the mean over its usual values.
        """
        alike = np.concatenate([*self._with_nodes(at)])
        return np.asarray(dtrmm(1.0, self.back, alike.T, lower=1, overwrite_b=1).T)

    def estimate(self, weights: np.ndarray, at: np.ndarray) -> np.ndarray:
        """Sum (n,) of the functions with ``weights`` (m,) at conditions (n, d), as :meth:`fading`."""
        pull = self.back.T @ weights
        return np.asarray(self._left(at) * np.concatenate([alike @ pull for alike in self._with_nodes(at)]))

    def _with_nodes(self, at: np.ndarray) -> Iterator[np.ndarray]:
        """Covariance of the process of unit size between conditions (n, d), as in :meth:`columns`, and the m nodes.

        It comes in blocks (:data:`BLOCK`, m), which stay in the processor's fast memory.
        """
        nodes, load = self._placed(self.nodes), self._load(self.nodes)
        for begin in range(0, max(len(at), 1), BLOCK):
            block = at[begin : begin + BLOCK]
            alike = self._correlation(_Places.of(self._placed(block), self.inputs), nodes)
            yield _of_loads(self._load(block)[:, None], load) * alike

    def variance(self, at: np.ndarray) -> np.ndarray:
        """Of the process of unit size, at conditions (n, d); conditions that are NaN as in :meth:`columns`."""
        return self._covariance(at, at)

    def _covariance(self, at: np.ndarray, others: np.ndarray) -> np.ndarray:
        """Covariance (n,) of the process of unit size between conditions (n, d) and others (n, d)."""
        places, alike = self._placed(at), np.zeros(len(at))
        for sign, image in self._images(self._placed(others)):
            product = np.full(len(at), float(sign))
            for x, other, length, one in zip(places.T, image.T, self.lengths, self.inputs, strict=True):
                own = matern(np.abs(x - other), length)
                if one.averaged:
                    values = np.array(one.averaged)
                    own[np.isnan(own)] = np.mean(matern(np.abs(values[:, None] - values), length))
                product *= own
            alike += product
        return _of_loads(self._load(at), self._load(others)) * alike

    def untold_change(self, pair: np.ndarray) -> float:
        """Variance of the process's change between two conditions (2, d) that its values at the nodes do not tell."""
        whole = np.sum(self._covariance(pair, pair)) - 2.0 * self._covariance(*pair[:, None])[0]
        told, others = self.fading(pair)
        return max(float(whole - np.sum((told - others) ** 2)), 0.0)

    def fading(self, at: np.ndarray) -> np.ndarray:
        """Values (n, m) at conditions (n, d), which fade with the distance from the tested ones."""
        return np.asarray(self._left(at)[:, None] * self.columns(at))

    def faded(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Variance (n,) of the process of unit size at conditions (n, d) that the nodes do not tell, and :meth:`fading`."""
        functions = self.fading(at)
        return np.maximum(self.variance(at) - np.sum(functions**2, axis=1), 0.0), functions

    def _left(self, at: np.ndarray) -> np.ndarray:
        """What is left (n,) of the functions at conditions (n, d) outside the tested range; one that is NaN counts as tested."""
        distance = np.nan_to_num(at - self._clipped(at)) / self.lengths
        return np.asarray(np.exp(-0.5 * np.sum(distance**2, axis=1)))

    def _correlation(self, at: _Places, others: np.ndarray) -> np.ndarray:
        """Between places (n,) and others (m, d), and the mirror images of these."""
        return np.asarray(
            sum(sign * at.correlation(image, self.lengths) for sign, image in self._images(others))
        )

    def _images(self, at: np.ndarray) -> Iterator[tuple[int, np.ndarray]]:
        """Places (..., d), and their mirror images if any condition is mirrored, with the sign of the functions there."""
        yield 1, at
        if any(one.mirrored for one in self.inputs):
            yield self.sign, np.where([one.mirrored for one in self.inputs], -at, at)

    def _placed(self, at: np.ndarray) -> np.ndarray:
        """Places (..., d) of conditions on the scales along which the lengths are the same everywhere."""
        at = self._clipped(at)
        for i, one in enumerate(self.inputs):
            at[..., i] = one.stretched(at[..., i])
        return at

    def _load(self, at: np.ndarray) -> np.ndarray:
        """Load (...) at conditions (..., d) over the middle one; 1 if one was tested."""
        for i, one in enumerate(self.inputs):
            if one.name == "Fz":
                return np.asarray(
                    self._clipped(at)[..., i] / np.sqrt(max(one.lower, SMALLEST_LOAD) * one.upper)
                )
        return np.ones(at.shape[:-1])

    def _clipped(self, at: np.ndarray) -> np.ndarray:
        lower, upper = ([getattr(one, end) for one in self.inputs] for end in ("lower", "upper"))
        return np.asarray(np.clip(at, lower, upper))


CONSTANT = SmoothFunctions((), np.zeros((1, 0)), np.zeros(0))
"""The only function of a tyre at one condition."""


def _of_loads(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Factor of the covariance between conditions at loads over the middle one."""
    return np.asarray(0.5 * (1.0 + one * other))


def matern(apart: np.ndarray, length: float) -> np.ndarray:
    """Correlation at distances ``apart`` along a condition."""
    far = apart * (np.sqrt(5.0) / length)
    return np.asarray((1.0 + far * (1.0 + far / 3.0)) * np.exp(-far))


def _falls(apart: np.ndarray, length: float) -> np.ndarray:
    """Derivative of the log correlation by the logarithm of a length, at distances along its condition."""
    far = apart * (np.sqrt(5.0) / length)
    return np.asarray(far**2 * (1.0 + far) / (3.0 + far * (3.0 + far)))
