"""Friction and stiffness that differ from run to run: found where they do, with standard errors that contain it."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import small_rigs
from plain_pages import without_pictures
from scipy.optimize import minimize

import mffit
import tir
from mffit import config as configuration
from mffit.errors import InputError
from mffit.fit.influences.joint import JointFit, beyond_chance
from mffit.fit.influences.nuisance_choice import choose, halves_of_runs
from mffit.left_out import clearly_above_zero
from mffit.linearised.mixed import Mixed
from mffit.points import make_points
from mffit.report import verdict as shown
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
    content["noise"] = {"Fy_N": small_rigs.FY, "Mz_Nm": small_rigs.MZ, "Mx_Nm": 1.0}
    small_rigs.simulated(content, folder)
    drawn = {sweep["file"].removesuffix(".csv"): sweep["faults"] for sweep in content["sweep"]}
    with without_pictures():
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
    assert fit.runs.alone.keys() == fit.channels.keys()
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


def test_the_shown_misfit_is_that_of_the_written_file(scattered):
    """The file holds for the mean of the runs, so its misfit contains their scatter; that of the fit is said first."""
    result = scattered[0]
    of_file, of_model = (found["Fy"].rmse for found in (result.fit.runs.alone, result.fit.channels))
    assert of_file > 1.2 * of_model
    of_fit, _, left = shown.verdict(result).partition("; the file, ")
    assert f"fitted to {of_model:.3g} N in Fy" in of_fit
    assert f"leaves {of_file:.3g} N" in left


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
    with pytest.raises(InputError, match="2 runs cannot show how runs differ"):
        choose(with_keys(scattered[0], run_scale=True), replace(search, problem=few))


def joint(run, slope, own, residual):
    """Readings of one channel whose shared numbers have priors that do not pull."""
    model = Mixed(-residual, 1e4 * slope, own, [np.flatnonzero(run == k) for k in np.unique(run)])
    names = tuple(f"number {k}" for k in range(slope.shape[1]))
    return JointFit(names, model, np.ones((1, len(run))), ("Fy",), np.arange(len(run)), np.full(2, 0.3))


@pytest.fixture
def runs_that_scatter():
    """Readings of nine runs with two kinds of own numbers, and their covariance as a whole matrix for any spread."""
    rng = np.random.default_rng(12)
    run = np.repeat(np.arange(9), 8)
    own, slope = rng.uniform(0.5, 1.5, (72, 2)), rng.standard_normal((72, 5))
    slope[:, 4] = 0.8 * run + rng.standard_normal(72)  # nearly the same within a run
    drawn = np.array([0.5, 0.15]) * rng.standard_normal((9, 2))
    residual = np.sum(own * drawn[run], axis=1) + rng.standard_normal(72)

    def covariance(spread):
        wide = np.hstack([own * (run == k)[:, None] * spread for k in range(9)])
        return np.eye(72) + wide @ wide.T

    return joint(run, slope, own, residual), slope, residual, covariance


def restricted(slope, residual, V):
    """-2 log of the restricted likelihood (Patterson and Thompson, Biometrika 1971, 58, 545), and the sum of squares left."""
    inverse = np.linalg.inv(V)
    A = slope.T @ inverse @ slope
    left = residual - slope @ np.linalg.solve(A, slope.T @ inverse @ residual)
    chi2 = left @ inverse @ left
    return np.linalg.slogdet(V)[1] + np.linalg.slogdet(A)[1] + chi2, chi2


def best(slope, residual, covariance):
    """The greatest restricted likelihood, by another search."""
    start = np.full(2, np.log(0.3))
    return minimize(
        lambda x: restricted(slope, residual, covariance(np.exp(x)))[0], start, method="Nelder-Mead"
    )


def test_the_spread_is_that_of_the_greatest_restricted_likelihood(runs_that_scatter):
    found, slope, residual, covariance = runs_that_scatter
    aim = best(slope, residual, covariance)
    assert found.explained().scatter == pytest.approx(np.exp(aim.x), rel=0.03, abs=0.02)
    gain = restricted(slope, residual, covariance(np.zeros(2)))[0] - aim.fun
    assert 2.0 * (found.explained().value - found.model.evidence(found.alike()).value) == pytest.approx(
        gain, rel=1e-3
    )


def test_what_a_number_explains_is_weighed_with_the_scatter_of_the_runs(runs_that_scatter):
    """Twice the gain is the fall of -2 log likelihood, each at its own scatter, the volume of the number apart."""
    found, slope, residual, covariance = runs_that_scatter
    with_it, without = best(slope, residual, covariance), best(slope[:, :4], residual, covariance)
    inverse = np.linalg.inv(covariance(np.exp(with_it.x)))
    variance = np.linalg.inv(slope.T @ inverse @ slope)[4, 4]
    gain = found.gain({"number 4"})
    assert 2.0 * gain == pytest.approx(without.fun - with_it.fun - np.log(variance), rel=0.01, abs=0.01)
    alike = restricted(slope[:, :4], residual, np.eye(72))[1] - restricted(slope, residual, np.eye(72))[1]
    assert 2.0 * gain < 0.5 * alike  # what is nearly constant within a run competes with its own numbers


def test_a_left_out_half_is_predicted_as_by_a_fit_without_it(runs_that_scatter):
    """Against a solution of the whole system with a column for every number of every run."""
    found, slope, residual, _ = runs_that_scatter
    run, own, given = np.repeat(np.arange(9), 8), found.model.own, found.explained().given
    wide = np.column_stack([slope, *(own * (run == j)[:, None] for j in range(9))])
    prior = np.diag(np.concatenate([np.full(5, 1e-8), np.tile(np.exp(-given.own), 9)]))
    half = 2 * run + (np.arange(72) % 8 > 3)
    squares = []
    for piece in np.unique(half):
        kept = half != piece
        numbers = np.linalg.solve(wide[kept].T @ wide[kept] + prior, wide[kept].T @ residual[kept])
        squares.append(np.sum((residual[~kept] - wide[~kept] @ numbers) ** 2))
    left_out = found.left_out(given, half)
    np.testing.assert_allclose(left_out.squares, squares, rtol=1e-5)
    assert left_out.gaps["Fy"] == pytest.approx(np.sqrt(np.sum(squares) / 72), rel=1e-5)


def test_more_is_asked_of_the_best_of_several():
    assert beyond_chance(4.7, 2)  # exp(-4.7) is 0.9 %
    assert not beyond_chance(4.5, 2)
    assert not beyond_chance(4.7, 2, candidates=2)
    assert not beyond_chance(-1.0, 2)
    assert clearly_above_zero(np.array([1.0, 2.0, 3.0]))  # 2 +- 0.58
    assert not clearly_above_zero(np.array([0.0, 2.0, 4.0]))  # 2 +- 1.15


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
