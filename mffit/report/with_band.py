"""Any quantity of the fitted tyre with its 95 % band, for the pictures only."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import Posterior
from mffit.fit.posterior import spread_through
from tir.derivatives import gradient, plain, traced

OfTyre = Callable[[Any], Any]
"""A quantity (n,), or several of them, from an object with the file's parameter names."""


class Banded(NamedTuple):
    """A quantity (n,) and half the width of its 95 % band (n,)."""

    line: np.ndarray
    half: np.ndarray


def with_band(values: Mapping[str, Any], posterior: Posterior, quantity: OfTyre) -> Banded:
    """A quantity of the tyre of these values; errors of the rig count through the coefficients that they made uncertain."""
    (found,) = several_with_band(values, posterior, lambda p: [quantity(p)])
    return found


def several_with_band(
    values: Mapping[str, Any], posterior: Posterior, quantities: Callable[[Any], Sequence[Any]]
) -> list[Banded]:
    """The same for several quantities of one computation."""
    rows = [i for i, name in enumerate(posterior.names) if name in values]
    numbers = traced({posterior.names[i]: float(values[posterior.names[i]]) for i in rows})
    covariance = posterior.covariance[np.ix_(rows, rows)]
    found = []
    for quantity in quantities(SimpleNamespace(**{**values, **numbers})):
        line = np.asarray(plain(quantity), dtype=float)
        slopes = np.broadcast_to(gradient(quantity, list(numbers.values())), (len(line), len(rows)))
        found.append(Banded(line, COVERAGE_FACTOR_95 * spread_through(slopes, covariance)))
    return found
