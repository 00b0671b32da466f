"""Drift: how far the forces of each sweep differ from the usual, as conditions show that several sweeps repeat.

A tyre that warms or wears changes its stiffness from sweep to sweep, so that camber sweeps and zeros are those of two tyres.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.constants import SAME_SIDESLIP, STRAIGHT
from mffit.measured.result import Drift
from mffit.measured.uncertain import named
from mffit.measured.zeros import u_of
from mffit.parts.constants import SAME_CAMBER
from mffit.points import Points, levels
from mffit.scatter import rms

SOURCE = "drift between sweeps"
"""Its name in the uncertainty budget."""
SAME = (
    ("alpha", levels.LevelKind("sideslip", SAME_SIDESLIP.rad)),
    ("gamma", levels.LevelKind("camber", SAME_CAMBER.rad)),
    ("Fz", levels.LOAD),
    ("p", levels.PRESSURE),
    ("V", levels.SPEED),
)
"""What a repeated condition has in common, beside direction, mount, path and set-up."""


@dataclass(frozen=True, slots=True)
class SweepShares:
    """By how much every sweep's forces exceed the usual, relative."""

    sweeps: np.ndarray  #: (k,) their numbers
    shares: tuple[UFloat, ...]  #: (k,)
    drift: Drift

    def between(self, points: Points, one: np.ndarray, other: np.ndarray) -> UFloat | float:
        """How much larger forces of the rows ``one`` are than those of the rows ``other``, relative; 0 if either is unknown."""
        first, second = (self._mean(points.sweep[rows]) for rows in (one, other))
        return 0.0 if first is None or second is None else first - second

    def _mean(self, sweep: np.ndarray) -> UFloat | None:
        place = np.searchsorted(self.sweeps, sweep[np.isin(sweep, self.sweeps)])
        return sum(self.shares[k] for k in place.tolist()) / len(place) if len(place) else None


def shares_of_sweeps(points: Points) -> SweepShares | None:
    """The drift of a test, if repeated conditions show one; None where none is repeated, or zeros that move explain more.

    Shares of sweeps scatter normally about a usual one. Their scatter is the likeliest, and each share its mean given the
    readings.
    """
    sweeps = np.unique(points.sweep)
    conditions = list(_repeated(points, sweeps))
    if not conditions:
        return None
    left = np.concatenate([one.left for one in conditions])
    of_zeros = np.vstack([one.own for one in conditions])
    shares = _likeliest(left, np.vstack([one.own * one.force for one in conditions]), len(conditions))
    zeros = _likeliest(left, of_zeros * rms(np.array([one.force for one in conditions])), len(conditions))
    if zeros.evidence > shares.evidence:
        return None
    errors = [named(0.0, 1.0, SOURCE, "-", kind="A") for _ in sweeps]
    numbers = tuple(
        value + sum(x * error for x, error in zip(row, errors, strict=True))
        for value, row in zip(shares.mean.tolist(), shares.root.tolist(), strict=True)
    )
    known = np.flatnonzero(np.any(of_zeros != 0.0, axis=0))
    least, most = (known[f(shares.mean[known])] for f in (np.argmin, np.argmax))
    drift = Drift(
        scatter=shares.scatter,
        # A scatter is not negative, so half of all sound tests show none.
        chance=0.5 * float(chdtrc(1, 2.0 * max(shares.evidence, 0.0))),
        least=points.sweep_names[sweeps[least]],
        most=points.sweep_names[sweeps[most]],
        apart=float(shares.mean[most] - shares.mean[least]),
    )
    return SweepShares(sweeps, numbers, drift)


class _Scatter(NamedTuple):
    """Numbers of sweeps (k,) that scatter normally about zero."""

    scatter: float  #: standard deviation
    evidence: float  #: its logarithm, over that of none
    mean: np.ndarray  #: (k,) of each number, given the readings
    root: np.ndarray  #: (k, k) of their covariance


def _likeliest(left: np.ndarray, slopes: np.ndarray, means: int) -> _Scatter:
    """The scatter under which readings (m,) less ``means`` are likeliest, with their slopes (m, k) over the numbers of sweeps.

    Noise is at least as stated; it is larger where readings contradict each other whatever the numbers are.
    """
    rest = left - slopes @ np.linalg.lstsq(slopes, left, rcond=None)[0]
    freedom = len(left) - means - int(np.linalg.matrix_rank(slopes))
    noise = max(1.0, float(rest @ rest) / freedom) if freedom > 0 else 1.0
    strength, axes = np.linalg.eigh(slopes.T @ slopes / noise)
    strength, pull = np.maximum(strength, 0.0), axes.T @ slopes.T @ left / noise

    def evidence(u: float) -> float:
        grown = 1.0 + u**2 * strength
        return float(0.5 * np.sum((u * pull) ** 2 / grown - np.log(grown)))

    scatter = float(minimize_scalar(lambda u: -evidence(u), bounds=(0.0, 1.0), method="bounded").x)
    variance = scatter**2 / (1.0 + scatter**2 * strength)
    return _Scatter(scatter, evidence(scatter), axes @ (variance * pull), axes * np.sqrt(variance))


class _Condition(NamedTuple):
    """A condition that several sweeps repeat."""

    left: np.ndarray  #: (m,) forces less their mean, over their noise
    own: np.ndarray  #: (m, k) change of these if a sweep reads more [1/N]
    force: float  #: mean [N]


def _repeated(points: Points, sweeps: np.ndarray) -> Iterator[_Condition]:
    """The conditions without sideslip that several sweeps repeat: their force depends little on the exact angle."""
    used = np.flatnonzero(
        points.free_rolling
        & ~points.continuous
        & (np.abs(points.alpha) < STRAIGHT.rad)
        & np.isfinite(points.Fy)
    )
    part = points.select(used)
    keys = [levels.labels(getattr(part, name), kind) for name, kind in SAME]
    keys += [part.direction, part.mount, part.setup, np.unique(part.phi_t, return_inverse=True)[1]]
    same = np.column_stack(keys)
    u = u_of(part, "Fy")
    for rows in levels.rows_of_equal(same):
        if len(np.unique(part.sweep[rows])) < 2 or np.any(same[rows[0], : len(SAME)] == levels.NO_LEVEL):
            continue
        # The load wanders, and the force with it.
        load = part.Fz[rows]
        force, weight = part.Fy[rows] * np.mean(load) / load, u[rows] ** -2.0
        mean = float(np.average(force, weights=weight))
        own = (part.sweep[rows][:, None] == sweeps).astype(float)
        own -= np.average(own, axis=0, weights=weight)
        yield _Condition((force - mean) / u[rows], own / u[rows][:, None], mean)
