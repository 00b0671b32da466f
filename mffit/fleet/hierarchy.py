"""Joint estimate of all tyres of a rig: common rig errors, and tyres that scatter around an estimated population.

Tyre i has numbers x_i, the rig has errors theta. The likelihood of its points is ``exp(-z L_i z / 2 + h_i z)`` with
``z = (x_i, theta)``. The priors are ``x_i ~ N(mu, diag(tau^2))``, ``mu ~ N(expected, spread^2)``, and the declared prior of theta
once for all tyres. Given tau this is a linear mixed model with the tyres as groups; expectation maximisation estimates tau^2.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.as_json import keys
from mffit.constants import FEWEST
from mffit.fit.priors import scatter
from mffit.fleet import constants
from mffit.linearised.mixed import Mixed, MixedPosterior, Variances
from mffit.numbers import Numbers
from mffit.rig_errors import OF_RUN, error_of, rig_estimates
from tir.frozen import ReadOnlyArrays
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class Population:
    """Distribution of one coefficient over the tyres."""

    mean: float
    u_mean: float
    scatter: float  #: standard deviation between tyres
    tyres: int  #: number of tyres whose points inform it

    @property
    def assumed(self) -> bool:
        """Whether the scatter is that of tyres in general, because there are too few tyres."""
        return self.tyres < FEWEST


keys(Population, "* assumed")


@dataclass(frozen=True, slots=True)
class TyreEstimate(ReadOnlyArrays):
    """One tyre in the joint estimate."""

    names: tuple[str, ...]
    values: np.ndarray  #: (k,)
    covariance: np.ndarray  #: (k, k)
    strain: Mapping[str, float]
    """By rig error, its shift by this tyre from the estimate of all others, over the expected standard deviation."""

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
    rig: Mapping[str, tuple[float, float]]  #: common rig error -> (value, standard uncertainty)
    declared: Mapping[str, tuple[float, float]]  #: common rig error -> declared (value, standard uncertainty)
    population: Mapping[str, Population]
    """By coefficient that at least two tyres inform; empty if there are unlike kinds of tyres."""


keys(Hierarchy, "errors population", errors=lambda rig: rig_estimates(rig.rig))


def estimate(found: Sequence[Numbers]) -> Hierarchy:
    """The joint estimate of all tyres of one rig; for one tyre, its own build's estimate with PECP1 and PECP2 free.

    Names of coefficients end in ``@`` and the kind of the tyre if there are unlike ones. A coefficient that only one tyre has
    keeps the prior of its build.
    """
    tyres = _Tyres(found)
    tau = tyres.general.copy()
    learnt = tyres.count >= FEWEST
    for _ in range(200 if learnt.any() else 0):
        # Dividing by the number of tyres less one avoids underestimating the scatter.
        mean_square = tyres.squares(tau) / np.maximum(tyres.count - 1, 1)
        new = np.clip(np.sqrt(mean_square), 1e-3 * tyres.general, tyres.general)
        new = np.where(learnt, new, tyres.general)
        moved = np.max(np.abs(np.log(new / tau)))
        tau = new
        if moved < 1e-3:
            break
    return tyres.described(tau)


class _Tyres:
    """The points of all tyres as one linear mixed model.

    Common numbers are rig errors and population means; the random effects of a tyre are its differences from these means.
    """

    def __init__(self, found: Sequence[Numbers]) -> None:
        self.found = found
        self.own = tuple(dict.fromkeys(i.names[k] for i in found for k in _rows(i, rig=False)))
        self.shared = tuple(dict.fromkeys(i.names[k] for i in found for k in _rows(i, rig=True)))
        self.count = np.array([sum(name in i.names for i in found) for name in self.own])
        self.centre, spread = _prior(found, self.own)
        self.rig_centre, self.rig_spread = _prior(found, self.shared)
        plain = [_plain(name) for name in self.own]
        width = np.array([BY_NAME[name].width for name in plain])
        general = [
            scatter(n, c, from_base=False, curved=False) for n, c in zip(plain, self.centre, strict=True)
        ]
        size = np.maximum(np.abs(self.centre), 1.0)  # of coefficients without bounds
        width, scattered = (np.where(np.isfinite(x), x, size) for x in (width, general))
        self.general = np.where(np.isfinite(spread), spread, scattered)
        self.known = np.where(np.isfinite(spread), spread, width)  # prior spread of the population mean
        self.informing = np.array(
            [
                sum(_informs(i, name, u) for i in found)
                for name, u in zip(self.own, self.known.tolist(), strict=True)
            ]
        )
        lone = self.count == 1
        self.general = np.where(lone, self.known, self.general)
        self.known = np.where(lone, 1e-6 * self.known, self.known)
        self.mine = [[self.own.index(i.names[k]) for k in _rows(i, rig=False)] for i in found]
        self.model = self._model()

    def _model(self) -> Mixed:
        """Pseudo-readings with the likelihood of the tyres' points, relative to the prior means."""
        names = (*self.shared, *self.own)
        sizes = np.concatenate([self.rig_spread, np.maximum(self.known, self.general)])
        centres = np.concatenate([self.rig_centre, self.centre])
        residual, common = [], []
        groups: list[np.ndarray] = []
        for one in self.found:
            place = [names.index(name) for name in one.names]
            size = sizes[place]
            information, axes = np.linalg.eigh(size[:, None] * one.information * size)
            seen = information > np.finfo(float).eps * np.max(information, initial=0.0)
            root, axes = np.sqrt(information[seen]), axes[:, seen]
            slope = np.zeros((len(root), len(names)))
            slope[:, place] = root[:, None] * axes.T / size
            common.append(slope)
            residual.append(
                axes.T @ (size * (one.information @ one.values + one.score)) / root - slope @ centres
            )
            groups.append(np.arange(len(root)) + sum(len(rows) for rows in groups))
        columns = np.concatenate(common)
        return Mixed(np.concatenate(residual), columns, columns[:, len(self.shared) :], groups)

    def given(self, tau: np.ndarray) -> Variances:
        """The prior variances for a scatter (K,) of the population."""
        return Variances(2.0 * np.log(np.concatenate([self.rig_spread, self.known])), 2.0 * np.log(tau), 0.0)

    def squares(self, tau: np.ndarray) -> np.ndarray:
        """Expected sum (K,) over the tyres of the squared differences from the population mean."""
        found, out = self.model.posterior(self.given(tau)), np.zeros(len(self.own))
        for k, mine in enumerate(self.mine):
            difference, covariance = self._own(found, k, with_mean=False)
            out[mine] += difference**2 + np.diag(covariance)
        return out

    def _own(self, found: MixedPosterior, k: int, *, with_mean: bool) -> tuple[np.ndarray, np.ndarray]:
        """The numbers of tyre ``k`` relative to their prior means, and their covariance.

        ``with_mean``: including the difference of the population mean from its prior mean.
        """
        rows, mine = self.model.groups[k], self.mine[k]
        by_common = -found.half[k][mine] @ found.halfway[k]
        alone = found.own[k][mine] @ (self.model.own[rows].T @ self.model.residual[rows])
        if with_mean:
            by_common[range(len(mine)), [len(self.shared) + j for j in mine]] += 1.0
        root = by_common @ found.root
        return alone + by_common @ found.mean, found.own[k][np.ix_(mine, mine)] + root @ root.T

    def described(self, tau: np.ndarray) -> Hierarchy:
        """The solution by name."""
        found, m = self.model.posterior(self.given(tau)), len(self.shared)
        value = found.mean + np.concatenate([self.rig_centre, self.centre])
        u = np.sqrt(np.sum(found.root**2, axis=1))
        common = [k for k, name in enumerate(self.shared) if self._is_common(name)]
        tyres = []
        for k, mine in enumerate(self.mine):
            x, covariance = self._own(found, k, with_mean=True)
            names = tuple(_plain(self.own[j]) for j in mine)
            strain = self._strain(k, found, common)
            tyres.append(TyreEstimate(names, self.centre[mine] + x, covariance, strain))
        return Hierarchy(
            tyres=tuple(tyres),
            rig={self.shared[k]: (float(value[k]), float(u[k])) for k in common},
            declared={self.shared[k]: (float(self.rig_centre[k]), float(self.rig_spread[k])) for k in common},
            population={
                name: Population(
                    mean=float(value[m + k]),
                    u_mean=float(u[m + k]),
                    scatter=float(tau[k]),
                    tyres=int(self.informing[k]),
                )
                for k, name in enumerate(self.own)
                if self.informing[k] >= 2 and OF_RUN not in name
            },
        )

    def _is_common(self, name: str) -> bool:
        """Whether an error of the rig is common to two or more tyres, or there is only one tyre."""
        return len(self.found) == 1 or sum(name in one.names for one in self.found) > 1

    def _strain(self, k: int, found: MixedPosterior, common: Sequence[int]) -> dict[str, float]:
        """By rig error, its shift by tyre ``k`` in standard deviations.

        The covariance of the shift is the covariance without the tyre less that with it.
        """
        if len(self.found) < 2:
            return {}
        rows = self.model.groups[k]
        x, own, error = self.model.common[rows], self.model.own[rows], self.model.residual[rows]
        told = x - own @ (found.own[k] @ (own.T @ x))  # columns with the tyre's random effects marginalised
        share = found.root.T @ (x.T @ told) @ found.root  # the tyre's share of the posterior information
        without = np.linalg.inv(np.eye(len(share)) - share)
        moved = found.root @ without @ (found.root.T @ (told.T @ (error - x @ found.mean)))
        variance = np.sum((found.root @ (without @ share)) * found.root, axis=1)
        return {
            self.shared[i]: float(moved[i] / np.sqrt(variance[i]))
            for i in common
            if _informs(self.found[k], self.shared[i], float(self.rig_spread[i]))
        }


def _plain(name: str) -> str:
    """The name of a coefficient without its kind of tyre."""
    return name.partition(OF_RUN)[0]


def _rows(one: Numbers, *, rig: bool) -> list[int]:
    """Indices of the rig errors, or of the tyre's own numbers."""
    return [i for i, name in enumerate(one.names) if (error_of(name) is not None) == rig]


def _informs(one: Numbers, name: str, known: float) -> bool:
    """Whether a tyre's points narrow the prior of a number, with all other numbers known."""
    if name not in one.names:
        return False
    k = one.names.index(name)
    return bool(1.0 / (1.0 + one.information[k, k] * known**2) < constants.INFORMED_VARIANCE_SHARE)


def _prior(found: Sequence[Numbers], names: Sequence[str]) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard deviation of the builds' priors: the mean of the means, and the largest standard deviation."""
    centre, spread = np.zeros(len(names)), np.full(len(names), np.inf)
    for k, name in enumerate(names):
        rows = [(i.expected[j], i.spread[j]) for i in found for j, n in enumerate(i.names) if n == name]
        centre[k] = np.mean([c for c, _ in rows])
        spread[k] = max(s for _, s in rows)
    return centre, spread
