"""Levels of the set-points: the conditions that a test plan repeats, and how closely a rig keeps to them.

A level is a dense place among the values, found densest first: a few values on the way from one level to the
next neither join two levels nor make one of their own. Where the values are spread evenly no place is denser
than the others; they are cut into levels between one and two tolerances apart, so that they count as varied.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mffit.points.points import Points


@dataclass(frozen=True, slots=True)
class Quantity:
    """A quantity that a test plan sets, and how near two values of it are the same setting."""

    name: str
    tolerance: (
        float  #: values further apart than this may be two levels; a rig's scatter is a third of it or less
    )
    relative: bool = False  #: the tolerance is a share of the value, which is positive


LOAD = Quantity("load", 0.08, relative=True)  # [N]
CAMBER = Quantity("camber", np.radians(0.8))  # [rad]
PRESSURE = Quantity("pressure", 10e3)  # [Pa]
SPEED = Quantity("speed", 0.1, relative=True)  # [m/s]
SIDESLIP = Quantity("sideslip", np.radians(0.4))  # [rad]

SMALLEST_SHARE = 0.02
"""Values a level needs, per value of the largest level."""
FLANK = 0.3
"""Density, relative to the densest place half a tolerance away, below which values are the flank of that place."""
CLOSE = 1.0 / 3.0
"""Distance from a level, in tolerances, within which most values of a setting lie that was held."""
MOST_AWAY = 0.3
"""Share of values further away than that from which the values are spread rather than held."""
NONE = -1
"""Label of a value that belongs to no level."""


def labels(values: np.ndarray, quantity: Quantity) -> np.ndarray:
    """Number (n,) of the level of each value, rising from 0 with the value; ``NONE`` for those between levels.

    Parameters
    ----------
    values : (n,); NaN belongs to no level
    quantity : what the values are
    """
    scaled = _scaled(values, quantity)
    centres = _centres(scaled)
    found = _nearest(scaled, centres)
    far = np.abs(scaled - _at(centres, found)) >= 1.0
    return np.where(far, NONE, found)


def nearest_labels(values: np.ndarray, quantity: Quantity) -> np.ndarray:
    """As :func:`labels`, but values between levels are given to the nearest one; ``NONE`` for NaN only."""
    scaled = _scaled(values, quantity)
    return _nearest(scaled, _centres(scaled))


def level_values(values: np.ndarray, quantity: Quantity) -> np.ndarray:
    """Median (n,) of the level nearest to each value; NaN stays NaN."""
    values = np.asarray(values, dtype=float)
    own, near = labels(values, quantity), nearest_labels(values, quantity)
    medians = np.array([np.median(values[own == k]) for k in range(near.max(initial=NONE) + 1)])
    return _at(medians, near)


def count(values: np.ndarray, quantity: Quantity) -> int:
    """Number of levels among the values; evenly spread values are three or more from four tolerances on."""
    return len(_centres(_scaled(values, quantity)))


def spread(values: np.ndarray, quantity: Quantity) -> bool:
    """Whether the values wander through their range rather than keep to two levels or more."""
    scaled = _scaled(values, quantity)
    centres = _centres(scaled)
    if len(centres) < 2:
        return False
    away = np.abs(scaled - _at(centres, _nearest(scaled, centres)))
    return bool(np.mean(away[np.isfinite(away)] > CLOSE) > MOST_AWAY)


def main_pressure(points: Points) -> np.ndarray:
    """Mask (n,) of the points at the pressure at which most of the programme was run.

    Of pressures with equally many points it is the one nearest to the middle of the programme.
    """
    level = labels(points.p, PRESSURE)
    sizes = np.bincount(level[level >= 0])
    if not len(sizes):
        return np.ones(len(points), dtype=bool)
    means = [float(np.mean(points.p[level == k])) for k in range(len(sizes))]
    middle = float(np.median(points.p))
    best = max(range(len(sizes)), key=lambda k: (sizes[k], -abs(means[k] - middle)))
    return level == best


def main_path(points: Points) -> float:
    """Turn slip phi_t [1/m] of the path on which most points were run; 0 on a flat track, or without points."""
    paths, counts = np.unique(points.phi_t, return_counts=True)
    return float(paths[counts.argmax()]) if len(paths) else 0.0


def _scaled(values: np.ndarray, quantity: Quantity) -> np.ndarray:
    """The values (n,) in tolerances; NaN where they say nothing."""
    values = np.asarray(values, dtype=float)
    if quantity.relative:
        values = np.log(np.where(values > 0.0, values, np.nan))
    return np.where(np.isfinite(values), values, np.nan) / quantity.tolerance


def _centres(scaled: np.ndarray) -> np.ndarray:
    """Middles (k,) of the levels, rising, more than one tolerance apart."""
    known = np.sort(scaled[np.isfinite(scaled)])
    if not len(known):
        return known
    density = _within(known, known, 0.5)
    places, sizes, left = [], [], known
    while len(left):
        place = left[np.argmax(_within(left, left, 0.5))]
        about = left[np.abs(left - place) <= 0.5]
        place = float(np.median(about))
        if not _is_flank(place, known, density):
            places.append(place)
            sizes.append(len(about))
        left = left[np.abs(left - place) >= 1.0]
    # The square root is about the scatter of a count: of few values even one may be a level.
    fewest = max(np.sqrt(max(sizes)) / 3.0, SMALLEST_SHARE * max(sizes))
    return np.sort([place for place, size in zip(places, sizes, strict=True) if size >= fewest])


def _is_flank(place: float, known: np.ndarray, density: np.ndarray) -> bool:
    """Whether a place belongs to the slope of a denser one."""
    about = density[np.abs(known - place) <= 0.5]
    return bool(_within(np.array([place]), known, 0.5)[0] < FLANK * about.max())


def _within(places: np.ndarray, ordered: np.ndarray, distance: float) -> np.ndarray:
    """How many of the ordered values lie within a distance of each place."""
    upper = np.searchsorted(ordered, places + distance, side="right")
    return upper - np.searchsorted(ordered, places - distance, side="left")


def _nearest(scaled: np.ndarray, centres: np.ndarray) -> np.ndarray:
    """Number (n,) of the nearest centre; ``NONE`` for NaN."""
    if not len(centres):
        return np.full(len(scaled), NONE)
    near = np.searchsorted((centres[1:] + centres[:-1]) / 2.0, scaled)
    return np.where(np.isfinite(scaled), near, NONE)


def _at(values: np.ndarray, index: np.ndarray) -> np.ndarray:
    """``values`` at the numbers (n,), NaN at ``NONE``."""
    return np.append(values, np.nan)[index]
