"""The search for parameters, against integrals that are known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from mffit.linearised.search import (
    ParameterSearch,
    Scored,
    Scoring,
    SearchedParameter,
    arcsine,
    half_cauchy,
    normal,
    share_of,
    uniform,
)


@pytest.mark.parametrize("prior", [half_cauchy, arcsine, uniform])
def test_a_prior_is_a_density_on_the_scale_of_the_search(prior):
    assert quad(lambda x: math.exp(prior(x)[0]), -30.0, 30.0)[0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("prior", [half_cauchy, arcsine, uniform, normal(0.5, 2.0)])
@pytest.mark.parametrize("x", [-2.0, 0.3, 3.0])
def test_the_slope_of_a_prior_is_its_difference(prior, x):
    assert prior(x)[1] == pytest.approx((prior(x + 1e-5)[0] - prior(x - 1e-5)[0]) / 2e-5, abs=1e-8)


def test_log_odds_without_end_are_no_share():
    assert share_of(-math.inf) == 0.0
    assert share_of(0.0) == 0.5


def test_the_probability_of_a_normal_posterior_is_exact():
    """Two parameters with a normal prior, seen through a normal likelihood: the integral has a closed form."""
    information, at = np.array([[30.0, 8.0], [8.0, 12.0]]), np.array([0.4, -0.7])

    def evidence(x: np.ndarray) -> tuple[float, np.ndarray]:
        return -0.5 * float((x - at) @ information @ (x - at)), -information @ (x - at)

    one = SearchedParameter(0.0, -9.0, 9.0, normal(0.0, 2.0))
    search = ParameterSearch({"a": one, "b": one}, evidence, 50)
    x, probability = search.most_probable({"b": 1.0})
    whole = information + np.eye(2) / 4.0
    np.testing.assert_allclose(x, np.linalg.solve(whole, information @ at), atol=0.02)
    left = 0.5 * float(at @ information @ at - at @ information @ np.linalg.solve(whole, information @ at))
    expected = 0.5 * math.log((2.0 * math.pi) ** 2 / np.linalg.det(whole)) - left
    assert probability == pytest.approx(expected, abs=0.01)


def test_the_search_keeps_to_its_bounds():
    search = ParameterSearch(
        {"a": SearchedParameter(0.0, -1.0, 1.0)}, lambda x: (3.0 * x[0], np.array([3.0])), 10
    )
    assert search.most_probable()[0] == pytest.approx([1.0])


@pytest.mark.parametrize("start", [-9.0, -2.0, 3.0, 9.0])
def test_scoring_finds_the_variance_of_readings(start):
    """The most likely variance is the mean square; of 50 readings the search ends within a fraction of its uncertainty."""
    n, square = 50, 50.0 * math.exp(0.7)
    looks = []

    def evidence(x: np.ndarray) -> Scored:
        looks.append(x)
        misfit = square * math.exp(-x[0])
        return Scored(-0.5 * (n * x[0] + misfit), np.array([0.5 * (misfit - n)]), np.array([[0.5 * n]]))

    (x,) = Scoring([SearchedParameter(0.0, -9.0, 9.0)], evidence).most_probable([start])
    assert x == pytest.approx(0.7, abs=0.01)
    assert len(looks) < 20


def test_scoring_keeps_to_its_bounds_and_to_what_is_known():
    """Of two normal parameters, one ends at its bound, the other one at its best given the first, its prior included."""
    information, at = np.array([[30.0, 8.0], [8.0, 12.0]]), np.array([4.0, -0.7])

    def evidence(x: np.ndarray) -> Scored:
        return Scored(-0.5 * (x - at) @ information @ (x - at), -information @ (x - at), information.copy())

    parameters = [SearchedParameter(0.0, -1.0, 1.0), SearchedParameter(0.0, -9.0, 9.0, normal(0.0, 0.5))]
    x = Scoring(parameters, evidence).most_probable([0.0, 0.0])
    assert x[0] == 1.0
    assert x[1] == pytest.approx((8.0 * 3.0 - 12.0 * 0.7) / (12.0 + 4.0), abs=0.02)
