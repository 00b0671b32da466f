"""The smooth functions against the covariance that they stand for."""

from __future__ import annotations

import numpy as np
import pytest

from mffit.linearised import constants
from mffit.linearised.inputs import Input
from mffit.linearised.mixed import Mixed
from mffit.linearised.smooth import CONSTANT, SmoothFunctions
from mffit.scatter import rms

ALPHA = Input("alpha", -0.2, 0.3, 0.1)
LOAD = Input("Fz", 1000.0, 3000.0, 1000.0)
GRID = np.stack(np.meshgrid(np.linspace(-0.2, 0.3, 9), np.linspace(1000.0, 3000.0, 4)), axis=-1).reshape(
    -1, 2
)


def covariance(
    inputs: tuple[Input, ...], at: np.ndarray, others: np.ndarray, lengths: tuple[float, ...]
) -> np.ndarray:
    """Of a Matern process of order 5/2 between conditions (n, d) and (k, d); its variance is 1 at the middle load."""
    found = np.ones((len(at), len(others)))
    for one, x, y, length in zip(inputs, at.T, others.T, lengths, strict=True):
        far = np.sqrt(5.0) * np.abs(x[:, None] - y) / length
        found *= (1.0 + far + far**2 / 3.0) * np.exp(-far)
        if one.name == "Fz":
            found *= 0.5 * (1.0 + np.outer(x, y) / (one.lower * one.upper))
    return found


def test_functions_with_all_readings_as_nodes_have_the_covariance_of_the_process():
    lengths = (0.15, 1500.0)
    columns = SmoothFunctions.over((ALPHA, LOAD), GRID, lengths).columns(GRID)
    assert columns.shape == (len(GRID), len(GRID))
    assert columns @ columns.T == pytest.approx(covariance((ALPHA, LOAD), GRID, GRID, lengths), abs=1e-4)


def test_nodes_of_one_length_have_the_covariance_of_another():
    smooth, lengths = SmoothFunctions.over((ALPHA, LOAD), GRID, (0.15, 1500.0)), np.array([0.3, 900.0])
    true = covariance((ALPHA, LOAD), smooth.nodes, smooth.nodes, (0.3, 900.0))
    assert smooth.at_nodes(lengths)[0] == pytest.approx(true, abs=1e-4)


@pytest.mark.parametrize("enough", [0.3, 0.03, 0.003])
def test_nodes_tell_all_but_enough_at_every_reading_and_no_node_is_idle(enough):
    random = np.random.default_rng(2)
    at = random.uniform([-0.2, 1000.0], [0.3, 3000.0], (300, 2))
    smooth = SmoothFunctions.over((ALPHA, LOAD), at, (0.1, 800.0), enough=enough)
    untold, _ = smooth.faded(at)
    assert np.max(untold) <= enough
    fewer = SmoothFunctions((ALPHA, LOAD), smooth.nodes[:-1], smooth.lengths)
    assert np.max(fewer.faded(at)[0]) > enough


CONDITIONS = tuple(Input(f"x{i}", 0.0, end, 1.0) for i, end in enumerate((2.0, 12.0, 3.0, 2.0, 2.0, 4.0)))
LENGTHS = (1.1, 3.0, 2.5, 2.5, 1.5, 3.0)


def test_a_model_error_over_many_conditions_is_predicted_as_by_its_covariance():
    """Of a test of all combinations of three sideslips, three cambers, three pressures and four loads, each at a temperature."""
    random = np.random.default_rng(4)
    held = np.array([*np.ndindex(3, 4, 3, 3)], dtype=float)
    held = np.column_stack([held, random.uniform(0.0, 4.0, len(held))])
    at = np.repeat(held, 7, axis=0)
    at = np.insert(at, 1, np.tile(np.linspace(0.0, 12.0, 7), len(held)), axis=1)
    alike, n = covariance(CONDITIONS, at, at, LENGTHS), len(at)
    force = np.linalg.cholesky(alike + 1e-9 * np.eye(n)) @ random.standard_normal(n)
    noise = 0.1
    read = force + noise * random.standard_normal(n)
    out = np.repeat(np.arange(len(held)) % 8 == 3, 7)
    known = alike[np.ix_(~out, ~out)] + noise**2 * np.eye(np.sum(~out))
    best = alike[np.ix_(out, ~out)] @ np.linalg.solve(known, read[~out])

    smooth = SmoothFunctions.over(CONDITIONS, at[~out], LENGTHS, enough=noise**2)
    columns = smooth.columns(at)
    model = Mixed(read / noise, columns / noise, np.zeros((n, 1)), [np.flatnonzero(~out)])
    given = model.alike(np.zeros(len(smooth.nodes)))
    predicted = columns[out] @ model.posterior(given).mean
    assert rms(predicted - force[out]) < 1.1 * rms(best - force[out])


@pytest.mark.parametrize("sign", [None, -1, 1])
def test_slopes_of_the_covariance_are_its_differences(sign):
    alpha = ALPHA if sign is None else Input("alpha", -0.3, 0.3, 0.05, mirrored=True)
    smooth, at = SmoothFunctions.over((alpha, LOAD), GRID, (0.15, 1500.0), sign or 1), np.log([0.2, 1200.0])
    _, slopes = smooth.at_nodes(np.exp(at))
    for slope, step in zip(slopes, 1e-5 * np.eye(2), strict=True):
        rise = smooth.at_nodes(np.exp(at + step))[0] - smooth.at_nodes(np.exp(at - step))[0]
        assert slope == pytest.approx(rise / 2e-5, rel=1e-4, abs=1e-4)


def test_functions_that_change_little_over_the_load_are_straight_lines_over_it():
    """A constant, as a zero of the rig is, and a part of the load, as a force is."""
    loads = np.linspace(1000.0, 3000.0, 21)[:, None]
    columns = SmoothFunctions.over((LOAD,), loads, (1e6,)).columns(loads)
    lines = np.column_stack([np.ones(21), loads[:, 0]])
    left = columns - lines @ np.linalg.lstsq(lines, columns, rcond=None)[0]
    assert rms(left) < 0.01 * rms(columns)
    assert np.linalg.matrix_rank(columns, tol=0.1) == 2


def test_beyond_the_tested_range_the_functions_stay_and_fade():
    inside, end, beyond = [0.1, 2000.0], [0.3, 3000.0], [0.4, 3500.0]
    smooth = SmoothFunctions.over((ALPHA, LOAD), np.array([inside, end, [-0.2, 2000.0]]), (0.1, 500.0))
    columns = smooth.columns(np.array([inside, end, beyond]))
    assert np.array_equal(columns[1], columns[2])
    assert not np.allclose(columns[0], columns[1])
    settings = np.array([inside, end, beyond, [-0.3, 2000.0]])
    untold, faded = smooth.faded(settings)
    assert untold == pytest.approx(
        smooth.variance(settings) * (1.0 - np.exp([0.0, 0.0, -2.0, -1.0])), abs=1e-6
    )
    assert faded[2] == pytest.approx(columns[2] * np.exp(-1.0))
    weights = np.array([1.0, -2.0, 0.5])
    assert smooth.estimate(weights, settings) == pytest.approx(faded @ weights)


def test_a_tyre_at_one_condition_has_a_constant_only():
    assert np.allclose(CONSTANT.columns(np.empty((3, 0))), np.ones((3, 1)))
    assert CONSTANT.fading(np.empty((3, 0))) == pytest.approx(np.ones((3, 1)))


def test_many_readings_keep_to_the_most_functions():
    at = np.random.default_rng(6).uniform(0.0, 1.0, (900, 10))
    inputs = tuple(Input(f"x{i}", 0.0, 1.0, 0.1 if i < 3 else 1.0) for i in range(10))
    assert len(SmoothFunctions.over(inputs, at, [0.2] * 10).nodes) == constants.FUNCTIONS


@pytest.mark.parametrize("sign", [-1, 1])
def test_functions_of_mirrored_conditions_have_the_symmetry_of_the_channel(sign):
    alpha, path = (
        Input("alpha", -0.2, 0.2, 0.05, mirrored=True),
        Input("phi_t", -0.75, 0.75, 0.75, mirrored=True),
    )
    at = np.random.default_rng(3).uniform([-0.2, 1000.0, -0.75], [0.2, 3000.0, 0.75], (20, 3))
    smooth = SmoothFunctions.over((alpha, LOAD, path), at, (0.1, 1500.0, 1.0), sign)
    assert len(smooth.nodes) > 10
    assert smooth.columns(at * [-1.0, 1.0, -1.0]) == pytest.approx(sign * smooth.columns(at), abs=1e-6)
    turned = np.array([[0.0, 2000.0, -0.75]])
    assert np.any(np.abs(smooth.columns(turned)) > 0.1)  # turn slip alone has a force


def test_a_condition_that_is_not_stated_is_averaged_over_its_usual_values():
    usual = (42.0, 50.0, 59.0)
    inputs = (Input("alpha", -0.1, 0.1, 0.02), Input("T", 40.0, 60.0, 5.0, averaged=usual))
    alpha = np.linspace(-0.1, 0.1, 7)
    stated = [np.column_stack([alpha, np.full(7, T)]) for T in usual]
    smooth = SmoothFunctions.over(inputs, np.vstack(stated), (0.05, 8.0))
    untold, functions = smooth.faded(np.column_stack([alpha, np.full(7, np.nan)]))
    assert untold == pytest.approx(0.0, abs=1e-4)
    assert functions == pytest.approx(np.mean([smooth.columns(one) for one in stated], axis=0), abs=1e-12)


def test_what_no_reading_shows_of_a_difference_is_that_of_drawn_functions():
    """Of functions with the covariance of the process, what a regression on their values at the nodes leaves of a difference.

    Beyond all loads the difference itself.
    """
    alpha, length, pair = Input("alpha", -0.12, 0.12, 0.1), 0.05, np.array([-2e-3, 1e-3])
    at = np.append(pair, np.linspace(-0.12, 0.12, 6))[:, None]
    root = np.linalg.cholesky(covariance((alpha,), at, at, (length,)) + 1e-12 * np.eye(len(at)))
    drawn = np.random.default_rng(1).standard_normal((20_000, len(at))) @ root.T
    change = drawn[:, 1] - drawn[:, 0]
    left = change - drawn[:, 2:] @ np.linalg.lstsq(drawn[:, 2:], change, rcond=None)[0]
    load = np.full(len(at), np.sqrt(LOAD.lower * LOAD.upper))  # where the process has its size
    settings = np.column_stack([at, load])
    smooth = SmoothFunctions.over((alpha, LOAD), settings[2:], (length, 1500.0))
    assert smooth.untold_change(settings[:2]) == pytest.approx(np.var(left), rel=0.04)
    far, growth = settings[:2] + np.array([0.0, 20_000.0]), 0.5 * (1.0 + (LOAD.upper / load[0]) ** 2)
    assert smooth.untold_change(far) == pytest.approx(growth * np.var(change), rel=0.04)


def test_a_slope_at_zero_slip_is_known_less_than_one_beside():
    """A force over slip may bend fastest around zero, where its readings are as far apart as beside it."""
    alpha = Input("alpha", -0.2, 0.2, 0.4 / 12.0)
    readings = np.linspace(-0.2, 0.2, 14)[:, None]
    smooth, step = SmoothFunctions.over((alpha,), readings, (0.05,)), np.array([[-1e-3], [1e-3]])
    middle = 0.5 * (readings[11] + readings[12])  # as zero is the middle of two readings
    at_zero, aside = (smooth.untold_change(step + x) for x in (0.0, middle))
    assert at_zero > 5.0 * aside
