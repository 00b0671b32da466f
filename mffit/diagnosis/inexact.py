"""How inexact the given model's coefficients are: uncertain numbers with a prior, estimated together with the effects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from mffit.fit.priors import scatter
from mffit.least_squares import root
from mffit.points import Points
from mffit.rig import Simulation
from tir import Tyre
from tir.parameters import TABLE


@dataclass(frozen=True, slots=True)
class Inexactness:
    """Prior of the given model's coefficients: normal around the values in the file."""

    names: tuple[str, ...]
    expected: np.ndarray  #: (k,) values in the file
    root: np.ndarray  #: (k, k) the covariance is root root'

    def __bool__(self) -> bool:
        return bool(self.names)

    def columns(self, points: Points, state: Simulation) -> np.ndarray:
        """Changes of the readings (2n, k), one prior standard deviation each."""
        if not self.names:
            return np.zeros((2 * len(points), 0))
        _, slope = state.sensitivities(points, self.names)
        return np.nan_to_num(np.concatenate(slope)) @ self.root

    def moved(self, points: Points, state: Simulation, at: Simulation) -> np.ndarray:
        """What has to be added to readings (2n,) for the prior to be centred where ``at`` has left it.

        ``state`` is where :meth:`columns` are taken.
        """
        if not self.names:
            return np.zeros(2 * len(points))
        _, slope = state.sensitivities(points, self.names)
        away = np.array([float(at.values[name]) for name in self.names]) - self.expected
        return np.nan_to_num(np.concatenate(slope)) @ away

    def without(self, names: frozenset[str]) -> Inexactness:
        """The prior of the others, whatever these are."""
        kept = [k for k, name in enumerate(self.names) if name not in names]
        if len(kept) == len(self.names):
            return self
        covariance = (self.root @ self.root.T)[np.ix_(kept, kept)]
        return correlated([self.names[k] for k in kept], self.expected[kept], covariance)


EXACT = Inexactness((), np.empty(0), np.empty((0, 0)))


def declared(tyre: Tyre, u_coefficients: float) -> Inexactness:
    """Every P.Y. and Q.Z. coefficient that the file has, off by a share of itself."""
    if u_coefficients <= 0.0:
        return EXACT
    names = [row.name for row in TABLE if row.normal_mode and float(tyre[row.name])]
    values = np.array([float(tyre[name]) for name in names])
    return Inexactness(tuple(names), values, np.diag(u_coefficients * np.abs(values)))


def refitted(tyre: Tyre, *, curved: bool) -> Inexactness:
    """The coefficients that a build fitted, free to move again as far as coefficients of similar tyres scatter.

    For points that were already used to fit them: what is known of them beyond that is in these points.
    """
    fitted = [row.name for row in TABLE if row.kind == "number" and "+-" in tyre.status.get(row.name, "")]
    spread = {n: scatter(n, float(tyre[n]), from_base=True, curved=curved) for n in fitted}
    known = {n: u for n, u in spread.items() if np.isfinite(u) and u > 0.0}
    values = np.array([float(tyre[name]) for name in known])
    return Inexactness(tuple(known), values, np.diag(list(known.values())))


def correlated(names: Sequence[str], expected: np.ndarray, covariance: np.ndarray) -> Inexactness:
    """The posterior of an earlier fit as prior."""
    return Inexactness(tuple(names), np.asarray(expected), root(covariance))
