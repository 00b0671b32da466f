"""A fit at its solution as one linear model of all its readings: what sweeps share, and what each has of its own."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize
from scipy.special import gammaincc

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.fit.fitted import uncertain
from mffit.fit.problem import FitProblem
from mffit.least_squares import FreeNumber
from mffit.left_out import needed_fall, over_scatter
from mffit.linearised.constants import POINTS_EXAMINED
from mffit.linearised.mixed import FurtherColumns, LeftOutReadings, Mixed, Variances
from mffit.rig_errors import BY_NAME
from mffit.scatter import rms

NO_SCATTER = 0.005
"""Scatter among the groups over the usual one that does not show."""

HELD = -60.0
"""Logarithm of the variance of a number that is held."""

UNKNOWN = 1e3
"""Standard deviation of the prior of a number that has none, over the standard error that the readings alone give it."""


class LeftOutGroups(NamedTuple):
    """Left-out groups of points as all others predict them."""

    density: np.ndarray  #: (g,) logarithm of the probability of the readings of every group
    squares: np.ndarray  #: (g,) sum of squared errors in units of their weights
    gaps: dict[str, float]  #: by channel, rms error [N] or [Nm]

    @classmethod
    def of(
        cls, found: Sequence[LeftOutReadings], sigma: np.ndarray, channels: Sequence[str]
    ) -> LeftOutGroups:
        """From the readings of all groups, whose channels have uncertainties (c, n) as weights."""
        error = np.zeros(sigma.size)
        for one in found:
            error[one.rows] = one.error
        gaps = {}
        for name, errors, u in zip(channels, error.reshape(sigma.shape), sigma, strict=True):
            used = np.isfinite(u) & (errors != 0.0)
            if np.any(used):
                gaps[name] = rms(errors[used] * u[used])
        return cls(
            density=np.array([one.log_density for one in found]),
            squares=np.array([one.error @ one.error for one in found]),
            gaps=gaps,
        )


class Explained(NamedTuple):
    """Evidence of a model at the most probable scatter of its groups."""

    value: float
    given: Variances

    @property
    def scatter(self) -> np.ndarray:
        """Standard deviation (q,) of every own number among the groups."""
        return np.exp(0.5 * self.given.own)


@dataclass(frozen=True, eq=False)
class JointFit:
    """The readings as numbers that all groups share with their priors, numbers that each group has of its own, and noise."""

    names: tuple[str, ...]  #: (k,) of the shared numbers
    model: Mixed  #: whose shared numbers have unit variance
    sigma: np.ndarray  #: (c, n) uncertainties of the readings as weights
    channels: tuple[str, ...]  #: (c,)
    looked_at: np.ndarray  #: (n,) rows of the points: of very many, some
    usual: np.ndarray  #: (q,) scatter of the own numbers from which the search for it starts

    @classmethod
    def of(
        cls,
        problem: FitProblem,
        numbers: Sequence[FreeNumber],
        own: Sequence[str],
        group: np.ndarray,
    ) -> JointFit:
        """The model at the values of ``problem``; groups of its points differ in their ``own`` numbers."""
        looked_at = np.arange(0, len(group), -(-len(group) // int(POINTS_EXAMINED)))
        problem, group = problem.select(looked_at), group[looked_at]
        shared = [uncertain(number) for number in problem.starting_here(numbers)]
        residual, slope = problem.rows([*(number.name for number in shared), *own])
        k, c = len(shared), len(problem.channels)
        size = np.array([number.spread for number in shared])
        unknown = ~np.isfinite(size)  # no limits and no prior: the readings alone know it
        size[unknown] = UNKNOWN / np.maximum(np.linalg.norm(slope[:, :k][:, unknown], axis=0), 1e-12)
        radii = np.full(len(residual) - c * len(group), -1)  # measured ones belong to no group of points
        of_row = np.append(np.tile(group, c), radii)
        return cls(
            names=tuple(number.name for number in shared),
            model=Mixed(
                residual=-residual - slope[:, :k] @ [number.expected for number in shared],
                common=slope[:, :k] * size,
                own=slope[:, k:],
                groups=[np.flatnonzero(of_row == g) for g in np.unique(of_row)],
            ),
            sigma=np.array([*problem.sigma.values()]),
            channels=problem.channels,
            looked_at=looked_at,
            usual=np.array([BY_NAME[name].spread for name in own]),
        )

    def explained(self, held: Collection[str] = ()) -> Explained:
        """The evidence if some numbers are held at their expected values, by the scatter that makes it largest."""
        common = self._held(held)

        def loss(x: np.ndarray) -> tuple[float, np.ndarray]:
            found = self.model.evidence(Variances(common, 2.0 * x, 0.0))
            return -found.value, -2.0 * found.own

        start = np.log(self.usual)
        bounds = [(x + float(np.log(NO_SCATTER)), 0.0) for x in start.tolist()]
        found = minimize(loss, start, jac=True, method="L-BFGS-B", bounds=bounds)
        return Explained(-float(found.fun), Variances(common, 2.0 * found.x, 0.0))

    def alike(self, held: Collection[str] = ()) -> Explained:
        """The same if the groups do not differ."""
        given = self._alike(held)
        return Explained(self.model.evidence(given).value, given)

    def _alike(self, held: Collection[str] = ()) -> Variances:
        return Variances(self._held(held), np.full(self.model.own.shape[1], HELD), 0.0)

    def further(self, columns: np.ndarray) -> FurtherColumns:
        """What the readings say of further changes (m, j) of them, if the groups do not differ."""
        return self.model.further(self._alike(), columns)

    @property
    def misfit(self) -> float:
        """Sum of squares of what all numbers leave, in units of the readings' weights, if the groups do not differ."""
        left = self.model.residual - self.model.common @ self.model.posterior(self._alike()).mean
        return float(left @ left)

    def _held(self, names: Collection[str]) -> np.ndarray:
        """Logarithm (k,) of the variances of the shared numbers."""
        return np.where(np.isin(self.names, [*names]), HELD, 0.0)

    def gain(self, more: Collection[str], held: Collection[str] = ()) -> float:
        """By how much some numbers raise the logarithm of the largest likelihood, beside all others but those that are held.

        The evidence without the price of their priors.
        """
        beside = self.explained([name for name in held if name not in more])
        without = self.explained([*held, *more])
        root = self.model.posterior(beside.given).root[np.isin(self.names, [*more])]
        return beside.value - without.value - 0.5 * float(np.linalg.slogdet(root @ root.T)[1])

    def left_out(self, given: Variances, group: np.ndarray) -> LeftOutGroups:
        """Each group of the points as all other readings predict it; what is left of a run shows its own numbers."""
        of_row = np.tile(group[self.looked_at], len(self.channels))
        found = self.model.left_out(given, [np.flatnonzero(of_row == g) for g in np.unique(of_row)])
        return LeftOutGroups.of(found, self.sigma, self.channels)


def clearly_above_zero(change: np.ndarray) -> bool:
    """Whether changes (g,) of groups are above zero on average by more than their scatter makes them by chance."""
    return over_scatter(change) > needed_fall(1)


def beyond_chance(gain: float, numbers: int, candidates: int = 1) -> bool:
    """Whether numbers raise the log likelihood by more than the best of several candidates does by chance."""
    return bool(gammaincc(0.5 * numbers, max(gain, 0.0)) < PREDICTION_FALSE_ALARM / max(candidates, 1))
