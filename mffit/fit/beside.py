"""Coefficients that come from elsewhere than the points: radii, rolling resistance, relaxation, a sister tyre."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.fit import constants
from mffit.fit.constraints import Envelope, violations
from mffit.least_squares import root
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
    envelope: Envelope | None = (
        None  #: over which a drawn tyre keeps the physical limits, if they depend on these
    )

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

    def drawn(
        self, values: Mapping[str, Any], best: Mapping[str, Any], random: np.random.Generator
    ) -> dict[str, float]:
        """The coefficients of a tyre whose other ``values`` were drawn before; ``best`` are those of the fit.

        Drawn again until they keep their limits; after many draws nearer and nearer to the best ones.
        """
        if not self.values:
            return {}
        names, mean = list(self.values), np.array(list(self.values.values()))
        if self.leans_on:
            mean = mean + self.slope @ [
                float(values.get(n, 0.0)) - float(best.get(n, 0.0)) for n in self.leans_on
            ]  # rig errors move no coefficient
        spread = root(self.covariance)
        for k in range(2 * constants.MOST_DRAWS):
            away = spread @ random.standard_normal(len(mean))
            draw = mean + away * 0.5 ** max(0, k - constants.MOST_DRAWS)
            drawn = {name: BY_NAME[name].inside(x) for name, x in zip(names, draw.tolist(), strict=True)}
            if self.keeps_limits({**values, **drawn}):
                return drawn
        return dict(self.values)

    def keeps_limits(self, values: Mapping[str, Any]) -> bool:
        """Whether a drawn tyre is possible: stiffnesses are positive, and the limits hold over the envelope of the data."""
        positive = all(values[name] > 0.0 for name in self.values if name.endswith("STIFFNESS"))
        if self.envelope is None or not positive:
            return positive
        return bool(np.max(violations(SimpleNamespace(**values), self.envelope)) <= constants.LIMIT_MARGIN)
