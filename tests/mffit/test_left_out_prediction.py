"""Prediction of left-out groups against fits that really leave them out, and the rule that compares predictions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mffit.left_out import (
    Predicted,
    Support,
    alone,
    improves,
    left_out_errors,
    needed_fall,
    predicted,
)


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


def test_the_misfit_is_summed_by_group_and_channel():
    found = predicted(np.array([1.0, 2.0, 3.0, 4.0]), np.array([0, 1, 0, 1]), np.array([0, 0, 1, 1]))
    np.testing.assert_array_equal(found.chi2, [[1.0, 9.0], [4.0, 16.0]])
    assert found.total == 30.0


RNG = np.random.default_rng(4)
BEFORE = RNG.chisquare(10, size=(20, 2))


CLEAR = Support(chi2=90.0, removed=90.0, numbers=2, freedom=np.inf)


@pytest.mark.parametrize(
    ("after", "support", "better"),
    [
        (BEFORE - [4.0, 1.0] - 0.5 * RNG.random((20, 2)), CLEAR, True),
        (BEFORE - np.where(np.arange(20)[:, None] == 3, [80.0, 1.0], 0.0), CLEAR, True),  # one sweep has the gain
        (BEFORE - [4.0, 1.0] - 0.5 * RNG.random((20, 2)), replace(CLEAR, chi2=6.0), False),  # within chance
        (BEFORE - [4.0, 1.0] - 0.5 * RNG.random((20, 2)), replace(CLEAR, freedom=1.5), False),  # scatter unknown
        (BEFORE - [4.0, 1.0] - 0.5 * RNG.random((20, 2)), replace(CLEAR, removed=9.0), False),  # too little
        (BEFORE + np.array([4.0, 1.0]), CLEAR, False),
        (BEFORE - [8.0, -4.0] - 0.5 * RNG.random((20, 2)), CLEAR, False),  # one channel is worse
        (BEFORE + np.where(np.arange(20)[:, None] == 3, [0.0, 900.0], -1.0), CLEAR, False),  # by one sweep only
        (BEFORE + np.where(np.arange(20)[:, None] == 3, [0.0, 90.0], -1.0), CLEAR, True),  # as chance does
    ],
    ids=[
        "all sweeps", "one sweep", "within chance", "scatter unknown", "too little", "worse", "one channel worse",
        "one sweep far off", "one sweep off",
    ],
)  # fmt: skip
def test_numbers_belong_into_a_model_if_all_points_show_them_and_no_channel_is_worse(after, support, better):
    assert improves(Predicted(BEFORE), Predicted(after), support, candidates=3, least=10.0) is better


def test_a_large_gain_cannot_fail():
    """However the gain is spread over the sweeps, more of it never turns a yes into a no."""
    before = BEFORE + np.where(np.arange(20)[:, None] == 3, 1e4, 0.0)
    for chi2 in (30.0, 300.0, 3e4):
        assert improves(Predicted(before), Predicted(BEFORE), replace(CLEAR, chi2=chi2))


def test_chance_explains_as_much_as_pure_noise_does():
    """Share of drawn noise that explains more, with a scatter that is known and with one from five readings."""
    rng = np.random.default_rng(5)
    size = np.sum(rng.normal(size=(200_000, 2)) ** 2, axis=1)
    scatter = np.mean(rng.normal(size=(200_000, 5)) ** 2, axis=1)
    for drawn, freedom in ((size, np.inf), (size / scatter, 5.0)):
        for chi2 in (4.0, 8.0):
            share = float(np.mean(drawn > chi2))
            assert Support(chi2, chi2, 2, freedom).chance == pytest.approx(share, rel=0.04)
    assert Support(10.0, 10.0, 2, np.inf).beyond_chance()
    assert not Support(10.0, 10.0, 2, np.inf).beyond_chance(candidates=3)


def test_numbers_alone_explain_what_a_fit_with_them_explains_beyond_one_without():
    rng = np.random.default_rng(6)
    A, y = rng.normal(size=(40, 5)), rng.normal(size=40)
    own, gradient = alone(A.T @ A, -A.T @ y, np.array([1, 3]))
    left = [np.linalg.lstsq(A[:, some], y, rcond=None)[1][0] for some in ([0, 2, 4], [0, 1, 2, 3, 4])]
    assert gradient @ np.linalg.solve(own, gradient) == pytest.approx(left[0] - left[1])


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
