"""Division of time series into stretches: plateaus, and sweeps of one angle or of the longitudinal slip.

The division uses only the settings (angles, slip, load, pressure, speed). Later, :mod:`mffit.points.choice` uses the forces to
remove transients and to drop plateaus that never settle.
"""

import itertools
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts are loaded on first use

from mffit.constants import FALSE_ALARM, MOST, STRAIGHT, UPRIGHT
from mffit.points import constants
from mffit.points.stretch import MOVE, SWEEP, Stretch, runs
from mffit.scatter import bends, beyond, finite_median, robust

CONDITIONS = ("Fz", "p", "V")
STEP = {
    "alpha": constants.STEP_OF_ANGLE.rad,
    "gamma": constants.STEP_OF_ANGLE.rad,
    "kappa": float(constants.SLIP),
}
"""Settings that a rig sweeps, in the order of the search, and the smallest change to another set-point."""
LEVEL = {"alpha": STRAIGHT.rad, "gamma": UPRIGHT.rad, "kappa": float(constants.SLIP)}
"""Readings of each setting within which it is one level."""
OTHERS = {"alpha": ("gamma", "kappa"), "gamma": ("kappa",), "kappa": ("alpha", "gamma")}
"""The settings that must rest in a sweep of a setting. Sideslip may follow camber, as on rigs that steer about another axis."""
Scale = Mapping[str, float]
"""Usual size of each setting in a recording."""


class SteadySettings(NamedTuple):
    """Set-points as the rig reports them, sample by sample (n,)."""

    time: np.ndarray  #: [s], rising
    alpha: np.ndarray  #: [rad]
    gamma: np.ndarray  #: [rad]
    Fz: np.ndarray  #: [N]
    p: np.ndarray  #: [Pa]
    V: np.ndarray  #: [m/s]
    kappa: np.ndarray  #: [-]; 0 where the wheel rolls freely


def stretches(
    settings: SteadySettings,
    point: np.ndarray | None = None,
    cuts: Sequence[int] = (),
    scale: Scale | None = None,
) -> list[Stretch]:
    """The stretches of a series in time order: plateaus, where all settings rest; sweeps, where one angle or the slip moves
    through its range and all else rests; and moves, which are neither, with the reason, such as the change of an angle
    between plateaus.

    ``point`` (n,) is the label of the point of every sample, "" between points; None: the settings decide. A stretch begins at
    the samples ``cuts``, too. ``scale`` is the usual size of each setting in the whole campaign; None: that of this series.
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
        piece = SteadySettings(*(x[begin:end] for x in settings))
        found += [
            s._replace(begin=s.begin + int(begin), end=s.end + int(begin)) for s in _of_piece(piece, scale)
        ]
    return found


def gaps(time: np.ndarray) -> np.ndarray:
    """Indices of the first samples after gaps in time."""
    steps = np.diff(time)
    if not len(steps):
        return np.zeros(0, dtype=int)
    shortest = max(constants.GAP_OVER_STEP * float(np.median(steps)), constants.AVERAGED_TIME)
    return np.flatnonzero(steps > shortest) + 1


def _of_piece(settings: SteadySettings, scale: Scale) -> list[Stretch]:
    """The stretches of a part without gaps."""
    if len(settings.time) < 2:
        return [Stretch(0, len(settings.time), "only one sample", MOVE)]
    masks = moves(settings, scale)
    changing = _load_changes(settings, masks["Fz"]) | masks["p"] | masks["V"]
    found = []
    for begin, end in runs(~changing):
        part = SteadySettings(*(x[begin:end] for x in settings))
        inside = _of_condition(part, {name: masks[name][begin:end] for name in STEP})
        found += [s._replace(begin=s.begin + begin, end=s.end + begin) for s in inside]
    found += [Stretch(begin, end, "load, pressure or speed changes", MOVE) for begin, end in runs(changing)]
    return sorted(found)


def _load_changes(settings: SteadySettings, moving: np.ndarray) -> np.ndarray:
    """Mask (n,) of the samples in which the load goes to another set-point, of those in which it is ``moving`` (n,).

    Any other movement is a profile, which all readings follow. Before and after the middle of its movement, the mean loads
    differ by the whole range in a step between rests, by half of it along an even ramp, by little where the load turns back: a
    change of set-point is nearer to the step.
    """
    smooth, changing, wanders = _smoothed(settings, "Fz")[0], moving.copy(), moving.copy()
    rest = samples_in(settings.time, _shortest_plateau(settings))
    for begin, end in runs(~moving):
        wanders[begin:end] = end - begin < rest
    for begin, end in runs(wanders):
        if not np.any(moving[begin:end]):
            continue
        first, middle = max(begin - rest, 0), begin + int(np.median(np.flatnonzero(moving[begin:end])))
        apart = abs(float(np.mean(smooth[middle : end + rest]) - np.mean(smooth[first : middle + 1])))
        if apart < 0.5 * (1.0 + 0.5) * np.ptp(smooth[first : end + rest]):
            changing[begin:end] = False
    return changing


def samples_in(time: np.ndarray, seconds: float) -> int:
    """Number of samples of a series (n,) in a time [s], at least one."""
    n = len(time)
    if n < 2:
        return 1
    return int(np.clip(round(seconds / max(np.median(np.diff(time)), 1e-9)), 1, n - 1))


def _of_condition(settings: SteadySettings, moving: Mapping[str, np.ndarray]) -> list[Stretch]:
    """The stretches of a part at constant load, pressure and speed; ``moving`` has a mask (n,) for every swept setting."""
    creeping = _creeps(settings, ~np.any(list(moving.values()), axis=0))
    resting = ~np.any([*moving.values(), *creeping.values()], axis=0)
    rests = _with_their_ends(settings, runs(resting))
    held = [settings.time[s.end - 1] - settings.time[s.begin] for s in rests]
    # The rig rests most of the time, or hurries to where it settles and then rests.
    rests_long = 2 * sum(seconds >= _shortest_plateau(settings, roll=True) for seconds in held) > len(held)
    staircase = 2.0 * sum(held) >= np.ptp(settings.time) or (rests_long and _hurries(settings))
    # Between plateaus a movement is a sweep only if it covers most of its setting's range; else it leads to the next plateau.
    span = {name: MOST * np.ptp(_smoothed(settings, name)[0]) if staircase else 0.0 for name in STEP}
    # The forces of a rest shorter than their transient never settle: it is part of a movement.
    shortest = _transient(settings) if staircase else _shortest_plateau(settings)
    found = [
        _with_its_load(settings, s) for s, seconds in zip(rests, held, strict=True) if seconds >= shortest
    ]
    covered = np.zeros(len(settings.time), dtype=bool)
    for rest in found:
        covered[rest.begin : rest.end] = True
    for begin, end in runs(~covered):
        found += _swept(settings, moving, creeping, begin, end, span)
    return found


def _hurries(settings: SteadySettings) -> bool:
    """Whether the way of all settings is made in a small part of the time.

    A rig that settles at each set-point seems to move for long, but hardly does; in a sweep, the way takes the time.
    """
    lag = samples_in(settings.time, constants.COMPARED_APART)
    made = np.sum(
        [np.abs(np.diff(_smoothed(settings, name)[0][::lag])) / step for name, step in STEP.items()], axis=0
    )
    return bool(np.sum(made) ** 2 <= MOST * len(made) * np.sum(made**2))


def _with_their_ends(settings: SteadySettings, rests: Sequence[tuple[int, int]]) -> list[Stretch]:
    """Plateaus from rests, each to where a setting leaves its level.

    A movement was found between times apart, which takes from the rests beside it, and all of a short one.
    """
    short = samples_in(settings.time, constants.AVERAGED_TIME)
    compared = samples_in(settings.time, constants.COMPARED_APART)
    taken = compared + compared // 2  # and half of a mean over it
    values = {
        name: scipy.ndimage.uniform_filter1d(getattr(settings, name), short, mode="nearest") for name in STEP
    }
    n = len(settings.time)
    clear = beyond(FALSE_ALARM / n) * np.sqrt(2.0 / short)
    tolerance = {
        name: clear * _noise(getattr(settings, name)) + n * np.spacing(np.max(np.abs(smooth), initial=0.0))
        for name, smooth in values.items()
    }
    found: list[Stretch] = []
    for k, (begin, end) in enumerate(rests):
        lowest = max(found[-1].end if found else 0, begin - taken)
        highest = min(rests[k + 1][0] if k + 1 < len(rests) else n, end + taken)
        away = np.zeros(highest - lowest, dtype=bool)
        for name, smooth in values.items():
            away |= np.abs(smooth[lowest:highest] - np.median(smooth[begin:end])) > tolerance[name]
        left, right = np.flatnonzero(away[: begin - lowest]), np.flatnonzero(away[end - lowest :])
        found.append(
            Stretch(
                lowest + int(left[-1]) + 1 if len(left) else lowest,
                end + int(right[0]) if len(right) else highest,
            )
        )
    return found


def _with_its_load(settings: SteadySettings, rest: Stretch) -> Stretch:
    """A rest of the angles and the slip, as a sweep of the load if the load is not held."""
    load = _smoothed(settings, "Fz")[0][rest.begin : rest.end]
    wanders = len(load) > 0 and np.ptp(load) > constants.HELD_LOAD * np.median(load)
    return rest._replace(kind=SWEEP, swept="Fz") if wanders else rest


def _shortest_plateau(settings: SteadySettings, *, roll: bool = False) -> float:
    """Time [s] of a rest between movements, transient included, below which it is part of the sweep around it.

    ``roll``: or below which it gives no point, because the wheel does not roll far enough either.
    """
    transient = _transient(settings)
    return min(constants.SHORTEST_STRETCH, transient if roll and transient else np.inf) + transient


def _transient(settings: SteadySettings) -> float:
    """Time [s] in which the forces settle after a change; 0 at standstill, where nothing rolls."""
    speed = float(np.median(settings.V))
    return constants.TRANSIENT_ROLL / speed if speed > 0.0 else 0.0


def _swept(
    settings: SteadySettings,
    moving: Mapping[str, np.ndarray],
    creeping: Mapping[str, np.ndarray],
    begin: int,
    end: int,
    span: Mapping[str, float],
) -> list[Stretch]:
    """Sweeps of one setting over at least its ``span`` in a moving part; the remaining samples are moves between plateaus.

    Meanwhile the others may drift, by fewer of their steps.
    """
    found: list[Stretch] = []
    smooth = {name: _smoothed(settings, name)[0] for name in STEP}
    for name, others in OTHERS.items():
        rests = ~np.any([moving[other][begin:end] for other in others], axis=0)
        for s in found:
            rests[s.begin - begin : s.end - begin] = False
        for b, e in ((begin + b, begin + e) for b, e in runs(rests)):
            ranges = {each: float(np.ptp(smooth[each][b:e])) for each in STEP}
            steps = {
                each: ranges[each] / STEP[each]
                for each in (name, *others)
                if np.any(moving[each][b:e] | creeping[each][b:e])
            }
            if name not in steps or steps[name] < max(steps.values()):
                continue
            follows = name == "gamma" and ranges["alpha"] > MOST * ranges["gamma"]
            if ranges[name] >= span[name] and not follows and _lasts(settings, smooth[name], b, e):
                found += [Stretch(i, j, "", SWEEP, name) for i, j in _without_jumps(settings, name, b, e)]
    taken = np.zeros(end - begin, dtype=bool)
    for s in found:
        taken[s.begin - begin : s.end - begin] = True
    found += [Stretch(begin + b, begin + e, "moves between set-points", MOVE) for b, e in runs(~taken)]
    return found


def _lasts(settings: SteadySettings, smooth: np.ndarray, begin: int, end: int) -> bool:
    """Whether a movement is more than a move to another set-point: it lasts, or turns back long enough for forces to follow.

    A rig goes to its next set-point at once, but by the shortest way.
    """
    seconds = settings.time[end - 1] - settings.time[begin]
    if seconds >= constants.SHORTEST_STRETCH:
        return True
    rolled = seconds * float(np.median(settings.V[begin:end]))
    away = abs(smooth[end - 1] - smooth[begin])
    turns = away <= (1.0 - MOST) * np.ptp(smooth[begin:end])
    return bool(turns and rolled >= 2.0 * constants.TRANSIENT_ROLL and end - begin >= constants.FEWEST_POINTS)


def _without_jumps(settings: SteadySettings, name: str, begin: int, end: int) -> list[tuple[int, int]]:
    """The parts of a sweep between jumps of its setting, as a sawtooth has, in which the force does not follow.

    In a jump the setting would cross its range in less than a second, and moves much faster than usual in this sweep.
    """
    values = getattr(settings, name)[begin:end]
    lag = samples_in(settings.time, constants.AVERAGED_TIME)
    smooth = scipy.ndimage.uniform_filter1d(values, lag, mode="nearest")
    most = MOST * np.ptp(smooth)
    crossed = most * constants.AVERAGED_TIME / constants.COMPARED_APART
    usual = constants.GAP_OVER_STEP * float(np.median(np.abs(smooth[lag:] - smooth[:-lag])))
    noise = beyond(FALSE_ALARM / len(values)) * _noise(values) * np.sqrt(2.0 / lag)
    jumps = _changes(smooth, max(crossed, usual, noise), lag)
    return [(begin + b, begin + e) for b, e in runs(~jumps) if np.ptp(smooth[b:e]) >= most]


def scale_of(series: Sequence[SteadySettings]) -> Scale:
    """Median absolute value of each setting; 0 if it is unknown. Empty without a series."""
    every = {name: [getattr(one, name) for one in series] for name in (*STEP, *CONDITIONS) if series}
    return {name: float(np.nan_to_num(finite_median(np.abs(np.concatenate(x))))) for name, x in every.items()}


def moves(settings: SteadySettings, scale: Scale | None = None) -> dict[str, np.ndarray]:
    """By setting, mask (n,) of the samples at which it changes within a short time.

    ``scale`` is the usual size of each setting in the whole recording; if None, that of this series.
    """
    n = len(settings.time)
    scale = scale or scale_of([settings])
    lag = samples_in(settings.time, constants.COMPARED_APART)
    masks: dict[str, np.ndarray] = {}
    for name in (*STEP, *CONDITIONS):
        values = getattr(settings, name)
        if not np.ptp(values) > 0.0:
            masks[name] = np.zeros(n, dtype=bool)
            continue
        smooth, noise = _smoothed(settings, name)
        step: float | np.ndarray
        if name in STEP:
            step = STEP[name]
        else:
            usual = max(scale[name], float(np.median(np.abs(values))))
            step = usual * _step_of_condition(masks["kappa"][lag:])
        masks[name] = _changes(smooth, np.maximum(step, noise), lag)
        if name in STEP:
            masks[name] |= _swings(settings.time, values, LEVEL[name])
    return masks


def _swings(time: np.ndarray, values: np.ndarray, level: float) -> np.ndarray:
    """Mask (n,) of the samples in sweeps so fast that means over :data:`COMPARED_APART` hide them.

    Means over half and a quarter of that time change by more than a level's tolerance and half of the setting's range there;
    control around a set-point does not.
    """
    low, high = np.percentile(values, constants.CORE)
    step, found = max(level, MOST * (high - low)), np.zeros(len(values), dtype=bool)
    lag = samples_in(time, constants.COMPARED_APART)
    while (lag := lag // 2) >= samples_in(time, constants.AVERAGED_TIME):
        noise = beyond(FALSE_ALARM / len(values)) * _noise(values) * np.sqrt(2.0 / lag)
        found |= _changes(scipy.ndimage.uniform_filter1d(values, lag, mode="nearest"), max(step, noise), lag)
    return found


def _smoothed(settings: SteadySettings, name: str) -> tuple[np.ndarray, float]:
    """Means (n,) of a setting over a short time, and the difference of two of them that noise does not reach."""
    values = getattr(settings, name)
    lag = samples_in(settings.time, constants.COMPARED_APART)
    clear = beyond(FALSE_ALARM / len(values))  # corrected for n comparisons
    return scipy.ndimage.uniform_filter1d(values, lag, mode="nearest"), float(
        clear * _noise(values) * np.sqrt(2.0 / lag)
    )


def _changes(values: np.ndarray, step: float | np.ndarray, lag: int) -> np.ndarray:
    """Mask (n,) of the samples between any two values that are ``lag`` samples apart and differ by more than ``step``.

    All samples between the two are marked, because a small change appears in few pairs only.
    """
    n = len(values)
    change = np.abs(values[lag:] - values[:-lag]) > step
    begun = np.zeros(n + 1, dtype=int)
    begun[: n - lag] += change
    begun[lag + 1 :] -= change
    return np.asarray(np.cumsum(begun)[:n] > 0)


def _creeps(settings: SteadySettings, resting: np.ndarray) -> dict[str, np.ndarray]:
    """By swept setting, mask (n,) of the samples at which it moves too slowly for :func:`moves`, in the rests of a mask (n,).

    Pairs further and further apart are compared within what rested so far. The distance doubles, so that the samples marked
    before a slow movement and behind it take less time than one step of it.
    """
    masks = {}
    for name, step in STEP.items():
        smooth, noise = _smoothed(settings, name)
        creeps, lag = np.zeros(len(smooth), dtype=bool), samples_in(settings.time, constants.COMPARED_APART)
        while (lag := 2 * lag) < len(smooth):
            for begin, end in runs(resting & ~creeps):
                if end - begin > lag:
                    creeps[begin:end] = _changes(smooth[begin:end], max(step, noise), lag)
        masks[name] = creeps
    return masks


def _step_of_condition(driving: np.ndarray) -> float | np.ndarray:
    """Relative change of a condition that counts as another set-point, larger where the slip moves (n,)."""
    if not np.any(driving):
        return float(constants.CONDITION)
    return np.where(
        driving, 0.5 * constants.HELD_LOAD, constants.CONDITION
    )  # half the range lies to either side


def _noise(values: np.ndarray) -> float:
    """Standard deviation of a setting's noise, from median second differences, in which an even movement vanishes.

    First ones would take a movement for noise where few samples are recorded of it.
    """
    return robust(bends(values, 2)) if len(values) > 2 else 0.0
