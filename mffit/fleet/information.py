"""Information of one build's points about tyre and rig, without the priors."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mffit.fit.fitted import Fitted
from mffit.fit.priors import scatter
from mffit.rig_errors import BESIDE, error_of

SPIN = ("PECP1", "PECP2")
"""Coefficients that the points inform even if the build holds them at the result of the direct method."""
MEASURED = ("PECP1",)
"""Coefficients without a prior, because the uncertainty with which the fit holds them comes from the same points."""


@dataclass(frozen=True, slots=True)
class Information:
    """A quadratic log-likelihood ``-x matrix x / 2 + x vector`` of the numbers ``x``, and their priors.

    To first order around the build's solution.
    """

    names: tuple[str, ...]  #: free coefficients and rig errors
    values: np.ndarray  #: (k,) solution of the build
    matrix: np.ndarray  #: (k, k) information matrix of the points alone
    vector: np.ndarray  #: (k,)
    expected: np.ndarray  #: (k,) prior means
    spread: np.ndarray  #: (k,) prior standard deviations, inf without a prior
    moved_by: Mapping[str, np.ndarray] = field(default_factory=dict)
    """By declared rig error or held measured coefficient, the change of ``values`` by one standard uncertainty of it."""

    def rows(self, *, rig: bool) -> list[int]:
        """Indices of the rig errors, or of the tyre's own numbers."""
        return [i for i, name in enumerate(self.names) if (error_of(name) is not None) == rig]

    def without(self, names: Collection[str]) -> Information:
        """The information about the other numbers, with the named ones marginalised over their priors."""
        out = [i for i, name in enumerate(self.names) if name in names]
        kept = [i for i, name in enumerate(self.names) if name not in names]
        prior = self.spread[out] ** -2.0
        across = self.matrix[np.ix_(kept, out)]
        shift = np.linalg.solve(self.matrix[np.ix_(out, out)] + np.diag(prior), across.T).T
        return replace(
            self,
            names=tuple(self.names[i] for i in kept),
            values=self.values[kept],
            matrix=self.matrix[np.ix_(kept, kept)] - shift @ across.T,
            vector=self.vector[kept] - shift @ (self.vector[out] + prior * self.expected[out]),
            expected=self.expected[kept],
            spread=self.spread[kept],
            moved_by={name: move[kept] for name, move in self.moved_by.items()},
        )


def information(fitted: Fitted) -> Information | None:
    """The information of a fit; None if nothing was free.

    Numbers at a bound or a physical limit are left out, because the likelihood is not quadratic there. Effects of the tyre that
    are not coefficients are marginalised, as they are estimated anew in every build.
    """
    prior = {n.name: (n.expected, n.spread) for n in fitted.numbers}
    values = fitted.simulation.values
    for name in (*fitted.held, *(SPIN if "PECP1" in {*prior, *fitted.held} else ())):
        value = float(values[name])
        if name not in fitted.hand.held:
            prior.setdefault(name, (value, fitted.held.get(name, math.inf)))
    if "PECP2" in prior and "PECP2" not in {n.name for n in fitted.numbers}:
        prior["PECP2"] = (0.0, scatter("PECP2", 0.0, from_base=False, curved=False))
    for name in MEASURED:
        if name in prior:
            prior[name] = (prior[name][0], math.inf)
    names = [name for name in prior if name not in fitted.at_bound]
    if not names:
        return None
    problem, simulation = fitted.problem, fitted.simulation
    at = np.array([simulation.number(name, problem.points) for name in names])
    here = problem.free(names).linear(at)
    matrix = here.slope.T @ here.slope
    centre, spread = zip(*(prior[name] for name in names), strict=True)
    found = Information(
        names=tuple(names),
        values=at,
        matrix=matrix,
        vector=matrix @ at - here.slope.T @ here.data,
        expected=np.array(centre),
        spread=np.array(spread),
        moved_by=_moved_by(fitted, names),
    )
    return found.without([error.name for error in BESIDE])


def _moved_by(fitted: Fitted, names: Sequence[str]) -> dict[str, np.ndarray]:
    """By rig error or held measured coefficient, the changes of the named numbers by one standard uncertainty of it.

    A fitted number changes with its prior as far as the points leave it free; a held number changes fully.
    """
    prior, held = {n.name: n.spread for n in fitted.inner}, fitted.taken_as_exact
    every, k, problem = (*prior, *held), len(prior), fitted.problem
    u = np.array([*prior.values(), *held.values()])
    slope = problem.free(every).linear(np.array([problem.value(name) for name in every])).slope
    told = slope.T @ slope
    yields = np.linalg.inv(told[:k, :k] + np.diag(u[:k] ** -2.0))
    free = np.hstack([yields / u[:k], -yields @ told[:k, k:] * u[k:]])
    moves = dict(zip(every, np.vstack([free, np.diag(u)[k:]]), strict=True))
    still = np.zeros(len(every))
    return {
        name: np.array([moves.get(number, still)[i] for number in names])
        for i, name in enumerate(every)
        if (error_of(name) or (name in held and name in MEASURED)) and u[i] < math.inf
    }


def to_json(found: Information | None) -> dict[str, Any]:
    """The content of ``information.json``; the symmetric matrix as rows up to the diagonal."""
    if found is None:
        return {"names": []}
    return {
        "about": "Information of the points alone about the build's numbers x, to first order: "
        "log-likelihood = vector.x - x.matrix.x/2. Read by `mffit fleet`.",
        "names": list(found.names),
        "values": found.values.tolist(),
        "matrix": [row[: i + 1] for i, row in enumerate(found.matrix.tolist())],
        "vector": found.vector.tolist(),
        "expected": found.expected.tolist(),
        "spread": [None if math.isinf(u) else u for u in found.spread.tolist()],
        "moved_by": {name: move.tolist() for name, move in found.moved_by.items()},
    }


def from_json(content: Mapping[str, Any]) -> Information:
    """The record from the content of ``information.json``.

    Raises ValueError, KeyError or TypeError if the content has another form.
    """
    names = tuple(str(name) for name in content["names"])
    k = len(names)
    matrix = np.zeros((k, k))
    for i, row in enumerate(content["matrix"]):
        matrix[i, : i + 1] = row
    matrix += np.tril(matrix, -1).T
    vectors = {n: np.array(content[n], dtype=float) for n in ("values", "vector", "expected")}
    spread = np.array([math.inf if u is None else float(u) for u in content["spread"]])
    moves = {str(name): np.array(move, dtype=float) for name, move in content["moved_by"].items()}
    if any(len(v) != k for v in (*vectors.values(), spread, *moves.values())) or not np.all(
        np.isfinite(matrix)
    ):
        raise ValueError("names, matrix and vectors must have one length")
    return Information(names=names, matrix=matrix, spread=spread, **vectors, moved_by=moves)
