"""Points from means of a recording over its steady stretches and along its sweeps."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd

from mffit.constants import STRAIGHT
from mffit.points import constants
from mffit.points.mean import errors_of_means
from mffit.points.points import Points, make_points
from mffit.points.stretch import Stretch
from mffit.quantities import CHANNELS, u_column
from mffit.sweeps import Sweep

AVERAGED_CHANNELS = (
    *("alpha", "gamma", "kappa", "Fz", "p", "V", "T", "t", "iteration"),
    *CHANNELS,
    *(f"u_{name}" for name in CHANNELS),
)

AVERAGED_RANGE = {
    "alpha": STRAIGHT.rad,
    "gamma": STRAIGHT.rad,
    "kappa": float(constants.SLIP),
}
"""Largest change of each swept setting over which a sweep is averaged."""


def rows_as_points(sweep: Sweep, phi_t: float, rows: np.ndarray) -> Points:
    """Some rows of a sweep as points."""
    means = {name: getattr(sweep, name)[rows] for name in AVERAGED_CHANNELS}
    return _points(sweep, phi_t, rows, means, sweep.table.iloc[rows])


def over_plateaus(sweep: Sweep, phi_t: float, kept: list[Stretch], faulty: np.ndarray) -> Points:
    """Means over the stretches without faulty samples, with their standard errors if the file states none."""
    if not kept:
        return rows_as_points(sweep, phi_t, np.zeros(0, dtype=int))
    parts = [sound_rows(stretch, faulty) for stretch in kept]
    found = _means(sweep, phi_t, np.concatenate(parts), _begins([len(part) for part in parts]))
    u = {}
    for channel in CHANNELS:
        values, stated = getattr(sweep, channel), found.u(channel)
        if np.any(np.isfinite(values)):
            errors = errors_of_means([values[part] for part in parts])
            # A record without scatter does not show how exact it is.
            stated = np.where(np.isfinite(stated), stated, np.where(errors > 0.0, errors, np.nan))
        u[channel] = stated
    table = found.table.assign(**{u_column(channel): values for channel, values in u.items()})
    return found.replace(
        **{f"u_{channel}": values for channel, values in u.items()},
        table=table.dropna(axis="columns", how="all"),
    )


def sound_rows(stretch: Stretch, faulty: np.ndarray) -> np.ndarray:
    """The samples (m,) of a stretch that are not ``faulty`` (n,)."""
    return np.flatnonzero(~faulty[stretch.begin : stretch.end]) + stretch.begin


def along_sweeps(
    sweep: Sweep, phi_t: float, stretches: list[Stretch], labels: list[str], faulty: np.ndarray
) -> tuple[Points, np.ndarray]:
    """Means over short blocks of sweeps, without faulty samples; and the samples (m,) that they average."""
    if not stretches:
        return rows_as_points(sweep, phi_t, np.zeros(0, dtype=int)), np.zeros(0, dtype=int)
    kept, sizes, numbers = [], [], []
    for k, stretch in enumerate(stretches):
        rows = sound_rows(stretch, faulty)
        first, usual = _blocks(sweep, rows)
        counts = np.diff(np.r_[first, len(rows)])
        enough = 2 * counts >= usual  # most of its samples
        kept.append(rows[np.repeat(enough, counts)])
        sizes.append(counts[enough])
        numbers.append(np.full(int(enough.sum()), k))
    averaged, first = np.concatenate(kept), _begins(np.concatenate(sizes))
    found = _means(sweep, phi_t, averaged, first).replace(
        continuous=True,
        time=_mean(sweep.time, averaged, first),
        sweep=np.concatenate(numbers),
        sweep_names=tuple(labels),
    )
    return found, averaged


def _blocks(sweep: Sweep, rows: np.ndarray) -> tuple[np.ndarray, int]:
    """First row of every block that is averaged, and the usual number of samples in a block."""
    time = sweep.time[rows]
    interval = float(np.median(np.diff(time))) if len(rows) > 1 else constants.AVERAGED_TIME
    step = float(constants.AVERAGED_TIME)
    apart = max(1, round(step / interval))  # samples; slip is noisy from one to the next
    for name, most in AVERAGED_RANGE.items():
        values, samples = getattr(sweep, name)[rows], apart if name == "kappa" else 1
        change = np.abs(values[samples:] - values[:-samples]) / samples
        moved = float(np.median(change)) / interval if len(change) else 0.0
        if moved > 0.0:
            step = min(step, most / moved)
    size = max(1, round(step / interval))
    block = np.floor((time - time[0]) / (size * interval) + 1e-6)
    return np.r_[0, np.flatnonzero(np.diff(block)) + 1], size


def _begins(sizes: Sequence[int] | np.ndarray) -> np.ndarray:
    """Where each of successive blocks begins."""
    return np.cumsum(np.r_[0, sizes])[:-1].astype(int)


def _mean(values: np.ndarray, rows: np.ndarray, first: np.ndarray) -> np.ndarray:
    """Means (k,) over blocks of rows (m,), which begin at ``first`` (k,)."""
    if values.strides == (0,) or not len(first):  # not measured, or one value for all samples
        return np.broadcast_to(values[:1], first.shape)
    return np.asarray(np.add.reduceat(values[rows], first) / np.diff(np.r_[first, len(rows)]))


def _means(sweep: Sweep, phi_t: float, rows: np.ndarray, first: np.ndarray) -> Points:
    """Points from the means over blocks; of every text the first, and no time, so that they are read as finished points."""
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
    """Points from means by channel, and from the first samples for every other channel."""
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
