"""Smooth functions of several conditions: a Gaussian process, described by its values at some of the readings.

Each condition has a Matern covariance of order 5/2: model error bends fast where a tyre begins to slide and slowly elsewhere,
which the single length of a squared exponential cannot describe. Along a slip that sweeps move, lengths are shorter around zero.
Half of the variance at the middle load is of functions that grow with the load, as forces do, half of functions that do not: a
zero of the rig cannot be told from these by their loads. Between the nodes the process has its expected value (Quinonero-Candela
and Rasmussen 2005, Journal of Machine Learning Research 6, 1939). Nodes lie only where readings are, so a test that never moves
two conditions together needs few.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import solve_triangular

from mffit.linearised import constants
from mffit.linearised.gaussian import lower_root
from mffit.linearised.inputs import Input
from tir.constants import SMALLEST_LOAD
from tir.frozen import ReadOnlyArrays

SINGULAR = 1e-6
"""Added to correlations, so that those of close settings can be inverted."""


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
        process = cls.with_all(inputs, settings[:: max(1, len(settings) // (4 * most))], lengths, sign)
        places = process.nodes
        at, load = process._placed(places), process._load(places)
        untold, known, chosen = process.variance(places), np.zeros((most, len(places))), list[int]()
        while len(chosen) < min(most, len(places)):
            k, i = len(chosen), int(np.argmax(untold.round(6)))  # rounding must not choose between equal ones
            if chosen and untold[i] <= max(enough, SINGULAR):
                break
            whole = _of_loads(load, load[i]) * process._correlation(at, at[i])
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
    def root(self) -> np.ndarray:
        """Lower triangle (m, m) of the values at the nodes by the weights."""
        return lower_root(self.at_nodes(self.lengths)[0])

    def at_nodes(self, lengths: np.ndarray) -> tuple[np.ndarray, list[np.ndarray]]:
        """Covariance (m, m) of the values at the nodes for other lengths (d,), and its derivatives by the log of each."""
        images = [(sign * self._by_load * matern(apart, lengths), apart) for sign, apart in self._apart]
        whole = sum((alike for alike, _ in images), SINGULAR * np.eye(len(self.nodes)))
        by_lengths = [
            np.asarray(sum(alike * _falls(apart[i], length) for alike, apart in images))
            for i, length in enumerate(lengths)
        ]
        return np.asarray(whole), by_lengths

    @cached_property
    def _apart(self) -> list[tuple[int, list[np.ndarray]]]:
        """Signs, and distances (m, m) along every condition, of the nodes from each other and from their mirror images."""
        at = self._placed(self.nodes)
        return [(sign, _distances(at[:, None], image)) for sign, image in self._images(at)]

    @cached_property
    def _by_load(self) -> np.ndarray:
        """Factors (m, m) of the covariance at the nodes for their loads."""
        return _of_loads(self._load(self.nodes)[:, None], self._load(self.nodes))

    def columns(self, at: np.ndarray) -> np.ndarray:
        """Values (n, m) at conditions (n, d), which are clipped to the tested range.

        Of a condition that is NaN, and over which predictions average, the mean over its usual values.
        """
        alike = np.mean([self.covariance(one[:, None], self.nodes) for one in self._stated(at)], axis=0)
        return np.asarray(solve_triangular(self.root, alike.T, lower=True).T)

    def covariance(self, at: np.ndarray, others: np.ndarray) -> np.ndarray:
        """Of the process of unit size, between conditions (..., d) and others (..., d), clipped to the tested range."""
        alike = self._correlation(self._placed(at), self._placed(others))
        return np.asarray(_of_loads(self._load(at), self._load(others)) * alike)

    def variance(self, at: np.ndarray) -> np.ndarray:
        """Of the process of unit size, at conditions (n, d); conditions that are NaN as in :meth:`columns`."""
        each = [*self._stated(at)]
        return np.asarray(np.mean([self.covariance(*two) for two in itertools.product(each, each)], axis=0))

    def untold_change(self, pair: np.ndarray) -> float:
        """Variance of the process's change between two conditions (2, d) that its values at the nodes do not tell."""
        one, other = pair
        whole = sum(self.covariance(at, at) for at in pair) - 2.0 * self.covariance(one, other)
        told, others = self.fading(pair)
        return max(float(whole - np.sum((told - others) ** 2)), 0.0)

    def fading(self, at: np.ndarray) -> np.ndarray:
        """Values (n, m) at conditions (n, d), which fade with the :meth:`squared_distance` from the tested ones."""
        return np.asarray(np.exp(-0.5 * self.squared_distance(at))[:, None] * self.columns(at))

    def faded(self, at: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Variance (n,) of the process of unit size at conditions (n, d) that the nodes do not tell, and :meth:`fading`."""
        functions = self.fading(at)
        return np.maximum(self.variance(at) - np.sum(functions**2, axis=1), 0.0), functions

    def squared_distance(self, at: np.ndarray) -> np.ndarray:
        """Squared distance (n,) of conditions (n, d) from the nearest tested ones, in lengths; 0 inside the range.

        A condition that is NaN counts as tested.
        """
        distance = np.nan_to_num(at - self._clipped(at)) / self.lengths
        return np.asarray(np.sum(distance**2, axis=1))

    def _correlation(self, at: np.ndarray, others: np.ndarray) -> np.ndarray:
        """Between places (..., d) and others (..., d), and the mirror images of these."""
        each = (sign * matern(_distances(at, image), self.lengths) for sign, image in self._images(others))
        return np.asarray(sum(each))

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

    def _stated(self, at: np.ndarray) -> Iterator[np.ndarray]:
        """The conditions (n, d), once for every combination of usual values of those that are NaN somewhere."""
        usual = [
            one.averaged if one.averaged and np.any(np.isnan(x)) else (np.nan,)
            for one, x in zip(self.inputs, at.T, strict=True)
        ]
        for values in itertools.product(*usual):
            yield np.where(np.isnan(at), np.reshape(values, (1, -1)), at)


CONSTANT = SmoothFunctions((), np.zeros((1, 0)), np.zeros(0))
"""The only function of a tyre at one condition."""


def _of_loads(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    """Factor of the covariance between conditions at loads over the middle one."""
    return np.asarray(0.5 * (1.0 + one * other))


def _distances(at: np.ndarray, others: np.ndarray) -> list[np.ndarray]:
    """Distances of places (..., d) from others (..., d), along each condition; an empty one if there is no condition."""
    apart = [np.asarray(np.abs(at[..., i] - others[..., i])) for i in range(at.shape[-1])]
    return apart or [np.zeros(np.broadcast_shapes(at.shape[:-1], others.shape[:-1]))]


def matern(apart: Sequence[np.ndarray], lengths: Sequence[float] | np.ndarray) -> np.ndarray:
    """Correlation at distances ``apart`` along every condition, with length scales (d,)."""
    whole, alike = np.zeros(apart[0].shape), np.ones(apart[0].shape)
    for one, length in zip(apart, lengths, strict=False):
        far = one * (np.sqrt(5.0) / length)
        whole -= far
        # 1 + far + far^2 / 3, in the memory at hand: much of the time of a search goes here
        bend = far * (1.0 / 3.0)
        bend += 1.0
        bend *= far
        bend += 1.0
        alike *= bend
    alike *= np.exp(whole, out=whole)
    return np.asarray(alike)


def _falls(apart: np.ndarray, length: float) -> np.ndarray:
    """Derivative of the log correlation by the logarithm of a length, at distances along its condition."""
    far = apart * (np.sqrt(5.0) / length)
    return np.asarray(far**2 * (1.0 + far) / (3.0 + far * (3.0 + far)))
