"""Drift of the forces from sweep to sweep, estimated from conditions that several sweeps repeat.

A tyre that warms up or wears changes its stiffness from sweep to sweep, so camber sweeps and zeros belong to different states.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import chdtrc
from uncertainties import UFloat

from mffit.constants import SAME_SIDESLIP, STRAIGHT
from mffit.measured.result import Drift
from mffit.measured.uncertain import named
from mffit.measured.zeros import u_of
from mffit.parts.constants import SAME_CAMBER
from mffit.points import Points, levels
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

SOURCE = "drift between sweeps"
"""Name of the drift in the uncertainty budget."""
SAME = (
    ("alpha", levels.LevelKind("sideslip", SAME_SIDESLIP.rad)),
    ("gamma", levels.LevelKind("camber", SAME_CAMBER.rad)),
    ("Fz", levels.LOAD),
    ("p", levels.PRESSURE),
    ("V", levels.SPEED),
)
"""Settings that must agree in a repeated condition, in addition to direction, mount, path and set-up."""


@dataclass(frozen=True, slots=True)
class SweepShares(ReadOnlyArrays):
    """Relative deviation of every sweep's forces from the usual ones."""

    sweeps: np.ndarray  #: (k,) indices of the sweeps
    shares: tuple[UFloat, ...]  #: (k,) relative deviations
    drift: Drift

    def between(self, points: Points, one: np.ndarray, other: np.ndarray) -> UFloat | float:
        """Relative excess of the forces at rows ``one`` over those at rows ``other``; 0 if either is unknown."""
        first, second = (self._mean(points.sweep[rows]) for rows in (one, other))
        return 0.0 if first is None or second is None else first - second

    def _mean(self, sweep: np.ndarray) -> UFloat | None:
        place = np.searchsorted(self.sweeps, sweep[np.isin(sweep, self.sweeps)])
        return sum(self.shares[k] for k in place.tolist()) / len(place) if len(place) else None


def shares_of_sweeps(points: Points) -> SweepShares | None:
    """The relative deviations of the sweeps; None without repeated conditions, or if shifting zeros explain the forces better.

    The deviations are random effects with a normal distribution. Their standard deviation maximises the marginal likelihood, and
    each deviation is its posterior mean.
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
        # The standard deviation is at its bound 0 in half of all tests without drift.
        chance=0.5 * float(chdtrc(1, 2.0 * max(shares.evidence, 0.0))),
        least=points.sweep_names[sweeps[least]],
        most=points.sweep_names[sweeps[most]],
        apart=float(shares.mean[most] - shares.mean[least]),
    )
    return SweepShares(sweeps, numbers, drift)


class _Scatter(NamedTuple):
    """Random effects (k,) of sweeps, normal around zero."""

    scatter: float  #: standard deviation
    evidence: float  #: gain of log marginal likelihood over no scatter
    mean: np.ndarray  #: (k,) posterior mean
    root: np.ndarray  #: (k, k) root of the posterior covariance


def _likeliest(left: np.ndarray, slopes: np.ndarray, means: int) -> _Scatter:
    """The random effects of sweeps with the most likely scatter, from readings ``left`` (m,) with derivatives (m, k).

    ``means`` is the number of means already subtracted. The noise is as stated, or larger if residuals of a free least-squares
    fit show that.
    """
    rest = left - slopes @ np.linalg.lstsq(slopes, left, rcond=None)[0]
    freedom = len(left) - means - int(np.linalg.matrix_rank(slopes))
    noise = max(1.0, float(rest @ rest) / freedom) if freedom > 0 else 1.0
    strength, axes = np.linalg.eigh(slopes.T @ slopes / noise)
    strength, pull = np.maximum(strength, 0.0), axes.T @ slopes.T @ left / noise

    def evidence(u: np.ndarray) -> np.ndarray:
        grown = 1.0 + u[:, None] ** 2 * strength
        return np.asarray(0.5 * np.sum((u[:, None] * pull) ** 2 / grown - np.log(grown), axis=1))

    scatter, gain = _highest(evidence, 0.0, 1.0)
    variance = scatter**2 / (1.0 + scatter**2 * strength)
    return _Scatter(scatter, gain, axes @ (variance * pull), axes * np.sqrt(variance))


def _highest(of: Callable[[np.ndarray], np.ndarray], low: float, high: float) -> tuple[float, float]:
    """The place and value of the maximum of a function of one number, from ever finer grids around the best place so far."""
    while True:
        grid = np.linspace(low, high, 101)
        values = of(grid)
        best = int(np.argmax(values))
        if high - low < 1e-6:
            return float(grid[best]), float(values[best])
        low, high = grid[max(best - 1, 0)], grid[min(best + 1, len(grid) - 1)]


class _Condition(NamedTuple):
    """A condition that several sweeps repeat."""

    left: np.ndarray  #: (m,) forces less their mean, over their noise
    own: np.ndarray  #: (m, k) derivatives of ``left`` by a force added to each sweep [1/N]
    force: float  #: mean force [N]


def _repeated(points: Points, sweeps: np.ndarray) -> Iterator[_Condition]:
    """The conditions without sideslip that several sweeps repeat; only these, because their force hardly depends on the angle."""
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
        # Scale the forces to the mean load.
        load = part.Fz[rows]
        force, weight = part.Fy[rows] * np.mean(load) / load, u[rows] ** -2.0
        mean = float(np.average(force, weights=weight))
        own = (part.sweep[rows][:, None] == sweeps).astype(float)
        own -= np.average(own, axis=0, weights=weight)
        yield _Condition((force - mean) / u[rows], own / u[rows][:, None], mean)
