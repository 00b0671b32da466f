"""Unnamed local structure: a bump anywhere in the programme, the rival of every named effect."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mffit.constants import STRAIGHT, UPRIGHT
from mffit.diagnosis import constants
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.noise import Noise
from mffit.points import Points, levels
from tir.frozen import ReadOnlyArrays

SWEPT = {
    "alpha_deg": constants.BUMP_WIDTHS_SIDESLIP,
    "gamma_deg": constants.BUMP_WIDTHS_CAMBER,
    "kappa": constants.BUMP_WIDTHS_SLIP,
}
"""By condition of ``mffit.quantities``, widths of the bumps; the smallest width is also the distance of their centres."""
Ranges = dict[str, tuple[float, float]]
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


@dataclass(frozen=True)
class BumpScan(ReadOnlyArrays):
    """All bumps that the programme could reveal."""

    noise: Noise
    bumps: np.ndarray  #: (n, k) unit bumps over the points
    regions: tuple[Ranges, ...]
    spread: Mapping[str, float]  #: usual amplitude by channel

    @cached_property
    def _white(self) -> list[tuple[str, int, np.ndarray, np.ndarray, np.ndarray]]:
        """Bumps in blocks: channel, index of the first bump, used rows of the channel, whitened shapes, sums of squares.

        A bump is zero in all other rows. The shapes are whitened without shared changes, the sums of squares with them.
        """
        out, block = [], 256
        for channel in self.spread:
            for first in range(0, len(self.regions), block):
                rows, shapes = self.noise.whitened_alone(channel, self.bumps[:, first : first + block])
                power = np.einsum("ij,ij->j", shapes, shapes) - self.noise.directions.power(rows, shapes)
                out.append((channel, first, rows, shapes.astype(np.float32), power))
        return out

    def best(self, hypothesis: Hypothesis) -> Bump:
        """The bump that explains most of a hypothesis' residual, with the hypothesis' free numbers projected out."""
        residual = hypothesis.residual
        along = hypothesis.axes.T @ residual
        # The whitening by shared changes is symmetric, so it is applied to the smaller factor of each product only.
        axes = self.noise.directions.less(hypothesis.axes).astype(np.float32)
        left = self.noise.directions.less(residual).astype(np.float32)
        tried = math.log(max(len(self.regions) * len(self.spread), 1))
        best = Bump("Fy", {}, 0.0, -math.inf)
        for channel, first, rows, shapes, whole in self._white:
            spread = self.spread[channel]
            inside = (axes[rows].T @ shapes).astype(float)
            score = (shapes.T @ left[rows]).astype(float) - inside.T @ along
            power = whole - np.einsum("ij,ij->j", inside, inside)
            precision = np.maximum(power, 0.0) + spread**-2.0
            gain = 0.5 * score**2 / precision - 0.5 * np.log(precision * spread**2) - tried
            k = int(np.argmax(gain))
            if gain[k] > best.gain:
                amplitude = float(score[k] / precision[k])
                best = Bump(channel, self.regions[first + k], amplitude, float(gain[k]))
        return best


def bump_scan(points: Points, noise: Noise) -> BumpScan:
    """Bumps over sideslip, camber or slip: in the whole programme, at one load, on one side of camber, or in backward runs.

    Bumps over slip also on one side of sideslip.
    """
    parts = _parts(points)
    beside = {"kappa": list(_sides("alpha_deg", points, STRAIGHT))}
    shapes, regions = [], []
    for column, centre, width, bell in _bells(points):
        for region, mask in (*parts, *beside.get(column, ())):
            shape = bell * mask
            if np.sum(shape > 0.5) >= 2:
                shapes.append(shape.astype(np.float32))
                regions.append(_narrowed(region, column, centre - width, centre + width))
    spread = {
        name: constants.USUAL_MISS_OF_A_FORMULA * float(np.nanmax(np.abs(points.channel(name))))
        for name in noise.channels
        if np.any(np.nan_to_num(points.channel(name)))  # nothing is missing from a channel of zeros
    }
    bumps = np.column_stack(shapes) if shapes else np.empty((len(points), 0), np.float32)
    return BumpScan(noise, bumps, tuple(regions), spread)


def _bells(points: Points) -> Iterator[tuple[str, float, float, np.ndarray]]:
    """Column, centre, width and height (n,) of Gaussian bells along each swept condition, in the unit of its column."""
    for column, widths in SWEPT.items():
        values = points.condition(column)
        if column == "kappa" and np.all(points.free_rolling):
            continue
        for centre in _centres(values, min(widths)):
            for width in widths:
                bell = np.exp(-0.5 * ((values - centre) / width) ** 2)
                yield column, centre, width, bell


def _narrowed(region: Ranges, column: str, low: float, high: float) -> Ranges:
    """The region with the range of one column cut to the bump."""
    before = region.get(column, (-np.inf, np.inf))
    return {**region, column: (float(max(low, before[0])), float(min(high, before[1])))}


def _centres(values: np.ndarray, step: float) -> np.ndarray:
    """Centres of bumps: the values rounded to steps, or fewer evenly spaced ones if there are too many."""
    most, steps = constants.MOST_BUMP_CENTRES, np.unique(np.round(values / step) * step)
    return steps if len(steps) <= most else np.linspace(steps[0], steps[-1], most)


def _parts(points: Points) -> list[tuple[Ranges, np.ndarray]]:
    """Parts of the programme to which a bump may be confined, with their masks (n,)."""
    return [
        ({}, np.ones(len(points))),
        *_sides("gamma_deg", points, UPRIGHT),
        *_loads(points),
        *(
            [({"direction": (-1.0, -1.0)}, (points.direction < 0) * 1.0)]
            if np.any(points.direction < 0)
            else []
        ),
    ]


def _sides(column: str, points: Points, middle: float) -> Iterator[tuple[Ranges, np.ndarray]]:
    """Masks of the two sides of an angle and of the band within ``middle`` [deg] around zero."""
    angle = points.condition(column)
    for low, high in ((-90.0, -middle), (-middle, middle), (middle, 90.0)):
        mask = (angle >= low) & (angle <= high)
        if 2 <= mask.sum() < len(points):
            yield {column: (max(low, float(angle.min())), min(high, float(angle.max())))}, mask * 1.0


def _loads(points: Points) -> Iterator[tuple[Ranges, np.ndarray]]:
    level = levels.nearest_labels(points.Fz, levels.LOAD)
    number = int(level.max()) + 1
    for k in range(number) if 1 < number <= constants.MOST_LOADS_WITH_BUMPS else ():
        mask = level == k
        yield {"Fz_N": (float(points.Fz[mask].min()), float(points.Fz[mask].max()))}, mask * 1.0
