"""Scatter of grip and stiffness from run to run: its size, and its effect on the prediction of left-out readings.

A run is a sweep. Its own numbers act on its own readings only, so they are eliminated run by run, and the equations that
remain are those of the shared numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields
from typing import NamedTuple

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

    @classmethod
    def sum(cls, parts: Iterable[Part], k: int, j: int) -> Part:
        """The equations of several parts together; zeros without any."""
        none = cls.of(np.zeros((0, k)), np.zeros((0, j)), np.zeros(0))
        every = [none, *parts]
        return cls(*(np.sum([getattr(part, f.name) for part in every], axis=0) for f in fields(cls)))

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


class OfRuns(NamedTuple):
    """Linearised readings of some whole runs."""

    point: np.ndarray  #: (m,) index of the point
    slope: np.ndarray  #: (m, k) derivatives by the shared numbers, in units of the noise
    own: np.ndarray  #: (m, j) derivatives by a number of all runs, for every kind of own number
    residual: np.ndarray  #: (m,) model less measured

    def part(self, which: np.ndarray) -> Part:
        """The equations of some of the readings, by their rows (r,)."""
        slope, own = (np.take(x.T, which, axis=1).T for x in (self.slope, self.own))  # by columns in memory
        return Part.of(slope, own, self.residual[which])


@dataclass(frozen=True, slots=True)
class Runs:
    """A linearised fit whose runs may have numbers of their own."""

    rows: Callable[[], Iterator[OfRuns]]
    """All readings, by whole runs, channel after channel; computed when they are asked for, because they may be many."""
    run: np.ndarray  #: (n,) index of each point's run
    information: (
        np.ndarray
    )  #: (k, k) about the shared numbers from priors and from readings that belong to no run
    pull: np.ndarray  #: (k,) half the derivative of the sum of squares of these

    def parts(self) -> Part:
        """The equations of all runs, in the order of :meth:`rows` and of their index within a block."""
        each = [
            rows.part(np.flatnonzero(self.run[rows.point] == k))
            for rows in self.rows()
            for k in np.unique(self.run[rows.point])
        ]
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

    def spread(self, parts: Part) -> np.ndarray:
        """Standard deviation (j,) of the own numbers among the runs, of maximum likelihood; ``parts`` are :meth:`parts`.

        Iterated: the mean square of the numbers, each with its variance. Runs that do not show a number keep its variance.
        """
        found = np.full(parts.own.shape[-1], float(constants.USUAL_RUN_SCATTER))
        for _ in range(constants.RUN_SCATTER_STEPS):
            values, variances = self.own_numbers(parts, found)
            last, found = found, np.sqrt(np.mean(values**2 + variances, axis=0))
            if np.all(np.abs(found - last) < constants.RUN_SCATTER_TOLERANCE * last):
                break
        return np.maximum(found, float(constants.LEAST_RUN_SCATTER))

    def left_out(self, parts: Part, group: np.ndarray, spreads: Sequence[np.ndarray]) -> np.ndarray:
        """Errors (s, c, n) of the readings when each group (n,), a run or a piece of one, is predicted from all other readings.

        What remains of the run shows its own numbers; those of a whole run that is left out have their expected value. One
        prediction for each of the ``spreads`` (j,).
        """
        known = [(spread, *self.common(parts, spread)) for spread in spreads]
        blocks = [(rows.point, self._errors(rows, group[rows.point], known)) for rows in self.rows()]
        channels = len(blocks[0][0]) // len(np.unique(blocks[0][0]))
        error = np.empty((len(spreads), channels, len(group)))
        for point, found in blocks:
            own = point[: len(point) // channels]
            error[:, :, own] = found.reshape(len(spreads), channels, -1)
        return error

    def _errors(
        self, rows: OfRuns, group: np.ndarray, known: Sequence[tuple[np.ndarray, np.ndarray, np.ndarray]]
    ) -> np.ndarray:
        """Errors (s, m) of the readings of some runs; ``known`` are spread and common equations of all runs."""
        error, run = np.empty((len(known), len(group))), self.run[rows.point]
        size = rows.slope.shape[1], rows.own.shape[1]
        for k in np.unique(run):
            mine = np.flatnonzero(run == k)
            pieces = {piece: mine[group[mine] == piece] for piece in np.unique(group[mine]).tolist()}
            equations = {piece: rows.part(which) for piece, which in pieces.items()}
            all_of_it = Part.sum(equations.values(), *size)
            for piece, out in pieces.items():
                rest = Part.sum((part for other, part in equations.items() if other != piece), *size)
                for to, (spread, matrix, pull) in zip(error, known, strict=True):
                    whole, left = all_of_it.eliminated(spread), rest.eliminated(spread)
                    shared = -np.linalg.solve(matrix - whole[0] + left[0], pull - whole[1] + left[1])
                    own = rest.solved(shared, spread)
                    to[out] = rows.residual[out] + rows.slope[out] @ shared + rows.own[out] @ own
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
