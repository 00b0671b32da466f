"""Coefficients that are fitted beside the least squares of the points: radii, rolling resistance, relaxation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from mffit.fit import constants
from mffit.least_squares import root
from tir import Quantity
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class BesideNumbers:
    """Coefficients that were fitted beside the others, to readings of their own."""

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

    def drawn(
        self, values: Mapping[str, Any], best: Mapping[str, Any], random: np.random.Generator
    ) -> dict[str, float]:
        """The coefficients of a tyre whose other ``values`` were drawn before; ``best`` are those of the fit.

        A stiffness stays positive: where no draw is, the coefficients are the best ones.
        """
        if not self.values:
            return {}
        names, mean = list(self.values), np.array(list(self.values.values()))
        if self.leans_on:
            mean = mean + self.slope @ [float(values[n]) - float(best[n]) for n in self.leans_on]
        for _ in range(constants.MOST_DRAWS):
            draw = mean + root(self.covariance) @ random.standard_normal(len(mean))
            drawn = dict(zip(names, draw.tolist(), strict=True))
            if all(x > 0.0 for name, x in drawn.items() if name.endswith("STIFFNESS")):
                return drawn
        return dict(self.values)
