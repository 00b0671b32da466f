"""What the fit leaves uncertain: one joint covariance of everything that was fitted or held with a known spread."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.brief import Brief
from mffit.fit.problem import Problem
from mffit.least_squares import Solution
from mffit.points import Points
from mffit.rig import Simulation
from mffit.rig_errors import BY_NAME as RIG_ERRORS

COVERING = 1.959964
"""Standard deviations on either side of a normal distribution that hold 95 % of it."""


@dataclass(frozen=True, slots=True, repr=False)
class Posterior(Brief):
    """Best values and joint covariance of tyre and rig, to first order around the best values."""

    names: tuple[str, ...]  #: coefficients and rig errors: the fitted ones, then those held with a spread
    covariance: np.ndarray  #: (k, k)

    @property
    def stderr(self) -> dict[str, float]:
        """Standard error by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    def band(self, tyre: Simulation, points: Points) -> tuple[np.ndarray, np.ndarray]:
        """Half width of the 95 % band of Fy [N] and Mz [Nm] at any conditions (n,).

        Of the tyre, not of what a rig reads: errors of the rig count as far as the coefficients inherited them.

        Parameters
        ----------
        tyre : the fitted tyre without rig errors
        points : conditions; only the set-points are used
        """
        rows = [i for i, name in enumerate(self.names) if name not in RIG_ERRORS]
        slopes = tyre.sensitivities(points, [self.names[i] for i in rows])[1]
        covariance = self.covariance[np.ix_(rows, rows)]
        widths = [spread_through(s, covariance) for s in slopes]
        return COVERING * widths[0], COVERING * widths[1]


def joint(problem: Problem, solution: Solution, held: Mapping[str, float]) -> Posterior:
    """The posterior of a solution and of what was held beside it.

    A number held at the wrong value shifts the fitted ones, to first order by ``-C J^T J_held`` of its error.

    Parameters
    ----------
    problem : at the solution
    solution : of the numbers that were free
    held : spread (1 sigma) of numbers that the solution takes as exact
    """
    covariance, names = solution.covariance, list(held)
    if not names:
        return Posterior(solution.names, covariance)
    at = np.array([problem.simulation.number(name, problem.points) for name in names])
    slope = problem.free(names).linear(at).slope
    return beside_held(solution.names, covariance, held, solution.jacobian.T @ slope)


def beside_held(
    free: Sequence[str], covariance: np.ndarray, held: Mapping[str, float], shared: np.ndarray
) -> Posterior:
    """The posterior of free and held numbers.

    Parameters
    ----------
    free : names (k,) of the numbers of the covariance (k, k), the held ones taken as exact
    held : spread of the others (m,)
    shared : (k, m) ``J^T J_held``, the information that the data have of both together
    """
    shift = -covariance @ shared
    known = np.diag(np.array(list(held.values())) ** 2)
    whole = np.block([[covariance + shift @ known @ shift.T, shift @ known], [known @ shift.T, known]])
    return Posterior((*free, *held), whole)


def spread_through(slopes: np.ndarray, covariance: np.ndarray) -> np.ndarray:
    """Standard deviation (n,) that a covariance (k, k) has where the slopes by its numbers are (n, k)."""
    return np.sqrt(np.maximum(np.einsum("ni,ij,nj->n", slopes, covariance, slopes), 0.0))


def strongest_correlations(posterior: Posterior, of: Sequence[str]) -> dict[str, tuple[str, float]]:
    """For each of the named numbers the one it is tied to most, where the correlation is above 0.95."""
    rows = [posterior.names.index(name) for name in of]
    covariance = posterior.covariance[np.ix_(rows, rows)]
    size = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(size, size)
    np.fill_diagonal(correlation, 0.0)
    strongest = np.argmax(np.abs(correlation), axis=1) if len(of) else []
    return {
        name: (of[j], float(correlation[i, j]))
        for i, (name, j) in enumerate(zip(of, strongest, strict=True))
        if abs(correlation[i, j]) > 0.95
    }
