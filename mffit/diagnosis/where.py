"""Regions of the programme in which measurement and simulation disagree, with size and significance."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from mffit.constants import FEWEST, MOST_ROWS
from mffit.diagnosis import constants
from mffit.diagnosis.noise import Noise
from mffit.points import Points, levels
from mffit.quantities import CONDITIONS
from mffit.scatter import significant

PAIRS = (
    ("alpha_deg", "gamma_deg"),
    ("alpha_deg", "Fz_N"),
    ("gamma_deg", "Fz_N"),
    ("alpha_deg", "direction"),
    ("Fz_N", "p_kPa"),
    ("kappa", "alpha_deg"),
    ("kappa", "gamma_deg"),
    ("kappa", "Fz_N"),
)
Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Region:
    """A region of the programme in which the mean residual of a channel differs from zero."""

    channel: str
    region: dict[str, Range]
    bias: float  #: mean of measured minus simulated [N] or [Nm]
    z: float  #: bias in standard errors, correlations included


def where(points: Points, residual: np.ndarray, noise: Noise) -> tuple[Region, ...]:
    """Regions whose mean residual differs from zero, at a false discovery rate of 1 %; the most significant first.

    ``residual`` (c n,) is measured minus simulated, in the channels of ``noise``. Regions that mostly repeat the points of a
    more significant one are left out.
    """
    found = list(_tested(points, residual, noise))
    passing = [found[k] for k in np.flatnonzero(significant(np.array([region.z for region, _ in found])))]
    passing.sort(key=lambda item: -abs(item[0].z))
    return _distinct(passing)


def _tested(points: Points, residual: np.ndarray, noise: Noise) -> Iterator[tuple[Region, frozenset[int]]]:
    """Every cell and channel with its mean residual, and the indices of its readings."""
    position = np.full(len(residual), -1)
    position[noise.used] = np.arange(len(noise.used))
    for region, mask in _cells(points):
        for k, channel in enumerate(noise.channels):
            rows = position[np.flatnonzero(mask) + k * len(points)]
            rows = rows[rows >= 0]
            if len(rows) < FEWEST:
                continue
            bias = float(residual[noise.used[rows]].mean())
            z = bias / (noise.error_of_sum(rows) / len(rows))
            yield Region(channel=channel, region=region, bias=bias, z=z), frozenset(rows.tolist())


def _distinct(ranked: list[tuple[Region, frozenset[int]]]) -> tuple[Region, ...]:
    """The first regions that do not mostly repeat the readings of an earlier one."""
    kept: list[tuple[Region, frozenset[int]]] = []
    for region, members in ranked:
        if all(
            len(members & other) < constants.REGION_OVERLAP * min(len(members), len(other))
            for _, other in kept
        ):
            kept.append((region, members))
        if len(kept) == MOST_ROWS:
            break
    return tuple(region for region, _ in kept)


def _cells(points: Points) -> Iterator[tuple[dict[str, Range], np.ndarray]]:
    """Ranges and masks (n,) of the bins of single variables and of pairs."""
    found = bins(points)
    for name, cells in found.items():
        for limits, mask in cells:
            yield {name: limits}, mask
    for a, b in PAIRS:
        for limits_a, mask_a in found.get(a, ()):
            for limits_b, mask_b in found.get(b, ()):
                mask = mask_a & mask_b
                if mask.sum() >= FEWEST:
                    yield {a: limits_a, b: limits_b}, mask


def bins(points: Points) -> dict[str, list[tuple[Range, np.ndarray]]]:
    """Bins of every variable that has at least two."""
    variables = {name: points.condition(name) for name in CONDITIONS}
    variables["direction"] = points.direction.astype(float)
    if np.all(points.free_rolling):
        variables.pop("kappa")
    return {name: cells for name, values in variables.items() if len(cells := _cut(values)) > 1}


def _cut(values: np.ndarray) -> list[tuple[Range, np.ndarray]]:
    """Bins of values (n,): their levels if there are few, else quantiles."""
    fewest, most = FEWEST, constants.MOST_REGION_BINS
    finite = values[np.isfinite(values)]
    if len(finite) < 2 * fewest or np.ptp(finite) == 0.0:
        return []
    width = levels.LevelKind("share of the range", constants.REGION_LEVEL_WIDTH * float(np.ptp(finite)))
    level = levels.nearest_labels(values, width)
    number = int(level.max()) + 1
    if 1 < number <= most and not levels.spread(values, width):
        masks = [level == k for k in range(number)]
    else:
        edges = np.unique(np.quantile(finite, np.linspace(0.0, 1.0, most + 1)))
        masks = [(values >= low) & (values <= high) for low, high in pairwise(edges)]
    return [
        ((float(values[mask].min()), float(values[mask].max())), mask)
        for mask in masks
        if mask.sum() >= fewest
    ]
