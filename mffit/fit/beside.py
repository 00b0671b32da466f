"""Coefficients determined outside the main fit: from radii, rolling resistance or relaxation."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from mffit.numbers import Numbers
from tir import Quantity
from tir.frozen import ReadOnlyArrays
from tir.parameters import BY_NAME


@dataclass(frozen=True, slots=True)
class BesideNumbers(ReadOnlyArrays):
    """Coefficients determined separately from the main fit, from their own readings."""

    values: Mapping[str, float] = field(default_factory=dict)  #: (k,)
    covariance: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))
    """(k, k) with the coefficients of the main fit taken as exact."""
    leans_on: tuple[str, ...] = ()  #: (m,) coefficients of the main fit on which these values depend
    slope: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  #: (k, m) derivatives by these

    @property
    def quantities(self) -> dict[str, Quantity]:
        """The coefficients with the standard uncertainties of ``covariance``."""
        u = np.sqrt(np.diag(self.covariance)).tolist()
        return {n: Quantity(x, s, BY_NAME[n].unit) for (n, x), s in zip(self.values.items(), u, strict=True)}


def with_beside(known: Numbers, found: BesideNumbers) -> Numbers:
    """The numbers with separately determined coefficients; those that are known already are unchanged."""
    return known.beside(found.values, found.covariance, found.leans_on, found.slope)
