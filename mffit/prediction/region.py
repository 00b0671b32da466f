"""The region of conditions with the largest significant model error of a channel, relative to its force."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.special import ndtr

from mffit.constants import COVERAGE_FACTOR_95, FALSE_ALARM
from mffit.linearised.inputs import LEVELS, inputs_of, swept_of
from mffit.points import Points, levels
from mffit.points.points import of_si
from mffit.prediction import constants
from mffit.prediction.conditions import PATH, UNITS
from mffit.prediction.predictor import Predictor
from mffit.prediction.slopes import MissedSlope, missed_slopes
from mffit.quantities import COLUMNS, column
from mffit.rig import Readings, Simulation
from mffit.scatter import rms
from tir import Tyre

SIDES = ("", "positive", "negative", "apart")
"""Signs of the force: both, positive only, negative only, and the difference between positive and negative."""

SLIP = {"Fx": "kappa", "Fy": "alpha"}
"""By channel, the slip over which its force reaches a maximum, the grip."""


@dataclass(frozen=True, slots=True)
class MissedRegion:
    """Conditions under which the model misses the largest forces of every sweep with the same sign."""

    side: str  #: one of ``SIDES``
    over: Mapping[str, tuple[float, float]]
    """Conditions that restrict the region, with their lowest and highest level in it [unit of the column]."""
    lower: float  #: lower end of the 95 % interval of tyre force / model force - 1, mean of all sweeps
    upper: float  #: upper end of this interval
    sweeps: int  #: sweeps, or groups of readings at equal settings, in the region


@dataclass(frozen=True, slots=True)
class MissedAtReadings:
    """Model error of a channel at the readings of a build, at the usual temperature."""

    channel: str
    size: float  #: rms model error [unit of the channel]
    largest: float  #: size of the channel's largest force in the file
    is_grip: bool  #: whether sweeps over the channel's own slip reach its grip
    region: MissedRegion | None  #: region of the largest model error; None if no region is significant
    slopes: tuple[MissedSlope, ...] = ()  #: over the channel's own slip, at zero


class _Seen(NamedTuple):
    """Relative error of the largest forces of one sweep on one side."""

    level: np.ndarray  #: (d,) levels of the held conditions
    share: float  #: measured less model, over the model
    u: float  #: standard uncertainty of ``share``, scatter between runs included


def missed_at_readings(
    known: Predictor, fitted: Tyre, points: Points, model: Readings, proven: Collection[str]
) -> dict[str, MissedAtReadings]:
    """By channel, the model error at the readings and the region of the largest one, for channels with a ``proven`` one.

    ``known`` is the predictor of the ``fitted`` file; ``model`` has the fitted model's readings at the points, rig errors
    included.
    """
    moved = swept_of(points, inputs_of(points))
    swept = set(moved.values())
    level = {
        name: levels.level_values(getattr(points, name), kind)
        for name, kind in LEVELS.items()
        if name not in swept and levels.count(getattr(points, name), kind) > 1
    }
    keys = np.array([points.sweep, *level.values()])
    whole = np.flatnonzero(np.all(np.isfinite(keys), axis=0))
    groups = [whole[rows] for rows in levels.rows_of_equal(keys.T[whole])]
    at = pd.DataFrame({name: points.condition(name) for name in UNITS if name not in (PATH, "T_degC")})
    at[PATH] = points.phi_t
    run = known.predict(fitted, fitted, at.assign(T_degC=points.condition("T_degC")), proven)
    force = Simulation.of(fitted, turn_slip=known.curved).readings(points, known.channels)
    found = {}
    for name in (name for name in known.channels if name in proven):
        missed, residual = known.missed(name, known.points(fitted, at)), points.channel(name) - model[name]
        read, u = np.isfinite(residual), run[f"u_{column(name, 'run')}"].to_numpy()
        seen: dict[str, list[_Seen]] = {side: [] for side in SIDES}
        own_slip = SLIP.get(name)
        of_grip = [own for own in groups if own_slip not in swept or moved[points.sweep[own[0]]] == own_slip]
        for rows in (part for own in of_grip if len(part := own[read[own]])):
            here = np.array([values[rows[0]] for values in level.values()])
            of_sign = _of_sweep(here, force[name][rows], residual[rows], u[rows])
            for side, one in of_sign.items():
                seen[side].append(one)
        found[name] = MissedAtReadings(
            channel=name,
            size=rms(missed[read]),
            largest=float(np.max(np.abs(force[name][read]), initial=1e-12)),
            is_grip=own_slip in swept,
            region=_clearest(tuple(level), seen),
            slopes=missed_slopes(known, fitted, points, name, own_slip) if own_slip in swept else (),
        )
    return found


def _of_sweep(level: np.ndarray, F: np.ndarray, residual: np.ndarray, u: np.ndarray) -> dict[str, _Seen]:
    """By side, the relative error of the largest forces of a sweep: model's (n,), residuals and their u (n,)."""
    large = np.abs(F) >= constants.LARGE_FORCE * np.max(np.abs(F), initial=0.0)
    signs = {"": large, "positive": large & (F > 0.0), "negative": large & (F < 0.0)}
    found = {
        side: _Seen(level, *(float(x / np.sum(np.abs(F[own]))) for x in sums))
        for side, own in signs.items()
        if np.any(F[own])
        for sums in [(np.sign(F[own]) @ residual[own], np.sum(u[own]))]
    }
    if len(found) == len(signs):
        up, down = found["positive"], found["negative"]
        found["apart"] = _Seen(level, up.share - down.share, float(np.hypot(up.u, down.u)))
    return found


def _clearest(names: Sequence[str], seen: Mapping[str, Sequence[_Seen]]) -> MissedRegion | None:
    """The significant region with the fewest restrictions, among these the one with the largest error; None without any."""
    found = [one for side, own in seen.items() for one in _regions(side, names, own)]
    clear = [one for one in found if len(found) * one.chance < FALSE_ALARM]
    return max(clear, key=lambda one: (-one.restrictions, one.weight)).region if clear else None


class _Candidate(NamedTuple):
    """A region, and the criteria of its choice."""

    region: MissedRegion
    chance: float  #: p-value of the mean error, given the scatter between runs
    restrictions: int
    weight: float  #: mean relative error times the root of the number of sweeps


def _regions(side: str, names: Sequence[str], seen: Sequence[_Seen]) -> Iterator[_Candidate]:
    """Regions restricted in at most two conditions, each region reaching to an end of the tested range."""
    if len(seen) < 2:
        return
    level, share, u = (np.array(own) for own in zip(*seen, strict=True))
    ends = [
        (i, inside)
        for i in range(len(names))
        for value in np.unique(level[:, i])[:-1]
        for inside in (level[:, i] <= value, level[:, i] > value)
    ]
    pairs = (pair for pair in itertools.combinations(ends, 2) if pair[0][0] != pair[1][0])
    for chosen in itertools.chain([()], ((end,) for end in ends), pairs):
        inside = np.all([np.ones(len(seen), dtype=bool), *(own for _, own in chosen)], axis=0)
        n = int(np.sum(inside))
        if n < 2:
            continue
        mean, of_mean = float(np.mean(share[inside])), float(np.sqrt(np.sum(u[inside] ** 2))) / n
        half, alike = COVERAGE_FACTOR_95 * of_mean, np.all(share[inside] * mean > 0.0) and abs(mean) < 1.0
        over = {}
        for i, _ in chosen:
            heading = COLUMNS[names[i]]
            own = level[inside, i] * of_si(heading)
            over[heading] = (float(own.min()), float(own.max()))
        yield _Candidate(
            MissedRegion(side, over, mean - half, mean + half, n),
            2.0 * float(ndtr(-abs(mean) / of_mean)) if alike else 1.0,
            len(chosen) + (side != ""),
            abs(mean) * np.sqrt(n),
        )
