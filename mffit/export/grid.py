"""Grids between whose nodes linear interpolation stays close to a function."""

import itertools
import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np

from mffit.export import constants
from tir.correction import interpolated

Function = Callable[..., Any]
Ranges = Mapping[str, tuple[float, float]]


class Grid(NamedTuple):
    """Values of a function at nodes."""

    axes: dict[str, np.ndarray]  #: nodes (n,) of each axis, ascending; without axes that have no effect
    values: np.ndarray  #: (n, m, ...), in the order of the axes
    largest: float  #: largest absolute value over the ranges
    error: float  #: largest error found of multilinear interpolation, over ``largest``
    tested: int  #: conditions off the nodes at which it was looked for
    held: dict[str, float]  #: value of the conditions without an axis

    def mesh(self) -> dict[str, np.ndarray]:
        """The conditions of all nodes, each in the shape of the values."""
        return dict(zip(self.axes, np.meshgrid(*self.axes.values(), indexing="ij"), strict=True))


def grid_of(function: Function, ranges: Ranges, goal: float) -> Grid:
    """The smallest grid found on which multilinear interpolation misses the function by less than the goal.

    ``function`` takes the conditions by name, which broadcast, within ``ranges``. ``goal`` is the largest error over the
    largest absolute value; with too many nodes (``TABLE_NODES``) the grid may miss it.

    The error of multilinear interpolation is at most the sum of those along each axis, and the nodes needed along an axis grow
    with the inverse root of its error: the product of the numbers of nodes is smallest if all axes have the same error. So
    every axis gets the same share of the goal, and the longest steps that keep it at all places that were looked at. The share
    then follows the error of the whole grid, as the worst places of the axes are seldom one condition.
    """
    random = np.random.default_rng(0)
    profiles = {name: _profile(function, ranges, name, random) for name in ranges}
    largest = max(float(np.abs(y).max()) for _, y in profiles.values())
    if not np.isfinite(largest):
        return Grid({}, np.zeros(()), largest, 0.0, 0, {})
    bent = {
        name: (x, y / largest)
        for name, (x, y) in profiles.items()
        if np.ptp(y, axis=0).max() > np.finfo(float).eps * 10.0 * largest
    }
    held = {name: _nearest_zero(*ends) for name, ends in ranges.items() if name not in bent}
    if not bent:
        return Grid({}, np.zeros(()), largest, 0.0, 0, {})
    share, found = goal / len(bent), []
    for _ in range(constants.TABLE_TRIES):
        axes = _axes(bent, share)
        full = _size(axes) > constants.TABLE_NODES
        while _size(axes) > constants.TABLE_NODES:
            share *= 1.02 * (_size(axes) / constants.TABLE_NODES) ** (2.0 / len(axes))
            axes = _axes(bent, share)
        found.append(_measured(function, axes, held, largest, random))
        missed = found[-1].error / (goal * constants.TABLE_RESERVE)
        if 0.75 < missed <= 1.0 or (full and missed > 1.0):
            break
        share *= constants.TABLE_RESERVE / max(missed, 0.1)
    good = [grid for grid in found if grid.error <= goal * constants.TABLE_RESERVE]
    return min(good, key=lambda grid: grid.values.size) if good else min(found, key=lambda grid: grid.error)


def _profile(
    function: Function, ranges: Ranges, name: str, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n,) of an axis, closer together near zero, and the values (n, m) there at places of the other axes."""
    low, high = ranges[name]
    zero = _nearest_zero(low, high)
    out = np.linspace(0.0, 1.0, int(constants.TABLE_POSITIONS)) ** 2
    x = np.unique(
        _rounded(np.concatenate([zero + (low - zero) * out, zero + (high - zero) * out]), high - low)
    )
    others = {key: ends for key, ends in ranges.items() if key != name}
    lows, highs = np.array([*others.values()]).reshape(-1, 2).T
    corners = itertools.product(*((a, _nearest_zero(a, b), b) for a, b in others.values()))
    drawn = random.uniform(lows, highs, (int(constants.TABLE_PLACES), len(others)))
    places = np.concatenate([np.array([*corners]), drawn])
    values = function(**{name: x[:, None]}, **dict(zip(others, places.T, strict=True)))
    return x, np.broadcast_to(values, (len(x), len(places)))


def _axes(profiles: Mapping[str, tuple[np.ndarray, np.ndarray]], share: float) -> dict[str, np.ndarray]:
    """The nodes of each axis, from zero to either side."""
    axes = {}
    for name, (x, y) in profiles.items():
        zero = int(np.argmin(np.abs(x)))
        up = _steps(x[zero:], y[zero:], share)
        down = _steps(x[zero::-1], y[zero::-1], share)
        axes[name] = x[[*(zero - k for k in down[:0:-1]), *(zero + k for k in up)]]
    return axes


def _steps(x: np.ndarray, y: np.ndarray, share: float) -> list[int]:
    """Positions from the first to the last, each the furthest whose chord misses none between by more than the share."""
    nodes = [0]

    def close(end: int) -> bool:
        i = nodes[-1]
        part = ((x[i + 1 : end] - x[i]) / (x[end] - x[i]))[:, None]
        return bool(np.all(np.abs(y[i + 1 : end] - (1.0 - part) * y[i] - part * y[end]) <= share))

    while nodes[-1] < len(x) - 1:
        step = 1
        while nodes[-1] + 2 * step < len(x) and close(nodes[-1] + 2 * step):
            step *= 2
        near, far = nodes[-1] + step, min(nodes[-1] + 2 * step, len(x))
        while far - near > 1:
            between = (near + far) // 2
            near, far = (between, far) if close(between) else (near, between)
        nodes.append(near)
    return nodes


def _measured(
    function: Function,
    axes: dict[str, np.ndarray],
    held: dict[str, float],
    largest: float,
    random: np.random.Generator,
) -> Grid:
    """The grid of these nodes, with its error at random conditions, in the middle of cells and all over the worst cells."""
    nodes, n = list(axes.values()), int(constants.TABLE_CONDITIONS)
    shape = (n, len(nodes))

    def exact(at: Iterable[np.ndarray]) -> Any:
        return function(**dict(zip(axes, at, strict=True)), **held)

    values = exact(np.meshgrid(*nodes, indexing="ij", sparse=True))
    values = _rounded(np.broadcast_to(values, [len(x) for x in nodes]), largest)
    largest = max(largest, float(np.abs(values).max()))

    def within(cells: np.ndarray, part: Any) -> np.ndarray:
        """Conditions (k, axes) in cells given by their lowest nodes (k, axes)."""
        return np.stack(
            [x[i] + p * (x[i + 1] - x[i]) for x, i, p in zip(nodes, cells.T, part.T, strict=True)], axis=1
        )

    def missed(at: np.ndarray) -> np.ndarray:
        return np.asarray(np.abs(interpolated(nodes, values[..., None], at.T)[0] - exact(at.T)) / largest)

    middle = within(random.integers(0, [len(x) - 1 for x in nodes], shape), np.full(shape, 0.5))
    anywhere = random.uniform([x[0] for x in nodes], [x[-1] for x in nodes], shape)
    at = np.concatenate([anywhere, middle])
    first = missed(at)
    worst = at[np.argsort(-first)[: int(constants.TABLE_WORST_CELLS)]]
    lowest = (np.searchsorted(x, q) - 1 for x, q in zip(nodes, worst.T, strict=True))
    cells = np.clip(np.stack([*lowest], axis=1), 0, [len(x) - 2 for x in nodes])
    again = missed(within(cells[np.arange(n) % len(cells)], random.uniform(size=shape)))
    return Grid(axes, values, largest, float(max(first.max(), again.max())), len(first) + len(again), held)


def _size(axes: Mapping[str, np.ndarray]) -> int:
    return math.prod(len(x) for x in axes.values())


def _nearest_zero(low: float, high: float) -> float:
    return min(max(0.0, low), high)


def _rounded(values: np.ndarray, size: float) -> np.ndarray:
    """Values with as many digits as single precision has for the size, in which programs may hold a table."""
    digits = np.finfo(np.float32).precision - (math.floor(math.log10(size)) + 1 if size > 0.0 else 0)
    return np.round(values, digits) + 0.0
