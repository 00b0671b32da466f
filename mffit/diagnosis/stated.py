"""The noise stated with the readings, or estimated from neighbouring points if none is stated."""

from __future__ import annotations

from collections.abc import Collection, Iterable

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.noise import MemorySpan, Noise, Origin, Scatter
from mffit.errors import InputError
from mffit.fit.weights import stated_or_nominal
from mffit.points import Points
from mffit.points.constants import GAP_OVER_STEP
from mffit.points.noise import neighbour_noise
from mffit.quantities import CHANNELS, SIDEWAYS, u_column
from mffit.rig import Simulation
from mffit.scatter import rms

TINY = 1e-9


def with_uncertainties(
    points: Points, state: Simulation, channels: Collection[str] = SIDEWAYS
) -> tuple[Points, Origin | None]:
    """The points with a standard uncertainty for every reading of some channels, and its origin for Fy.

    Missing uncertainties are estimated from the scatter of measured minus simulated between neighbouring points of each sweep.
    If all stated uncertainties are zero, an InputError asks for real ones.
    """
    found, origins = {}, {}
    for name, simulated in state.readings(points, channels).items():
        found[name], origins[name] = _of_channel(
            points, points.channel(name), points.u(name), simulated, u_column(name)
        )
    return points.replace(**{f"u_{name}": u for name, u in found.items()}), origins.get("Fy")


def stated_noise(points: Points, origin: Origin | None = None, channels: Iterable[str] = SIDEWAYS) -> Noise:
    """The stated independent noise of some channels, with the chains along which errors may be correlated."""
    scatter = {name: Scatter() for name in CHANNELS if name in set(channels)}
    unsettled = _first_of_a_moving_sweep(points)
    u = np.concatenate([np.where(unsettled, np.inf, points.u(name)) for name in scatter])
    sweeps = 1 + int(points.sweep.max(initial=0))
    chain = np.concatenate([points.sweep + k * sweeps for k in range(len(scatter))])
    order, longer = _in_time(points)
    turn = np.empty(len(u), dtype=int)
    for k, known in enumerate(np.split(np.isfinite(u), len(scatter))):
        turn[k * len(points) + order] = np.cumsum(known[order]) - 1  # among the readings of the channel
    tiled = {span: np.tile(chain, len(scatter)) for span, chain in longer.items()}
    return Noise(u=u, stated=u, chain=chain, origin=origin, scatter=scatter, longer=tiled, turn=turn)


def _first_of_a_moving_sweep(points: Points) -> np.ndarray:
    """Mask (n,) of the first reading of every continuous sweep: how far the tyre lagged there depends on what was before."""
    first = np.zeros(len(points), dtype=bool)
    first[np.unique(points.sweep, return_index=True)[1]] = True
    return first & points.continuous


def _in_time(points: Points) -> tuple[np.ndarray, dict[MemorySpan, np.ndarray]]:
    """Order (n,) in which the points were taken, and uninterrupted chains (n,) longer than a sweep.

    The order follows from the times or, if times are unknown, from the lines of the files.
    """
    when = np.where(np.isfinite(points.t), points.t, points.time)
    timed = bool(np.all(np.isfinite(when)))
    when = when if timed else np.zeros(len(points))
    begin = np.array([when[points.file == k].min(initial=np.inf) for k in range(len(points.files))])
    order = np.lexsort((points.line, when, points.file, begin[points.file]))
    step, next_file = np.diff(when[order]), np.diff(points.file[order]) != 0
    pause = np.zeros(len(step), dtype=bool)
    if timed and np.any(step > 0.0):
        pause = (step < 0.0) | (step > GAP_OVER_STEP * np.median(step[step > 0.0]))
    spans = {MemorySpan.FILE: pause | next_file}
    if timed and len(points.files) > 1:
        spans[MemorySpan.PROGRAMME] = pause
    chains = {span: np.empty(len(points), dtype=int) for span in spans}
    for span, begins in spans.items():
        chains[span][order] = np.append(0, np.cumsum(begins))
    return order, chains


def _of_channel(
    points: Points, values: np.ndarray, stated: np.ndarray, simulated: np.ndarray, column: str
) -> tuple[np.ndarray, Origin | None]:
    """Standard uncertainty (n,) of one channel, inf where it was not measured; and its origin.

    A small lower limit keeps readings without noise recognisable.
    """
    measured = np.isfinite(values)
    if not np.any(measured):
        return np.full(len(points), np.inf), None
    least = max(constants.NO_NOISE_SHARE * rms(values[measured]), TINY)
    known = measured & np.isfinite(stated)
    if np.any(known) and np.all(stated[known] <= 0.0):
        raise InputError(
            f"all {column} are zero; give real standard uncertainties, or leave the column out", column=column
        )
    if np.all(known[measured]):
        floor = constants.LEAST_STATED_NOISE_SHARE * np.median(stated[known][stated[known] > 0])
        return np.where(measured, np.maximum(stated, max(floor, least)), np.inf), Origin.STATED
    off = values - simulated
    u = stated_or_nominal(np.where(known, np.maximum(stated, least), neighbour_noise(points, off)), off)
    return np.where(measured, np.maximum(u, least), np.inf), Origin.SCATTER
