"""Named numbers as one normal distribution: information from readings, priors, and every question about both."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from mffit.as_json import keys
from mffit.brief import Brief
from mffit.least_squares import inverse, root
from tir.frozen import ReadOnlyArrays

ABOUT = (
    "What the readings alone tell of the numbers x, around their values v, to first order: "
    "log-likelihood = score.(x-v) - (x-v).information.(x-v)/2. Read by `mffit fleet`."
)


@dataclass(frozen=True, repr=False, eq=False)
class Numbers(ReadOnlyArrays, Brief):
    """Numbers with the information of the readings about them, and with priors; normal, to first order around the values.

    A ``held`` number keeps its prior: the readings do not move it, and its error moves the others.
    """

    names: tuple[str, ...]  #: coefficients and rig errors
    values: np.ndarray  #: (k,) the estimate
    information: np.ndarray  #: (k, k) of the readings alone
    score: np.ndarray  #: (k,) derivative of the readings' log-likelihood at the values
    expected: np.ndarray  #: (k,) prior means
    spread: np.ndarray  #: (k,) prior standard deviations, inf without a prior
    held: frozenset[str] = frozenset()

    @classmethod
    def of(
        cls, names: Sequence[str], values: Sequence[float] | np.ndarray, covariance: np.ndarray
    ) -> Numbers:
        """Numbers of which only a covariance (k, k) is known."""
        k, at = len(names), np.asarray(values, dtype=float)
        return cls(tuple(names), at, inverse(covariance), np.zeros(k), at, np.full(k, math.inf))

    @classmethod
    def beforehand(
        cls,
        names: Sequence[str],
        values: np.ndarray,
        expected: np.ndarray,
        spread: np.ndarray,
        held: Collection[str] = (),
    ) -> Numbers:
        """Numbers of which only the priors are known."""
        k = len(names)
        return cls(tuple(names), values, np.zeros((k, k)), np.zeros(k), expected, spread, frozenset(held))

    @cached_property
    def covariance(self) -> np.ndarray:
        """Covariance (k, k) of the estimate."""
        free, held = self._split(self.held)
        own = self._inverse(free)
        moves = own @ self.information[np.ix_(free, held)]
        known = self.spread[held] ** 2
        out = np.zeros((len(self.names), len(self.names)))
        out[np.ix_(free, free)] = own + (moves * known) @ moves.T
        out[np.ix_(free, held)] = -moves * known
        out[np.ix_(held, free)] = out[np.ix_(free, held)].T
        out[held, held] = known
        return out

    @cached_property
    def root(self) -> np.ndarray:
        """A matrix R (k, k) with R @ R.T = covariance: its columns are changes by independent numbers of variance 1."""
        return root(self.covariance)

    @cached_property
    def stderr(self) -> dict[str, float]:
        """Standard uncertainty by name."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    def rows(self, names: Iterable[str]) -> list[int]:
        """Positions of the named numbers."""
        place = {name: i for i, name in enumerate(self.names)}
        return [place[name] for name in names]

    def covariance_of(self, names: Sequence[str]) -> np.ndarray:
        """Covariance (j, j) of some numbers; 0 for an unknown name, whose number is exact."""
        known = [i for i, name in enumerate(names) if name in self.stderr]
        rows = self.rows(names[i] for i in known)
        out = np.zeros((len(names), len(names)))
        out[np.ix_(known, known)] = self.covariance[np.ix_(rows, rows)]
        return out

    def spread_of(self, slopes: np.ndarray, names: Sequence[str]) -> np.ndarray:
        """Standard uncertainty (n,) of quantities with the derivatives ``slopes`` (n, j) by the named numbers."""
        variance = np.sum(slopes @ self.covariance_of(names) * slopes, axis=1)
        return np.asarray(np.sqrt(np.maximum(variance, 0.0)))

    def given(self, names: Collection[str]) -> Numbers:
        """The other numbers, with the named ones exactly known."""
        return self._only(self._split(names)[0])

    def without(self, names: Collection[str]) -> Numbers:
        """The other numbers, with the named ones, none of them held, left to the readings and to their priors."""
        kept, out = self._split(names)
        across = self.information[np.ix_(kept, out)]
        moves = across @ self._inverse(out)
        pull = self.score[out] - self._precision(out) * (self.values - self.expected)[out]
        left = self._only(kept)
        return replace(left, information=left.information - moves @ across.T, score=left.score - moves @ pull)

    def renamed(self, names: Sequence[str]) -> Numbers:
        """The same numbers under other names."""
        new = dict(zip(self.names, names, strict=True))
        return replace(self, names=tuple(names), held=frozenset(new[name] for name in self.held))

    def beside(
        self,
        values: Mapping[str, float],
        covariance: np.ndarray,
        leans_on: Sequence[str],
        slope: np.ndarray,
    ) -> Numbers:
        """The numbers with further ones (j,), determined by readings of their own with the numbers ``leans_on`` taken as exact.

        ``covariance`` (j, j) is theirs under that condition, ``slope`` (j, m) their derivatives by ``leans_on``. Numbers that
        are known already stay as they are.
        """
        new = [i for i, name in enumerate(values) if name not in self.names]
        names, at = [list(values)[i] for i in new], [list(values.values())[i] for i in new]
        by = np.zeros((len(new), len(self.names)))
        if leans_on:
            by[:, self.rows(leans_on)] = slope[new]
        told = inverse(covariance[np.ix_(new, new)]) if new else np.zeros((0, 0))
        across = -told @ by
        return Numbers(
            names=(*self.names, *names),
            values=np.append(self.values, at),
            information=np.block([[self.information - by.T @ across, across.T], [across, told]]),
            score=np.append(self.score, np.zeros(len(new))),
            expected=np.append(self.expected, at),
            spread=np.append(self.spread, np.full(len(new), math.inf)),
            held=self.held,
        )

    def moved_by(self) -> dict[str, np.ndarray]:
        """By number with a prior, the change (k,) of the values by one standard deviation of its prior mean."""
        free, held = self._split(self.held)
        moves = np.zeros_like(self.information)  # by a unit of prior mean over its variance
        moves[np.ix_(free, free)] = self._inverse(free)
        moves[:, held] = self.covariance[:, held]
        return {
            name: moves[:, i] / u
            for i, (name, u) in enumerate(zip(self.names, self.spread.tolist(), strict=True))
            if 0.0 < u < math.inf
        }

    def strongest_correlations(self, of: Sequence[str], least: float) -> dict[str, tuple[str, float]]:
        """By number ``of`` these, the one that is most correlated with it and the correlation, if it exceeds ``least``."""
        covariance = self.covariance_of(of)
        size = np.sqrt(np.diag(covariance))
        correlation = covariance / np.outer(size, size)
        np.fill_diagonal(correlation, 0.0)
        strongest = np.argmax(np.abs(correlation), axis=1) if len(of) else []
        pairs = zip(of, enumerate(strongest), strict=True)
        return {
            name: (of[j], float(correlation[i, j]))
            for name, (i, j) in pairs
            if abs(correlation[i, j]) > least
        }

    def _split(self, names: Collection[str]) -> tuple[list[int], list[int]]:
        """Positions of the other numbers, and of the named ones."""
        named = [name in names for name in self.names]
        return [i for i, is_named in enumerate(named) if not is_named], list(np.flatnonzero(named))

    def _precision(self, rows: Sequence[int]) -> np.ndarray:
        return np.asarray(self.spread[rows] ** -2.0)

    def _inverse(self, rows: Sequence[int]) -> np.ndarray:
        """Covariance of some numbers with all others exactly known."""
        return inverse(self.information[np.ix_(rows, rows)] + np.diag(self._precision(rows)))

    def _only(self, rows: Sequence[int]) -> Numbers:
        return Numbers(
            names=tuple(self.names[i] for i in rows),
            values=self.values[rows],
            information=self.information[np.ix_(rows, rows)],
            score=self.score[rows],
            expected=self.expected[rows],
            spread=self.spread[rows],
            held=self.held & {self.names[i] for i in rows},
        )


keys(Numbers, "names covariance")


def to_json(numbers: Numbers) -> dict[str, Any]:
    """The content of ``information.json``; the symmetric matrix as rows up to the diagonal."""
    return {
        "about": ABOUT,
        "names": list(numbers.names),
        "values": numbers.values.tolist(),
        "information": [row[: i + 1] for i, row in enumerate(numbers.information.tolist())],
        "score": numbers.score.tolist(),
        "expected": numbers.expected.tolist(),
        "spread": [None if math.isinf(u) else u for u in numbers.spread.tolist()],
        "held": sorted(numbers.held),
    }


def from_json(content: Mapping[str, Any]) -> Numbers:
    """The record from the content of ``information.json``.

    Raises ValueError, KeyError or TypeError if the content has another form.
    """
    names = tuple(str(name) for name in content["names"])
    information = np.zeros((len(names), len(names)))
    for i, row in enumerate(content["information"]):
        information[i, : i + 1] = row
    information += np.tril(information, -1).T
    vectors = {n: np.array(content[n], dtype=float) for n in ("values", "score", "expected")}
    spread = np.array([math.inf if u is None else float(u) for u in content["spread"]])
    if any(len(v) != len(names) for v in (*vectors.values(), spread)) or not np.all(np.isfinite(information)):
        raise ValueError("names, information and vectors must have one length")
    held = frozenset(map(str, content["held"]))
    return Numbers(names=names, information=information, spread=spread, held=held, **vectors)
