"""Where the forces of a plateau have settled: the transient is cut off, and a drifting plateau is dropped."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from mffit.points import constants
from mffit.points.mean import mean_and_error
from mffit.points.steady import SteadySettings
from mffit.points.stretch import Stretch


def settled(
    stretch: Stretch, settings: SteadySettings, responses: Sequence[tuple[np.ndarray, float, str]]
) -> Stretch:
    """The stretch without its transient, or with the reason why it gives no point.

    ``responses`` has, for each measured force or moment, the samples (n,), the harmless drift over a stretch, and its unit.
    """
    time = settings.time
    speed = max(float(np.median(settings.V[stretch.begin : stretch.end])), constants.SLOWEST_ROLLING)
    begin = stretch.begin
    if begin > 0:
        begin = int(np.searchsorted(time, time[begin] + constants.TRANSIENT_ROLL / speed))
    short = _too_short(time, begin, stretch.end)
    if short:
        return stretch._replace(dropped=short)
    begin = max(begin + _transient(x[begin : stretch.end]) for x, _, _ in responses)
    short = _too_short(time, begin, stretch.end)
    if short:
        return stretch._replace(dropped=short)
    for x, harmless, unit in responses:
        drift, error = _drift(x[begin : stretch.end])
        if abs(drift) > max(constants.PROVEN_DRIFT * error, harmless):
            return stretch._replace(dropped=f"still drifting by {drift:.3g} {unit}")
    return Stretch(begin, stretch.end)


def _too_short(time: np.ndarray, begin: int, end: int) -> str:
    if end - begin < constants.FEWEST_SAMPLES_OF_STRETCH:
        return f"only {max(end - begin, 0)} samples after the transient"
    seconds = time[end - 1] - time[begin]
    return f"only {seconds:.1f} s steady" if seconds < constants.SHORTEST_STRETCH else ""


def _transient(x: np.ndarray) -> int:
    """Number of leading samples that differ from the mean of the second half; at most half of all samples."""
    blocks = min(constants.BLOCKS_OF_STRETCH, len(x))
    half = blocks // 2
    edges = np.linspace(0, len(x), blocks + 1).astype(int)
    level, error = mean_and_error(x[edges[half] :])
    error *= np.sqrt(blocks / 2.0 + 1.0)  # of the difference between one block and the second half
    for block in range(half):
        away = abs(float(np.mean(x[edges[block] : edges[block + 1]])) - level)
        if not away > constants.LEADING_BLOCK * error:
            return int(edges[block])
    return int(edges[half])


def _drift(x: np.ndarray) -> tuple[float, float]:
    """Change over the record along a straight line, and its standard error.

    The residuals of the line have the noise of a steady record. The standard error of the change over equidistant
    samples is sqrt(12) times that of their mean.
    """
    time = np.linspace(-0.5, 0.5, len(x))
    change = float(np.dot(time, x) / np.dot(time, time))
    _, error = mean_and_error(x - change * time)
    return change, float(np.sqrt(12.0)) * error
