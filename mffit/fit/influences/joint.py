"""A fit at its solution as one linear mixed model of all readings: numbers common to all sweeps, and random effects per sweep."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.special import gammaincc

from mffit.constants import PREDICTION_FALSE_ALARM
from mffit.fit.fitted import uncertain
from mffit.fit.problem import FitProblem
from mffit.least_squares import POLISH_TOLERANCE, FreeNumber
from mffit.linearised.constants import POINTS_EXAMINED
from mffit.linearised.mixed import HELD, FurtherColumns, LeftOutReadings, Mixed, Variances
from mffit.linearised.search import Scored, Scoring, SearchedParameter
from mffit.rig_errors import BY_NAME
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

NO_SCATTER = 0.005
"""Lower bound of the standard deviation among groups over the usual one: too small to show in the readings."""

UNKNOWN = 1e3
"""Standard deviation assumed for a number without prior, over its standard error from the readings alone."""


class LeftOutGroups(NamedTuple):
    """Errors of left-out groups of points as predicted from all other groups."""

    density: np.ndarray  #: (g,) log predictive density of the readings of each group
    squares: np.ndarray  #: (g,) sum of squared prediction errors in units of the readings' uncertainties
    gaps: dict[str, float]  #: by channel, rms prediction error [N] or [Nm]

    @classmethod
    def of(
        cls, found: Sequence[LeftOutReadings], sigma: np.ndarray, channels: Sequence[str]
    ) -> LeftOutGroups:
        """The record from the predictions of all groups; ``sigma`` (c, n) are the readings' uncertainties."""
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
    """Log marginal likelihood of a model, and the variances at which it was evaluated."""

    value: float
    given: Variances

    @property
    def scatter(self) -> np.ndarray:
        """Standard deviation (q,) of each random effect among the groups."""
        return np.exp(0.5 * self.given.own)


@dataclass(frozen=True, eq=False)
class JointFit(ReadOnlyArrays):
    """Linear mixed model of the readings: shared numbers with priors, random effects of each group, and noise."""

    names: tuple[str, ...]  #: (k,) names of the shared numbers
    model: Mixed  #: scaled so that the shared numbers have unit prior variance
    sigma: np.ndarray  #: (c, n) uncertainties of the readings
    channels: tuple[str, ...]  #: (c,)
    looked_at: np.ndarray  #: (n,) indices of the points in the model, thinned if there are very many
    usual: np.ndarray  #: (q,) starting values of the random effects' standard deviations

    @classmethod
    def of(
        cls, problem: FitProblem, numbers: Sequence[FreeNumber], own: Sequence[str], group: np.ndarray
    ) -> JointFit:
        """The model linearised at the values of ``problem``; ``own`` names the numbers with a random effect per group."""
        looked_at = np.arange(0, len(group), -(-len(group) // int(POINTS_EXAMINED)))
        problem, group = problem.select(looked_at), group[looked_at]
        shared = [uncertain(number) for number in problem.starting_here(numbers)]
        residual, slope = problem.rows([*(number.name for number in shared), *own])
        k, c = len(shared), len(problem.channels)
        size = np.array([number.spread for number in shared])
        unknown = ~np.isfinite(size)  # no bounds and no prior: only the readings determine it
        size[unknown] = UNKNOWN / np.maximum(np.linalg.norm(slope[:, :k][:, unknown], axis=0), 1e-12)
        radii = np.full(len(residual) - c * len(group), -1)  # measured radii form a group of their own
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
        """The log marginal likelihood, maximal over the random effects' variances; ``held`` numbers are at their prior means."""
        common = self._held(held)

        def evidence(x: np.ndarray) -> Scored:
            found = self.model.evidence(Variances(common, 2.0 * x, 0.0))
            return Scored(found.value, 2.0 * found.own, 4.0 * found.of_own)

        start = np.log(self.usual).tolist()
        sizes = [SearchedParameter(x, x + float(np.log(NO_SCATTER)), 0.0) for x in start]
        x = Scoring(sizes, evidence, POLISH_TOLERANCE).most_probable(start)
        return Explained(evidence(x).value, Variances(common, 2.0 * x, 0.0))

    def alike(self, held: Collection[str] = ()) -> Variances:
        """The variances without random effects."""
        return self.model.alike(self._held(held))

    def further(self, columns: np.ndarray) -> FurtherColumns:
        """The information of the readings about further columns (m, j), without random effects."""
        return self.model.further(self.alike(), columns)

    @property
    def misfit(self) -> float:
        """Sum of squared residuals at the posterior mean, in units of the readings' uncertainties, without random effects."""
        left = self.model.residual - self.model.common @ self.model.posterior(self.alike()).mean
        return float(left @ left)

    def _held(self, names: Collection[str]) -> np.ndarray:
        """Logarithm (k,) of the shared numbers' variances, with the named ones held."""
        return np.where(np.isin(self.names, [*names]), HELD, 0.0)

    def gain(self, more: Collection[str], held: Collection[str] = ()) -> float:
        """Increase of the log likelihood if the numbers ``more`` are freed as well; those ``held`` otherwise stay held.

        It is the difference of the log marginal likelihoods without the penalty for the priors of ``more``.
        """
        beside = self.explained([name for name in held if name not in more])
        without = self.explained([*held, *more])
        root = self.model.posterior(beside.given).root[np.isin(self.names, [*more])]
        return beside.value - without.value - 0.5 * float(np.linalg.slogdet(root @ root.T)[1])

    def left_out(self, given: Variances, group: np.ndarray) -> LeftOutGroups:
        """Each group of points predicted from all other readings; the remaining readings of a run show its random effects."""
        of_row = np.tile(group[self.looked_at], len(self.channels))
        found = self.model.left_out(given, [np.flatnonzero(of_row == g) for g in np.unique(of_row)])
        return LeftOutGroups.of(found, self.sigma, self.channels)


def beyond_chance(gain: float, numbers: int, candidates: int = 1) -> bool:
    """Whether a gain in log likelihood from this many ``numbers`` is significant for the best of this many ``candidates``."""
    return bool(gammaincc(0.5 * numbers, max(gain, 0.0)) < PREDICTION_FALSE_ALARM / max(candidates, 1))
