"""Smooth functions of several conditions, with a Gaussian prior of few numbers.

Products of cosines over the tested range with a little room around it, as in a reduced-rank Gaussian process with a squared
exponential covariance (Solin and Sarkka 2020, Statistics and Computing 30, 419), so that only variances change with size and
lengths. There is no constant among them: that belongs to the zeros of the rig.
"""

from __future__ import annotations

import itertools
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from mffit.linearised import constants
from mffit.linearised.inputs import Input

LEAST = float(-np.log(constants.LEAST_SHARE))


@dataclass(frozen=True, slots=True, eq=False)
class Smooth:
    """The functions: m products of cosines over d conditions."""

    inputs: tuple[Input, ...]  #: (d,)
    orders: np.ndarray  #: (m, d) half waves of every function along every condition

    @classmethod
    def over(cls, inputs: tuple[Input, ...]) -> Smooth:
        """The functions that matter most at the shortest lengths."""
        most = [_most_half_waves(one) for one in inputs]
        orders = np.array(list(itertools.product(*(range(n + 1) for n in most))), dtype=int)[1:]
        size = sum(
            -0.5 * (np.pi * orders[:, i] * one.spacing / _length(one)) ** 2 for i, one in enumerate(inputs)
        )
        order = np.argsort(-np.asarray(size), kind="stable")[: constants.FUNCTIONS]
        return cls(inputs, orders[order[np.asarray(size)[order] > -LEAST]])

    def columns(self, at: Mapping[str, np.ndarray]) -> np.ndarray:
        """Values (n, m) at conditions (n,); beyond the tested range those at its end."""
        out = np.ones((len(next(iter(at.values()))), len(self.orders)))
        for i, one in enumerate(self.inputs):
            place = (np.clip(at[one.name], one.lower, one.upper) - one.lower) / _length(one)
            place += constants.ROOM / (1.0 + 2.0 * constants.ROOM)
            order = np.arange(int(self.orders[:, i].max()) + 1)
            waves = np.cos(np.pi * place[:, None] * order) * np.where(order > 0, np.sqrt(2.0), 1.0)
            out *= waves[:, self.orders[:, i]]
        return out

    def log_variance(self, lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Logarithm of the share (m,) of every function in the variance, and its derivatives (m, d) by those of the lengths."""
        size = np.zeros(len(self.orders))
        slope = np.zeros((len(self.orders), len(self.inputs)))
        for i, one in enumerate(self.inputs):
            order = np.arange(_most_half_waves(one) + 1)
            exponent = -0.5 * (np.pi * order * lengths[i] / _length(one)) ** 2
            total = float(np.log(np.sum(np.exp(exponent))))
            share = np.exp(exponent - total)
            size += (exponent - total)[self.orders[:, i]]
            slope[:, i] = 2.0 * (exponent - share @ exponent)[self.orders[:, i]]
        return size, slope

    def likeness(self, at: Mapping[str, np.ndarray], lengths: np.ndarray) -> np.ndarray:
        """Correlation (n,) of the functions at conditions beyond the tested range with those at its end; 1 within it."""
        far = np.zeros(len(next(iter(at.values()))))
        for one, length in zip(self.inputs, lengths, strict=True):
            beyond = np.maximum(np.maximum(one.lower - at[one.name], at[one.name] - one.upper), 0.0)
            far += (beyond / length) ** 2
        return np.asarray(np.exp(-0.5 * far))


def _length(one: Input) -> float:
    """Range over which the functions of a condition run."""
    return (1.0 + 2.0 * constants.ROOM) * one.width


def _most_half_waves(one: Input) -> int:
    """Half waves of the functions that matter at the shortest length."""
    return int(np.ceil(np.sqrt(2.0 * LEAST) / np.pi * _length(one) / one.spacing))
