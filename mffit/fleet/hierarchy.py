"""Joint estimate of all tyres of a rig: common rig errors, and tyres that scatter around a population estimated with them.

Tyre i has numbers x_i, the rig has errors theta. The likelihood of its points is ``exp(-z L_i z / 2 + h_i z)`` with
``z = (x_i, theta)``. The priors are ``x_i ~ N(mu, diag(tau^2))``, ``mu ~ N(expected, spread^2)`` and theta as the rig declares,
once for all tyres. Everything but tau is linear and Gaussian and solved exactly; tau^2 is found by expectation maximisation.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.fit.priors import scatter
from mffit.fleet import constants
from mffit.fleet.information import Information
from mffit.least_squares import inverse
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class Population:
    """Distribution of one coefficient over the tyres."""

    mean: float
    u_mean: float
    scatter: float  #: from tyre to tyre, 1 sigma
    tyres: int  #: whose points inform it

    @property
    def assumed(self) -> bool:
        """Whether the scatter is that of tyres in general, because these tyres are too few."""
        return self.tyres < constants.FEWEST_TYRES_FOR_SCATTER


@dataclass(frozen=True, slots=True)
class TyreEstimate:
    """One tyre in the joint estimate."""

    names: tuple[str, ...]
    values: np.ndarray  #: (k,)
    covariance: np.ndarray  #: (k, k)
    strain: Mapping[str, float]
    """By rig error: how far this tyre moves it from where the others put it, over the expected standard deviation."""

    def number(self, name: str) -> tuple[float, float] | None:
        """Value and standard uncertainty; None if the number was not free in the tyre's build."""
        if name not in self.names:
            return None
        i = self.names.index(name)
        return float(self.values[i]), float(np.sqrt(self.covariance[i, i]))


@dataclass(frozen=True, slots=True)
class Hierarchy:
    """The estimate of one rig and its tyres."""

    tyres: tuple[TyreEstimate, ...]  #: in the order given
    rig: Mapping[str, tuple[float, float]]  #: rig error that tyres share -> (value, standard uncertainty)
    declared: Mapping[str, tuple[float, float]]  #: the same as declared
    population: Mapping[str, Population]  #: of coefficients that at least two tyres inform


def estimate(found: Sequence[Information]) -> Hierarchy:
    """Estimate all tyres of one rig together; for one tyre, its own build's estimate with PECP1 and PECP2 free.

    Parameters
    ----------
    found : information of each tyre's build on this rig
    """
    model = _Model(found)
    tau = model.general.copy()
    learnt = model.count >= constants.FEWEST_TYRES_FOR_SCATTER
    for _ in range(200 if learnt.any() else 0):
        # Division by one tyre less keeps the scatter off zero, where it would be overconfident.
        mean_square = model.solved(tau).squares / np.maximum(model.count - 1, 1)
        new = np.clip(np.sqrt(mean_square), 1e-3 * model.general, model.general)
        new = np.where(learnt, new, model.general)
        moved = np.max(np.abs(np.log(new / tau)))
        tau = new
        if moved < 1e-3:
            break
    return model.described(tau)


class _Model:
    """The tyres' information, and the exact solution for a given scatter."""

    def __init__(self, found: Sequence[Information]) -> None:
        self.found = found
        self.own = tuple(dict.fromkeys(i.names[k] for i in found for k in i.rows(rig=False)))
        self.shared = tuple(dict.fromkeys(i.names[k] for i in found for k in i.rows(rig=True)))
        self.count = np.array([sum(name in i.names for i in found) for name in self.own])
        self.centre, spread = _prior(found, self.own)
        self.rig_centre, self.rig_spread = _prior(found, self.shared)
        width = np.array([BY_NAME[name].width for name in self.own])
        general = [
            scatter(n, c, from_base=False, curved=False) for n, c in zip(self.own, self.centre, strict=True)
        ]
        size = np.maximum(np.abs(self.centre), 1.0)  # of coefficients without bounds
        width, scattered = (np.where(np.isfinite(x), x, size) for x in (width, general))
        self.general = np.where(np.isfinite(spread), spread, scattered)
        self.known = np.where(np.isfinite(spread), spread, width)  # of the population's mean
        self.informing = np.array(
            [
                sum(_informs(i, name, u) for i in found)
                for name, u in zip(self.own, self.known.tolist(), strict=True)
            ]
        )
        if len(found) == 1:  # the prior of its build, which had no population
            self.general, self.known = self.known, 1e-6 * self.known

    def prior(self) -> tuple[np.ndarray, np.ndarray]:
        """Prior of the common numbers, theta and mu: precision (m + K, m + K) and vector."""
        spread = np.concatenate([self.rig_spread, self.known])
        return np.diag(spread**-2.0), np.concatenate([self.rig_centre, self.centre]) * spread**-2.0

    def part(self, one: Information, tau: np.ndarray) -> _Part:
        """Information of one tyre about the common numbers, its own numbers eliminated."""
        m, size = len(self.shared), len(self.shared) + len(self.own)
        own, rig = one.rows(rig=False), one.rows(rig=True)
        mine = [m + self.own.index(one.names[k]) for k in own]
        theirs = [self.shared.index(one.names[k]) for k in rig]
        ties = tau[[k - m for k in mine]] ** -2.0
        inner = inverse(one.matrix[np.ix_(own, own)] + np.diag(ties))
        B = np.zeros((len(own), size))
        B[:, theirs] = one.matrix[np.ix_(own, rig)]
        B[range(len(own)), mine] = -ties
        gain = inner @ B
        precision, vector = -B.T @ gain, -gain.T @ one.vector[own]
        precision[np.ix_(theirs, theirs)] += one.matrix[np.ix_(rig, rig)]
        precision[mine, mine] += ties
        vector[theirs] += one.vector[rig]
        return _Part(mine, inner, gain, inner @ one.vector[own], precision, vector)

    def solved(self, tau: np.ndarray) -> _Solved:
        """Mean and covariance of every number, given the population's scatter (K,)."""
        precision, vector = self.prior()
        parts = [self.part(one, tau) for one in self.found]
        covariance = inverse(precision + sum(part.precision for part in parts))
        common = covariance @ (vector + sum(part.vector for part in parts))
        squares = np.zeros(len(self.own))
        tyres = []
        for part in parts:
            x = part.own - part.gain @ common
            C = part.inner + part.gain @ covariance @ part.gain.T
            with_mean = -part.gain @ covariance[:, part.mine]
            away = np.diag(C) + np.diag(covariance)[part.mine] - 2.0 * np.diag(with_mean)
            k = [i - len(self.shared) for i in part.mine]
            squares[k] += (x - common[part.mine]) ** 2 + np.maximum(away, 0.0)
            tyres.append((x, C))
        return _Solved(tuple(parts), tuple(tyres), common, covariance, squares)

    def described(self, tau: np.ndarray) -> Hierarchy:
        """The solution by name."""
        found, m = self.solved(tau), len(self.shared)
        u = np.sqrt(np.diag(found.covariance))
        rig = {
            n: (float(found.common[k]), float(u[k])) for k, n in enumerate(self.shared) if self.is_common(n)
        }
        population = {
            name: Population(
                mean=float(found.common[m + k]),
                u_mean=float(u[m + k]),
                scatter=float(tau[k]),
                tyres=int(self.informing[k]),
            )
            for k, name in enumerate(self.own)
            if self.informing[k] >= 2
        }
        tyres = tuple(
            TyreEstimate(
                tuple(one.names[k] for k in one.rows(rig=False)), x, C, self._strain(one, part, found)
            )
            for one, part, (x, C) in zip(self.found, found.parts, found.tyres, strict=True)
        )
        known = zip(self.rig_centre.tolist(), self.rig_spread.tolist(), strict=True)
        declared = {n: prior for n, prior in zip(self.shared, known, strict=True) if n in rig}
        return Hierarchy(tyres, rig, declared, population)

    def is_common(self, name: str) -> bool:
        """Whether an error of the rig is common to two or more tyres, or there is only one tyre."""
        return len(self.found) == 1 or sum(name in one.names for one in self.found) > 1

    def _strain(self, one: Information, part: _Part, found: _Solved) -> dict[str, float]:
        """How one tyre moves the errors of the rig. The covariances without and with it differ by that of the move."""
        if len(found.parts) < 2:
            return {}
        precision, vector = self.prior()
        others = [other for other in found.parts if other is not part]
        covariance = inverse(precision + sum(other.precision for other in others))
        moved = found.common - covariance @ (vector + sum(other.vector for other in others))
        variance = np.diag(covariance - found.covariance)
        return {
            name: float(moved[k] / np.sqrt(variance[k]))
            for k, name in enumerate(self.shared)
            if self.is_common(name) and _informs(one, name, float(self.rig_spread[k]))
        }


@dataclass(frozen=True, slots=True)
class _Part:
    """Contribution of one tyre to the joint estimate."""

    mine: list[int]  #: positions of the means of its numbers among the common numbers
    inner: np.ndarray  #: (k, k) covariance of its numbers, given the common ones
    gain: np.ndarray  #: (k, m + K) negative derivative of its numbers by the common ones
    own: np.ndarray  #: (k,) its numbers if the common ones are zero
    precision: np.ndarray  #: (m + K, m + K)
    vector: np.ndarray  #: (m + K,)


@dataclass(frozen=True, slots=True)
class _Solved:
    parts: tuple[_Part, ...]
    tyres: tuple[tuple[np.ndarray, np.ndarray], ...]
    common: np.ndarray  #: (m + K,) rig errors, then the population's means
    covariance: np.ndarray
    squares: np.ndarray  #: (K,) expected sum over the tyres of (x - mu)^2


def _informs(one: Information, name: str, known: float) -> bool:
    """Whether a tyre's points narrow the prior of a number, everything else given."""
    if name not in one.names:
        return False
    k = one.names.index(name)
    return bool(1.0 / (1.0 + one.matrix[k, k] * known**2) < constants.INFORMED_VARIANCE_SHARE)


def _prior(found: Sequence[Information], names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Centre and spread of the builds' priors: mean of the centres, widest spread."""
    centre, spread = np.zeros(len(names)), np.full(len(names), np.inf)
    for k, name in enumerate(names):
        rows = [(i.expected[j], i.spread[j]) for i in found for j, n in enumerate(i.names) if n == name]
        centre[k] = np.mean([c for c, _ in rows])
        spread[k] = max(s for _, s in rows)
    return centre, spread
