"""Scatter of grip and stiffness from run to run: its size, and its effect on the prediction of left-out readings.

A run is a sweep. Its own numbers act on its own readings only, so they are eliminated run by run, and the equations that
remain are those of the shared numbers.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from mffit.fit import constants
from mffit.points import Points


@dataclass(frozen=True, slots=True)
class Part:
    """Normal equations of some readings, shared numbers (k,) beside the own numbers (j,) of their run.

    Those of several runs have one more axis in front.
    """

    shared: np.ndarray  #: (..., k, k)
    mixed: np.ndarray  #: (..., k, j)
    own: np.ndarray  #: (..., j, j)
    shared_pull: np.ndarray  #: (..., k) derivatives times residuals
    own_pull: np.ndarray  #: (..., j)

    @classmethod
    def of(cls, slope: np.ndarray, own: np.ndarray, residual: np.ndarray) -> Part:
        """The equations of rows with derivatives by shared (m, k) and own (m, j) numbers, and residuals (m,)."""
        return cls(slope.T @ slope, slope.T @ own, own.T @ own, slope.T @ residual, own.T @ residual)

    def inverse(self, spread: np.ndarray) -> np.ndarray:
        """Covariance (..., j, j) of the own numbers for known shared ones; ``spread`` (j,) of their priors may be 0."""
        inside = np.eye(len(spread)) + spread[:, None] * self.own * spread
        return spread[:, None] * np.linalg.solve(inside, np.broadcast_to(np.diag(spread), inside.shape))

    def eliminated(self, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Equations of the shared numbers alone: matrix (..., k, k) and pull (..., k)."""
        through = self.mixed @ self.inverse(spread)
        matrix = self.shared - through @ np.swapaxes(self.mixed, -1, -2)
        return matrix, self.shared_pull - (through @ self.own_pull[..., None])[..., 0]

    def solved(self, shared: np.ndarray, spread: np.ndarray) -> np.ndarray:
        """Change of the own numbers (..., j) for a change of the shared ones (k,)."""
        pull = self.own_pull + np.swapaxes(self.mixed, -1, -2) @ shared
        return -(self.inverse(spread) @ pull[..., None])[..., 0]


@dataclass(frozen=True, slots=True)
class Runs:
    """A linearised fit whose runs may have numbers of their own."""

    slope: np.ndarray  #: (m, k) derivatives by the shared numbers, in units of the noise
    own: np.ndarray  #: (m, j) derivatives by a number of all runs, for every kind of own number
    residual: np.ndarray  #: (m,) model less measured
    run: np.ndarray  #: (m,) index of the run
    information: (
        np.ndarray
    )  #: (k, k) about the shared numbers from priors and from readings that belong to no run
    pull: np.ndarray  #: (k,) half the derivative of the sum of squares of these

    def part(self, rows: np.ndarray) -> Part:
        """The equations of some rows."""
        return Part.of(self.slope[rows], self.own[rows], self.residual[rows])

    def parts(self) -> Part:
        """The equations of all runs."""
        each = [self.part(self.run == k) for k in np.unique(self.run)]
        return Part(*(np.array([getattr(part, field.name) for part in each]) for field in fields(Part)))

    def common(self, parts: Part, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Equations of the shared numbers from all runs and priors."""
        matrix, pull = parts.eliminated(spread)
        return self.information + matrix.sum(axis=0), self.pull + pull.sum(axis=0)

    def own_numbers(self, parts: Part, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Own numbers (runs, j) and their variances (runs, j)."""
        matrix, pull = self.common(parts, spread)
        covariance, inverse = np.linalg.inv(matrix), parts.inverse(spread)
        through = parts.mixed @ inverse
        inside = inverse + np.swapaxes(through, -1, -2) @ covariance @ through
        return parts.solved(-covariance @ pull, spread), np.diagonal(inside, axis1=-2, axis2=-1)

    def spread(self) -> np.ndarray:
        """Standard deviation (j,) of the own numbers among the runs, of maximum likelihood.

        Iterated: the mean square of the numbers, each with its variance. Runs that do not show a number keep its variance.
        """
        found, parts = np.full(self.own.shape[1], float(constants.USUAL_RUN_SCATTER)), self.parts()
        for _ in range(constants.RUN_SCATTER_STEPS):
            values, variances = self.own_numbers(parts, found)
            last, found = found, np.sqrt(np.mean(values**2 + variances, axis=0))
            if np.all(np.abs(found - last) < constants.RUN_SCATTER_TOLERANCE * last):
                break
        return np.maximum(found, float(constants.LEAST_RUN_SCATTER))

    def left_out(self, group: np.ndarray, spread: np.ndarray) -> np.ndarray:
        """Errors (m,) of the rows when each group (m,), a run or a piece of one, is predicted from all other rows.

        What remains of the run shows its own numbers; those of a whole run that is left out have their expected value.
        """
        parts = self.parts()
        matrix, pull = self.common(parts, spread)
        error = np.empty_like(self.residual)
        every = parts.eliminated(spread)
        for k, run in enumerate(np.unique(self.run)):
            rows, whole = np.flatnonzero(self.run == run), (every[0][k], every[1][k])
            for piece in np.unique(group[rows]):
                out, rest = rows[group[rows] == piece], self.part(rows[group[rows] != piece])
                left = rest.eliminated(spread)
                shared = -np.linalg.solve(matrix - whole[0] + left[0], pull - whole[1] + left[1])
                own = rest.solved(shared, spread)
                error[out] = self.residual[out] + self.slope[out] @ shared + self.own[out] @ own
        return error


def halves_of_runs(points: Points) -> np.ndarray:
    """Number (n,) of the half of its run that each point is in, from 0: either side of the middle of sideslip, or of camber.

    The two sides share the tyre's state but not their angles, so that what one of them shows is no detail of its own curve.
    """
    out = np.empty(len(points), dtype=int)
    for k, run in enumerate(np.unique(points.sweep)):
        rows = points.sweep == run
        angle = max((points.alpha[rows], points.gamma[rows]), key=np.ptp)
        out[rows] = 2 * k + (angle > 0.5 * (angle.min() + angle.max()))
    return out
