"""Points from means of a recording over its steady stretches and along its sweeps."""

from __future__ import annotations

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
    return _points(sweep, phi_t, {}, sweep.table, rows)


def over_plateaus(sweep: Sweep, phi_t: float, kept: list[Stretch], faulty: np.ndarray) -> Points:
    """Means over the stretches without faulty samples, with their standard errors if the file states none."""
    if not kept:
        return _no_points(sweep, phi_t)
    parts = [sound_rows(stretch, faulty) for stretch in kept]
    means = {
        name: np.array([np.mean(getattr(sweep, name)[part]) for part in parts]) for name in AVERAGED_CHANNELS
    }
    table = _averaged_table(sweep.table, parts)
    for channel in CHANNELS:
        values, u = getattr(sweep, channel), f"u_{channel}"
        if np.any(np.isfinite(values)):
            errors = errors_of_means([values[part] for part in parts])
            # A record without scatter does not show how exact it is.
            means[u] = np.where(np.isfinite(means[u]), means[u], np.where(errors > 0.0, errors, np.nan))
        table[u_column(channel)] = means[u]
    first = np.array([part[0] for part in parts])
    return _points(sweep, phi_t, means, table.dropna(axis="columns", how="all"), first)


def sound_rows(stretch: Stretch, faulty: np.ndarray) -> np.ndarray:
    """The samples (m,) of a stretch that are not ``faulty`` (n,)."""
    return np.flatnonzero(~faulty[stretch.begin : stretch.end]) + stretch.begin


def _averaged_table(table: pd.DataFrame, parts: list[np.ndarray]) -> pd.DataFrame:
    """Mean of every number and first of every text; without time, so that the rows are read as finished points."""
    averaged = {
        name: [
            column.iloc[part].mean() if pd.api.types.is_numeric_dtype(column) else column.iloc[part[0]]
            for part in parts
        ]
        for name, column in table.items()
        if name != "time_s"
    }
    return pd.DataFrame(averaged)


def along_sweeps(
    sweep: Sweep, phi_t: float, stretches: list[Stretch], labels: list[str], faulty: np.ndarray
) -> tuple[Points, np.ndarray]:
    """Means over short blocks of sweeps, without faulty samples; and the samples (m,) that they average."""
    if not stretches:
        return _no_points(sweep, phi_t), np.zeros(0, dtype=int)
    whole, begins, numbers, count = [], [], [], 0
    for k, stretch in enumerate(stretches):
        rows = sound_rows(stretch, faulty)
        first, size = _blocks(sweep, rows)
        enough = 2 * np.diff(np.r_[first, len(rows)]) >= size  # most of its samples
        whole.append(rows)
        begins.append(np.column_stack([first + count, enough]))
        numbers.append(np.full(len(first), k))
        count += len(rows)
    rows, blocks, number = np.concatenate(whole), np.concatenate(begins), np.concatenate(numbers)
    first, enough = blocks[:, 0], blocks[:, 1].astype(bool)
    counts = np.diff(np.r_[first, len(rows)])

    def mean(values: np.ndarray) -> np.ndarray:
        if values.strides == (0,):  # not measured, or one value for all samples
            return np.broadcast_to(values[:1], (int(enough.sum()),))
        return np.asarray((np.add.reduceat(values[rows], first) / counts)[enough])

    means = {name: mean(getattr(sweep, name)) for name in AVERAGED_CHANNELS}
    table = pd.DataFrame(
        {
            name: mean(column.to_numpy(dtype=float))
            if pd.api.types.is_numeric_dtype(column)
            else column.to_numpy()[rows[first[enough]]]
            for name, column in sweep.table.items()
            if name != "time_s"
        }
    )
    found = _points(sweep, phi_t, means, table, rows[first[enough]])
    found = found.replace(
        continuous=True, time=mean(sweep.time), sweep=number[enough], sweep_names=tuple(labels)
    )
    return found, rows[np.repeat(enough, counts.astype(int))]


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


def _no_points(sweep: Sweep, phi_t: float) -> Points:
    return rows_as_points(sweep, phi_t, np.zeros(0, dtype=int))


def _points(
    sweep: Sweep, phi_t: float, means: dict[str, np.ndarray], table: pd.DataFrame, first: np.ndarray
) -> Points:
    """Points from means by channel, and from the first samples for every other channel."""
    values: dict[str, Any] = {name: getattr(sweep, name)[first] for name in AVERAGED_CHANNELS} | means
    return make_points(
        **values,
        phi_t=phi_t,
        direction=sweep.direction[first],
        mount=sweep.mount,
        line=sweep.line[first],
        sweep_names=(sweep.name,),
        files=(sweep.file,),
        setups=(sweep.setup,),
        table=table.iloc[first] if len(table) != len(first) else table,
    )
