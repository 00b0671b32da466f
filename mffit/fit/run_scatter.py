"""Numbers that scatter from run to run: their size, what others explain beside them, and the prediction of left-out readings.

A run is a sweep. Its own numbers act on its own readings only, so they are eliminated run by run, and the equations that
remain are those of the shared numbers.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np

from mffit.fit import constants
from mffit.left_out import Support, alone
from mffit.points import Points


@dataclass(frozen=True, slots=True)
class Part:
    """Normal equations of some readings, shared numbers (k,) beside the own numbers (j,) of their run.

    Those of several runs have one more axis in front, but for the sums ``shared`` and ``shared_pull``.
    """

    shared: np.ndarray  #: (k, k)
    mixed: np.ndarray  #: (..., k, j)
    own: np.ndarray  #: (..., j, j)
    shared_pull: np.ndarray  #: (k,) derivatives times residuals
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
        """Equations of the shared numbers alone: matrix (k, k) and pull (k,)."""
        k, j = self.mixed.shape[-2:]
        mixed, pull = self.mixed.reshape(-1, k, j), self.own_pull.reshape(-1, j)
        through = (self.mixed @ self.inverse(spread)).reshape(-1, k, j)
        matrix = self.shared - np.tensordot(through, mixed, axes=([0, 2], [0, 2]))
        return matrix, self.shared_pull - np.tensordot(through, pull, axes=([0, 2], [0, 1]))

    def moved(self, step: np.ndarray) -> Part:
        """The equations after a step (k,) of the shared numbers."""
        own = self.own_pull + np.swapaxes(self.mixed, -1, -2) @ step
        return replace(self, shared_pull=self.shared_pull + self.shared @ step, own_pull=own)

    def only(self, kept: np.ndarray) -> Part:
        """The equations without the shared numbers that are not ``kept``, by their index (i,)."""
        return replace(
            self,
            shared=self.shared[np.ix_(kept, kept)],
            mixed=self.mixed[..., kept, :],
            shared_pull=self.shared_pull[kept],
        )

    def solved(self, shared: np.ndarray, spread: np.ndarray) -> np.ndarray:
        """Change of the own numbers (..., j) for a change of the shared ones (k,)."""
        return np.asarray(-(self.inverse(spread) @ self.moved(shared).own_pull[..., None])[..., 0])


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
        runs: dict[str, list[np.ndarray]] = {"mixed": [], "own": [], "own_pull": []}
        shared, pull = np.zeros_like(self.information), np.zeros_like(self.pull)
        for rows in self.rows():
            for k in np.unique(self.run[rows.point]):
                part = rows.part(np.flatnonzero(self.run[rows.point] == k))
                shared, pull = shared + part.shared, pull + part.shared_pull
                for name, each in runs.items():
                    each.append(getattr(part, name))
        return Part(shared, shared_pull=pull, **{name: np.array(each) for name, each in runs.items()})

    def common(self, parts: Part, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Equations of the shared numbers from all runs and priors."""
        matrix, pull = parts.eliminated(spread)
        return self.information + matrix, self.pull + pull

    def own_numbers(self, parts: Part, spread: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Own numbers (runs, j) and their variances (runs, j)."""
        matrix, pull = self.common(parts, spread)
        covariance, inverse = np.linalg.inv(matrix), parts.inverse(spread)
        through = parts.mixed @ inverse
        inside = inverse + np.swapaxes(through, -1, -2) @ covariance @ through
        return parts.solved(-covariance @ pull, spread), np.diagonal(inside, axis1=-2, axis2=-1)

    def spread(self, parts: Part) -> np.ndarray:
        """Standard deviation (j,) of the own numbers among the runs, of the restricted likelihood; ``parts`` are :meth:`parts`.

        Iterated: the sum of squares of the numbers over how many of them the readings determine (MacKay, Neural Computation
        1992, 4, 415, section 4.3), which also reaches a scatter of zero soon.
        """
        found = np.full(parts.own.shape[-1], float(constants.USUAL_RUN_SCATTER))
        for _ in range(constants.RUN_SCATTER_STEPS):
            values, _ = self.own_numbers(parts, found)
            known = np.maximum(self.determined(parts, found), np.finfo(float).tiny)
            last = found
            found = np.maximum(np.sqrt(np.sum(values**2, axis=0) / known), float(constants.LEAST_RUN_SCATTER))
            if np.all(np.abs(found - last) < constants.RUN_SCATTER_TOLERANCE * last):
                break
        return found

    def determined(self, parts: Part, spread: np.ndarray) -> np.ndarray:
        """How many (j,) of the own numbers the readings determine, rather than their spread."""
        _, variances = self.own_numbers(parts, spread)
        return np.asarray(np.sum(np.maximum(1.0 - variances / spread**2, 0.0), axis=0))

    def support(self, parts: Part, kept: np.ndarray, more: np.ndarray, step: np.ndarray) -> Support:
        """What the shared numbers ``more`` explain beside the others of ``kept``, by their index (i,) and (m,).

        Numbers are first moved by ``step`` (k,), which takes ``more`` and those that are not kept to where they have no effect.
        The own numbers scatter as they do with all of ``kept``: without them, what they explain would count as scatter. The
        degrees of freedom of this scatter follow Satterthwaite (Biometrics Bulletin 1946, 2, 110).
        """
        information = self.information[np.ix_(kept, kept)]
        there = replace(self, information=information, pull=(self.pull + self.information @ step)[kept])
        parts, place = parts.moved(step).only(kept), np.flatnonzero(np.isin(kept, more))
        spread = there.spread(parts)
        own, gradient = alone(*there.common(parts, spread), place)
        alike, plain = alone(*there.common(parts, np.zeros_like(spread)), place)
        share = 1.0 - float(np.trace(np.linalg.solve(alike, own))) / len(more)
        known = max(float(np.mean(there.determined(parts, spread))), 1.0)
        return Support(
            chi2=float(gradient @ np.linalg.solve(own, gradient)),
            removed=float(plain @ np.linalg.solve(alike, plain)),
            numbers=len(more),
            freedom=known / max(share, np.finfo(float).eps) ** 2,
        )

    def support_of_scatter(self, parts: Part, spread: np.ndarray) -> Support:
        """What the scatter of the own numbers explains, by the restricted likelihood."""
        gain = self._deviance(parts, np.zeros_like(spread)) - self._deviance(parts, spread)
        return Support(chi2=gain, removed=gain, numbers=len(spread), freedom=np.inf)

    def explained(self, parts: Part, spread: np.ndarray) -> float:
        """Sum of squares of the residuals that the own numbers and a step of the shared ones to the best take away."""
        matrix, pull = self.common(parts, spread)
        own = np.einsum("...i,...ij,...j", parts.own_pull, parts.inverse(spread), parts.own_pull)
        return float(np.sum(own) + pull @ np.linalg.solve(matrix, pull))

    def _deviance(self, parts: Part, spread: np.ndarray) -> float:
        """-2 log of the restricted likelihood, less what does not depend on the spread."""
        inside = np.eye(len(spread)) + spread[:, None] * parts.own * spread
        volume = np.sum(np.linalg.slogdet(inside)[1]) + np.linalg.slogdet(self.common(parts, spread)[0])[1]
        return float(volume) - self.explained(parts, spread)

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
