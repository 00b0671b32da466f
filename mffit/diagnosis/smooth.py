"""Unnamed smooth structure: low-order curves over all conditions, the global rival of every named effect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from mffit.diagnosis import constants
from mffit.diagnosis.noise import Noise
from mffit.linearised.gaussian import Informed
from mffit.linearised.inputs import Input
from mffit.linearised.smooth import SmoothFunctions
from mffit.points import Points
from mffit.rig import Readings
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

SMALLEST, LARGEST = constants.SMOOTH_AMPLITUDES
AMPLITUDES = np.geomspace(SMALLEST, LARGEST, constants.SMOOTH_AMPLITUDES_TRIED)


@dataclass(frozen=True, slots=True)
class Smooth:
    """The smooth structure that fits a residual best."""

    amplitude: dict[str, float]
    """By channel, rms over the rms of the readings; 0 or no entry without structure."""
    gain: float  #: gain of log evidence

    @property
    def found(self) -> bool:
        return self.gain > constants.STRUCTURE_EVIDENCE


NO_SMOOTH = Smooth({}, 0.0)


def smooth_basis(
    points: Points, simulated: Readings, divisions: float = constants.DIVISIONS_BESIDE_NOISE
) -> np.ndarray:
    """Smooth changes (c n, k) of the readings, separate for every channel, with smaller variance for shorter lengths.

    The shortest length along an angle is its range over ``divisions``. At amplitude 1 their joint rms is that of the channel's
    readings. Changes of gain are proportional to the ``simulated`` readings, because the measured ones contain the errors to be
    explained.
    """
    angles, others = _conditions(points)
    shapes = _functions({**angles, **others}, divisions, len(points))
    gains = _functions(others, divisions, len(points))[:, 1:]
    rows = []
    for name, model in simulated.items():
        size = float(np.nan_to_num(rms(points.channel(name))))
        columns = np.hstack([size * shapes, np.nan_to_num(model)[:, None] * gains])
        rows.append(columns * (size / max(float(np.sqrt(np.mean(np.sum(columns**2, axis=1)))), 1e-12)))
    return block_diag(*rows)


def _conditions(points: Points) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """The varying angles, and the other varying conditions over which structure may be smooth, by name."""
    angles = {"alpha": points.alpha, "gamma": points.gamma}
    others = {name: getattr(points, name).astype(float) for name in ("p", "T", "V", "t", "direction")}
    varying = [
        {name: x for name, x in group.items() if np.any(np.isfinite(x)) and np.nanmax(x) > np.nanmin(x)}
        for group in (angles, {"Fz": np.log(points.Fz), **others})
    ]
    return varying[0], varying[1]


def _functions(conditions: Mapping[str, np.ndarray], divisions: float, n: int) -> np.ndarray:
    """Smooth functions (n, k) of some conditions, the constant first; unknown values are replaced by the middle of the range."""
    inputs, at = [], []
    for name, x in conditions.items():
        lower, upper = float(np.nanmin(x)), float(np.nanmax(x))
        steps = {"alpha": divisions, "gamma": divisions, "t": 2, "Fz": 2}
        distinct = len(np.unique(np.round((x[np.isfinite(x)] - lower) / (upper - lower), 2))) - 1
        inputs.append(Input(name, lower, upper, (upper - lower) / max(min(steps.get(name, 1), distinct), 1)))
        at.append(np.where(np.isfinite(x), x, 0.5 * (lower + upper)))
    if not inputs:
        return np.ones((n, 1))
    functions = SmoothFunctions.over(tuple(inputs))
    share, _ = functions.log_variance(np.array([one.spacing for one in inputs]))
    found: np.ndarray = functions.columns(np.column_stack(at)) * np.exp(0.5 * share)
    return found


class ChannelDirections(NamedTuple):
    """Orthonormal directions of the smooth changes of one channel among whitened readings."""

    rows: slice  #: readings of the channel
    axes: np.ndarray  #: (n, k)
    variance: np.ndarray  #: (k,) variances of the changes at amplitude 1


@dataclass(frozen=True, eq=False)
class SmoothStructure(ReadOnlyArrays):
    """Smooth structure that may be added to any hypothesis; all rows (m,) are whitened readings."""

    channels: tuple[str, ...]  #: (c,)
    basis: np.ndarray  #: (c n, k) changes of the readings at amplitude 1, equally many for every channel
    shared: np.ndarray  #: (m, p) changes that readings share, one standard deviation each
    directions: tuple[ChannelDirections, ...]  #: by channel

    @classmethod
    def over(cls, basis: np.ndarray, noise: Noise) -> SmoothStructure:
        """The structure of a basis (c n, k) with equally many columns for every channel, and the shared changes of a noise."""
        alone, n = noise.alone(), len(noise.u) // len(noise.channels)
        ends = np.searchsorted(noise.used, n * np.arange(len(noise.channels) + 1))
        directions = []
        for begin, end, columns in zip(
            ends[:-1], ends[1:], np.split(basis, len(noise.channels), axis=1), strict=True
        ):
            rows = slice(int(begin), int(end))
            left, size, _ = np.linalg.svd(alone.whiten(columns)[rows], full_matrices=False)
            some = size > 1e-4 * max(float(size.max(initial=0.0)), 1e-9)
            directions.append(ChannelDirections(rows, left[:, some], size[some] ** 2))
        nothing = np.zeros((len(noise.used), 0))
        shared = nothing if noise.shared is None else alone.whiten(noise.shared)
        return cls(noise.channels, basis, shared, tuple(directions))

    @cached_property
    def _alone(self) -> BesideColumns:
        nothing = tuple(np.zeros((len(one.variance), 0)) for one in self.directions)
        return BesideColumns(self, self.shared[:, :0], np.zeros((0, 0)), nothing).with_columns(self.shared)

    def beside(self, columns: np.ndarray, residual: np.ndarray) -> BesideColumns:
        """The structure together with columns (m, j) of unit prior variance that may explain a residual (m,)."""
        return self._alone.with_columns(np.column_stack([residual, columns]))

    def at(self, amplitude: Mapping[str, float]) -> np.ndarray:
        """Changes of the readings (c n, k), one standard deviation each, by structure of the channels with an amplitude."""
        parts = np.split(self.basis, len(self.channels), axis=1)
        found = (amplitude.get(name, 0.0) * part for name, part in zip(self.channels, parts, strict=True))
        return np.column_stack([part[:, np.any(part, axis=0)] for part in found])


class BesideColumns(NamedTuple):
    """Products from which the evidence for any amplitude of structure is computed."""

    structure: SmoothStructure
    rows: np.ndarray  #: (m, p + 1 + j) the shared changes, the residual, the columns
    products: np.ndarray  #: (p + 1 + j, p + 1 + j) products of ``rows``
    along: tuple[np.ndarray, ...]  #: by channel, projections (k, p + 1 + j) of ``rows`` on its directions

    def with_columns(self, columns: np.ndarray) -> BesideColumns:
        """The record extended by further columns (m, i)."""
        across = self.rows.T @ columns
        return BesideColumns(
            self.structure,
            np.column_stack([self.rows, columns]),
            np.block([[self.products, across], [across.T, columns.T @ columns]]),
            tuple(
                np.column_stack([along, one.axes.T @ columns[one.rows]])
                for along, one in zip(self.along, self.structure.directions, strict=True)
            ),
        )

    def evidence(self, amplitude: Mapping[str, float]) -> float:
        """Log evidence with the columns and with structure of given amplitudes by channel, up to a constant."""
        products, log = self.products, self.improbable(amplitude)
        for name, along, one in zip(
            self.structure.channels, self.along, self.structure.directions, strict=True
        ):
            if amplitude.get(name):
                size = amplitude[name] ** 2 * one.variance
                products = products - along.T @ ((size / (1.0 + size))[:, None] * along)
                log += 0.5 * float(np.sum(np.log1p(size)))
        r = self.structure.shared.shape[1]  # index of the residual
        others = np.delete(np.arange(len(products)), r)
        found = Informed.by(products[np.ix_(others, others)], products[others, r])
        return found.gain - 0.5 * float(products[r, r]) - log

    def improbable(self, amplitude: Mapping[str, float]) -> float:
        """Negative log prior of the amplitudes, relative to none."""
        return 0.5 * sum((size / constants.USUAL_MISS_OF_A_FORMULA) ** 2 for size in amplitude.values())

    def best(self) -> Smooth:
        """The most likely amplitudes; the gain is reduced by a penalty for the search."""
        channels = self.structure.channels
        size, without = dict.fromkeys(channels, 0.0), self.evidence({})
        paid, gain = len(channels) * math.log(len(AMPLITUDES)), 0.0
        for channel in (*channels, *channels[:-1]):  # shared changes correlate the channels
            for amplitude in AMPLITUDES:
                trial = {**size, channel: float(amplitude)}
                value = self.evidence(trial) - without - paid
                if value > gain:
                    size, gain = trial, value
        return Smooth(size, gain)


@dataclass(frozen=True, eq=False)
class StructureBeside:
    """Structure that the evidence of every hypothesis of a problem allows for, and its amplitudes in the covariance."""

    scatter: Noise  #: noise with the other changes that readings share, without structure
    structure: SmoothStructure
    amplitude: Mapping[str, float] = field(default_factory=dict)  #: by channel, amplitude in the covariance

    @classmethod
    def over(cls, basis: np.ndarray, noise: Noise) -> StructureBeside:
        """The structure of a basis, with none of it in the covariance."""
        return cls(noise, SmoothStructure.over(basis, noise))

    @classmethod
    def nothing(cls, noise: Noise) -> StructureBeside:
        """The empty structure."""
        return cls.over(np.zeros((len(noise.u), 0)), noise)

    @cached_property
    def half_log_determinant(self) -> float:
        """Half the log determinant of the covariance, less that without structure."""
        after, before = (np.sum(np.log1p(one.directions.variance)) for one in (self.noise, self.scatter))
        return 0.5 * float(after - before)

    @cached_property
    def noise(self) -> Noise:
        """The noise with structure of these amplitudes."""
        return self.scatter.sharing(self.scatter.shared, self.structure.at(self.amplitude))
