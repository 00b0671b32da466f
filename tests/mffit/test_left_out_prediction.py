"""Prediction of left-out groups against fits that really leave them out, and the rule that compares predictions."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.left_out import Predicted, covariance_without, improves, left_out_errors, needed_fall, predicted


def test_a_linear_problem_is_predicted_as_by_a_fit_without_the_group():
    rng = np.random.default_rng(2)
    A, y = rng.normal(size=(40, 4)), rng.normal(size=40)
    group = np.repeat(np.arange(5), 8)
    prior, expected, x = np.array([0.0, 0.5, 2.0, 0.0]), rng.normal(size=4), rng.normal(size=4)
    error = left_out_errors(
        A, A @ x - y, A.T @ A + np.diag(prior), A.T @ (A @ x - y) + prior * (x - expected), group
    )
    for k in range(5):
        kept = group != k
        whole = np.vstack([A[kept], np.diag(np.sqrt(prior))])
        aim = np.concatenate([y[kept], np.sqrt(prior) * expected])
        own = np.linalg.lstsq(whole, aim, rcond=None)[0]
        np.testing.assert_allclose(error[~kept], (A @ own - y)[~kept], rtol=1e-9)
        root = np.linalg.inv(np.linalg.cholesky(A.T @ A + np.diag(prior)))
        covariance = root.T @ covariance_without(A[~kept] @ root.T, 1e-9) @ root
        np.testing.assert_allclose(np.linalg.inv(covariance), whole.T @ whole, rtol=1e-9, atol=1e-9)


def test_the_misfit_is_summed_by_group_and_channel():
    found = predicted(np.array([1.0, 2.0, 3.0, 4.0]), np.array([0, 1, 0, 1]), np.array([0, 0, 1, 1]))
    np.testing.assert_array_equal(found.chi2, [[1.0, 9.0], [4.0, 16.0]])
    assert found.total == 30.0


RNG = np.random.default_rng(4)
BEFORE = RNG.chisquare(10, size=(20, 2))


@pytest.mark.parametrize(
    ("after", "better"),
    [
        (BEFORE - [4.0, 1.0] - 0.5 * RNG.random((20, 2)), True),
        (BEFORE + np.array([4.0, 1.0]), False),
        (BEFORE - [8.0, -4.0] - 0.5 * RNG.random((20, 2)), False),  # one channel is worse
        (BEFORE - np.where(np.arange(20)[:, None] == 3, 80.0, 0.0), False),  # one sweep only
        (BEFORE - 0.001 - 0.0005 * RNG.random((20, 2)), False),  # sure, and too little to matter
    ],
    ids=["all sweeps", "worse", "one channel worse", "one sweep", "too little"],
)
def test_a_prediction_is_better_if_sweeps_agree_that_it_is(after, better):
    found = improves(Predicted(BEFORE), Predicted(after), least=1.0, needed=needed_fall(5))
    assert found is better


@pytest.mark.parametrize(
    ("change", "kept"),
    [
        ([0.0, 0.01 * 10.0], True),  # 1 % of one channel
        ([-2.0, 0.01 * 10.0], True),
        ([-2.0, 0.04 * 10.0], False),  # a gain in one channel does not pay for the other
    ],
)
def test_each_channel_must_be_predicted_as_well(change, kept):
    scatter = 4.0 * np.resize([[1.0, -1.0], [-1.0, 1.0]], BEFORE.shape)  # so that nothing is beyond chance
    after = Predicted(BEFORE + change + scatter)
    assert Predicted(BEFORE).keeps(after, 0.02) is kept
    assert not Predicted(BEFORE).keeps(
        Predicted(BEFORE + np.array([0.0, 0.15])), 0.02
    )  # little, but in every sweep


def test_more_candidates_need_a_clearer_fall():
    assert needed_fall(1) == pytest.approx(2.326, abs=1e-3)
    assert needed_fall(10) > needed_fall(2) > needed_fall(1)
