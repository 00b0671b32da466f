"""The covariance between loads: that of the library of numbers with uncertainty, and the same in every run."""

from __future__ import annotations

import numpy as np
from uncertainties import UFloat, covariance_matrix, ufloat

from mffit.measured.loads import covariance


def with_common_sources() -> list[UFloat]:
    """Three numbers that share some of seven sources."""
    sources = [ufloat(1.0 + 0.1 * k, 0.07 / (1 + k)) for k in range(7)]
    return [
        sources[0] * sources[1] / sources[2] + sources[3],
        sources[2] ** 2 * sources[4] - sources[5],
        sources[0] / sources[5] + sources[6] * sources[1],
    ]


def test_it_is_the_covariance_of_common_sources():
    numbers = with_common_sources()
    np.testing.assert_allclose(covariance(numbers), covariance_matrix(numbers), rtol=1e-12)


def test_it_does_not_depend_on_where_the_sources_lie_in_memory():
    kept, found = [], set()
    for k in range(40):
        kept.append([object() for _ in range(17 * k % 23)])
        found.add(covariance(with_common_sources()).tobytes())
    assert len(found) == 1
