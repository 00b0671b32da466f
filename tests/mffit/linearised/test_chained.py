"""Readings whose errors have a memory, against the explicit Gaussian distribution."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mffit.linearised import constants
from mffit.linearised.chained import Chained, ChainedErrors, Memory, chains_of

M = 60
MEMORIES = [{"correlation": 0.8, "independent": -0.8}, {"correlation": 3.0}, {}]
SIZES = {"shape": 0.3, "part": -0.4}


@pytest.fixture(scope="module")
def case():
    """Two terms of columns and two of noise, one of each with a size, and weights."""
    rng = np.random.default_rng(1)
    chain = rng.permutation(np.repeat([0, 1, 2, 3], [25, 20, 10, 5]))
    columns = {"known": rng.normal(0.0, 3.0, (M, 4)), "shape": rng.normal(0.0, 3.0, (M, 5))}
    noise = {"part": rng.uniform(9.0, 36.0, M), "least": rng.uniform(0.0, 5.0, M)}
    model = Chained(rng.normal(0.0, 9.0, M), columns, noise, chains_of(chain), rng.uniform(0.2, 1.2, M))
    return model, chain


def covariance(model, chain, x):
    """Of the errors, and of the readings."""
    memory = Memory.of(x)
    place = np.array([np.sum(chain[:i] == chain[i]) for i in range(M)])
    alike = memory.correlation ** np.abs(np.subtract.outer(place, place)) * (chain[:, None] == chain)
    alike = (1.0 - memory.independent) * alike
    np.fill_diagonal(alike, 1.0)
    u = np.sqrt((np.exp(2.0 * x["part"]) * model.noise["part"] + model.noise["least"]) / model.weight)
    errors = np.outer(u, u) * alike
    known, shape = model.columns["known"], np.exp(x["shape"]) * model.columns["shape"]
    return errors, errors + known @ known.T + shape @ shape.T


@pytest.mark.parametrize("memory", MEMORIES)
def test_the_evidence_is_the_density_of_the_readings(case, memory):
    model, chain = case
    _, whole = covariance(model, chain, x := {**SIZES, **memory})
    expected = multivariate_normal(np.zeros(M), whole).logpdf(model.residual) + 0.5 * M * np.log(2.0 * np.pi)
    assert model.evidence(x)[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("memory", MEMORIES)
def test_its_slopes_are_its_differences(case, memory):
    model, _ = case
    x, step = {**SIZES, **memory}, 1e-5
    found = model.evidence(x)[1]
    assert [*found] == [*x]
    for name, at in x.items():
        above, below = (model.evidence({**x, name: at + d})[0] for d in (step, -step))
        assert found[name] == pytest.approx((above - below) / (2.0 * step), rel=1e-5, abs=1e-5)


@pytest.mark.parametrize("memory", MEMORIES)
def test_each_reading_is_foretold_by_all_others(case, memory):
    model, chain = case
    errors, whole = covariance(model, chain, x := {**SIZES, **memory})
    found = model.standardised(x)
    for i in (0, 7, 33):
        rest = np.arange(M) != i
        weight = np.linalg.solve(whole[np.ix_(rest, rest)], whole[rest, i])
        error = model.residual[i] - weight @ model.residual[rest]
        variance = whole[i, i] - weight @ whole[rest, i]
        own = errors[i, i] - errors[i, rest] @ np.linalg.solve(errors[np.ix_(rest, rest)], errors[rest, i])
        assert found[i] == pytest.approx(error / np.sqrt(variance + (model.weight[i] - 1.0) * own))


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
