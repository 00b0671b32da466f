"""Levels of the set-points: the conditions that a test plan repeats.

A level is a cluster of values; the densest is found first. So a few values between two levels neither join these nor form a
level themselves. Evenly spread values, without clusters, are cut into levels between one and two tolerances apart, so that they
count as varied.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import ndtr

from mffit.constants import STRAIGHT, UPRIGHT
from mffit.points import constants
from mffit.points.points import Points


@dataclass(frozen=True, slots=True)
class LevelKind:
    """A setting of a test plan, and the tolerance of its levels."""

    name: str
    tolerance: float  #: three standard deviations of a rig; values further apart may be two levels
    relative: bool = False  #: whether the tolerance is relative to the value, which must be positive


LOAD = LevelKind("load", constants.CONDITION, relative=True)  # [N]
CAMBER = LevelKind("camber", UPRIGHT.rad)  # [rad]
PRESSURE = LevelKind("pressure", constants.PRESSURE)  # [Pa]
SPEED = LevelKind("speed", constants.CONDITION, relative=True)  # [m/s]
SIDESLIP = LevelKind("sideslip", STRAIGHT.rad)  # [rad]
SLIP = LevelKind("longitudinal slip", constants.SLIP)  # [-]
KINDS = {"alpha": SIDESLIP, "kappa": SLIP, "Fz": LOAD, "gamma": CAMBER, "p": PRESSURE, "V": SPEED}
"""Kinds of levels by the field of :class:`Points`."""
SETTINGS = ("Fz", "gamma", "p")
"""Fields of the settings that label sweeps."""

NO_LEVEL = -1
"""Label of a value outside all levels."""
SCATTER = 1.0 / 3.0
"""Standard deviation of a held setting, in tolerances."""


def labels(values: np.ndarray, kind: LevelKind) -> np.ndarray:
    """Index (n,) of the level of each value, rising with the value from 0; ``NO_LEVEL`` for values between levels and NaN."""
    return _labels(values, kind)[0]


def nearest_labels(values: np.ndarray, kind: LevelKind) -> np.ndarray:
    """As :func:`labels`, with values between levels assigned to the nearest one; ``NO_LEVEL`` for NaN only."""
    return _labels(values, kind)[1]


def _labels(values: np.ndarray, kind: LevelKind) -> tuple[np.ndarray, np.ndarray]:
    """:func:`labels` and :func:`nearest_labels` (n,)."""
    scaled = in_tolerances(values, kind)
    centres = _centres(scaled)
    near = _nearest(scaled, centres)
    far = np.abs(scaled - _at(centres, near)) >= 1.0
    return np.where(far, NO_LEVEL, near), near


def labels_of_sweeps(values: np.ndarray, sweep: np.ndarray, kind: LevelKind) -> np.ndarray:
    """As :func:`nearest_labels`, but a sweep that holds the setting has one label, that of its median.

    The load varies with the forces of a sweep, at small loads by more than the tolerance. Levels are therefore those of the
    medians of such sweeps. ``sweep`` (n,) is the index of each value's sweep.
    """
    held = np.array(values, dtype=float)
    scaled = in_tolerances(values, kind)
    known = np.flatnonzero(np.isfinite(scaled))
    order = known[np.lexsort((held[known], sweep[known]))]  # sweep after sweep, each with rising values
    for rows in np.split(order, np.flatnonzero(np.diff(sweep[order])) + 1):
        if len(rows) and _is_held(scaled[rows]):
            held[rows] = 0.5 * (held[rows[(len(rows) - 1) // 2]] + held[rows[len(rows) // 2]])
    return nearest_labels(held, kind)


def labels_of_setting(points: Points, name: str) -> np.ndarray:
    """Index (n,) of the intended level of each point: by :func:`labels_of_sweeps` for a load, else :func:`nearest_labels`."""
    values, kind = getattr(points, name), KINDS[name]
    return labels_of_sweeps(values, points.sweep, kind) if kind is LOAD else nearest_labels(values, kind)


def _is_held(scaled: np.ndarray) -> bool:
    """Whether sorted values (n,) in tolerances vary around one value: without a gap between levels and over a limited range."""
    low, high = np.percentile(scaled, constants.CORE)
    inside = scaled[(scaled >= low) & (scaled <= high)]
    wanders = bool(np.diff(inside).max(initial=0.0) < 1.0)
    return wanders and bool(high - low < constants.HELD_LOAD / constants.CONDITION)


def median_of_labels(values: np.ndarray, found: np.ndarray) -> np.ndarray:
    """Median (n,) of the values with the same label as each value; NaN without a label."""
    out = np.full(len(values), np.nan)
    for k in np.unique(found[found != NO_LEVEL]):
        out[found == k] = np.median(values[found == k])
    return out


def level_values(values: np.ndarray, kind: LevelKind) -> np.ndarray:
    """Median (n,) of the level nearest to each value; NaN stays NaN."""
    values = np.asarray(values, dtype=float)
    own, near = _labels(values, kind)
    medians = np.array([np.median(values[own == k]) for k in range(near.max(initial=NO_LEVEL) + 1)])
    return _at(medians, near)


def count(values: np.ndarray, kind: LevelKind) -> int:
    """Number of levels among the values; values spread evenly over four tolerances or more count as three or more levels."""
    return len(_centres(in_tolerances(values, kind)))


def spread(values: np.ndarray, kind: LevelKind) -> bool:
    """Whether the values are spread over their range instead of keeping to two or more levels."""
    scaled = in_tolerances(values, kind)
    centres = _centres(scaled)
    if len(centres) < 2:
        return False
    away = np.abs(scaled - _at(centres, _nearest(scaled, centres)))
    return bool(np.mean(away[np.isfinite(away)] > SCATTER) > 2.0 * ndtr(-1.0))


def rows_of_equal(keys: np.ndarray) -> list[np.ndarray]:
    """Groups of row indices (m,) with equal keys (n, k), in the order of the keys.

    Columns are compared one by one, which for few levels is many times faster than comparing whole rows.
    """
    label = np.zeros(len(keys), dtype=int)
    for column in keys.T:
        distinct, own = np.unique(column, return_inverse=True)
        if len(distinct) > 1:
            label = np.unique(label * len(distinct) + own, return_inverse=True)[1]
    if not len(keys):
        return []
    return np.split(np.argsort(label, kind="stable"), np.cumsum(np.bincount(label))[:-1])


def main_pressure(points: Points) -> np.ndarray:
    """Mask (n,) of the points at the pressure with most points; among equals, the pressure nearest the median of all points."""
    level = labels(points.p, PRESSURE)
    sizes = np.bincount(level[level >= 0])
    if not len(sizes):
        return np.ones(len(points), dtype=bool)
    means = [float(np.mean(points.p[level == k])) for k in range(len(sizes))]
    middle = float(np.median(points.p))
    best = max(range(len(sizes)), key=lambda k: (sizes[k], -abs(means[k] - middle)))
    return np.asarray(level == best)


def main_path(points: Points) -> float:
    """Turn slip phi_t [1/m] of the path on which most points were run; 0 on a flat track, or without points."""
    paths, counts = np.unique(points.phi_t, return_counts=True)
    return float(paths[counts.argmax()]) if len(paths) else 0.0


def in_tolerances(values: np.ndarray, kind: LevelKind) -> np.ndarray:
    """The values (n,) in units of the tolerance, logarithmic if it is relative; NaN where they are not finite."""
    values = np.asarray(values, dtype=float)
    if kind.relative:
        values = np.log(np.where(values > 0.0, values, np.nan))
    return np.where(np.isfinite(values), values, np.nan) / kind.tolerance


def _centres(scaled: np.ndarray) -> np.ndarray:
    """Centres (k,) of the levels, rising, more than one tolerance apart."""
    known = _Counted(*np.unique(scaled[np.isfinite(scaled)], return_counts=True))
    if not len(known.values):
        return known.values
    density = _within(known.values, known, 0.5)
    places, sizes, left = [], [], known
    while len(left.values):
        place = left.values[np.argmax(_within(left.values, left, 0.5))]
        about = left.part(np.abs(left.values - place) <= 0.5)
        ends = np.cumsum(about.counts)
        middle = np.searchsorted(ends, [(ends[-1] - 1) // 2, ends[-1] // 2], side="right")
        place = float(np.sum(about.values[middle])) / 2.0
        if not _is_flank(place, known, density):
            places.append(place)
            sizes.append(int(about.counts.sum()))
        left = left.part(np.abs(left.values - place) >= 1.0)
    # Drop levels with very few values compared with the largest; among few values a single one may be a level.
    fewest = np.sqrt(max(sizes)) * SCATTER
    return np.sort([place for place, size in zip(places, sizes, strict=True) if size >= fewest])


class _Counted(NamedTuple):
    """Distinct values (k,), rising, and their frequencies."""

    values: np.ndarray
    counts: np.ndarray

    def part(self, which: np.ndarray) -> _Counted:
        return _Counted(self.values[which], self.counts[which])


def _is_flank(place: float, known: _Counted, density: np.ndarray) -> bool:
    """Whether a value lies on the flank of a denser cluster."""
    about = density[np.abs(known.values - place) <= 0.5]
    return bool(_within(np.array([place]), known, 0.5)[0] < constants.LEVEL_FLANK * about.max())


def _within(places: np.ndarray, among: _Counted, distance: float) -> np.ndarray:
    """Number of values within a distance of each place."""
    below = np.concatenate([[0], np.cumsum(among.counts)])
    upper = below[np.searchsorted(among.values, places + distance, side="right")]
    return np.asarray(upper - below[np.searchsorted(among.values, places - distance, side="left")])


def _nearest(scaled: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Index (n,) of the nearest centre; ``NO_LEVEL`` for NaN."""
    if not len(centres):
        return np.full(len(scaled), NO_LEVEL)
    near = np.searchsorted((centres[1:] + centres[:-1]) / 2.0, scaled)
    return np.where(np.isfinite(scaled), near, NO_LEVEL)


def _at(values: np.ndarray, index: np.ndarray) -> np.ndarray:
    """``values`` at the indices (n,); NaN at ``NO_LEVEL``."""
    return np.asarray(np.append(values, np.nan)[index])
