"""Readings whose errors have a memory, against the explicit Gaussian distribution."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mffit.linearised import constants
from mffit.linearised.chained import Chained, ChainedErrors, Memory, chains_of

M, K = 60, 9
MEMORIES = [Memory(0.7, 0.3), Memory(0.95, 0.0), Memory(0.0, 0.0)]


@pytest.fixture(scope="module")
def case():
    rng = np.random.default_rng(1)
    chain = rng.permutation(np.repeat([0, 1, 2, 3], [25, 20, 10, 5]))
    model = Chained(rng.normal(0.0, 9.0, M), rng.normal(0.0, 3.0, (M, K)), chains_of(chain))
    return model, chain, rng.uniform(3.0, 6.0, M), rng.uniform(0.5, 2.0, K)


def covariance(chain, u, memory):
    place = np.array([np.sum(chain[:i] == chain[i]) for i in range(M)])
    alike = memory.correlation ** np.abs(np.subtract.outer(place, place)) * (chain[:, None] == chain)
    alike = (1.0 - memory.independent) * alike
    np.fill_diagonal(alike, 1.0)
    return np.outer(u, u) * alike


@pytest.mark.parametrize("memory", MEMORIES)
def test_the_evidence_is_the_density_of_the_readings(case, memory):
    model, chain, u, sizes = case
    scaled = model.columns * sizes
    whole = covariance(chain, u, memory) + scaled @ scaled.T
    expected = multivariate_normal(np.zeros(M), whole).logpdf(model.residual) + 0.5 * M * np.log(2.0 * np.pi)
    assert model.evidence(u, sizes, memory).value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("memory", MEMORIES[:2])
def test_its_slopes_are_its_differences(case, memory):
    model, _, u, sizes = case
    found, step = model.evidence(u, sizes, memory), 1e-5

    def differences(at, count):
        unit = step * np.eye(count)
        return np.array([(at(d) - at(-d)) / (2.0 * step) for d in unit])

    by_size = differences(lambda d: model.evidence(u, sizes * np.exp(d), memory).value, K)
    by_u = differences(lambda d: model.evidence(u * np.exp(d), sizes, memory).value, M)
    by_memory = differences(lambda d: model.evidence(u, sizes, Memory(*(np.array(memory) + d))).value, 2)
    np.testing.assert_allclose(found.sizes, by_size, atol=1e-5)
    np.testing.assert_allclose(found.u, by_u, atol=1e-5)
    np.testing.assert_allclose(found.memory, by_memory, rtol=1e-5, atol=1e-4)


@pytest.mark.parametrize("memory", MEMORIES)
def test_each_reading_is_foretold_by_all_others(case, memory):
    model, chain, u, sizes = case
    scaled = model.columns * sizes
    errors = covariance(chain, u, memory)
    whole = errors + scaled @ scaled.T
    found = model.foretold(u, sizes, memory)
    for i in (0, 7, 33):
        rest = np.arange(M) != i
        weight = np.linalg.solve(whole[np.ix_(rest, rest)], whole[rest, i])
        error = model.residual[i] - weight @ model.residual[rest]
        variance = whole[i, i] - weight @ whole[rest, i]
        own = errors[i, i] - errors[i, rest] @ np.linalg.solve(errors[np.ix_(rest, rest)], errors[rest, i])
        assert found.error[i] * u[i] == pytest.approx(error)
        assert found.variance[i] * u[i] ** 2 == pytest.approx(variance)
        assert found.own[i] * u[i] ** 2 == pytest.approx(own)


def test_a_very_long_chain_is_cut():
    longest = int(constants.LONGEST_CHAIN)
    chains = chains_of(np.zeros(2 * longest + 5, dtype=int))
    assert [len(rows) for rows in chains] == [longest, longest, 5]
    errors = ChainedErrors(chains, Memory(0.9))
    white = errors.whiten(np.eye(2 * longest + 5)[:, :longest])
    inside = white[:longest] @ Memory(0.9).matrix(longest) @ white[:longest].T
    np.testing.assert_allclose(inside, np.eye(longest), atol=1e-9)


def test_a_turn_that_is_missing_begins_another_chain():
    chains = chains_of(np.zeros(5, dtype=int), np.array([4, 0, 1, 5, 2]))
    assert [rows.tolist() for rows in chains] == [[1, 2, 4], [0, 3]]
