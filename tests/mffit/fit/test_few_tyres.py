"""The prior of a coefficient whose spread few published tyres tell: Student's t, by the density of scipy."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from scipy.optimize import minimize_scalar
from scipy.stats import norm, t

from mffit.fit.plan import FitPlan

SPREAD, TYRES = 1.3, 8
"""Of PDX3 in the table."""


def most_probable(name: str, spread: float, shown: float, u: float) -> float:
    """By the fit's way: normal priors around the value that the last pass found."""
    plan, value = FitPlan(cover=(), expected={name: 0.5}, scatter={name: spread}), 0.5
    for _ in range(200):
        here: Any = SimpleNamespace(simulation=SimpleNamespace(values={name: value}))
        (number,) = plan.coefficients([name], here)
        weight, prior = u**-2.0, number.spread**-2.0
        value = (weight * shown + prior * number.expected) / (weight + prior)
    return value


@pytest.mark.parametrize(("shown", "u"), [(1.5, 3.0), (4.0, 1.0), (20.0, 0.5), (-6.0, 0.7)])
def test_the_pull_is_that_of_students_t(shown, u):
    def minus_log_density(x: float) -> float:
        return float(-norm.logpdf(shown, x, u) - t.logpdf(x, TYRES - 1, 0.5, SPREAD))

    ends = sorted((0.5, shown))
    expected = minimize_scalar(
        minus_log_density, ends, method="bounded", bounds=ends, options={"xatol": 1e-9}
    ).x
    assert most_probable("PDX3", SPREAD, shown, u) == pytest.approx(expected, abs=1e-5)


def test_a_spread_from_elsewhere_is_that_of_a_normal_prior():
    weight = 1.0 / (1.0 + 4.0)  # of a reading with twice the spread as uncertainty
    assert most_probable("PDX3", 1.0, 20.0, 2.0) == pytest.approx(0.5 + weight * 19.5)
