"""Time series to steady stretches: where the rig stood still long enough for its forces to settle.

Only the settings (angles, load, pressure, speed) decide where the rig stood still. What the forces do then
decides how much of a stretch is transient, and whether it ever came to rest.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from mffit.points.mean import mean_and_error

STEP_ANGLE = np.radians(0.15)
"""Change of an angle within a stretch [rad]; a logger's noise is below, a set-point's step above."""
STEP_SHARE = 0.08
"""Relative change of load, pressure or speed that makes another set-point."""
LAG = 0.5  # s, over which settings are compared
SHORTEST = 2.0  # s, of what is left after the transient
FEWEST = 8  # samples of it
TRANSIENT_ROLL = 2.0
"""Rolling distance [m] that is always dropped behind a change: three to ten relaxation lengths."""
HOLDING_SHARE = 0.5
"""A series that rests for a smaller part of its time is a continuous sweep."""
BLOCKS = 10
LEADING_BLOCK = 3.5
"""A leading block this many of its standard errors away from the second half belongs to the transient."""
DRIFT = 6.0
"""Standard errors of the change over a stretch that prove a drift."""


class Settings(NamedTuple):
    """What the rig was told to do, sample by sample (n,)."""

    time: np.ndarray  #: [s], rising
    alpha: np.ndarray  #: [rad]
    gamma: np.ndarray  #: [rad]
    Fz: np.ndarray  #: [N]
    p: np.ndarray  #: [Pa]
    V: np.ndarray  #: [m/s]


class Stretch(NamedTuple):
    """Samples ``begin`` to ``end`` (excluded); ``dropped`` says why they give no point, empty if they do."""

    begin: int
    end: int
    dropped: str = ""


def stretches(settings: Settings, point: np.ndarray | None = None) -> list[Stretch]:
    """The stretches at constant settings, in time order, transients included; empty for a continuous sweep.

    Parameters
    ----------
    settings : of one series
    point : (n,) label of the point of every sample, "" between points; None finds the stretches from the
        settings
    """
    n = len(settings.time)
    if point is not None:
        edges = np.flatnonzero(point[1:] != point[:-1]) + 1
        resting = point != ""
    else:
        resting = ~moving(settings)
        edges = np.flatnonzero(np.diff(resting.astype(int))) + 1
    bounds = zip(np.r_[0, edges], np.r_[edges, n], strict=True)
    found = [Stretch(int(begin), int(end)) for begin, end in bounds if resting[begin]]
    if point is not None:
        return found
    found = [stretch for stretch in found if not _creeps(settings, stretch)]
    held = sum(settings.time[s.end - 1] - settings.time[s.begin] for s in found)
    return found if held >= HOLDING_SHARE * np.ptp(settings.time) else []


def moving(settings: Settings) -> np.ndarray:
    """Mask (n,) of the samples within ``LAG`` of a change of a setting."""
    n = len(settings.time)
    lag = int(np.clip(round(LAG / max(np.median(np.diff(settings.time)), 1e-9)), 1, max(n - 1, 1)))
    mask = np.zeros(n, dtype=bool)
    for values, step in (
        (settings.alpha, STEP_ANGLE),
        (settings.gamma, STEP_ANGLE),
        *((x, STEP_SHARE * float(np.median(np.abs(x)))) for x in (settings.Fz, settings.p, settings.V)),
    ):
        smooth = uniform_filter1d(values, lag, mode="nearest")
        change = np.abs(smooth[lag:] - smooth[:-lag]) > max(step, 6.0 * _noise(values) / np.sqrt(lag))
        mask[lag:] |= change
        mask[:-lag] |= change
    return mask


def _noise(values: np.ndarray) -> float:
    """Standard deviation of a setting's noise, from the median step between samples."""
    return float(1.4826 * np.median(np.abs(np.diff(values))) / np.sqrt(2.0)) if len(values) > 1 else 0.0


def _creeps(settings: Settings, stretch: Stretch) -> bool:
    """Whether an angle moves so slowly through the stretch that no single step shows."""
    quarter = max((stretch.end - stretch.begin) // 4, 1)
    for values in (settings.alpha, settings.gamma):
        part = values[stretch.begin : stretch.end]
        if abs(float(np.mean(part[-quarter:]) - np.mean(part[:quarter]))) > STEP_ANGLE:
            return True
    return False


def settled(
    stretch: Stretch, settings: Settings, responses: Sequence[tuple[np.ndarray, float, str]]
) -> Stretch:
    """The stretch without its transient, or with the reason why it gives no point.

    Parameters
    ----------
    stretch : samples at constant settings
    settings : of the series
    responses : for each measured force or moment the samples (n,), the drift over a stretch that does not
        matter, and
        its unit
    """
    time = settings.time
    speed = max(float(np.median(settings.V[stretch.begin : stretch.end])), 0.1)
    begin = stretch.begin
    if begin > 0:
        begin = int(np.searchsorted(time, time[begin] + TRANSIENT_ROLL / speed))
    short = _too_short(time, begin, stretch.end)
    if short:
        return stretch._replace(dropped=short)
    begin = max(begin + _transient(x[begin : stretch.end]) for x, _, _ in responses)
    short = _too_short(time, begin, stretch.end)
    if short:
        return stretch._replace(dropped=short)
    for x, harmless, unit in responses:
        drift, error = _drift(x[begin : stretch.end])
        if abs(drift) > max(DRIFT * error, harmless):
            return stretch._replace(dropped=f"still drifting by {drift:.3g} {unit}")
    return Stretch(begin, stretch.end)


def _too_short(time: np.ndarray, begin: int, end: int) -> str:
    if end - begin < FEWEST:
        return f"only {max(end - begin, 0)} samples after the transient"
    seconds = time[end - 1] - time[begin]
    return f"only {seconds:.1f} s steady" if seconds < SHORTEST else ""


def _transient(x: np.ndarray) -> int:
    """Number of leading samples that differ from what the second half settles at; at most half of them."""
    edges = np.linspace(0, len(x), BLOCKS + 1).astype(int)
    level, error = mean_and_error(x[edges[BLOCKS // 2] :])
    error *= np.sqrt(BLOCKS / 2.0 + 1.0)  # of one block against half of them all
    for block in range(BLOCKS // 2):
        if not abs(float(np.mean(x[edges[block] : edges[block + 1]])) - level) > LEADING_BLOCK * error:
            return int(edges[block])
    return int(edges[BLOCKS // 2])


def _drift(x: np.ndarray) -> tuple[float, float]:
    """Change over the record along a straight line, and its standard error.

    The line leaves residuals of the same noise as a steady record; a slope over equidistant samples is known
    sqrt(12) times less well, over the record, than their mean.
    """
    time = np.linspace(-0.5, 0.5, len(x))
    change = float(np.dot(time, x) / np.dot(time, time))
    _, error = mean_and_error(x - change * time)
    return change, float(np.sqrt(12.0)) * error
