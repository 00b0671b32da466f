"""The runs whose readings are larger or smaller than simulated by one share: those at one level of a setting, or all."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from mffit.constants import FEWEST, MOST, TWO_SIGMA
from mffit.diagnosis import constants
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.where import Range, Region
from mffit.points import Points, levels
from mffit.quantities import CHANNELS, COLUMNS, CONDITIONS

SETTINGS = ("Fz", "p", "V")
"""Fields of the settings whose levels are compared, in addition to direction, mount, set-up and file."""


@dataclass(frozen=True, slots=True)
class OddLevel:
    """Readings of some runs that are larger or smaller than simulated by one share."""

    channel: str
    runs: str  #: in words
    region: Mapping[str, Range]
    """By column, smallest and largest value; empty if no column of conditions holds the level."""
    share: float  #: readings of these runs over the simulated ones, less 1
    others: float  #: the same of all other runs; NaN without any
    size: float  #: rms of the misfit by this share [N], [Nm]
    z: float  #: share over its standard error by noise

    @property
    def said(self) -> str:
        """The disagreement, without full stop."""
        said = f"the {CHANNELS[self.channel].word} of {self.runs} is {_by(self.share)} than simulated"
        if math.isnan(self.others):
            return said
        return f"{said}, that of the others {'as simulated' if abs(self.others) < 5e-4 else _by(self.others)}"

    @property
    def cure(self) -> str:
        """What to do, without full stop."""
        if math.isnan(self.others):
            return f"check the calibration of {self.channel}, and whether it is another specimen of the tyre"
        return f"check {self.runs} or repeat them"

    @property
    def sentence(self) -> str:
        """The remark in words."""
        return f"This explains most of the misfit: {self.said}; {self.cure}."

    @property
    def place(self) -> Region:
        """The place in the programme, with the rms misfit as bias."""
        sign = math.copysign(1.0, self.share)
        return Region(self.channel, dict(self.region), sign * self.size, sign * self.z)


def _by(share: float) -> str:
    """A relative difference in words."""
    return f"{abs(100.0 * share):.1f} % {'larger' if share > 0.0 else 'smaller'}"


def odd_level(
    points: Points, residual: np.ndarray, simulated: np.ndarray, noise: Noise, left: Mapping[str, float]
) -> OddLevel | None:
    """The runs that explain most of what a model misses by one share of its readings; None without any.

    ``residual`` and ``simulated`` (c n,) are measured less simulated and simulated readings. ``left`` [N], [Nm] is by channel
    what the build of the model left of its own readings: up to twice as much needs no cause. The share of some runs must differ
    from that of all others, and they must explain more than all runs do, both beyond the price of the search.
    """
    groups = list(_groups(points))
    price = constants.STRUCTURE_EVIDENCE + math.log(max(len(groups) * len(noise.channels), 1))
    best: OddLevel | None = None
    residuals, readings, errors = (noise.by_channel(x) for x in (residual, simulated, noise.u))
    for channel, r in residuals.items():
        used = np.isfinite(errors[channel]) & np.isfinite(r)
        F, w = readings[channel], np.where(used, errors[channel], np.inf) ** -2.0
        missed = left.get(channel, 0.0)
        excess = float(np.sum(w * np.nan_to_num(r) ** 2)) - used.sum() - missed**2 * float(np.sum(w))
        for runs, region, mask in groups:
            (own, power), (other, beside) = (_share(r, F, w * part) for part in (mask, ~mask))
            if power <= 0.0:
                continue
            every = beside <= 0.0
            difference = own**2 * power if every else (own - other) ** 2 / (1.0 / power + 1.0 / beside)
            size = abs(own) * math.sqrt(power / float(np.sum(w * mask)))
            explained = own**2 * power
            beyond = 0.5 * difference > price and size > TWO_SIGMA * missed and explained > MOST * excess
            if beyond and (best is None or 0.5 * (explained - best.z**2) > price):
                others = math.nan if every else other
                best = OddLevel(channel, runs, region, own, others, size, math.sqrt(explained))
    return best


def _share(residual: np.ndarray, simulated: np.ndarray, weight: np.ndarray) -> tuple[float, float]:
    """Share of the simulated readings (n,) by which the readings are larger, and its precision."""
    power = float(np.sum(weight * simulated**2))
    return float(np.sum(weight * simulated * np.nan_to_num(residual))) / max(power, 1e-12), power


def _groups(points: Points) -> Iterator[tuple[str, dict[str, Range], np.ndarray]]:
    """All runs, then those at each level of each setting that varies: in words, as a region, and as a mask (n,)."""
    yield "all runs", {}, np.ones(len(points), dtype=bool)
    for name in SETTINGS:
        column, kind = COLUMNS[name], levels.KINDS[name]
        values = points.condition(column)
        if levels.spread(getattr(points, name), kind):
            continue
        for mask in _parts(levels.labels_of_setting(points, name)):
            at = float(np.median(values[mask]))
            word, _, unit = CONDITIONS[column][:3]
            yield (
                f"the runs at a {word} of {at:.4g} {unit}",
                {column: (float(values[mask].min()), float(values[mask].max()))},
                mask,
            )
    for sign, way in ((1.0, "the forward runs"), (-1.0, "the backward runs")):
        mask = points.direction == sign
        if 0 < mask.sum() < len(points):
            yield way, {"direction": (sign, sign)}, mask
    for names, index in ((points.setups, points.setup), (points.files, points.file)):
        for mask in _parts(index):
            yield f"the runs of {names[index[mask][0]]}", {}, mask


def _parts(label: np.ndarray) -> Iterator[np.ndarray]:
    """Masks (n,) of the labels, if there are several with enough points."""
    found = [label == k for k in np.unique(label[label >= 0])]
    yield from (mask for mask in found if FEWEST <= mask.sum() < len(label))
