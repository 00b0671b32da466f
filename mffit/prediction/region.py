"""Where the formula misses a channel most, for certain and in relation to its force: a region of few conditions."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.constants import COVERAGE_FACTOR_95
from mffit.linearised.inputs import COLUMNS, LEVELS, inputs_of, swept_of
from mffit.points import Points, levels
from mffit.points.points import OF_SI
from mffit.prediction import constants
from mffit.prediction.conditions import PATH, UNITS
from mffit.prediction.predictor import Predictor
from mffit.quantities import CONDITIONS, column
from mffit.rig import Readings, Simulation
from mffit.scatter import rms
from tir import Tyre

SIDES: Mapping[str, int] = {"": 0, "positive": 1, "negative": -1}
"""Signs of the force."""


@dataclass(frozen=True, slots=True)
class MissedRegion:
    """Conditions under which the largest forces of every sweep are missed in one sense."""

    side: str  #: sign of the force, "positive" or "negative"; "" for both
    over: Mapping[str, tuple[float, float]]
    """Conditions of which it has not all levels, with the lowest and the highest level in it [unit of the column]."""
    least: float  #: force of the tyre over that of the file, less 1, in the sweep that shows least
    most: float  #: in that which shows most
    sweeps: int  #: sweeps, or groups of readings at equal settings, in the region
    agreeing: int  #: those whose readings lie on this side of the file


@dataclass(frozen=True, slots=True)
class MissedAtReadings:
    """What the formula misses of a channel at the readings of a build, at the usual temperature."""

    channel: str
    size: float  #: root mean square [unit of the channel]
    largest: float  #: size of the channel's largest force in the file
    region: MissedRegion | None  #: where it misses most; None if nowhere in one sense for certain


class _Seen(NamedTuple):
    """What the largest forces of one sweep at its settings show."""

    level: np.ndarray  #: (d,) of the held conditions
    share: float  #: missed over the force
    u: float  #: of it
    residual: float  #: of the readings, in the sense of the force


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
    best = known.predict(fitted, fitted, at)
    force = Simulation.of(fitted, turn_slip=known.curved).readings(points, known.channels)
    found = {}
    for name in (name for name in known.channels if name in proven):
        missed = known.missed(name, known.points(fitted, at))
        u, residual = best[f"u_{column(name, 'best')}"].to_numpy(), points.channel(name) - model[name]
        read = np.isfinite(residual)
        candidates: list[tuple[float, MissedRegion]] = []
        for side, sign in SIDES.items():
            seen = []
            for rows in groups:
                F = force[name][rows]
                large = np.abs(F) >= constants.LARGE_FORCE * np.max(np.abs(F))
                inside = rows[read[rows] & large & ((sign == 0) | (np.sign(F) == sign))]
                if len(inside):
                    sense, total = np.sign(force[name][inside]), np.sum(np.abs(force[name][inside]))
                    share, of_u = (float(np.sum(x) / total) for x in (sense * missed[inside], u[inside]))
                    own = np.array([values[inside[0]] for values in level.values()])
                    seen.append(_Seen(own, share, of_u, float(np.sum(sense * residual[inside]))))
            candidates += _regions(side, tuple(level), seen)
        found[name] = MissedAtReadings(
            channel=name,
            size=rms(missed[read]),
            largest=float(np.max(np.abs(force[name][read]), initial=1e-12)),
            region=max(candidates, key=lambda one: one[0])[1] if candidates else None,
        )
    return found


def _regions(side: str, names: Sequence[str], seen: Sequence[_Seen]) -> Iterator[tuple[float, MissedRegion]]:
    """Regions of at most two conditions, each from an end of what was tested, with the number by which they are chosen.

    That is the mean miss over the force times the root of the share of the sweeps, of which those that do not show it count less.
    """
    if len(seen) < 2:
        return
    level, share, u, residual = (np.array(own) for own in zip(*seen, strict=True))
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
        mean = float(np.mean(share[inside]))
        certain = abs(mean) > COVERAGE_FACTOR_95 * np.mean(u[inside])
        if not (certain and np.all(share[inside] * mean > 0.0)):
            continue
        over = {}
        for i, _ in chosen:
            heading = COLUMNS[names[i]]
            own = level[inside, i] * OF_SI.get(CONDITIONS[heading].unit, 1.0)
            over[heading] = (float(own.min()), float(own.max()))
        least, most = sorted(share[inside].tolist(), key=abs)[:: n - 1]
        agreeing = int(np.sum(residual[inside] * mean > 0.0))
        score = abs(mean) * np.sqrt(n / len(seen)) * agreeing / n
        yield score, MissedRegion(side, over, least, most, n, agreeing)
