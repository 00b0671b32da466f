"""Longitudinal force, combined slip and overturning moment: recovery of a known tyre, starts, and what the data show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from mffit.diagnosis.remains import Left, best_effect
from mffit.diagnosis.wording import rival_of_formula
from mffit.fit.by_hand import NO_HAND
from mffit.fit.coverage import coverage
from mffit.fit.fitted import Fitted, left_by
from mffit.fit.known import known_before_fit
from mffit.fit.plan import fit_plan
from mffit.fit.problem import fit_problem
from mffit.fit.start import starting_values
from mffit.fit.wording import at_limits
from mffit.pipeline.measuring import measure
from tests.mffit.fit import combined_programme as belt


@pytest.fixture(scope="module")
def points():
    return belt.programme()


@pytest.fixture(scope="module")
def found(points):
    return belt.fitted(points)


def test_every_channel_is_fitted_to_its_noise(found):
    for name, noise in belt.NOISE.items():
        assert found.channels[name].rmse == pytest.approx(noise, rel=0.05)


def test_the_errors_of_the_rig_in_mx_are_recovered(found):
    """The declared crosstalk of Fx to a tenth of a millimetre: no coefficient of the tyre has its shape."""
    for name, true in {"Mx0_Nm": belt.MX_ZERO, "crosstalk_Fx_Mx_m": belt.FX_INTO_MX}.items():
        value, u = found.rig[name]
        assert value == pytest.approx(true, abs=4.0 * u)
    assert found.rig["crosstalk_Fx_Mx_m"][1] < 1e-4


def without_crosstalk(fit: Fitted) -> Fitted:
    """The same coefficients with a rig without crosstalk of Fx into Mx."""
    name = "crosstalk_Fx_Mx_m"
    numbers = [n for n in fit.numbers if n.name != name]
    return replace(fit, problem=fit.problem.with_values({name: 0.0}), numbers=numbers)


def test_an_undeclared_crosstalk_is_the_best_effect_in_the_residuals(found):
    fit, name = found.search, "crosstalk_Fx_Mx_m"
    unaware = without_crosstalk(fit)
    best = best_effect(Left.of(unaware, left_by(unaware)))
    assert best.best.effect.id == "crosstalk-fx-mx"
    assert best.significant
    assert not best.rivals
    for share, rivals in ((0.9, True), (0.02, False)):  # model error is not in doubt for what explains little
        little = replace(best, best=replace(best.best, share=share))
        assert bool(rival_of_formula(little)) is rivals
    value, u = best.best.numbers[name]
    assert value == pytest.approx(belt.FX_INTO_MX, abs=4.0 * u)
    after = best_effect(Left.of(fit, left_by(fit)))
    assert after.best.effect.id != "crosstalk-fx-mx"
    assert not after.significant


def test_an_effect_is_found_in_residuals_without_a_self_aligning_moment(found):
    """Mz, without a reading, stays a channel of the fit."""
    unaware = without_crosstalk(found.search)
    problem, nothing = unaware.problem, np.full(len(unaware.problem.points), np.nan)
    sigma = {**problem.sigma, "Mz": np.full(len(nothing), np.inf)}
    blind = replace(unaware, problem=replace(problem, points=problem.points.replace(Mz=nothing), sigma=sigma))
    best = best_effect(Left.of(blind, left_by(blind)))
    assert best.best.effect.id == "crosstalk-fx-mx"
    assert best.significant


def test_the_forces_of_the_tyre_are_recovered_over_the_tested_range(found):
    """Within twice the noise of a point at conditions that were not run, combined slip and camber included."""
    true = belt.truth()
    rng = np.random.default_rng(2)
    n = 400
    Fz, gamma = rng.uniform(900.0, 2100.0, n), np.radians(rng.uniform(0.0, 6.0, n))
    alpha, kappa = np.radians(rng.uniform(-5.0, 5.0, n)), rng.uniform(-0.2, 0.2, n)
    expected, read = (
        tyre(Fz, alpha, gamma, kappa, p=250e3, turn_slip=False) for tyre in (true, found.written)
    )
    for name, noise in belt.NOISE.items():
        error = getattr(read, name) - getattr(expected, name)
        assert np.sqrt(np.mean(error**2)) < noise, name
        assert np.quantile(np.abs(error), 0.95) < 2.0 * noise, name


def test_standard_errors_cover_the_truth(found):
    """Of some 30 coefficients within 2.6 standard errors by chance in 99 %: two beyond are allowed."""
    true = belt.truth()
    z = {
        name: abs(found.coefficients[name].value - true[name]) / found.coefficients[name].stderr
        for name in belt.DRIVEN
    }
    assert sum(size > 2.6 for size in z.values()) <= 2, z
    assert not found.full.at_bound
    assert {found.coefficients[name].status for name in ("PDX1", "RBX1", "RBY1", "SSZ1", "QSX2")} == {
        "fitted"
    }


def test_the_file_says_which_slips_were_run(found):
    assert (found.written["KPUMIN"], found.written["KPUMAX"]) == pytest.approx((-0.2, 0.2))
    assert found.written.status["KPUMAX"]


def test_no_start_is_dead(points):
    """Every free coefficient changes some reading at the start: a product of factors that are all 0 would never move."""
    project = belt.config()
    _, measured = measure(project, points, None)
    known = known_before_fit(project, points, measured, None, {}, NO_HAND)
    # As a base file without any of it: all zero.
    zero = dict.fromkeys(
        ("RBX2", "RBY2", "RVY1", "RVY3", "RVY4", "RVY5", "RVY6", "QSX1", "QSX2", "QSX3"), 0.0
    )
    values = {**known.values, **zero}
    start = starting_values(values, points, measured)
    plan = fit_plan(project, points, measured, replace(known, values=values), start, {})
    problem = fit_problem(project, points, measured, values, plan.channels).with_values(
        {name: start[name] for name in plan.free}
    )
    names = plan.free
    slope = problem.free(names).linear(np.array([start[name] for name in names])).slope
    dead = [name for name, size in zip(names, np.abs(slope).max(axis=0), strict=True) if not size > 1e-9]
    assert set(dead) <= {
        "QBZ9",
        "QBZ10",
        "PPZ2",
    }  # factors of QDZ6 and QDZ8, which are not dead and move first
    assert {"RVY4", "RVY5", "RVY6", "RBX2", "PPMX1"} <= set(names)


def test_what_is_missing_for_longitudinal_slip_is_said():
    everything = {row.stage: row for row in coverage(belt.programme(), "left")}
    assert everything["combined-Fx"].supported
    straight = {row.stage: row for row in coverage(belt.programme(sideslips=(0.0,)), "left")}
    assert straight["Fx"].supported
    assert straight["combined-Fx"].missing == (
        "longitudinal slip was run at one sideslip only, which does not show how it falls with sideslip",
    )
    # A driven wheel that runs straight on has a side force and a moment of their own.
    of_thrust = ("RBY1", "RCY1", "REY1", "REY2", "RHY1", "RHY2")
    own = ("RVY1", "RVY2", "RVY3", "RVY5", "RVY6")
    assert straight["combined-Fy"].free == (*of_thrust, *own)
    upright = belt.programme(sideslips=(0.0,))
    upright = upright.select(upright.gamma == 0.0)
    assert {row.stage: row for row in coverage(upright, "left")}["combined-Fy"].free == tuple(
        name for name in own if name != "RVY3"
    )
    assert straight["combined-Mz"].free == ("SSZ1", "SSZ3", "SSZ4")
    right = {row.stage: row for row in coverage(belt.programme(sideslips=(0.0, 2.0, 5.0)), "left")}
    assert (
        "RHX1" in right["combined-Fx"].held
    )  # the sweeps of sideslip alone go to both sides, which does not show it
    assert any("sideslip was run to one side only" in why for why in right["combined-Fx"].missing)
    rolling = belt.programme(driven=False)
    assert {row.stage for row in coverage(rolling, "left")} == {
        *("Fy", "camber", "pressure", "trail", "residual", "spin", "shift")
    }
    held = {row.stage: row for row in coverage(rolling.replace(Fx=0.0), "left")}
    assert held["Fx"].missing == ("no sweep varies longitudinal slip",)


def test_slip_without_sideslip_is_fitted_to_the_noise():
    """A side force of its own, the loss of camber thrust, and the moment of a driven wheel that runs straight on."""
    points = belt.programme(sideslips=(0.0,))
    found = belt.fitted(points.select((np.abs(points.Fz - 1400.0) < 1.0) & (points.p == 250e3)))
    for name, noise in belt.NOISE.items():
        assert 0.8 < found.channels[name].rmse / noise < 1.15, name
    true = belt.truth()
    for name in ("RVY1", "SSZ1", "RBY1"):
        row = found.coefficients[name]
        assert abs(row.value - true[name]) < 3.3 * row.stderr, name


def test_a_rare_value_counts_as_at_a_limit_unless_the_base_has_it(found):
    rare = replace(found.search, values={**found.search.values, "RBX3": 300.0}, at_bound=frozenset())
    assert at_limits(rare) == ("RBX3",)
    like_the_base = [
        replace(n, start=310.0, expected=310.0) if n.name == "RBX3" else n for n in found.search.numbers
    ]
    assert at_limits(replace(rare, numbers=like_the_base)) == ()


def test_the_uncertainty_of_the_camber_stiffness_contains_the_skew_of_the_axis(found):
    """0.1 deg of skew, the default, is sideslip of that times the sine of camber: a side force like camber stiffness."""
    K_ya = belt.truth().state(1400.0, p=250e3).K_ya
    assert found.posterior.stderr["PKY6"] > np.radians(0.1) * abs(K_ya) / 1400.0
    assert found.posterior.stderr["PKY6"] < 2.0 * np.radians(0.1) * abs(K_ya) / 1400.0
