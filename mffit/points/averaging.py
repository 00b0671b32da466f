"""Points from means of a recording over its steady stretches and along its sweeps."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from mffit.constants import STRAIGHT
from mffit.points import constants
from mffit.points.mean import errors_of_means
from mffit.points.points import Points, make_points
from mffit.points.stretch import PLATEAU, Stretch
from mffit.quantities import CHANNELS, u_column
from mffit.sweeps import Sweep

AVERAGED_CHANNELS = (
    *("alpha", "gamma", "kappa", "Fz", "p", "V", "T", "t", "iteration"),
    *CHANNELS,
    *(f"u_{name}" for name in CHANNELS),
)

AVERAGED_RANGE = {"alpha": STRAIGHT.rad, "gamma": STRAIGHT.rad, "kappa": STRAIGHT.rad}
"""Largest change of each swept setting within one average along a sweep; forces bend over slip to any side alike."""


def rows_as_points(sweep: Sweep, phi_t: float, rows: np.ndarray) -> Points:
    """Some rows of a sweep as points."""
    means = {name: getattr(sweep, name)[rows] for name in AVERAGED_CHANNELS}
    return _points(sweep, phi_t, rows, means, sweep.table.iloc[rows])


class Means(NamedTuple):
    """Points from the stretches of a recording."""

    points: Points
    counts: tuple[int, ...]  #: number of points of each stretch
    used: np.ndarray  #: mask (n,) of the averaged samples


def means(
    sweep: Sweep,
    phi_t: float,
    stretches: Sequence[Stretch],
    labels: Sequence[str],
    faulty: np.ndarray,
    grids: Sequence["BlockGrid"],
) -> Means:
    """Points: means over plateaus, with estimated standard errors if the file states none, and over short blocks of sweeps.

    ``phi_t`` is the turn slip of the path [1/m]. ``labels`` name the sweep of each stretch, ``grids`` divide those that are no
    plateaus. Samples of the mask ``faulty`` (n,) are left out.
    """
    used = np.zeros(len(sweep), dtype=bool)
    if not stretches:
        return Means(rows_as_points(sweep, phi_t, np.flatnonzero(used)), (), used)
    plateau = np.zeros(1, dtype=int), np.ones(1, dtype=bool)  # one mean, of however many samples
    kept, sizes = [], []
    for stretch, grid in zip(stretches, grids, strict=True):
        rows = stretch.begin + np.flatnonzero(~faulty[stretch.begin : stretch.end])
        first, enough = plateau if stretch.kind == PLATEAU else _blocks(sweep.time[rows], grid)
        counts = np.diff(np.r_[first, len(rows)])
        kept.append(rows[np.repeat(enough, counts)])
        sizes.append(counts[enough])
    counts = [len(one) for one in sizes]
    rows, first = np.concatenate(kept), np.cumsum(np.r_[0, np.concatenate(sizes)])[:-1]
    used[rows] = True
    moving = np.repeat([stretch.kind != PLATEAU for stretch in stretches], counts)
    names = tuple(dict.fromkeys(labels))
    found = _means(sweep, phi_t, rows, first)
    resting = [part for part, s in zip(kept, stretches, strict=True) if s.kind == PLATEAU]
    u = {channel: _errors(sweep, found, channel, resting, moving) for channel in CHANNELS}
    begin, end = (
        np.repeat(ends, counts) for ends in zip(*[(s.rests_from, s.end) for s in stretches], strict=True)
    )
    last = np.r_[first[1:], len(rows)] - 1
    points = found.replace(
        **{f"u_{channel}": values for channel, values in u.items()},
        line=sweep.line[np.where(moving, rows[first], begin)],
        last_line=sweep.line[np.where(moving, rows[last], end - 1)],
        continuous=moving,
        time=np.where(moving, _mean(sweep.time, rows, first), np.nan),
        sweep=np.repeat([names.index(label) for label in labels], counts),
        sweep_names=names,
        table=found.table.assign(
            **{u_column(n): values for n, values in u.items() if not np.all(np.isnan(values))}
        ),
    )
    return Means(points, tuple(counts), used)


def _errors(
    sweep: Sweep, found: Points, channel: str, resting: Sequence[np.ndarray], moving: np.ndarray
) -> np.ndarray:
    """Standard errors (k,) of the means of a channel, those of plateaus estimated from their samples where none is stated."""
    values, stated = getattr(sweep, channel), found.u(channel)
    if not np.any(np.isfinite(values)) or np.all(moving):
        return stated
    errors = np.full(len(found), np.nan)
    errors[~moving] = errors_of_means([values[rows] for rows in resting])
    # Without scatter no standard error can be estimated.
    return np.where(np.isfinite(stated), stated, np.where(errors > 0.0, errors, np.nan))


class BlockGrid(NamedTuple):
    """Times at which a sweep is divided into blocks to average."""

    start: float  #: of the first block [s]
    interval: float  #: between samples [s]
    size: float  #: of a block, in samples
    shortest: float  #: time from the first to the last sample of a block [s]


def grid_of(sweep: Sweep, rows: np.ndarray, radius: float) -> BlockGrid:
    """The blocks of a stretch, from its sound ``rows``; ``radius`` is that of the wheel [m].

    A wheel that is not round makes a ripple, which a mean over whole turns does not contain: such a block lacks one sample at
    most at either end.
    """
    time = sweep.time[rows]
    every = time if len(rows) > 1 else sweep.time
    interval = float(np.median(np.diff(every))) if len(every) > 1 else constants.AVERAGED_TIME
    step = float(constants.AVERAGED_TIME)
    apart = max(1, round(step / interval))  # samples; readings are too noisy for differences of neighbours
    seconds = time[apart:] - time[:-apart]
    for name, most in AVERAGED_RANGE.items():
        values = getattr(sweep, name)[rows]
        rates = np.abs(values[apart:] - values[:-apart]) / seconds
        rates = rates[np.isfinite(rates)]  # lines left out by hand may have none
        moved = float(np.median(rates)) if len(rates) else 0.0
        if moved > 0.0:
            step = min(step, most / moved)
    size = float(max(1, round(step / interval)))
    shortest, turn = 0.0, _turn(sweep, rows, radius)
    if constants.RANGE_OF_A_TURN * step > turn:  # False without a turn
        size = max(1, round(step / turn)) * turn / interval
        shortest = (size - 2.5) * interval
    return BlockGrid(time[0], interval, size, shortest)


def _blocks(time: np.ndarray, grid: BlockGrid) -> tuple[np.ndarray, np.ndarray]:
    """First sample of every block by number, and the mask of the blocks that give a point: half of their samples are sound."""
    block = np.floor((time - grid.start) / (grid.size * grid.interval) + 1e-6)
    first = np.r_[0, np.flatnonzero(np.diff(block)) + 1]
    behind = np.r_[first[1:], len(time)]
    enough = (2.0 * (behind - first) >= grid.size) & (time[behind - 1] - time[first] >= grid.shortest)
    return first, enough


def _turn(sweep: Sweep, rows: np.ndarray, radius: float) -> float:
    """Time of one turn of the wheel [s], by its speed if measured, else by its ``radius`` [m]; not finite at a standstill."""
    turns = np.abs(sweep.omega[rows])
    turning = float(np.median(turns if np.any(turns > 0.0) else sweep.V[rows] / radius))
    return 2.0 * np.pi / turning if turning > 0.0 else np.nan


def _mean(values: np.ndarray, rows: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Means (k,) over blocks of rows (m,), which begin at ``first`` (k,)."""
    if values.strides == (0,) or not len(first):  # a broadcast value: not measured, or constant
        return np.broadcast_to(values[:1], first.shape)
    return np.asarray(np.add.reduceat(values[rows], first) / np.diff(np.r_[first, len(rows)]))


def _means(sweep: Sweep, phi_t: float, rows: np.ndarray, first: np.ndarray) -> Points:
    """Points from means over blocks; the table has the first text of each block and no time, as that of finished points."""
    means = {name: _mean(getattr(sweep, name), rows, first) for name in AVERAGED_CHANNELS}
    table = {
        name: _mean(column.to_numpy(dtype=float), rows, first)
        if pd.api.types.is_numeric_dtype(column)
        else column.to_numpy()[rows[first]]
        for name, column in sweep.table.items()
        if name != "time_s"
    }
    return _points(sweep, phi_t, rows[first], means, pd.DataFrame(table))


def _points(
    sweep: Sweep, phi_t: float, first: np.ndarray, means: dict[str, np.ndarray], table: pd.DataFrame
) -> Points:
    """Points from means by channel; all other fields are those of the first samples."""
    values: dict[str, Any] = means
    return make_points(
        **values,
        phi_t=phi_t,
        direction=sweep.direction[first],
        mount=sweep.mount,
        line=sweep.line[first],
        sweep_names=(sweep.name,),
        files=(sweep.file,),
        setups=(sweep.setup,),
        table=table,
    )
