"""Smooth structure without a name: low-order curves over all conditions, the global rival of every named effect."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag, cholesky, solve_triangular

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis, outside
from mffit.diagnosis.noise import Noise
from mffit.linearised.inputs import Input
from mffit.linearised.smooth import SmoothFunctions
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
    """Smooth changes (c n, k) of the readings, separate for every channel, smaller the faster they change.

    At amplitude 1 they vary together as much as the readings of their channel do. Changes of gain are proportional to the
    ``simulated`` readings, because the measured ones contain the errors to be explained.
    """
    angles, others = _conditions(points)
    shapes = _functions({**angles, **others})
    gains = _functions(others)[:, 1:]
    rows = []
    for name, model in simulated.items():
        size = float(np.nan_to_num(rms(points.channel(name))))
        columns = np.hstack([size * shapes, np.nan_to_num(model)[:, None] * gains])
        rows.append(columns * (size / max(float(np.sqrt(np.mean(np.sum(columns**2, axis=1)))), 1e-12)))
    return block_diag(*rows)


def _conditions(points: Points) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """The angles, and all other conditions over which structure may be smooth, by name; those that vary."""
    angles = {"alpha": points.alpha, "gamma": points.gamma}
    others = {name: getattr(points, name).astype(float) for name in ("p", "T", "V", "t", "direction")}
    varying = [
        {name: x for name, x in group.items() if np.any(np.isfinite(x)) and np.nanmax(x) > np.nanmin(x)}
        for group in (angles, {"Fz": np.log(points.Fz), **others})
    ]
    return varying[0], varying[1]


def _functions(conditions: Mapping[str, np.ndarray]) -> np.ndarray:
    """Smooth functions (n, k) of some conditions, the constant first; where a condition is not known it is in the middle."""
    inputs, at = [], []
    for name, x in conditions.items():
        lower, upper = float(np.nanmin(x)), float(np.nanmax(x))
        steps = {
            "alpha": constants.DIVISIONS_OF_AN_ANGLE,
            "gamma": constants.DIVISIONS_OF_AN_ANGLE,
            "t": 2,
            "Fz": 2,
        }
        distinct = len(np.unique(np.round((x[np.isfinite(x)] - lower) / (upper - lower), 2))) - 1
        inputs.append(Input(name, lower, upper, (upper - lower) / max(min(steps.get(name, 1), distinct), 1)))
        at.append(np.where(np.isfinite(x), x, 0.5 * (lower + upper)))
    if not inputs:
        return np.ones((len(conditions), 1))
    functions = SmoothFunctions.over(tuple(inputs))
    share, _ = functions.log_variance(np.array([one.spacing for one in inputs]))
    found: np.ndarray = functions.columns(np.column_stack(at)) * np.exp(0.5 * share)
    return found


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
