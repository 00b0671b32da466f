"""Readings where a moving sweep turns back: the rig accelerates there, so its inertia and filters distort the readings."""

from collections.abc import Iterator, Mapping
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from scipy.special import fdtrc

from mffit.constants import FALSE_ALARM, FEWEST
from mffit.points import Points, levels
from mffit.quantities import CHANNELS
from mffit.scatter import rms
from mffit.suspicion.rule import Outcome, Rule, When

NEAR = int(FEWEST)
"""Number of readings of a leg that extrapolate to the next reading, and number of readings examined on each side of a turn.
Farther from the turn, smooth model error would look like a departure."""


class Leg(NamedTuple):
    """Readings that a line through the preceding readings of the same leg extrapolates to, in one direction along the legs."""

    rows: np.ndarray  #: (k,) indices of the extrapolated readings
    behind: np.ndarray  #: (k, NEAR) indices of the preceding readings of the same leg
    lines: np.ndarray  #: (k, NEAR) weights of these readings in the extrapolation
    from_turn: np.ndarray  #: (k,) number of readings to the turn ahead; NEAR if no turn is near


class Reversals:
    """The turns of the moving sweeps of some points (n,), in the order of measuring."""

    def __init__(self, points: Points) -> None:
        from mffit.linearised.inputs import inputs_of, swept_of  # after a fit only

        swept = swept_of(points, inputs_of(points))
        x = np.full(len(points), np.nan)
        for k, name in swept.items():
            x[points.sweep == k] = getattr(points, name)[points.sweep == k]
        self.n = len(points)
        self.legs = tuple(_legs(x, _senses(points, x, swept))) if self.n > NEAR else ()

    def off(self, residual: np.ndarray) -> np.ndarray:
        """Mask (n,) of the readings near turns whose residuals depart significantly from their legs.

        ``residual`` (n,), measured less model in any unit, is NaN where a reading is not used. Positions are tested from the leg
        towards the turn. From the first position with significant departures over all turns, all readings up to the turn are
        marked.
        """
        out = np.zeros(self.n, dtype=bool)
        departures = [
            residual[leg.rows] - np.sum(leg.lines * residual[leg.behind], axis=1) for leg in self.legs
        ]
        of_others = np.concatenate(
            [d[leg.from_turn >= NEAR] for d, leg in zip(departures, self.legs, strict=True)] or [[]]
        )
        of_others = of_others[np.isfinite(of_others)]
        if len(of_others) < NEAR:
            return out
        usual = float(np.mean(of_others**2))
        for leg, departure in zip(self.legs, departures, strict=True):
            for place in range(NEAR - 1, -1, -1):
                own = departure[(leg.from_turn == place) & np.isfinite(departure)]
                if not len(own) or not usual > 0.0:
                    continue
                chance = fdtrc(len(own), len(of_others), float(np.mean(own**2)) / usual)
                if 2 * NEAR * chance < FALSE_ALARM:
                    out[leg.rows[leg.from_turn <= place]] = True
                    break
        out &= np.isfinite(residual)
        return out if self._harm(residual, out) else np.zeros_like(out)

    def _harm(self, residual: np.ndarray, off: np.ndarray) -> bool:
        """Whether the readings ``off`` have significantly larger residuals than the others.

        Residuals on one side of a turn are correlated, so each side counts as one reading.
        """
        turns = sum(int(np.sum(off[leg.rows] & (leg.from_turn == 0))) for leg in self.legs)
        used = np.isfinite(residual)
        rest = used & ~off
        if not turns:
            return False
        ratio = rms(residual[used & off]) / rms(residual[rest])
        return bool(fdtrc(turns, np.sum(rest), ratio**2) < FALSE_ALARM)


@lru_cache(maxsize=4)
def reversals_of(points: Points) -> Reversals:
    """The reversals of points, cached because a fit needs them repeatedly."""
    return Reversals(points)


def _senses(points: Points, x: np.ndarray, swept: Mapping[int, str]) -> np.ndarray:
    """Sign (n - 1,) of the step of the swept condition ``x`` (n,) to the next reading; 0 where another condition changes."""
    same = points.sweep[1:] == points.sweep[:-1]
    names = np.array([swept[k] for k in points.sweep.tolist()])[:-1]
    from mffit.linearised.inputs import LEVELS

    for name, kind in LEVELS.items():
        apart = np.abs(np.diff(levels.in_tolerances(getattr(points, name), kind)))
        same &= (apart < 1.0) | (names == name)
    return np.where(same, np.sign(np.diff(x)), 0.0)


def _legs(x: np.ndarray, senses: np.ndarray) -> Iterator[Leg]:
    """The extrapolations towards the turns ahead, then those towards the turns behind."""
    rows = np.arange(len(x))
    for ahead in (1, -1):
        steps = senses if ahead == 1 else senses[::-1]
        # Reading i is extrapolated from the NEAR preceding readings if all steps between them have one sign.
        passed = np.array([np.concatenate([np.zeros(NEAR), steps])[k : k + len(x)] for k in range(NEAR)]).T
        whole = np.all(passed == passed[:, -1:], axis=1) & (passed[:, -1] != 0.0)
        turn = np.zeros(len(x), dtype=bool)
        turn[1:-1] = steps[1:] * steps[:-1] < 0.0
        until = np.full(len(x), NEAR)
        for k in range(NEAR - 1, -1, -1):
            there = np.zeros(len(x), dtype=bool)
            there[: len(x) - k] = turn[k:]
            until[there] = k
        at = rows[whole]
        behind = at[:, None] - np.arange(1, NEAR + 1)
        if ahead == -1:
            at, behind = len(x) - 1 - at, len(x) - 1 - behind
        yield Leg(at, behind, _line(x, at, behind), until[whole])


def _line(x: np.ndarray, at: np.ndarray, behind: np.ndarray) -> np.ndarray:
    """Weights (k, NEAR) of the readings ``behind`` that extrapolate their least-squares line to the readings ``at`` (k,)."""
    middle = x[behind].mean(axis=1, keepdims=True)
    away = x[behind] - middle
    return 1.0 / NEAR + away * (x[at][:, None] - middle) / np.sum(away**2, axis=1, keepdims=True)


TURNING = Rule(
    id="turning-sweep",
    when=When.AFTER,
    looks_at="Residuals beside the turns of moving sweeps, extrapolated from their legs, against those elsewhere in the legs",
    outcome=Outcome.WARNED,
    sentence="{channel} is off the model by {off:.3g} {unit} rms where sweeps turn back ({number} readings), and by {usual:.3g} "
    "{unit} elsewhere: the rig accelerates there, so that its inertia is in what it reads; these readings count by their own "
    "scatter",
    find=Reversals.off,
)


def turning_sentences(
    points: Points, model: Mapping[str, np.ndarray], turning: Mapping[str, np.ndarray]
) -> Iterator[str]:
    """A warning for every channel with readings of reduced weight at turns; ``model`` has the expected readings."""
    for name, rows in turning.items():
        if np.any(rows):
            left = points.channel(name) - model[name]
            off, usual = rms(left[rows]), rms(left[~rows & np.isfinite(left)])
            facts = {"off": off, "usual": usual, "number": int(np.sum(rows)), "unit": CHANNELS[name].unit}
            yield TURNING.said({"channel": name, **facts})
