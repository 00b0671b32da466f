"""The linear model of residuals against the dense Gaussian that it stands for."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from mffit.linearised.mixed import Mixed, Variances

SIZES = (7, 4, 9, 1)
"""Readings of every run."""
GIVEN = Variances(np.log([0.5, 2.0, 0.1]), np.log([0.3, 0.05]), float(np.log(1.7)))


@pytest.fixture(scope="module")
def model() -> Mixed:
    """A draw of the model itself, its runs interleaved."""
    random = np.random.default_rng(3)
    n = sum(SIZES)
    run = random.permutation(np.repeat(np.arange(len(SIZES)), SIZES))
    groups = [np.flatnonzero(run == k) for k in range(len(SIZES))]
    common, own = random.standard_normal((n, 3)), random.standard_normal((n, 2))
    return Mixed(random.standard_normal(n), common, own, groups)


def dense(model: Mixed, given: Variances) -> np.ndarray:
    """Covariance (n, n) of the residuals."""
    same = np.zeros(2 * (len(model.residual),))
    for rows in model.groups:
        same[np.ix_(rows, rows)] = 1.0
    shared = (model.common * np.exp(given.common)) @ model.common.T
    of_runs = same * ((model.own * np.exp(given.own)) @ model.own.T)
    return shared + of_runs + np.exp(given.noise) * np.eye(len(same))


def evidence(model: Mixed, x: np.ndarray) -> float:
    """By the dense covariance; ``x`` are the logarithms of the variances of the shared and own numbers and of the noise."""
    given = Variances(x[:3], x[3:5], float(x[5]))
    return float(multivariate_normal(cov=dense(model, given)).logpdf(model.residual))


def test_evidence_and_its_slopes_are_those_of_the_dense_gaussian(model):
    found = model.evidence(GIVEN)
    at = np.array([*GIVEN.common, *GIVEN.own, GIVEN.noise])
    constant = -0.5 * len(model.residual) * np.log(2.0 * np.pi)
    assert found.value + constant == pytest.approx(evidence(model, at), rel=1e-9)
    steps = 1e-4 * np.eye(len(at))
    slopes = [(evidence(model, at + step) - evidence(model, at - step)) / 2e-4 for step in steps]
    assert [*np.diag(found.common), *found.own, found.noise] == pytest.approx(slopes, rel=1e-5, abs=1e-7)


def test_information_about_the_variances_is_that_of_the_dense_gaussian(model):
    """Half the trace of V^-1 dV V^-1 dV, by Fisher; that about the random effects is the sum of what each run tells."""
    found, V = model.evidence(GIVEN), dense(model, GIVEN)

    def told(columns: np.ndarray, variances: np.ndarray) -> np.ndarray:
        size = np.exp(0.5 * variances)
        return 0.5 * (columns.T @ np.linalg.solve(V, columns) * np.outer(size, size)) ** 2

    np.testing.assert_allclose(0.5 * found.told**2, told(model.common, GIVEN.common))
    runs = [np.isin(np.arange(len(V)), g)[:, None] * model.own for g in model.groups]
    np.testing.assert_allclose(found.of_own, sum(told(own, GIVEN.own) for own in runs))


def test_turned_columns_have_the_evidence_of_their_own_model(model):
    turn = np.tril(np.random.default_rng(5).standard_normal((3, 3)))
    alone, found = (
        replace(model, common=model.common @ turn).evidence(GIVEN),
        model.evidence(GIVEN, turn),
    )
    assert found.value == pytest.approx(alone.value)
    np.testing.assert_allclose(found.common, alone.common)
    np.testing.assert_allclose(found.told, alone.told)


def test_posterior_is_the_conditional_of_the_dense_gaussian(model):
    found = model.posterior(GIVEN)
    to_readings = np.exp(GIVEN.common)[:, None] * model.common.T
    through = np.linalg.solve(dense(model, GIVEN), to_readings.T).T
    assert found.mean == pytest.approx(through @ model.residual)
    covariance = np.diag(np.exp(GIVEN.common)) - through @ to_readings.T
    assert found.root @ found.root.T == pytest.approx(covariance)


def of_groups(model: Mixed, *numbers: int) -> np.ndarray:
    return np.sort(np.concatenate([model.groups[k] for k in numbers]))


@pytest.mark.parametrize(
    "rows",
    [
        lambda model: of_groups(model, 0),
        lambda model: of_groups(model, 3),
        lambda model: of_groups(model, 2, 0),
        lambda model: of_groups(model, 1, 2, 3),
        lambda model: of_groups(model, 2)[1:3],
        lambda model: np.array([0, 1, len(model.residual) - 1]),
    ],
)
def test_left_out_rows_are_as_all_others_predict_them(model, rows):
    """Whole runs, and parts of runs, whose rest shows what the run has of its own."""
    (found,) = model.left_out(GIVEN, [rows(model)])
    assert sorted(found.rows) == sorted(rows(model))
    rows = found.rows
    others = np.setdiff1d(np.arange(len(model.residual)), rows)
    covariance = dense(model, GIVEN)
    through = covariance[np.ix_(rows, others)] @ np.linalg.inv(covariance[np.ix_(others, others)])
    error = model.residual[rows] - through @ model.residual[others]
    spread = covariance[np.ix_(rows, rows)] - through @ covariance[np.ix_(others, rows)]
    assert found.error == pytest.approx(error)
    assert found.covariance == pytest.approx(spread)
    constant = -0.5 * len(rows) * np.log(2.0 * np.pi)
    density = multivariate_normal(cov=spread, allow_singular=False).logpdf(error)
    assert found.log_density + constant == pytest.approx(float(density))


def test_parts_of_a_whole_have_the_evidence_of_the_whole(model):
    """Run after run, each as the earlier ones predict it: the chain rule of probability."""
    total = 0.0
    for k in range(len(SIZES)):
        so_far = Mixed(model.residual, model.common, model.own, model.groups[: k + 1])
        total += so_far.left_out(GIVEN, [so_far.groups[k]])[0].log_density
    assert total == pytest.approx(model.evidence(GIVEN).value)
