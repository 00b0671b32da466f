"""Friction and stiffness that differ from run to run: found where they do, with standard errors that contain it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import small_rigs
from scipy.optimize import minimize

import mffit
import tir
from mffit import config as configuration
from mffit.errors import InputError
from mffit.fit.influences.nuisance_choice import choose
from mffit.fit.run_scatter import OfRuns, Runs, halves_of_runs
from mffit.points import make_points
from mffit.rig import Simulation
from mffit.rig_errors import OF_RUN

SIZE = 0.015
NAMES = ("run_grip", "run_stiffness")


def campaign(size, seed):
    """Sideslip and camber sweeps at three loads and three pressures on a flat track; scales drawn for every sweep."""
    rng = np.random.default_rng(seed)
    content = small_rigs.flat()
    content["sweep"] = [
        {
            **sweep,
            "file": f"{pressure}_{sweep['file']}",
            "p_kPa": pressure,
            "faults": dict(zip(NAMES, (size * rng.standard_normal(2)).tolist(), strict=True)),
        }
        for pressure in (250, 200, 300)
        for sweep in content["sweep"]
        if "forward" not in sweep["file"]
    ]
    return content


def verdict(choice):
    return next(row for row in choice.verdicts if row.nuisance.id == "run-scale")


@pytest.fixture(scope="module")
def scattered(tmp_path_factory):
    folder = tmp_path_factory.mktemp("scattered")
    content = campaign(SIZE, seed=1)
    small_rigs.simulated(content, folder)
    drawn = {sweep["file"].removesuffix(".csv"): sweep["faults"] for sweep in content["sweep"]}
    return mffit.build(folder / "tyre.toml", folder / "out"), folder / "out", drawn


@pytest.fixture(scope="module")
def alike(tmp_path_factory):
    return small_rigs.built(campaign(0.0, seed=1), tmp_path_factory.mktemp("alike"))


def test_the_numbers_of_the_runs_are_those_that_were_drawn(scattered):
    result, _, drawn = scattered
    assert verdict(result.fit.choice).modelled
    for name in NAMES:
        spread, u = result.fit.runs.scatter[name]
        assert abs(spread - SIZE) < 4.0 * u
        assert u == pytest.approx(spread / np.sqrt(2.0 * len(drawn)))
        found = {run: result.fit.rig[f"{name}@{run}"] for run in drawn if "sideslip" in run}
        pulls = [(value - drawn[run][name]) / u for run, (value, u) in found.items()]
        assert np.max(np.abs(pulls)) < 4.0
        assert (
            np.corrcoef([drawn[run][name] for run in found], [value for value, _ in found.values()])[0, 1]
            > 0.8
        )


def test_the_noise_is_what_remains_and_the_uncertainties_contain_the_scatter(scattered):
    result, folder, _ = scattered
    fit, true = result.fit, small_rigs.truth()
    assert fit.channels["Fy"].rmse < 1.1 * small_rigs.FY < 1.5 * small_rigs.FY < fit.runs.alone["Fy"].rmse
    assert not result.reasons
    for name in ("PDY1", "PDY2", "PKY1", "PPY4", "PPY3", "PKY2"):
        row = fit.coefficients[name]
        assert abs(row.value - true[name]) < 3.5 * row.stderr
    # The mean of twenty runs that each scatter by 1.5 % is uncertain by about a third of a per cent.
    assert fit.coefficients["PDY1"].stderr > 0.001 * true["PDY1"]
    of_rig = {name: value for name, (value, _) in fit.rig.items() if OF_RUN not in name}
    file = Simulation.of(tir.read(folder / "small.tir"), turn_slip=False).with_numbers(of_rig)
    alone = file.readings(result.points).Fy - result.points.Fy
    assert np.sqrt(np.mean(alone**2)) == pytest.approx(fit.runs.alone["Fy"].rmse, rel=0.02)


def test_terminal_page_and_json_say_how_large_it_is(scattered):
    result, folder, drawn = scattered
    said = next(line for line in result.fit.explanations if "run to run" in line)
    assert said.startswith(
        "The scatter of grip and stiffness from run to run is modelled: between 21 sweeps friction by 1."
    )
    assert f"{result.fit.runs.alone['Fy'].rmse:.3g} N" in said
    assert 'id="runs"' in (folder / "report.html").read_text(encoding="utf-8")
    content = json.loads((folder / "result.json").read_text())["fit"]
    assert set(content["runs"]["names"]) == set(drawn)
    assert content["runs"]["scatter"]["run_grip"]["value"] == result.fit.choice.scatter["run_grip"]
    assert content["rig"]["run_grip@250_sideslip_900"]["unit"] == "-"
    assert "run_grip" not in (folder / "small.tir").read_text()


def test_runs_that_do_not_differ_get_no_numbers(alike):
    result = alike
    found = verdict(result.fit.choice)
    assert not found.modelled
    assert found.reason == "what it explains is within chance"
    assert result.fit.runs is None
    assert not any("@" in name for name in result.fit.rig)


def with_keys(result, **keys):
    """The configuration of a build with other keys of [fit]."""
    config = configuration.load(result.config)
    changed = config.model_copy(update={"fit": config.fit.model_copy(update=keys)})
    changed._path, changed._lines = config.path, config._lines
    return changed


def test_what_the_formula_misses_between_runs_is_no_scatter(alike):
    """Forces fall with the mean temperature of a run but rise with that within it; the formula has one term for both.

    Numbers of the runs let the term follow the readings within the runs, and then predict other runs far off.
    """
    search, rng = alike.fit.search, np.random.default_rng(8)
    points = search.problem.points
    of_runs = rng.uniform(-12.0, 12.0, len(points.sweep_names))[points.sweep]
    within = 4.0 * np.random.default_rng(1).standard_normal(len(points))
    factor = 1.0 - 0.004 * of_runs + 0.004 * within
    sound = Simulation.of(small_rigs.truth(), turn_slip=False).readings(points)
    Fy = sound.Fy * factor + 4.0 * small_rigs.FY * rng.standard_normal(len(points))
    Mz = sound.Mz * factor + 4.0 * small_rigs.MZ * rng.standard_normal(len(points))
    changed = points.replace(Fy=Fy, Mz=Mz, T=50.0 + of_runs + within)
    config = with_keys(alike, temperature=True)
    found = verdict(choose(config, replace(search, problem=replace(search.problem, points=changed))))
    assert not found.modelled
    assert (
        found.reason == "whole left-out sweeps are predicted worse with it, because the formula misses them"
    )
    assert found.beside["Fy"] > 1.3 * found.without["Fy"]


@pytest.mark.parametrize(("given", "modelled"), [(True, True), (False, False)])
def test_the_key_decides(scattered, given, modelled):
    found = verdict(choose(with_keys(scattered[0], run_scale=given), scattered[0].fit.search))
    assert found.modelled == modelled
    assert found.reason == f"[fit] run_scale = {str(given).lower()}"


def test_two_runs_cannot_show_a_scatter(scattered):
    search = scattered[0].fit.search
    few = search.problem.select(np.flatnonzero(search.problem.points.sweep < 2))
    with pytest.raises(InputError, match="2 runs cannot differ"):
        choose(with_keys(scattered[0], run_scale=True), replace(search, problem=few))


def of_runs(run, slope, own, residual):
    """Readings of one channel in two blocks of whole runs, the later ones first."""
    late = run >= np.median(run)
    return lambda: (
        OfRuns(point=rows, slope=slope[rows], own=own[rows], residual=residual[rows])
        for rows in (np.flatnonzero(late), np.flatnonzero(~late))
    )


def test_a_left_out_piece_is_predicted_as_by_a_fit_without_it():
    """Against a solution of the whole system with a column for every number of every run."""
    rng = np.random.default_rng(4)
    runs, rows, k = 5, 12, 4
    run = np.repeat(np.arange(runs), rows)
    slope, own = rng.standard_normal((60, k)), rng.standard_normal((60, 2))
    residual, spread = rng.standard_normal(60), np.array([0.7, 0.2])
    information, pull = np.diag(rng.uniform(0.1, 1.0, k)), rng.standard_normal(k)
    found = Runs(rows=of_runs(run, slope, own, residual), run=run, information=information, pull=pull)
    wide = np.column_stack([slope, *(own * (run == j)[:, None] for j in range(runs))])
    prior = np.zeros((k + 2 * runs, k + 2 * runs))
    prior[:k, :k] = information
    prior[k:, k:] = np.diag(np.tile(spread**-2.0, runs))
    for group in (run, 2 * run + np.tile(np.arange(rows) % 3 == 0, runs)):
        errors, other = found.left_out(found.parts(), group, (spread, 2.0 * spread))
        assert not np.allclose(errors, other)
        for piece in np.unique(group):
            kept = group != piece
            A = wide[kept].T @ wide[kept] + prior
            b = wide[kept].T @ residual[kept] + np.r_[pull, np.zeros(2 * runs)]
            expected = residual[~kept] - wide[~kept] @ np.linalg.solve(A, b)
            np.testing.assert_allclose(errors[0, ~kept], expected, atol=1e-10)
    values, variances = (np.roll(x, 2, axis=0) for x in found.own_numbers(found.parts(), spread))
    A = wide.T @ wide + prior
    solution = -np.linalg.solve(A, wide.T @ residual + np.r_[pull, np.zeros(2 * runs)])
    np.testing.assert_allclose(values.ravel(), solution[k:], atol=1e-10)
    np.testing.assert_allclose(variances.ravel(), np.diag(np.linalg.inv(A))[k:], atol=1e-10)


def test_the_scatter_of_numbers_that_were_drawn_is_found():
    rng = np.random.default_rng(7)
    run = np.repeat(np.arange(150), 20)
    own, slope = rng.uniform(0.5, 1.5, (3000, 2)) * 100.0, rng.standard_normal((3000, 3))
    drawn = np.array([0.03, 0.006]) * rng.standard_normal((150, 2))
    residual = np.sum(own * drawn[run], axis=1) + rng.standard_normal(3000)
    rows = of_runs(run, slope, own, residual)
    found = Runs(rows=rows, run=run, information=np.zeros((3, 3)), pull=np.zeros(3))
    assert found.spread(found.parts()) == pytest.approx([0.03, 0.006], rel=0.2)


@pytest.fixture
def runs_that_scatter():
    """Readings of nine runs with two kinds of own numbers, and their covariance as a whole matrix for any spread."""
    rng = np.random.default_rng(12)
    run = np.repeat(np.arange(9), 8)
    own, slope = rng.uniform(0.5, 1.5, (72, 2)), rng.standard_normal((72, 5))
    slope[:, 4] = 0.8 * run + rng.standard_normal(72)  # nearly the same within a run
    drawn = np.array([1.5, 0.5]) * rng.standard_normal((9, 2))
    residual = np.sum(own * drawn[run], axis=1) + rng.standard_normal(72)
    found = Runs(of_runs(run, slope, own, residual), run, np.zeros((5, 5)), np.zeros(5))

    def covariance(spread):
        wide = np.hstack([own * (run == k)[:, None] * spread for k in range(9)])
        return np.eye(72) + wide @ wide.T

    return found, slope, residual, covariance


def restricted(slope, residual, V):
    """-2 log of the restricted likelihood (Patterson and Thompson, Biometrika 1971, 58, 545), and the sum of squares left."""
    inverse = np.linalg.inv(V)
    A = slope.T @ inverse @ slope
    left = residual - slope @ np.linalg.solve(A, slope.T @ inverse @ residual)
    chi2 = left @ inverse @ left
    return np.linalg.slogdet(V)[1] + np.linalg.slogdet(A)[1] + chi2, chi2


def test_the_spread_is_that_of_the_greatest_restricted_likelihood(runs_that_scatter):
    found, slope, residual, covariance = runs_that_scatter
    parts = found.parts()
    spread = found.spread(parts)
    best = minimize(
        lambda x: restricted(slope, residual, covariance(np.exp(x)))[0], np.zeros(2), method="Nelder-Mead"
    )
    assert spread == pytest.approx(np.exp(best.x), rel=0.03, abs=0.05)
    gain = restricted(slope, residual, covariance(np.zeros(2)))[0] - best.fun
    assert found.support_of_scatter(parts, spread).chi2 == pytest.approx(gain, rel=1e-3)


def test_what_numbers_explain_is_the_fall_of_the_sum_of_squares_weighted_with_the_scatter(runs_that_scatter):
    found, slope, residual, covariance = runs_that_scatter
    parts, every = found.parts(), np.arange(5)
    support = found.support(parts, every, np.array([4]), np.zeros(5))
    for spread, own in ((found.spread(parts), support.chi2), (np.zeros(2), support.removed)):
        V = covariance(spread)
        fall = restricted(slope[:, :4], residual, V)[1] - restricted(slope, residual, V)[1]
        assert own == pytest.approx(fall)
    assert (
        support.chi2 < 0.2 * support.removed
    )  # what is nearly constant within a run competes with its own numbers
    assert 1.0 < support.freedom < 18.0  # two numbers of nine runs at most
    # The same from where the number is 0.3 already
    there = [rows._replace(residual=rows.residual + 0.3 * rows.slope[:, 4]) for rows in found.rows()]
    elsewhere = replace(found, rows=lambda: iter(there))
    again = elsewhere.support(elsewhere.parts(), every, np.array([4]), np.array([0, 0, 0, 0, -0.3]))
    assert again.chi2 == pytest.approx(support.chi2)
    assert again.freedom == pytest.approx(support.freedom)


def test_the_halves_of_a_run_are_the_two_sides_of_its_angle():
    up, lean = np.radians(np.linspace(-6.0, 6.0, 13)), np.radians(np.linspace(-40.0, 40.0, 9))
    points = make_points(
        np.r_[up, up[::-1], np.zeros(9)], np.r_[np.zeros(26), lean], 1400.0, p=250e3, V=6.0, phi_t=0.0,
        sweep=np.r_[np.zeros(26, int), np.ones(9, int)], sweep_names=("slip", "lean"),
    )  # fmt: skip
    half = halves_of_runs(points)
    assert set(half[:26][points.alpha[:26] > 0]) == {1}
    assert set(half[:26][points.alpha[:26] < 0]) == {0}
    assert set(half[26:][lean > 0]) == {3}
    assert set(half[26:][lean < 0]) == {2}


@pytest.mark.parametrize("name", NAMES)
def test_a_number_of_a_run_moves_this_run_only_and_its_slope_is_exact(name):
    alpha = np.radians(np.tile(np.linspace(-6.0, 6.0, 13), 2))
    points = make_points(
        alpha,
        0.1,
        1400.0,
        p=250e3,
        V=6.0,
        phi_t=0.0,
        sweep=np.repeat([0, 1], 13),
        sweep_names=("first", "second"),
    )
    simulation, number = Simulation.of(small_rigs.truth(), turn_slip=False), f"{name}@second"
    _, slope = simulation.sensitivities(points, ["PKY1", number, "alpha_0_deg"])
    moved = [simulation.with_numbers({number: step}).predict(points) for step in (1e-5, -1e-5)]
    expected = ((moved[0] - moved[1]) / 2e-5).reshape(len(slope), -1)
    for channel, values in zip(slope.values(), expected, strict=True):
        np.testing.assert_allclose(channel[:, 1], values, atol=1e-5 * np.max(np.abs(values)))
        assert np.any(channel[:, 2])
    assert not np.any(expected[:, :13])
    assert np.max(np.abs(expected[0, 13:])) > 100.0
