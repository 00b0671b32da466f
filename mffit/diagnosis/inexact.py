"""Uncertainty of the given model's coefficients: nuisance parameters with a prior, estimated together with the effects."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import block_diag

from mffit.fit.priors import scatter
from mffit.least_squares import root
from mffit.points import Points
from mffit.quantities import SIDEWAYS
from mffit.rig import Simulation
from tir import Tyre
from tir.frozen import ReadOnlyArrays
from tir.parameters import TABLE


def slopes_of(state: Simulation, points: Points, names: Sequence[str], channels: Iterable[str]) -> np.ndarray:
    """Derivatives of the readings (c n, k) of a simulation by the named numbers; 0 where they are undefined."""
    if not names:
        return np.zeros((len(tuple(channels)) * len(points), 0))
    return np.nan_to_num(state.sensitivities(points, names, channels)[1].stacked)


@dataclass(frozen=True, slots=True)
class Inexactness(ReadOnlyArrays):
    """Prior of the given model's coefficients: normal around the values in the file."""

    names: tuple[str, ...]
    expected: np.ndarray  #: (k,) values in the file
    root: np.ndarray  #: (k, k); root @ root.T is the covariance

    def __bool__(self) -> bool:
        return bool(self.names)

    def columns(self, points: Points, state: Simulation, channels: Iterable[str] = SIDEWAYS) -> np.ndarray:
        """Changes of the readings (c n, k) by one prior standard deviation each."""
        return slopes_of(state, points, self.names, channels) @ self.root

    def moved(
        self, points: Points, state: Simulation, at: Simulation, channels: Iterable[str] = SIDEWAYS
    ) -> np.ndarray:
        """Change of the readings (c n,) if the coefficients move from the prior mean to those of ``at``.

        ``state`` is the simulation at which the derivatives are taken, as for :meth:`columns`.
        """
        away = np.array([at.number(name, points) for name in self.names]) - self.expected
        return slopes_of(state, points, self.names, channels) @ away

    def unit(self, n: int, spread: Sequence[float] | None = None) -> np.ndarray:
        """Changes (n + k, n + k) of ``n`` other numbers by their spread, else by 1, then of these by one standard deviation."""
        return np.asarray(block_diag(np.diag(np.ones(n) if spread is None else spread), self.root))

    def numbers(self, names: Sequence[str], x: np.ndarray) -> dict[str, float]:
        """Other numbers by name, then these, from their values and from moves of these in standard deviations."""
        own = self.expected + self.root @ x[len(names) :]
        return dict(zip((*names, *self.names), [*x[: len(names)].tolist(), *own.tolist()], strict=True))

    def ordered(self, free: Collection[str]) -> Inexactness:
        """The same prior, numbers that are not ``free`` first, with a triangular root: its last units move the free ones only."""
        order = sorted(range(len(self.names)), key=lambda k: self.names[k] in free)
        _, upper = np.linalg.qr(self.root[order].T)
        return Inexactness(tuple(self.names[k] for k in order), self.expected[order], upper.T)

    def holding(self, names: Collection[str]) -> Inexactness:
        """The prior of the other numbers if these are as expected."""
        found = self.ordered([name for name in self.names if name not in names])
        held = sum(name in names for name in self.names)
        return Inexactness(found.names[held:], found.expected[held:], found.root[held:, held:])

    def without(self, names: frozenset[str]) -> Inexactness:
        """The marginal prior of the other coefficients."""
        kept = [k for k, name in enumerate(self.names) if name not in names]
        if len(kept) == len(self.names):
            return self
        covariance = (self.root @ self.root.T)[np.ix_(kept, kept)]
        return correlated([self.names[k] for k in kept], self.expected[kept], covariance)


EXACT = Inexactness((), np.empty(0), np.empty((0, 0)))


def declared(tyre: Tyre, u_coefficients: float) -> Inexactness:
    """A prior with independent relative errors of every nonzero lateral and aligning coefficient of a file."""
    if u_coefficients <= 0.0:
        return EXACT
    names = [row.name for row in TABLE if row.normal_mode and float(tyre[row.name])]
    values = np.array([float(tyre[name]) for name in names])
    return Inexactness(tuple(names), values, np.diag(u_coefficients * np.abs(values)))


def with_rig(
    known: Inexactness, priors: Mapping[str, tuple[float, float]], names: Sequence[str]
) -> Inexactness:
    """The prior with the named numbers of the rig added; ``priors`` has the value and standard uncertainty of each."""
    if not names:
        return known
    values, u = zip(*(priors[name] for name in names), strict=True)
    root = block_diag(known.root, np.diag(u))
    return Inexactness((*known.names, *names), np.concatenate([known.expected, values]), root)


def refitted(tyre: Tyre, *, curved: bool, stated: Mapping[str, float] | None = None) -> Inexactness:
    """The coefficients that a build fitted, with the scatter of similar tyres or the ``stated`` one as prior.

    For points that the build already used: the posterior of the build would count them twice.
    """
    fitted = [row.name for row in TABLE if row.kind == "number" and "+-" in tyre.status.get(row.name, "")]
    spread = {n: scatter(n, float(tyre[n]), from_base=True, curved=curved) for n in fitted}
    spread |= {n: u for n, u in (stated or {}).items() if n in spread}
    known = {n: u for n, u in spread.items() if np.isfinite(u) and u > 0.0}
    values = np.array([float(tyre[name]) for name in known])
    return Inexactness(tuple(known), values, np.diag(list(known.values())))


def correlated(names: Sequence[str], expected: np.ndarray, covariance: np.ndarray) -> Inexactness:
    """The posterior of an earlier fit as prior."""
    return Inexactness(tuple(names), np.asarray(expected), root(covariance))
