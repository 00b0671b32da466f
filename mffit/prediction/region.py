"""Where the formula misses a channel most, for certain and in relation to its force: a region of few conditions."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd
from scipy.special import ndtr

from mffit.constants import COVERAGE_FACTOR_95, FALSE_ALARM
from mffit.linearised.inputs import COLUMNS, LEVELS, inputs_of, swept_of
from mffit.points import Points, levels
from mffit.points.points import of_si
from mffit.prediction import constants
from mffit.prediction.conditions import PATH, UNITS
from mffit.prediction.predictor import Predictor
from mffit.quantities import column
from mffit.rig import Readings, Simulation
from mffit.scatter import rms
from tir import Tyre

SIDES = ("", "positive", "negative", "apart")
"""Of the force: both signs, one of them, and the positive less the negative ones."""

SLIP = {"Fx": "kappa", "Fy": "alpha"}
"""By channel, the slip over which its force has a largest value, the grip."""


@dataclass(frozen=True, slots=True)
class MissedRegion:
    """Conditions under which the largest forces of every sweep are missed in one sense."""

    side: str  #: one of ``SIDES``
    over: Mapping[str, tuple[float, float]]
    """Conditions of which it has not all levels, with the lowest and the highest level in it [unit of the column]."""
    lower: float  #: 95 % interval of the mean of all sweeps of the force of the tyre over that of the model, less 1
    upper: float
    sweeps: int  #: sweeps, or groups of readings at equal settings, in the region


@dataclass(frozen=True, slots=True)
class MissedAtReadings:
    """What the formula misses of a channel at the readings of a build, at the usual temperature."""

    channel: str
    size: float  #: root mean square [unit of the channel]
    largest: float  #: size of the channel's largest force in the file
    is_grip: bool  #: whether sweeps over its own slip reach its largest forces
    region: MissedRegion | None  #: where it misses most; None if nowhere in one sense for certain


class _Seen(NamedTuple):
    """What the largest forces of one sweep at its settings show, of one side."""

    level: np.ndarray  #: (d,) of the held conditions
    share: float  #: measured less model, over the model
    u: float  #: standard uncertainty of that as a statement about the tyre: runs differ


def missed_at_readings(
    known: Predictor, fitted: Tyre, points: Points, model: Readings, proven: Collection[str]
) -> dict[str, MissedAtReadings]:
    """By channel, what is missed at the readings, and in which region most.

    Parameters
    ----------
    known : what the file of the ``fitted`` model misses
    points : the readings (n,)
    model : what the fitted model reads there, with the errors of the rig
    proven : channels whose miss is proven
    """
    swept = set(swept_of(points, inputs_of(points)).values())
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
        for rows in (own[read[own]] for own in groups):
            F = force[name][rows]
            large = np.abs(F) >= constants.LARGE_FORCE * np.max(np.abs(F), initial=0.0)
            signs = {"": large, "positive": large & (F > 0.0), "negative": large & (F < 0.0)}
            here = np.array([values[rows[0]] for values in level.values()])
            of_sign = {
                side: _Seen(here, *(float(x / np.sum(np.abs(F[own]))) for x in sums))
                for side, own in signs.items()
                if np.any(F[own])
                for sums in [(np.sign(F[own]) @ residual[rows[own]], np.sum(u[rows[own]]))]
            }
            if len(of_sign) == len(signs):
                up, down = of_sign["positive"], of_sign["negative"]
                of_sign["apart"] = _Seen(here, up.share - down.share, float(np.hypot(up.u, down.u)))
            for side, one in of_sign.items():
                seen[side].append(one)
        found[name] = MissedAtReadings(
            channel=name,
            size=rms(missed[read]),
            largest=float(np.max(np.abs(force[name][read]), initial=1e-12)),
            is_grip=SLIP.get(name) in swept,
            region=_clearest(tuple(level), seen),
        )
    return found


def _clearest(names: Sequence[str], seen: Mapping[str, Sequence[_Seen]]) -> MissedRegion | None:
    """The simplest region that chance does not explain, of these the one missed most; None if there is none."""
    found = [one for side, own in seen.items() for one in _regions(side, names, own)]
    clear = [one for one in found if len(found) * one.chance < FALSE_ALARM]
    return max(clear, key=lambda one: (-one.restrictions, one.weight)).region if clear else None


class _Candidate(NamedTuple):
    """A region, and how it is chosen."""

    region: MissedRegion
    chance: float  #: that the mean is so far from zero because runs differ
    restrictions: int
    weight: float  #: mean miss over the force, times the root of the number of sweeps


def _regions(side: str, names: Sequence[str], seen: Sequence[_Seen]) -> Iterator[_Candidate]:
    """Regions of at most two conditions, each from an end of what was tested."""
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
