"""Coefficients that come from elsewhere than the points: radii, rolling resistance, relaxation, a sister tyre."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from tir import Quantity
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class BesideNumbers:
    """Coefficients that were found after the others, from readings or files of their own."""

    values: Mapping[str, float] = field(default_factory=dict)  #: (k,)
    covariance: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    """(k, k) from their own readings, where the others are exact."""
    leans_on: tuple[str, ...] = ()  #: (m,) coefficients of the fit that their values follow
    slope: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  #: (k, m) derivatives by these

    @property
    def quantities(self) -> dict[str, Quantity]:
        """The coefficients with the standard uncertainties from their own readings."""
        u = np.sqrt(np.diag(self.covariance)).tolist()
        return {n: Quantity(x, s, BY_NAME[n].unit) for (n, x), s in zip(self.values.items(), u, strict=True)}

    def only(self, names: Collection[str]) -> BesideNumbers:
        """Some of them."""
        rows = [i for i, name in enumerate(self.values) if name in names]
        return replace(
            self,
            values={name: x for name, x in self.values.items() if name in names},
            covariance=self.covariance[np.ix_(rows, rows)],
            slope=self.slope[rows],
        )
