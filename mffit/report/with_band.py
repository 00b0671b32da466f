"""Any quantity of the fitted tyre with its 95 % band, for the pictures only."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import Posterior
from mffit.fit.posterior import spread_through
from tir.derivatives import gradient, plain, traced

OfTyre = Callable[[Any], Any]
"""A quantity (n,) from an object with the file's parameter names."""


class Banded(NamedTuple):
    """A quantity (n,) and half the width of its 95 % band (n,)."""

    line: np.ndarray
    half: np.ndarray


def with_band(values: Mapping[str, Any], posterior: Posterior, quantity: OfTyre) -> Banded:
    """A quantity of the tyre of these values; errors of the rig count through the coefficients that they made uncertain."""
    rows = [i for i, name in enumerate(posterior.names) if name in values]
    numbers = traced({posterior.names[i]: float(values[posterior.names[i]]) for i in rows})
    found = quantity(SimpleNamespace(**{**values, **numbers}))
    line = np.asarray(plain(found), dtype=float)
    slopes = np.broadcast_to(gradient(found, list(numbers.values())), (len(line), len(rows)))
    spread = spread_through(slopes, posterior.covariance[np.ix_(rows, rows)])
    return Banded(line, COVERAGE_FACTOR_95 * spread)
