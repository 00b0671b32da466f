"""The uncertainty of a fit: joint covariance of all numbers that were fitted or held with a known standard uncertainty."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.brief import Brief
from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import constants
from mffit.fit.beside import BesideNumbers
from mffit.fit.problem import FitProblem
from mffit.least_squares import Solution
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig import Readings, Simulation
from mffit.rig_errors import error_of


@dataclass(frozen=True, slots=True, repr=False)
class Posterior(Brief):
    """Joint covariance of tyre and rig, to first order around the best values."""

    names: tuple[str, ...]  #: coefficients and rig errors: the fitted ones, then the held ones
    covariance: np.ndarray  #: (k, k)

    @property
    def stderr(self) -> dict[str, float]:
        """Standard uncertainty by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    def with_numbers(self, beside: BesideNumbers) -> Posterior:
        """The posterior extended by separately determined coefficients; numbers that it already has are unchanged."""
        new = [i for i, name in enumerate(beside.values) if name not in self.names]
        names = [list(beside.values)[i] for i in new]
        slope = np.zeros((len(new), len(self.names)))
        if beside.leans_on:
            slope[:, [self.names.index(name) for name in beside.leans_on]] = beside.slope[new]
        across = slope @ self.covariance
        own = across @ slope.T + beside.covariance[np.ix_(new, new)]
        return Posterior((*self.names, *names), np.block([[self.covariance, across.T], [across, own]]))

    def without(self, names: Collection[str]) -> Posterior:
        """The marginal posterior of all numbers except the named ones."""
        rows = [i for i, name in enumerate(self.names) if name not in names]
        return Posterior(tuple(self.names[i] for i in rows), self.covariance[np.ix_(rows, rows)])

    def given(self, names: Collection[str]) -> Posterior:
        """The conditional posterior of the other numbers, with the named ones exactly known."""
        known = [i for i, name in enumerate(self.names) if name in names]
        rows = [i for i, name in enumerate(self.names) if name not in names]
        across = self.covariance[np.ix_(rows, known)]
        part = across @ np.linalg.solve(self.covariance[np.ix_(known, known)], across.T)
        return Posterior(tuple(self.names[i] for i in rows), self.covariance[np.ix_(rows, rows)] - part)

    def band(self, tyre: Simulation, points: Points, channels: Iterable[str] = SIDEWAYS) -> Readings:
        """Half width (n,) of the 95 % band of some channels at any conditions (n,), from the coefficients' uncertainty alone.

        Meant for channels without measurements, for which no model error can be estimated. Only the set-points of ``points``
        are used; ``tyre`` must have no rig errors.
        """
        rows = [i for i, name in enumerate(self.names) if error_of(name) is None]
        slopes = tyre.sensitivities(points, [self.names[i] for i in rows], channels)[1]
        covariance = self.covariance[np.ix_(rows, rows)]
        half = {
            name: COVERAGE_FACTOR_95 * spread_through(slope, covariance) for name, slope in slopes.items()
        }
        return Readings(**half)


def joint(problem: FitProblem, solution: Solution, held: Mapping[str, float]) -> Posterior:
    """The posterior of the fitted numbers and of the numbers held with a known standard uncertainty.

    An error of a held number shifts the fitted numbers, to first order by ``-C J^T J_held`` times the error. ``problem`` must be
    at the solution.
    """
    covariance, names = solution.covariance, list(held)
    if not names:
        return Posterior(solution.names, covariance)
    every = (*solution.names, *names)
    slope = problem.free(every).linear(np.array([problem.value(name) for name in every])).slope
    free, known = np.split(slope, [len(solution.names)], axis=1)
    return beside_held(solution.names, covariance, held, free.T @ known)


def beside_held(
    free: Sequence[str], covariance: np.ndarray, held: Mapping[str, float], shared: np.ndarray
) -> Posterior:
    """The posterior of free numbers (k,) and of held ones (m,), from the covariance (k, k) of the free ones with the held ones
    exact.

    ``held`` has standard uncertainties; ``shared`` (k, m) is ``J^T J_held``, the mixed block of the data's information matrix.
    """
    shift = -covariance @ shared
    known = np.diag(np.array(list(held.values())) ** 2)
    whole = np.block([[covariance + shift @ known @ shift.T, shift @ known], [known @ shift.T, known]])
    return Posterior((*free, *held), whole)


def spread_through(slopes: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Standard uncertainty (n,) of quantities whose derivatives by numbers with ``covariance`` (k, k) are ``slopes`` (n, k)."""
    return np.asarray(np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", slopes, covariance, slopes), 0.0)))


def strongest_correlations(posterior: Posterior, of: Sequence[str]) -> dict[str, tuple[str, float]]:
    """By named number, the number with the strongest correlation to it and the correlation; weak correlations are left out."""
    rows = [posterior.names.index(name) for name in of]
    covariance = posterior.covariance[np.ix_(rows, rows)]
    size = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(size, size)
    np.fill_diagonal(correlation, 0.0)
    strongest = np.argmax(np.abs(correlation), axis=1) if len(of) else []
    return {
        name: (of[j], float(correlation[i, j]))
        for i, (name, j) in enumerate(zip(of, strongest, strict=True))
        if abs(correlation[i, j]) > constants.STRONG_CORRELATION
    }
