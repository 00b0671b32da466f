"""Times of samples: correction of rounded times, the common clock of several recordings; distance rolled, sense of a sweep."""

import itertools
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import LEAST_SHARE_OF_A_SENSE, SAME_SIDESLIP
from mffit.points.points import Points
from mffit.sweeps import Sweep


def evenly_timed(sweep: Sweep) -> tuple[Sweep, tuple[str, ...]]:
    """The series with samples of equal time spread over the interval to the next time, and a sentence about it."""
    time = spread(sweep.time) if sweep.is_series and len(sweep) > 1 else sweep.time
    if time is sweep.time:
        return sweep, ()
    repeated = np.flatnonzero(np.diff(sweep.time) == 0.0) + 1
    place = f"{sweep.file}:{int(sweep.line[repeated[0]])}"
    sentence = f"{place}: {len(repeated)} of {len(sweep)} samples have the time of the one before; they are spread evenly"
    return replace(sweep, time=time), (sentence,)


def spread(time: np.ndarray) -> np.ndarray:
    """Times (n,) with equal ones spread evenly up to the next time; the same array if none are equal, or if time falls."""
    steps = np.diff(time)
    if not np.any(steps == 0.0) or np.any(steps < 0.0) or not np.any(steps > 0.0):
        return time
    first = np.r_[0, np.flatnonzero(steps > 0.0) + 1]
    counts = np.diff(np.r_[first, len(time)])
    distinct = time[first]
    step = np.minimum(np.r_[np.diff(distinct), np.inf], np.median(np.diff(distinct)))
    within = np.arange(len(time)) - np.repeat(first, counts)
    return np.asarray(np.repeat(distinct, counts) + within * np.repeat(step / counts, counts))


def with_common_clock(sweeps: Sequence[Sweep]) -> list[Sweep]:
    """The series with the time since the first sample of all as ``t``, if they share a clock, that is if none overlap."""
    begins = sorted((sweep.time[0], sweep.time[-1]) for sweep in sweeps if sweep.is_series and len(sweep))
    if len(begins) < len(sweeps) or any(one[1] > next_[0] for one, next_ in itertools.pairwise(begins)):
        return list(sweeps)
    return [
        sweep if np.any(np.isfinite(sweep.t)) else replace(sweep, t=sweep.time - begins[0][0])
        for sweep in sweeps
    ]


def rolled_distance(time: np.ndarray, V: np.ndarray) -> np.ndarray:
    """Distance (n,) rolled since the first sample [m], at speeds ``V`` (n,)."""
    return np.asarray(np.r_[0.0, np.cumsum(np.diff(time) * 0.5 * (V[1:] + V[:-1]))])


def sense(points: Points) -> np.ndarray:
    """Sense (n,) of the sideslip's motion along its sweep: 1 up, -1 down, 0 held."""
    out = np.zeros(len(points))
    for rows in points.rows_of_sweeps.values():
        if len(rows) > 1:
            moving = np.gradient(points.alpha[rows])
            out[rows] = np.where(np.abs(moving) > SAME_SIDESLIP.rad, np.sign(moving), 0.0)
    return out


def goes_both_ways(way: np.ndarray) -> bool:
    """Whether both senses, 1 and -1, have their share of the moving points ``way`` (n,)."""
    return bool(abs(np.mean(way)) < 1.0 - 2.0 * LEAST_SHARE_OF_A_SENSE)
