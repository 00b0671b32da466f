"""Smooth structure without a name: low-order curves over all conditions, the global rival of every named effect."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial.legendre import legvander
from scipy.linalg import block_diag, cholesky, solve_triangular

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis, outside
from mffit.diagnosis.noise import Noise
from mffit.points import Points
from mffit.rig import Readings
from mffit.scatter import rms

SMALLEST, LARGEST = constants.SMOOTH_AMPLITUDES
AMPLITUDES = np.geomspace(SMALLEST, LARGEST, constants.SMOOTH_AMPLITUDES_TRIED)


@dataclass(frozen=True, slots=True)
class Smooth:
    """The smooth structure that fits a residual best."""

    amplitude: dict[
        str, float
    ]  #: by channel, rms relative to that of the readings; 0 or no entry where there is none
    gain: float  #: log evidence

    @property
    def found(self) -> bool:
        return self.gain > constants.STRUCTURE_EVIDENCE


NO_SMOOTH = Smooth({}, 0.0)


def smooth_basis(points: Points, simulated: Readings) -> np.ndarray:
    """Smooth changes (c n, k) of the readings, separate for every channel, smaller the higher their order.

    At amplitude 1 they vary together as much as the readings of their channel do. Changes of gain are proportional to the
    ``simulated`` readings, because the measured ones contain the errors to be explained.
    """
    shapes, gains = _shapes(points), _gains(points)
    rows = []
    for name, model in simulated.items():
        size = float(np.nan_to_num(rms(points.channel(name))))
        columns = np.hstack([size * shapes, np.nan_to_num(model)[:, None] * gains])
        rows.append(columns * (size / max(float(np.sqrt(np.mean(np.sum(columns**2, axis=1)))), 1e-12)))
    return block_diag(*rows)


def _conditions(points: Points) -> list[np.ndarray]:
    """Legendre polynomials (n, k) over every condition but the angles."""
    few = constants.MOST_CONDITION_ORDER
    others = [
        (np.log(points.Fz), few),
        (points.p, few),
        (points.T, few),
        (points.V, few),
        (points.t, constants.MOST_TIME_ORDER),
        (points.direction.astype(float), 1),
    ]
    return [_orders(np.where(np.isfinite(values), values, np.nan), most) for values, most in others]


def _gains(points: Points) -> np.ndarray:
    """Changes (n, k) of gain, relative, with load, pressure, temperature, speed, time or direction."""
    columns = [along[:, k] / (1.0 + k) for along in _conditions(points) for k in range(1, along.shape[1])]
    return np.column_stack(columns) if columns else np.zeros((len(points), 0))


def _shapes(points: Points) -> np.ndarray:
    """Products (n, k) of Legendre polynomials over angles and conditions, smaller the higher their order."""
    most = constants.MOST_ANGLE_ORDER
    a = _orders(np.arctan(points.alpha / constants.SATURATION_SIDESLIP.rad), most)
    g = _orders(points.gamma, most)
    angles = {
        (i, j): a[:, i] * g[:, j]
        for i, j in itertools.product(range(a.shape[1]), range(g.shape[1]))
        if i + j <= most
    }
    columns = [(i + j, shape) for (i, j), shape in angles.items()]
    for along in _conditions(points):
        for k in range(1, along.shape[1]):
            for (i, j), shape in angles.items():
                # Higher orders, which only time has, are combined with the simplest shapes alone.
                if i + j + min(k, 2) <= constants.MOST_CROSS_ORDER or (k > 2 and i + j <= 1):
                    columns.append((i + j + k, shape * along[:, k]))
    scaled = [shape / (1.0 + order) for order, shape in columns if np.any(shape)]
    return np.column_stack(scaled)


def _orders(values: np.ndarray, most: int) -> np.ndarray:
    """Legendre polynomials (n, k) over the range of values (n,); only the constant where they do not vary."""
    known = values[np.isfinite(values)]
    if not len(known) or np.ptp(known) <= 1e-9 * max(1.0, float(np.abs(known).max())):
        return np.ones((len(values), 1))
    middle, half = 0.5 * (known.max() + known.min()), 0.5 * np.ptp(known)
    distinct = len(np.unique(np.round((known - middle) / half, 2)))
    return legvander(np.nan_to_num((values - middle) / half), min(most, distinct - 1))


@dataclass(frozen=True, slots=True)
class SmoothScan:
    """All smooth structure that the programme could show."""

    shapes: np.ndarray  #: (m, k) whitened
    channels: tuple[str, ...]  #: each with as many columns

    def best(self, hypothesis: Hypothesis) -> Smooth:
        """The amplitudes that explain most of a hypothesis' residual, its own freed numbers projected out."""
        axes = hypothesis.axes
        shapes, residual = outside(axes, self.shapes), outside(axes, hypothesis.residual)
        power, score = shapes.T @ shapes, shapes.T @ residual
        size, gain = dict.fromkeys(self.channels, 0.0), 0.0
        paid = len(self.channels) * math.log(len(AMPLITUDES))
        for channel in (*self.channels, *self.channels[:-1]):  # inexact coefficients correlate the channels
            for amplitude in AMPLITUDES:
                trial = {**size, channel: amplitude}
                value = _gain(power, score, _of_columns(trial, self.channels, len(score))) - paid
                if value > gain:
                    size, gain = trial, value
        return Smooth(size, gain)


def smooth_scan(basis: np.ndarray, noise: Noise) -> SmoothScan:
    """The basis, whitened."""
    return SmoothScan(noise.whiten(basis), noise.channels)


def amplified(basis: np.ndarray, smooth: Smooth, channels: Sequence[str]) -> np.ndarray:
    """The basis (c n, k) of some channels at the amplitudes that were found."""
    return basis * _of_columns(smooth.amplitude, channels, basis.shape[1])


def _of_columns(amplitude: Mapping[str, float], channels: Sequence[str], k: int) -> np.ndarray:
    """The amplitude (k,) of every column of a basis."""
    return np.repeat([float(amplitude.get(name, 0.0)) for name in channels], k // len(channels))


def _gain(power: np.ndarray, score: np.ndarray, amplitude: np.ndarray) -> float:
    """Log evidence of smooth structure of given amplitudes (k,)."""
    some = amplitude > 0.0
    scaled = amplitude[some]
    root = cholesky(
        np.eye(int(some.sum())) + scaled[:, None] * power[np.ix_(some, some)] * scaled, lower=True
    )
    found = solve_triangular(root, scaled * score[some], lower=True)
    return 0.5 * float(found @ found) - float(np.sum(np.log(np.diag(root))))
