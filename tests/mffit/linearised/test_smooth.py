"""The smooth functions against the covariance that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.linearised import constants
from mffit.linearised.inputs import Input
from mffit.linearised.mixed import Mixed
from mffit.linearised.smooth import SmoothFunctions
from mffit.scatter import rms

ALPHA = Input("alpha", -0.2, 0.3, 0.1)
LOAD = Input("Fz", 1000.0, 3000.0, 1000.0)


def covariance(smooth: SmoothFunctions, at: np.ndarray, lengths: list[float]) -> np.ndarray:
    """By the functions, between places (n, d); of all variance 1."""
    columns = smooth.columns(at)
    return (columns * np.exp(smooth.log_variance(np.array(lengths))[0])) @ columns.T


def matern(one: Input, at: np.ndarray, others: np.ndarray, length: float) -> np.ndarray:
    """Correlation (n, k) of the model error between settings (n,) and (k,) of one condition."""
    far = np.sqrt(5.0) * np.abs(at[:, None] - others) / length
    return (1.0 + far + far**2 / 3.0) * np.exp(-far)


@pytest.mark.parametrize("length", [0.5, 1.0, 3.0])
@pytest.mark.parametrize("settings", [2, 3, 5])
def test_settings_that_runs_hold_differ_as_a_matern_covariance_says(settings, length):
    """From one end to the other, however long the length is."""
    one = Input("gamma", 0.0, 1.0, 1.0 / (settings - 1))
    found = covariance(SmoothFunctions.over((one,)), np.array([[0.0], [1.0]]), [length])
    differ = np.array([1.0, -1.0])
    true = matern(one, np.array([0.0, 1.0]), np.array([0.0, 1.0]), length)
    assert differ @ found @ differ == pytest.approx(differ @ true @ differ, rel=0.1)


@pytest.mark.parametrize("length", [0.05, 0.1, 0.2])
def test_functions_of_a_swept_condition_have_a_matern_covariance(length):
    """But near the ends, where there is more of it."""
    swept = Input("alpha", -0.2, 0.3, 0.5 / 12.0)
    at = np.linspace(-0.05, 0.15, 9)
    found = covariance(SmoothFunctions.over((swept,)), at[:, None], [length])
    assert found == pytest.approx(matern(swept, at, at, length), abs=0.2)


CONDITIONS = (
    Input("alpha", 0.0, 2.0, 1.0), Input("kappa", 0.0, 12.0, 1.0), Input("Fz", 0.0, 3.0, 1.0), Input("gamma", 0.0, 2.0, 1.0),
    Input("p", 0.0, 2.0, 1.0), Input("T", 0.0, 4.0, 1.0),
)  # fmt: skip
LENGTHS = (1.1, 3.0, 2.5, 2.5, 1.5, 3.0)


def test_a_model_error_over_many_conditions_is_predicted_as_by_its_covariance():
    """Of a test of all combinations of three sideslips, three cambers, three pressures and four loads, each at a temperature."""
    random = np.random.default_rng(4)
    held = np.array([*np.ndindex(3, 4, 3, 3)], dtype=float)
    held = np.column_stack([held, random.uniform(0.0, 4.0, len(held))])
    at = np.repeat(held, 7, axis=0)
    at = np.insert(at, 1, np.tile(np.linspace(0.0, 12.0, 7), len(held)), axis=1)
    each = [matern(one, x, x, size) for one, x, size in zip(CONDITIONS, at.T, LENGTHS, strict=True)]
    alike, n = np.prod(each, axis=0), len(at)
    force = np.linalg.cholesky(alike + 1e-9 * np.eye(n)) @ random.standard_normal(n)
    noise = 0.1
    read = force + noise * random.standard_normal(n)
    out = np.repeat(np.arange(len(held)) % 8 == 3, 7)
    known = alike[np.ix_(~out, ~out)] + noise**2 * np.eye(np.sum(~out))
    best = alike[np.ix_(out, ~out)] @ np.linalg.solve(known, read[~out])

    smooth = SmoothFunctions.over(CONDITIONS, lengths=LENGTHS)
    columns = smooth.columns(at)
    model = Mixed(read / noise, columns / noise, np.zeros((n, 1)), [np.flatnonzero(~out)])
    given = model.alike(smooth.log_variance(np.array(LENGTHS))[0])
    predicted = columns[out] @ model.posterior(given).mean
    assert rms(predicted - force[out]) < 1.1 * rms(best - force[out])


def test_shares_of_all_functions_are_the_whole_variance():
    """But for the smallest, which are left out."""
    smooth = SmoothFunctions.over((ALPHA, LOAD))
    shares = np.exp(smooth.log_variance(np.array([0.15, 1500.0]))[0])
    assert shares.sum() == pytest.approx(1.0, abs=0.01)
    assert shares.sum() <= 1.0 + 1e-3


def test_slopes_of_the_shares_are_their_differences():
    smooth, at = SmoothFunctions.over((ALPHA, LOAD)), np.log([0.15, 1500.0])
    slopes = smooth.log_variance(np.exp(at))[1]
    for i, step in enumerate(1e-5 * np.eye(2)):
        rise = smooth.log_variance(np.exp(at + step))[0] - smooth.log_variance(np.exp(at - step))[0]
        assert slopes[:, i] == pytest.approx(rise / 2e-5, rel=1e-5, abs=1e-6)


def test_beyond_the_tested_range_the_functions_stay_and_fade():
    smooth = SmoothFunctions.over((ALPHA, LOAD))
    inside, end, beyond = [0.1, 2000.0], [0.3, 3000.0], [0.4, 3500.0]
    columns = smooth.columns(np.array([inside, end, beyond]))
    assert np.array_equal(columns[1], columns[2])
    assert not np.allclose(columns[0], columns[1])
    settings, lengths = np.array([inside, end, beyond, [-0.3, 2000.0]]), np.array([0.1, 500.0])
    untold, faded = smooth.faded(settings, lengths)
    assert untold == pytest.approx(1.0 - np.exp([0.0, 0.0, -2.0, -1.0]))
    assert faded[2] == pytest.approx(columns[2] * np.exp(-1.0))


def test_a_tyre_at_one_condition_has_a_constant_only():
    smooth = SmoothFunctions.over(())
    assert np.array_equal(smooth.columns(np.empty((3, 0))), np.ones((3, 1)))
    assert np.array_equal(smooth.squared_distance(np.empty((3, 0)), np.empty(0)), np.zeros(3))


def test_many_conditions_keep_to_the_largest_functions():
    """Ten conditions would have a billion products."""
    smooth = SmoothFunctions.over(tuple(Input(f"x{i}", 0.0, 1.0, 0.1 if i < 3 else 1.0) for i in range(10)))
    assert len(smooth.orders) == constants.FUNCTIONS_AT_FIRST
    shares = smooth.log_variance(np.full(10, 1.0))[0]
    assert shares.max() < 0.0
    assert len(SmoothFunctions.over(smooth.inputs, lengths=[1.0] * 10).orders) == constants.FUNCTIONS


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("negligible", [0.1, 0.01])
def test_functions_are_left_out_that_add_little(negligible, sign, monkeypatch):
    monkeypatch.setattr(constants, "FUNCTIONS_AT_FIRST", 1)
    inputs = (
        Input("alpha", -0.2, 0.2, 0.05, mirrored=True),
        LOAD,
        Input("gamma", -0.3, 0.3, 0.1, mirrored=True),
    )
    all_of_them, some = (
        SmoothFunctions.over(inputs, sign, [0.2, 1500.0, 0.4], share) for share in (0.0, negligible)
    )
    shortest = np.array([0.1, 1000.0, 0.2])  # for which they are chosen
    whole, left = (np.exp(one.log_variance(shortest)[0]).sum() for one in (all_of_them, some))
    fewer = np.exp(some.log_variance(shortest)[0][:-1]).sum()
    assert len(some.orders) < len(all_of_them.orders)
    assert fewer < whole - negligible <= left


@pytest.mark.parametrize("sign", [-1, 1])
def test_functions_of_mirrored_conditions_have_the_symmetry_of_the_channel(sign):
    alpha, path = (
        Input("alpha", -0.2, 0.2, 0.05, mirrored=True),
        Input("phi_t", -0.75, 0.75, 0.75, mirrored=True),
    )
    smooth = SmoothFunctions.over((alpha, LOAD, path), sign)
    at = np.random.default_rng(3).uniform([-0.2, 1000.0, -0.75], [0.2, 3000.0, 0.75], (20, 3))
    assert len(smooth.orders) > 10
    assert smooth.columns(at * [-1.0, 1.0, -1.0]) == pytest.approx(sign * smooth.columns(at), abs=1e-12)
    assert np.any(
        np.abs(smooth.columns(np.array([[0.0, 2000.0, -0.75]]))) > 0.1
    )  # turn slip alone has a force


def test_a_condition_that_is_not_stated_is_averaged_over_its_usual_values():
    usual = (42.0, 50.0, 59.0)
    inputs = (Input("alpha", -0.1, 0.1, 0.02), Input("T", 40.0, 60.0, 5.0, averaged=usual))
    smooth, alpha = SmoothFunctions.over(inputs), np.linspace(-0.1, 0.1, 7)
    each = [smooth.columns(np.column_stack([alpha, np.full(7, T)])) for T in usual]
    unstated = np.column_stack([alpha, np.full(7, np.nan)])
    untold, functions = smooth.faded(unstated, np.array([0.05, 8.0]))
    assert np.all(untold == 0.0)
    assert functions == pytest.approx(np.mean(each, axis=0), abs=1e-12)


def test_functions_are_chosen_for_the_likely_lengths():
    """A long one over some conditions leaves more functions to the others."""
    inputs = tuple(Input(f"x{i}", 0.0, 1.0, 0.1) for i in range(4))
    first, again = (SmoothFunctions.over(inputs, lengths=at) for at in (None, (0.1, 5.0, 5.0, 5.0)))
    assert first.orders[:, 0].max() < again.orders[:, 0].max()
    first, again = (
        np.exp(one.log_variance(np.array([0.1, 5.0, 5.0, 5.0]))[0]).sum() for one in (first, again)
    )
    assert first < 0.9 < 0.99 < again


def test_what_no_setting_shows_of_a_difference_is_that_of_drawn_functions():
    """Of functions with the Matern covariance, what a regression on their values at all settings leaves of a difference.

    Beyond all loads the difference itself; at two settings, and over a condition that is no slip, nothing.
    """
    alpha, length, pair = Input("alpha", -0.12, 0.12, 0.02), 0.05, np.array([-2e-3, 1e-3])
    at = alpha.stretched(np.append(pair, np.linspace(-0.12, 0.12, 13)))
    far = np.sqrt(5.0) * np.abs(at[:, None] - at) / length
    alike = (1.0 + far + far**2 / 3.0) * np.exp(-far)
    root = np.linalg.cholesky(alike + 1e-12 * np.eye(len(at)))
    drawn = np.random.default_rng(1).standard_normal((20_000, len(at))) @ root.T
    change = drawn[:, 1] - drawn[:, 0]
    left = change - drawn[:, 2:] @ np.linalg.lstsq(drawn[:, 2:], change, rcond=None)[0]
    smooth, lengths = SmoothFunctions.over((alpha, LOAD)), np.array([length, 1500.0])
    settings = np.column_stack([pair, [2000.0, 2000.0]])
    assert smooth.unseen(settings, lengths) == pytest.approx(np.var(left), rel=0.04)
    assert smooth.unseen(settings + np.array([0.0, 20_000.0]), lengths) == pytest.approx(
        np.var(change), rel=0.04
    )
    assert smooth.unseen(np.column_stack([[0.02, 0.06], [2000.0] * 2]), lengths) < 1e-6
    camber = SmoothFunctions.over((Input("gamma", -0.12, 0.12, 0.02), LOAD))
    assert camber.unseen(settings, lengths) < 1e-6


def test_a_slope_at_zero_slip_is_known_less_than_one_beside():
    """A force over slip may bend fastest around zero, where its readings are as far apart as beside it."""
    alpha, lengths = Input("alpha", -0.2, 0.2, 0.4 / 12.0), np.array([0.05, 1500.0])
    smooth, step = SmoothFunctions.over((alpha, LOAD)), np.array([[-1e-3, 0.0], [1e-3, 0.0]])
    at_zero, aside = (smooth.unseen(step + np.array([x, 2000.0]), lengths) for x in (0.0, 0.4 / 3.0))
    assert at_zero > 5.0 * aside
