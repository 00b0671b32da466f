"""Unnamed local structure: a bump anywhere in the programme, the rival of every named effect."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.where import Range, bins
from mffit.points import Points
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

SWEPT = {
    "alpha_deg": (constants.BUMP_WIDTHS_SIDESLIP, ("gamma_deg", "Fz_N", "direction")),
    "gamma_deg": (constants.BUMP_WIDTHS_CAMBER, ("Fz_N", "direction")),
    "kappa": (constants.BUMP_WIDTHS_SLIP, ("alpha_deg", "gamma_deg", "Fz_N", "direction")),
}
"""By condition of ``mffit.quantities``, widths of the bumps, and variables to one bin of which they may be confined.

The smallest width is also the distance of their centres.
"""
Ranges = dict[str, Range]
"""Column -> smallest and largest value."""


@dataclass(frozen=True, slots=True)
class Bump:
    """The best-fitting local structure."""

    channel: str
    region: Ranges
    amplitude: float  #: [N] or [Nm]
    gain: float  #: gain of log evidence, less the penalty for the search

    @property
    def found(self) -> bool:
        return self.gain > constants.STRUCTURE_EVIDENCE


class _Block(NamedTuple):
    """Some bumps in one channel, whitened without shared changes: the same whatever structure the covariance has."""

    channel: str
    first: int  #: index of the first bump
    rows: np.ndarray  #: used rows (m,) of the channel; a bump is 0 in all others
    shapes: np.ndarray  #: (m, k)
    power: np.ndarray  #: (k,) sums of squares
    by_structure: np.ndarray  #: (r, k) parts of them along the axes of the channel's structure


@dataclass(frozen=True)
class BumpScan(ReadOnlyArrays):
    """All bumps that the programme could reveal."""

    noise: Noise
    bumps: np.ndarray  #: (n, k) unit bumps over the points
    regions: tuple[Ranges, ...]
    spread: Mapping[str, float]  #: usual amplitude by channel
    allowed: Mapping[str, float]  #: by channel, the amplitude that the model error of the given file explains
    structure: Mapping[str, np.ndarray]
    """By channel, the axes (m, r) of the structure that a covariance may have, as in :attr:`Noise.structure`."""

    @cached_property
    def _white(self) -> list[_Block]:
        """All bumps in all channels."""
        out, size = [], 256
        for channel in self.spread:
            for first in range(0, len(self.regions), size):
                rows, shapes = self.noise.whitened_alone(channel, self.bumps[:, first : first + size])
                axes = self.structure.get(channel, np.zeros((len(rows), 0)))
                power, along = np.einsum("ij,ij->j", shapes, shapes), (axes.T @ shapes) ** 2
                out.append(_Block(channel, first, rows, shapes.astype(np.float32), power, along))
        return out

    def best(self, hypothesis: Hypothesis, noise: Noise | None = None) -> Bump:
        """The bump that explains most of a hypothesis' residual, with the hypothesis' free numbers projected out.

        ``noise`` is the one of the hypothesis, if its shared changes are not those of the scan.
        """
        noise = noise or self.noise
        residual = hypothesis.residual
        along = hypothesis.axes.T @ residual
        # The whitening for shared changes is transposed and applied to the smaller factor of each product only.
        axes = noise.backwards(hypothesis.axes).astype(np.float32)
        left = noise.backwards(residual).astype(np.float32)
        tried = math.log(max(len(self.regions) * len(self.spread), 1))
        best = Bump("Fy", {}, 0.0, -math.inf)
        for channel, first, rows, shapes, power, by_structure in self._white:
            spread = self.spread[channel]
            inside = (axes[rows].T @ shapes).astype(float)
            score = (shapes.T @ left[rows]).astype(float) - inside.T @ along
            power = power - noise.directions_alone.power(rows, shapes) - np.einsum("ij,ij->j", inside, inside)
            if channel in noise.structure:
                variance = noise.structure[channel].variance
                power -= (variance / (1.0 + variance)) @ by_structure
            precision = np.maximum(power, 0.0) + spread**-2.0
            beyond = np.maximum(np.abs(score) - self.allowed.get(channel, 0.0) * precision, 0.0)
            gain = 0.5 * beyond**2 / precision - 0.5 * np.log(precision * spread**2) - tried
            k = int(np.argmax(gain))
            if gain[k] > best.gain:
                amplitude = float(score[k] / precision[k])
                best = Bump(channel, self.regions[first + k], amplitude, float(gain[k]))
        return best


def bump_scan(
    points: Points,
    noise: Noise,
    allowed: Mapping[str, float] | None = None,
    structure: Mapping[str, np.ndarray] | None = None,
) -> BumpScan:
    """Bumps over sideslip, camber or slip, in the whole programme or in one bin of another variable.

    ``allowed`` is, by channel, the amplitude over the rms of the readings that needs no cause. The ``structure`` that the noise
    may have by channel is given by its axes (m, r).
    """
    shapes, regions, cells = [], [], bins(points)
    for column, (widths, others) in SWEPT.items():
        parts = [({name: limits}, mask) for name in others for limits, mask in cells.get(name, ())]
        for region, bell in _bells(column, points, widths):
            for part, mask in (({}, np.ones(len(points))), *parts):
                shape = bell * mask
                if np.sum(shape > 0.5) >= 2:
                    shapes.append(shape.astype(np.float32))
                    regions.append({**part, **region})
    spread = {
        name: constants.USUAL_MISS_OF_A_FORMULA * float(np.nanmax(np.abs(points.channel(name))))
        for name in noise.channels
        if np.any(np.nan_to_num(points.channel(name)))  # nothing is missing from a channel of zeros
    }
    bumps = np.column_stack(shapes) if shapes else np.empty((len(points), 0), np.float32)
    sizes = {name: part * rms(points.channel(name)) for name, part in (allowed or {}).items()}
    return BumpScan(noise, bumps, tuple(regions), spread, sizes, structure or {})


def _bells(column: str, points: Points, widths: Sequence[float]) -> Iterator[tuple[Ranges, np.ndarray]]:
    """Range and height (n,) of Gaussian bells along a swept condition, in the unit of its column."""
    values = points.condition(column)
    if column == "kappa" and np.all(points.free_rolling):
        return
    for centre in _centres(values, min(widths)).tolist():
        for width in widths:
            yield {column: (centre - width, centre + width)}, np.exp(-0.5 * ((values - centre) / width) ** 2)


def _centres(values: np.ndarray, step: float) -> np.ndarray:
    """Centres of bumps: the values rounded to steps, or fewer evenly spaced ones if there are too many."""
    most, steps = constants.MOST_BUMP_CENTRES, np.unique(np.round(values / step) * step)
    return steps if len(steps) <= most else np.linspace(steps[0], steps[-1], most)
