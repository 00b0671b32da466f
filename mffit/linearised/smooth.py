"""Smooth functions of several conditions: a Gaussian process in a reduced-rank basis.

The basis functions are products of cosines over a slightly widened tested range (Solin and Sarkka 2020, Statistics and Computing
30, 419); size and length scales change only their prior variances. Each condition has a Matern covariance of order 5/2: model
error bends fast where a tyre begins to slide and slowly elsewhere, which the single length of a squared exponential cannot
describe. A constant is one of the functions; the priors apportion it between model error and zeros of the rig.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mffit.linearised import constants
from mffit.linearised.inputs import Input
from tir.frozen import ReadOnlyArrays

LEAST = float(-np.log(constants.LEAST_SHARE))
WIDEST = float(np.sqrt(5.0 * np.expm1(LEAST / 3.0)))
"""Wave number, in radians per length scale, beyond which a basis function's variance is negligible."""
SINGULAR = 1e-9
"""Added to correlations, so that those of close settings can be inverted."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothFunctions(ReadOnlyArrays):
    """The basis: m products of cosines over d conditions."""

    inputs: tuple[Input, ...]  #: (d,)
    orders: np.ndarray  #: (m, d) number of half waves of every function along every condition

    @classmethod
    def over(
        cls, inputs: tuple[Input, ...], sign: int = 1, lengths: Sequence[float] | None = None
    ) -> SmoothFunctions:
        """The basis functions with the largest prior variance at the shortest lengths, or near the likely ``lengths`` (d,).

        Of mirrored conditions, only those are used that a mirror multiplies by ``sign``.
        """
        orders, size = np.zeros((1, 0), dtype=int), np.zeros(1)
        for one, length in zip(inputs, lengths or [0.0] * len(inputs), strict=True):
            order = np.arange(_most_half_waves(one) + 1)
            shortest = max(constants.CHOSEN_FOR * length, one.spacing)
            # further factors only reduce the variance, so small products are dropped at once
            size = (size[:, None] + _log_spectrum(np.pi * order * shortest / _length(one))[0]).ravel()
            orders = np.column_stack([np.repeat(orders, len(order), axis=0), np.tile(order, len(orders))])
            orders, size = orders[size > -LEAST], size[size > -LEAST]
        mirrored = np.array([one.mirrored for one in inputs], dtype=bool)
        if mirrored.any():  # around the middle of its range, a cosine with an odd number of half waves is odd
            symmetric = (-1) ** np.sum(orders[:, mirrored], axis=1) == sign
            orders, size = orders[symmetric], size[symmetric]
        largest = np.argsort(-size, kind="stable")[: constants.FUNCTIONS]
        return cls(inputs, orders[largest])

    def columns(self, at: np.ndarray) -> np.ndarray:
        """Values (n, m) at conditions (n, d), which are clipped to the tested range.

        Of a condition that is NaN, and over which predictions average, the mean over its usual values.
        """
        out = np.ones((len(at), len(self.orders)))
        for i, one in enumerate(self.inputs):
            order = np.arange(int(self.orders[:, i].max(initial=0)) + 1)
            waves = _waves(one, at[:, i], order)
            if one.averaged:
                waves[np.isnan(at[:, i])] = _waves(one, np.array(one.averaged), order).mean(axis=0)
            out *= np.take(waves, self.orders[:, i], axis=1)
        return out

    def log_variance(self, lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Log share (m,) of every function in the prior variance, and its derivatives (m, d) by the log lengths."""
        size = np.zeros(len(self.orders))
        slope = np.zeros((len(self.orders), len(self.inputs)))
        for i, one in enumerate(self.inputs):
            order = np.arange(_most_half_waves(one) + 1)
            exponent, by_length = _log_spectrum(np.pi * order * lengths[i] / _length(one))
            total = float(np.log(np.sum(np.exp(exponent))))
            share = np.exp(exponent - total)
            size += (exponent - total)[self.orders[:, i]]
            slope[:, i] = (by_length - share @ by_length)[self.orders[:, i]]
        return size, slope

    def unseen(self, pair: np.ndarray, lengths: np.ndarray) -> float:
        """Variance of the model error's change between two settings (2, d) of one condition, over that of the model error.

        All that readings at the settings of that condition, a spacing apart, show of it is taken as known. That is everything
        but over a swept slip: a force may bend faster around zero, where bristles begin to slide, than readings beside it show.
        Nothing is known where the other conditions are untested.
        """
        differs = int(np.argmax(np.ptp(pair, axis=0) / lengths))
        one = self.inputs[differs]
        at = one.stretched(np.append(pair[:, differs], one.nodes))
        far = np.sqrt(5.0) * np.abs(at[:, None] - at) / lengths[differs]
        alike = (1.0 + far + far**2 / 3.0) * np.exp(-far) + SINGULAR * np.eye(len(at))
        change = alike[1] - alike[0]
        whole = known = change[1] - change[0]
        if one.is_stretched:
            known = change[2:] @ np.linalg.solve(alike[2:, 2:], change[2:])
        others = pair[:1].copy()
        others[0, differs] = one.lower
        (squared,) = self.squared_distance(others, lengths)
        return max(float(whole - np.exp(-squared) * known), 0.0)

    def faded(self, settings: np.ndarray, lengths: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Share (n,) of the model error's variance at ``settings`` (n, d) that tested ones do not tell, and the functions (n, m).

        The functions fade with the :meth:`squared_distance` from the tested settings.
        """
        squared = self.squared_distance(settings, lengths)
        return -np.expm1(-squared), np.exp(-0.5 * squared)[:, None] * self.columns(settings)

    def squared_distance(self, at: np.ndarray, lengths: np.ndarray) -> np.ndarray:
        """Squared distance (n,) of conditions (n, d) from the nearest tested ones, in lengths; 0 inside the range.

        A condition that is NaN counts as tested.
        """
        lower, upper = ([getattr(one, end) for one in self.inputs] for end in ("lower", "upper"))
        distance = np.nan_to_num(at - np.clip(at, lower, upper)) / lengths
        return np.asarray(np.sum(distance**2, axis=1))


def _waves(one: Input, values: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Cosines (n, k) of one condition, of the numbers of half waves ``order`` (k,), normalised to unit mean square."""
    place = (np.clip(values, one.lower, one.upper) - one.lower + constants.ROOM * one.width) / _length(one)
    return np.asarray(np.cos(np.pi * place[:, None] * order) * np.where(order > 0, np.sqrt(2.0), 1.0))


def _length(one: Input) -> float:
    """Length of the widened range over which the cosines of a condition are defined."""
    return (1.0 + 2.0 * constants.ROOM) * one.width


def _most_half_waves(one: Input) -> int:
    """Largest number of half waves with non-negligible variance at the shortest length."""
    return int(np.ceil(WIDEST / np.pi * _length(one) / one.spacing))


def _log_spectrum(wave: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Log spectral density (k,) of a Matern 5/2 covariance at waves [rad/length], and its derivative by the log length."""
    return -3.0 * np.log1p(wave**2 / 5.0), -6.0 * wave**2 / (5.0 + wave**2)
