"""Recordings with steps of the sideslip angle: samples that show over which rolled distance the side force follows."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence

import numpy as np

from mffit.points import constants
from mffit.points.choice import settings_of
from mffit.points.lag import rolled_distance
from mffit.points.points import Points, concatenate, make_points
from mffit.points.steady import Scale, stretches
from mffit.points.stretch import PLATEAU, Stretch
from mffit.sweeps import Sweep


def steps(
    sweeps: Sequence[Sweep], phi_t: Mapping[str, float], radius: float, scale: Scale | None = None
) -> Points | None:
    """Samples of every run of steps between two held angles, each run a sweep with its times; None without any.

    Parameters
    ----------
    sweeps : files of the campaign
    phi_t : turn slip of the path [1/m], by file
    radius : unloaded radius [m], the size of relaxation lengths
    scale : usual size of the settings in the campaign
    """
    found = [
        _samples(sweep, phi_t[sweep.file], begin, end)
        for sweep in sweeps
        if sweep.is_series and np.any(np.isfinite(sweep.Fy)) and np.all(np.diff(sweep.time) > 0.0)
        for begin, end in _runs(sweep, radius, scale)
    ]
    return concatenate(found) if found else None


def _runs(sweep: Sweep, radius: float, scale: Scale | None) -> list[tuple[int, int]]:
    """First and last sample (excluded) of every run of steps."""
    if len(sweep) < 2 or not all(np.all(np.isfinite(x)) for x in settings_of(sweep)):
        return []
    rolled = rolled_distance(sweep.time, sweep.V)
    held = [s for s in stretches(settings_of(sweep), scale=scale) if s.kind == PLATEAU and not s.dropped]
    out: list[tuple[int, int]] = []
    for before, after in itertools.pairwise(held):
        if not _is_step(sweep, rolled, before, after, radius):
            continue
        if out and out[-1][1] == before.end:
            out[-1] = (out[-1][0], after.end)
        else:
            out.append((before.begin, after.end))
    return out


def _is_step(sweep: Sweep, rolled: np.ndarray, before: Stretch, after: Stretch, radius: float) -> bool:
    """Whether the angle goes from one plateau to the next at once, all else the same, and is held long enough after it."""
    rows = slice(before.begin, after.end)
    first, last = (float(np.median(sweep.alpha[s.begin : s.end])) for s in (before, after))
    if (
        abs(last - first) < constants.SMALLEST_STEP.rad
        or np.ptp(sweep.gamma[rows]) > constants.STEP_OF_ANGLE.rad
    ):
        return False
    if (
        np.any(np.diff(sweep.direction[rows]))
        or np.max(np.abs(sweep.kappa[rows])) > constants.FREE_ROLLING_SLIP
    ):
        return False
    load = sweep.Fz[rows]
    if np.ptp(load) > constants.LOAD_RANGE_OF_STEPS * np.mean(load):
        return False
    share = (sweep.alpha[rows] - first) / (last - first)
    leaves, arrives = int(np.argmax(share > 0.1)), len(share) - int(np.argmax(share[::-1] < 0.9)) - 1
    way = rolled[rows][arrives] - rolled[rows][leaves]
    spacing = float(np.median(np.diff(rolled[rows])))
    rest = rolled[after.end - 1] - rolled[rows][arrives]
    return bool(
        way <= constants.LONGEST_STEP * radius
        and 0.0 < spacing <= constants.LONGEST_STEP * radius
        and rest >= constants.SHORTEST_REST * radius
    )


def _samples(sweep: Sweep, phi_t: float, begin: int, end: int) -> Points:
    rows = slice(begin, end)
    names = ("p", "V", "T", "Fy", "direction", "line")
    return make_points(
        sweep.alpha[rows],
        sweep.gamma[rows],
        sweep.Fz[rows],
        sweep_names=(sweep.name,),
        files=(sweep.file,),
        phi_t=phi_t,
        time=sweep.time[rows],
        mount=sweep.mount,
        continuous=True,
        **{name: getattr(sweep, name)[rows] for name in names},
    )
