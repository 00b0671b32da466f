"""Quantities of a point that depend on the other points: distance rolled, sense of the sweep, usual path and speed."""

from collections.abc import Iterator
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.points import Points, main_path
from mffit.points.clock import sense
from tir import constants


class History:
    """Quantities of the points of a test that depend on other points, computed on first use."""

    def __init__(self, points: Points) -> None:
        self.points = points

    @cached_property
    def distance_km(self) -> np.ndarray:
        """Distance rolled (n,) [km]."""
        return distance_km(self.points)

    @cached_property
    def sense(self) -> np.ndarray:
        """Sense (n,) of the sweep: 1, -1, or 0 where the angle was held."""
        return sense(self.points)

    @cached_property
    def along_sweep(self) -> np.ndarray:
        """Position (n,) of every point in its sweep: 0 for the first, 1 for the last."""
        out = np.zeros(len(self.points))
        for rows in self.points.rows_of_sweeps.values():
            out[rows] = np.linspace(0.0, 1.0, len(rows))
        return out

    @cached_property
    def usual_speed(self) -> float:
        """The most frequent speed [m/s]."""
        return reference_speed(self.points)


class RowsOfTest(NamedTuple):
    """Some points of a test, and the history of the whole test."""

    history: History
    rows: np.ndarray | slice = slice(None)  #: indices (n,) of the points


def blocks(points: Points, *, by_sweep: bool) -> Iterator[np.ndarray]:
    """Row indices (m,) of successive blocks of the points; with ``by_sweep`` no sweep is divided.

    The size of the blocks fits the processor's cache. With ``by_sweep`` a larger sweep is one block.
    """
    n, most = len(points), int(constants.CONDITIONS_PER_BLOCK)
    if n <= most:
        yield np.arange(n)
        return
    if not by_sweep:
        yield from np.array_split(np.arange(n), -(-n // most))
        return
    order = np.argsort(points.sweep, kind="stable")
    ends = (np.flatnonzero(np.diff(points.sweep[order], append=-1)) + 1).tolist()
    begin = 0
    for end, following in zip(ends, [*ends[1:], n + most], strict=True):
        if following - begin > most:
            yield order[begin:end]
            begin = int(end)


def successive(rows: np.ndarray) -> np.ndarray | slice:
    """The rows (m,) as a slice if they are consecutive, which saves copies; else unchanged."""
    if len(rows) and rows[-1] - rows[0] == len(rows) - 1 and np.all(np.diff(rows) == 1):
        return slice(int(rows[0]), int(rows[-1]) + 1)
    return rows


def usual_radius(points: Points) -> float:
    """Path radius [m] declared for most points; very large on a straight path."""
    return 1.0 / max(abs(main_path(points)), 1e-12)


def path_radii(points: Points) -> np.ndarray:
    """Declared path radius (n,) of every point [m]; very large on a straight path."""
    return np.asarray(1.0 / np.maximum(np.abs(points.phi_t), 1e-12))


def reference_speed(points: Points) -> float:
    """The most frequent speed of the data [m/s], to 0.1 m/s."""
    values, counts = np.unique(np.round(points.V[np.isfinite(points.V)], 1), return_counts=True)
    return float(values[counts.argmax()])


def distance_km(points: Points) -> np.ndarray:
    """Distance (n,) rolled since time zero [km], the speed linear between points; 0 where times are not known."""
    out = np.zeros(len(points))
    rows = np.flatnonzero(np.isfinite(points.t))
    rows = rows[np.argsort(points.t[rows], kind="stable")]
    t, V = points.t[rows], points.V[rows]
    if len(rows):
        steps = np.diff(t) * 0.5 * (V[1:] + V[:-1])
        out[rows] = 1e-3 * (max(t[0], 0.0) * V[0] + np.concatenate([[0.0], np.cumsum(steps)]))
    return out


def of_part(points: Points, name: str) -> np.ndarray:
    """Indicator (n,): 1 at the points of the set-up, else the file, else the sweep of that name; 0 elsewhere."""
    counted = ((points.setups, points.setup), (points.files, points.file), (points.sweep_names, points.sweep))
    names, index = next((pair for pair in counted if name in pair[0]), counted[0])
    return np.asarray(np.array([float(other == name) for other in names])[index])
