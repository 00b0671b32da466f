"""Smooth functions of several conditions: a Gaussian process in a reduced-rank basis.

The basis functions are products of cosines: the discrete cosine transform over the settings of each condition nearly
diagonalises their covariance (Ahmed, Natarajan and Rao 1974, IEEE Transactions on Computers C-23, 90). Size and length scales
change only the functions' prior variances. Each condition has a Matern covariance of order 5/2: model
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

LEAST = 1e-12
"""Smallest share of a cosine in the variance over one condition; rounding may leave less than none."""
SINGULAR = 1e-9
"""Added to correlations, so that those of close settings can be inverted."""


@dataclass(frozen=True, slots=True, eq=False)
class SmoothFunctions(ReadOnlyArrays):
    """The basis: m products of cosines over d conditions."""

    inputs: tuple[Input, ...]  #: (d,)
    orders: np.ndarray  #: (m, d) number of half waves of every function along every condition

    @classmethod
    def over(
        cls,
        inputs: tuple[Input, ...],
        sign: int = 1,
        lengths: Sequence[float] | None = None,
        negligible: float = 0.0,
    ) -> SmoothFunctions:
        """The basis functions with the largest prior variance at the shortest lengths, or near the likely ``lengths`` (d,).

        Of mirrored conditions, only those are used that a mirror multiplies by ``sign``. The smallest ones, which together have
        at most a ``negligible`` share of the variance, are left out if there are many.
        """
        orders, size, mirror = np.zeros((1, 0), dtype=int), np.ones(1), np.ones(1)
        most, even = constants.FUNCTIONS if lengths else constants.FUNCTIONS_AT_FIRST, 1.0
        for one, length in zip(inputs, lengths or [0.0] * len(inputs), strict=True):
            share, _ = _shares(one, max(constants.CHOSEN_FOR * length, one.spacing))
            order = np.arange(len(share))
            # around the middle of its range, a cosine with an odd number of half waves is odd
            odd = (-1.0) ** (order * one.mirrored)
            orders = np.column_stack([np.repeat(orders, len(order), axis=0), np.tile(order, len(orders))])
            size, mirror = np.outer(size, share).ravel(), np.outer(mirror, odd).ravel()
            even *= odd @ share
            # further factors are the same for all functions of a sign, so the smallest stay the smallest; conditions of equal
            # grids have functions of equal size, which rounding must not order
            largest = np.argsort(-np.log(size).round(9), kind="stable")
            kept = np.concatenate([largest[mirror[largest] == way][:most] for way in (1, -1)])
            orders, size, mirror = orders[kept], size[kept], mirror[kept]
        way = sign if any(one.mirrored for one in inputs) else 1
        orders, told = orders[mirror == way], np.cumsum(size[mirror == way])
        enough = 1 + np.searchsorted(told, 0.5 * (1.0 + way * even) - negligible)
        return cls(inputs, orders[: max(enough, constants.FUNCTIONS_AT_FIRST)])

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
            share, by_length = _shares(one, lengths[i])
            size += np.log(share)[self.orders[:, i]]
            slope[:, i] = (by_length / share)[self.orders[:, i]]
        return size, slope

    def unseen(self, pair: np.ndarray, lengths: np.ndarray) -> float:
        """Variance of the model error's change between two settings (2, d) of one condition, over that of the model error.

        All that readings at the settings of that condition, a spacing apart, show of it is taken as known. That is everything
        but over a swept slip: a force may bend faster around zero, where bristles begin to slide, than readings beside it show.
        Nothing is known where the other conditions are untested.
        """
        differs = int(np.argmax(np.ptp(pair, axis=0) / lengths))
        one = self.inputs[differs]
        at = one.stretched(np.append(pair[:, differs], one.settings()))
        alike = _matern(at[:, None] - at, lengths[differs])[0] + SINGULAR * np.eye(len(at))
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


def _grid(one: Input) -> np.ndarray:
    """The settings (k,) of a condition; of a swept one also those between, as a curve may bend between settings."""
    return one.settings(1 if one.is_held else 2)


def _waves(one: Input, values: np.ndarray, order: np.ndarray) -> np.ndarray:
    """Cosines (n, k) of one condition, of the numbers of half waves ``order`` (k,), of unit mean square over its grid."""
    steps = len(_grid(one)) - 1
    # they run half a step beyond the ends
    place = (np.clip(values, one.lower, one.upper) - one.lower) / one.width * steps + 0.5
    turn = np.pi / (steps + 1) * place[:, None] * order
    return np.asarray(np.cos(turn) * np.where(order > 0, np.sqrt(2.0), 1.0))


def _shares(one: Input, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Share (k,) of every cosine in the variance over the grid of a condition, and its derivative by the log length."""
    at = _grid(one)
    waves = _waves(one, at, np.arange(len(at))) / len(at)
    share, slope = (
        np.einsum("ik,ij,jk->k", waves, own, waves, optimize=True)
        for own in _matern(at[:, None] - at, length)
    )
    return np.maximum(share, LEAST), slope


def _matern(apart: np.ndarray, length: float) -> tuple[np.ndarray, np.ndarray]:
    """Matern 5/2 correlation of settings that are ``apart``, and its derivative by the log length."""
    far = np.sqrt(5.0) * np.abs(apart) / length
    return (1.0 + far + far**2 / 3.0) * np.exp(-far), far**2 * (1.0 + far) / 3.0 * np.exp(-far)
