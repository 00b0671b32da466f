"""Time series to steady stretches: where the rig stood still long enough for its forces to settle.

Only the settings (angles, load, pressure, speed) decide where the rig stood still. What the forces do then
decides how much of a stretch is transient, and whether it ever came to rest.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import uniform_filter1d

from mffit.points.mean import mean_and_error
from mffit.points.stretch import MOVE, SWEEP, Stretch
from mffit.scatter import robust

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
"""A condition that rests for a greater part of its time is a staircase of plateaus with moves between them."""
SMALLEST_SWEEP = np.radians(3.0)
"""Range of an angle [rad] that makes its motion a sweep."""
GAP_STEPS, GAP = 5.0, 0.1
"""A gap in time: this many usual steps and this many seconds."""
SAMPLED = 20_000  # samples of a long recording that tell what is usual
SHARP = 0.1  # s, over which a setting is averaged to see where its change begins and ends
ANGLES, CONDITIONS = ("alpha", "gamma"), ("Fz", "p", "V")
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


def stretches(
    settings: Settings,
    point: np.ndarray | None = None,
    cuts: Sequence[int] = (),
    scale: Scale | None = None,
) -> list[Stretch]:
    """The stretches of a series in time order, transients included.

    Parameters
    ----------
    settings : of one series
    point : (n,) label of the point of every sample, "" between points; None finds the stretches from the
        settings
    cuts : samples before which something else begins, beside the gaps in time
    scale : usual size of each setting in the whole campaign; of this series if None

    Returns
    -------
    list of Stretch
        Plateaus, where all settings rest; sweeps, where one angle moves through its range and all else rests; and, with a
        reason, what is neither. Between plateaus the angle moves to the next one: that is no sweep.
    """
    n = len(settings.time)
    if point is not None:
        edges = np.flatnonzero(point[1:] != point[:-1]) + 1
        bounds = zip(np.r_[0, edges], np.r_[edges, n], strict=True)
        return [Stretch(int(begin), int(end)) for begin, end in bounds if point[begin] != ""]
    scale = scale or scale_of([settings])
    edges = np.unique(np.r_[0, gaps(settings.time), np.asarray(cuts, dtype=int), n])
    found: list[Stretch] = []
    for begin, end in itertools.pairwise(edges.tolist()):
        piece = Settings(*(x[begin:end] for x in settings))
        found += [
            s._replace(begin=s.begin + int(begin), end=s.end + int(begin)) for s in _of_piece(piece, scale)
        ]
    return found


def gaps(time: np.ndarray) -> np.ndarray:
    """Samples behind a gap in time."""
    steps = np.diff(time)
    if not len(steps):
        return np.zeros(0, dtype=int)
    return np.flatnonzero(steps > max(GAP_STEPS * float(np.median(steps)), GAP)) + 1


def _of_piece(settings: Settings, scale: Scale) -> list[Stretch]:
    """The stretches of a piece without gaps."""
    if len(settings.time) < 2:
        return [Stretch(0, len(settings.time), "only one sample", MOVE)]
    masks = moves(settings, scale)
    changing = masks.Fz | masks.p | masks.V
    found = []
    steady = _reaching(settings, scale, runs(~changing))
    changing = np.ones(len(settings.time), dtype=bool)
    for begin, end in steady:
        changing[begin:end] = False
    for begin, end in steady:
        part = Settings(*(x[begin:end] for x in settings))
        inside = _of_condition(part, masks.alpha[begin:end], masks.gamma[begin:end])
        found += [s._replace(begin=s.begin + begin, end=s.end + begin) for s in inside]
    found += [Stretch(begin, end, "load, pressure or speed changes", MOVE) for begin, end in runs(changing)]
    return sorted(found)


def _reaching(settings: Settings, scale: Scale, found: list[tuple[int, int]]) -> list[tuple[int, int]]:
    """Runs of one condition taken up to where it really begins and ends: a change shows ``LAG`` to either side of it."""
    n = len(settings.time)
    lag = _samples(settings, LAG)
    out = []
    smooth = {
        name: uniform_filter1d(getattr(settings, name), _samples(settings, SHARP), mode="nearest")
        for name in CONDITIONS
    }
    for k, (begin, end) in enumerate(found):
        least = found[k - 1][1] if k else 0
        most = found[k + 1][0] if k + 1 < len(found) else n
        least, most = max(least, begin - lag), min(most, end + lag)
        inside = np.ones(most - least, dtype=bool)
        for name, x in smooth.items():
            for a, b, c, d in (
                (least, begin, begin, min(begin + lag, end)),
                (end, most, max(end - lag, begin), end),
            ):
                step = STEP_SHARE * max(getattr(scale, name), abs(float(np.median(x[c:d]))))
                inside[a - least : b - least] &= np.abs(x[a:b] - np.median(x[c:d])) <= step
        before, behind = inside[: begin - least][::-1], inside[end - least :]
        begin -= len(before) if before.all() else int(np.argmin(before))
        end += len(behind) if behind.all() else int(np.argmin(behind))
        out.append((begin, end))
    return out


def _samples(settings: Settings, seconds: float) -> int:
    """How many samples that is, at least one."""
    n = len(settings.time)
    return int(np.clip(round(seconds / max(np.median(np.diff(settings.time)), 1e-9)), 1, max(n - 1, 1)))


def _of_condition(settings: Settings, alpha_moves: np.ndarray, gamma_moves: np.ndarray) -> list[Stretch]:
    """The stretches of a piece of constant load, pressure and speed."""
    resting = ~alpha_moves & ~gamma_moves
    rests = [Stretch(begin, end) for begin, end in runs(resting)]
    still = [rest for rest in rests if not _creeps(settings, rest)]
    held = sum(settings.time[s.end - 1] - settings.time[s.begin] for s in still)
    staircase = held >= HOLDING_SHARE * np.ptp(settings.time)
    long = [s for s in still if settings.time[s.end - 1] - settings.time[s.begin] >= SHORTEST]
    covered = np.zeros(len(settings.time), dtype=bool)
    for rest in still if staircase else long:
        covered[rest.begin : rest.end] = True
    found = list(still if staircase else long)
    for begin, end in runs(~covered):
        found += _swept(settings, gamma_moves, begin, end, staircase)
    return found


def _swept(
    settings: Settings, gamma_moves: np.ndarray, begin: int, end: int, staircase: bool
) -> list[Stretch]:
    """What a moving piece is: sweeps of one angle, or the way between plateaus."""
    found: list[Stretch] = []
    for values, held in ((settings.alpha, ~gamma_moves), (settings.gamma, None)):
        if held is None:
            whole = (
                not any(s.kind == SWEEP for s in found) and np.ptp(settings.alpha[begin:end]) < SMALLEST_SWEEP
            )
            parts = [(begin, end)] if whole else []
        else:
            parts = [(begin + b, begin + e) for b, e in runs(held[begin:end])]
        for b, e in parts:
            x = values[b:e]
            enough = settings.time[e - 1] - settings.time[b] >= SHORTEST and np.ptp(x) >= SMALLEST_SWEEP
            if enough and (not staircase or _returns(x)):
                found.append(Stretch(b, e, "", SWEEP))
    taken = np.zeros(end - begin, dtype=bool)
    for s in found:
        taken[s.begin - begin : s.end - begin] = True
    found += [Stretch(begin + b, begin + e, "moves between set-points", MOVE) for b, e in runs(~taken)]
    return found


def _returns(x: np.ndarray) -> bool:
    """Whether an angle goes a good part of its way back."""
    far = max(x.max() - max(x[0], x[-1]), min(x[0], x[-1]) - x.min())
    return bool(far > 0.3 * np.ptp(x))


def runs(mask: np.ndarray) -> list[tuple[int, int]]:
    """Begin and end (excluded) of every run of a mask (n,)."""
    edges = np.flatnonzero(np.diff(np.r_[False, mask, False].astype(np.int8)))
    return [(int(begin), int(end)) for begin, end in zip(edges[::2], edges[1::2], strict=True)]


class Scale(NamedTuple):
    """Usual size of each setting in a recording."""

    alpha: float
    gamma: float
    Fz: float
    p: float
    V: float


def scale_of(series: Sequence[Settings]) -> Scale:
    """Median size of each setting, of a sample of long recordings."""
    some = max(sum(len(settings.time) for settings in series) // SAMPLED, 1)
    sizes = (np.abs(np.concatenate([getattr(s, name)[::some] for s in series])) for name in Scale._fields)
    return Scale(
        *(float(np.median(size[np.isfinite(size)])) if np.isfinite(size).any() else 0.0 for size in sizes)
    )


class Moves(NamedTuple):
    """Masks (n,) of the samples within ``LAG`` of a change of each setting."""

    alpha: np.ndarray
    gamma: np.ndarray
    Fz: np.ndarray
    p: np.ndarray
    V: np.ndarray


def moves(settings: Settings, scale: Scale | None = None) -> Moves:
    """Where each setting changes.

    Parameters
    ----------
    settings : of a series without gaps
    scale : usual size of each setting in the whole recording; of this series if None
    """
    n = len(settings.time)
    scale = scale or scale_of([settings])
    lag = _samples(settings, LAG)
    masks = {}
    for name in Moves._fields:
        values = getattr(settings, name)
        usual = max(getattr(scale, name), float(np.median(np.abs(values))))
        step = STEP_ANGLE if name in ANGLES else STEP_SHARE * usual
        mask = np.zeros(n, dtype=bool)
        if np.ptp(values) > 0.0:
            smooth = uniform_filter1d(values, lag, mode="nearest")
            change = np.abs(smooth[lag:] - smooth[:-lag]) > max(step, 6.0 * _noise(values) / np.sqrt(lag))
            mask[lag:] |= change
            mask[:-lag] |= change
        masks[name] = mask
    return Moves(**masks)


def moving(settings: Settings) -> np.ndarray:
    """Mask (n,) of the samples within ``LAG`` of a change of a setting."""
    return np.logical_or.reduce(moves(settings))


def _noise(values: np.ndarray) -> float:
    """Standard deviation of a setting's noise, from the median step between samples."""
    return robust(np.diff(values)) / math.sqrt(2.0) if len(values) > 1 else 0.0


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
