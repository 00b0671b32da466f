"""Unnamed smooth structure: low-order curves over all conditions, the global rival of every named effect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np
from scipy.linalg import block_diag

from mffit.diagnosis import constants
from mffit.diagnosis.cosines import cosines
from mffit.diagnosis.noise import Noise
from mffit.linearised.gaussian import Directions, Informed
from mffit.linearised.inputs import Input
from mffit.points import Points
from mffit.rig import Readings
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

SMALLEST, LARGEST = constants.SMOOTH_AMPLITUDES
ANGLES = ("alpha", "gamma")
AMPLITUDES = np.geomspace(SMALLEST, LARGEST, constants.SMOOTH_AMPLITUDES_TRIED)


@dataclass(frozen=True, slots=True)
class Smooth:
    """The smooth structure that fits a residual best."""

    amplitude: dict[str, float]
    """By channel, rms over the rms of the readings; 0 or no entry without structure."""
    gain: float  #: gain of log evidence over the expected part
    expected: Mapping[str, float] = field(default_factory=dict)
    """By channel, the amplitude of the part that the model error of the given file explains; empty without any."""
    strange: tuple[str, ...] = ()  #: channels with more structure than needs no cause
    unexcused: float = 0.0  #: gain of log evidence over structure that needs no cause

    @property
    def found(self) -> bool:
        return self.gain > constants.STRUCTURE_EVIDENCE

    @property
    def is_strange(self) -> bool:
        """Whether it needs a cause."""
        return self.found and self.unexcused > constants.STRUCTURE_EVIDENCE


NO_SMOOTH = Smooth({}, 0.0)


def smooth_basis(
    points: Points, simulated: Readings, divisions: float = constants.DIVISIONS_BESIDE_NOISE
) -> np.ndarray:
    """Smooth changes (c n, k) of the readings, separate for every channel, with smaller variance for shorter lengths.

    The shortest length along an angle is its range over ``divisions``. At amplitude 1 their joint rms is that of the channel's
    readings. Changes of gain are proportional to the ``simulated`` readings, because the measured ones contain the errors to be
    explained.
    """
    inputs, at = _conditions(points, divisions)
    angles = sum(one.name in ANGLES for one in inputs)
    shapes, gains = cosines(inputs, at), cosines(inputs[angles:], at[:, angles:])[:, 1:]
    rows = []
    for name, model in simulated.items():
        size = float(np.nan_to_num(rms(points.channel(name))))
        columns = np.hstack([size * shapes, np.nan_to_num(model)[:, None] * gains])
        rows.append(columns * (size / max(float(np.sqrt(np.mean(np.sum(columns**2, axis=1)))), 1e-12)))
    return block_diag(*rows)


def _conditions(points: Points, divisions: float) -> tuple[tuple[Input, ...], np.ndarray]:
    """The varying conditions, angles first, and their values (n, d); the middle of the range where one is unknown."""
    most = dict.fromkeys(ANGLES, divisions) | {"Fz": 2, "p": 1, "T": 1, "V": 1, "t": 2, "direction": 1}
    inputs, at = [], [np.zeros((len(points), 0))]
    for name, steps in most.items():
        x = np.log(points.Fz) if name == "Fz" else getattr(points, name).astype(float)
        known = x[np.isfinite(x)]
        lower, upper = (float(end(known)) if len(known) else 0.0 for end in (np.min, np.max))
        if upper > lower:
            distinct = len(np.unique(np.round((known - lower) / (upper - lower), 2))) - 1
            inputs.append(Input(name, lower, upper, (upper - lower) / max(min(steps, distinct), 1)))
            at.append(np.where(np.isfinite(x), x, 0.5 * (lower + upper))[:, None])
    return tuple(inputs), np.hstack(at)


@dataclass(frozen=True, eq=False)
class SmoothStructure(ReadOnlyArrays):
    """Structure that the evidence of every hypothesis of a problem allows for; its rows (m,) are whitened readings."""

    scatter: Noise  #: noise with the other changes that readings share, without structure
    basis: np.ndarray  #: (c n, k) changes of the readings at amplitude 1, equally many for every channel
    allowed: Mapping[str, float] = field(default_factory=dict)
    """By channel, the largest amplitude that the model error of the given file explains; empty if that is unknown."""
    excused: Mapping[str, float] = field(default_factory=dict)
    """By channel, the amplitude up to which structure that is found needs no cause, because the model is declared inexact."""

    def most_excused(self, channel: str) -> float:
        """The largest of the amplitudes that are tried which needs no cause in a channel."""
        limit = self.excused.get(channel, 0.0)
        return float(np.max(AMPLITUDES, initial=0.0, where=limit >= AMPLITUDES))

    @cached_property
    def directions(self) -> dict[str, tuple[slice, Directions]]:
        """By channel, its rows and the directions of its structure."""
        channels, n = self.scatter.channels, len(self.scatter.u) // len(self.scatter.channels)
        ends = np.searchsorted(self.scatter.used, n * np.arange(len(channels) + 1)).tolist()
        rows = map(slice, ends[:-1], ends[1:])
        parts = np.split(self.scatter.alone().whiten(self.basis), len(channels), axis=1)
        return {c: (own, Directions.of(x[own])) for c, own, x in zip(channels, rows, parts, strict=True)}

    @cached_property
    def _shared(self) -> tuple[np.ndarray, BesideColumns]:
        """The other changes that readings share, whitened without them (m, p), and their products."""
        shared = self.scatter.shared
        white = self.scatter.alone().whiten(np.zeros((len(self.basis), 0)) if shared is None else shared)
        return white, self._products(white)

    def _products(self, rows: np.ndarray) -> BesideColumns:
        along = tuple(of.axes.T @ rows[own] for own, of in self.directions.values())
        return BesideColumns(self, rows.T @ rows, along)

    def beside(self, columns: np.ndarray, residual: np.ndarray) -> BesideColumns:
        """The structure together with columns (m, j) of unit prior variance that may explain a residual (m,)."""
        (shared, known), rows = self._shared, np.column_stack([residual, columns])
        new, across = self._products(rows), rows.T @ shared
        products = np.block([[new.products, across], [across.T, known.products]])
        return BesideColumns(self, products, tuple(map(np.hstack, zip(new.along, known.along, strict=True))))

    def noise(self, amplitude: Mapping[str, float]) -> Noise:
        """The noise with structure of these amplitudes by channel, one standard deviation each."""
        sized = {
            name: Directions(of.axes, amplitude[name] ** 2 * of.variance)
            for name, (_, of) in self.directions.items()
            if amplitude.get(name)
        }
        return replace(self.scatter, structure=sized)

    def estimated(self, amplitude: Mapping[str, float], residual: np.ndarray) -> np.ndarray:
        """The structure (c n,) of these amplitudes that a residual (c n,) shows."""
        noise, columns = self.scatter.alone(), self.columns(amplitude)
        return np.asarray(columns @ Informed.of_rows(noise.whiten(columns), noise.whiten(residual)).mean)

    def columns(self, amplitude: Mapping[str, float]) -> np.ndarray:
        """Changes (c n, k) by one standard deviation of structure of these amplitudes by channel."""
        channels = self.scatter.channels
        size = np.repeat([amplitude.get(c, 0.0) for c in channels], self.basis.shape[1] // len(channels))
        return np.asarray((self.basis * size)[:, size > 0.0])


class BesideColumns(NamedTuple):
    """Products from which the evidence for any amplitude of structure is computed."""

    structure: SmoothStructure
    products: np.ndarray  #: (1 + j + p, 1 + j + p) of the residual, the columns and the shared changes
    along: tuple[np.ndarray, ...]  #: by channel, projections (k, 1 + j + p) of these on its directions

    def evidence(self, amplitude: Mapping[str, float]) -> float:
        """Log evidence with the columns and with structure of given amplitudes by channel, up to a constant."""
        products, log = self.products, self.improbable(amplitude)
        for along, (name, (_, of)) in zip(self.along, self.structure.directions.items(), strict=True):
            if amplitude.get(name):
                inside = Directions(of.axes, amplitude[name] ** 2 * of.variance)
                products = products - along.T @ ((inside.variance / (1.0 + inside.variance))[:, None] * along)
                log += inside.half_log_determinant
        found = Informed.by(products[1:, 1:], products[1:, 0])
        return found.gain - 0.5 * float(products[0, 0]) - log

    def improbable(self, amplitude: Mapping[str, float]) -> float:
        """Negative log prior of the amplitudes, relative to none."""
        return 0.5 * sum((size / constants.USUAL_MISS_OF_A_FORMULA) ** 2 for size in amplitude.values())

    def best(self) -> Smooth:
        """The most likely amplitudes; the gain over those allowed is reduced by a penalty for the search."""
        channels = self.structure.scatter.channels
        expected, _ = self._climbed(dict.fromkeys(channels, 0.0), self.structure.allowed, 0.0)
        paid = len(channels) * math.log(len(AMPLITUDES))
        size, gain = self._climbed(expected, dict.fromkeys(channels, LARGEST), paid)
        known = {name: max(expected[name], self.structure.most_excused(name)) for name in channels}
        limits = {name: max(known[name], self.structure.allowed.get(name, 0.0)) for name in channels}
        strange = tuple(name for name in channels if size[name] > limits[name])
        less = {**size, **{name: known[name] for name in strange}}
        if not strange or less == expected:
            unexcused = gain if strange else 0.0
        else:
            unexcused = self.evidence(size) - self.evidence(less) - paid
        return Smooth(size, gain, {n: one for n, one in expected.items() if one}, strange, unexcused)

    def _climbed(
        self, size: dict[str, float], largest: Mapping[str, float], paid: float
    ) -> tuple[dict[str, float], float]:
        """The most likely amplitudes up to the ``largest`` and their gain over ``size``, less what is ``paid`` for the search."""
        channels, without, gain = self.structure.scatter.channels, self.evidence(size), 0.0
        for channel in (*channels, *channels[:-1]):  # shared changes correlate the channels
            for amplitude in AMPLITUDES[largest.get(channel, 0.0) >= AMPLITUDES]:
                trial = {**size, channel: float(amplitude)}
                value = self.evidence(trial) - without - paid
                if value > gain:
                    size, gain = trial, value
        return size, gain
