"""Prediction of left-out groups against fits that really leave them out."""

from __future__ import annotations

import numpy as np

from mffit.left_out import moved_without


def test_a_linear_problem_is_predicted_as_by_a_fit_without_the_group():
    rng = np.random.default_rng(2)
    A, y = rng.normal(size=(40, 4)), rng.normal(size=40)
    group = np.repeat(np.arange(5), 8)
    prior, expected, x = np.array([0.0, 0.5, 2.0, 0.0]), rng.normal(size=4), rng.normal(size=4)
    residual, information = A @ x - y, A.T @ A + np.diag(prior)
    gradient = A.T @ residual + prior * (x - expected)
    for k in range(5):
        kept = group != k
        whole = np.vstack([A[kept], np.diag(np.sqrt(prior))])
        aim = np.concatenate([y[kept], np.sqrt(prior) * expected])
        own = np.linalg.lstsq(whole, aim, rcond=None)[0]
        move = moved_without(A[~kept], residual[~kept], information, gradient)
        np.testing.assert_allclose(x + move, own, rtol=1e-9)
