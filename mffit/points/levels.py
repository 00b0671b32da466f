"""Levels of the set-points: the conditions that a test plan repeats."""

from __future__ import annotations

import numpy as np

from mffit.points.points import Points

LOAD_GAP = 0.08
"""Loads closer together than this, relative, are one level."""
PRESSURE_GAP = 10e3
"""Pressures closer together than this [Pa] are one level."""


def main_pressure(points: Points) -> np.ndarray:
    """Mask (n,) of the points at the pressure at which most of the programme was run."""
    counts = [int(np.sum(np.abs(points.p - p) < PRESSURE_GAP)) for p in points.p]
    return np.abs(points.p - points.p[int(np.argmax(counts))]) < PRESSURE_GAP


def load_levels(points: Points) -> int:
    """Number of loads: levels more than 8 % apart."""
    return int(np.sum(np.diff(np.log(np.sort(points.Fz))) > LOAD_GAP)) + 1
