"""Drive, combined, rolling and step runs of a belt: ranked by their gain, made by the virtual rig as proposed, and as good."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np
import pytest

import mffit
from mffit import virtual_rig
from mffit.errors import InputError
from mffit.fit import Posterior
from mffit.pipeline.planning import plan_of, sheet, simulated
from mffit.planning import read_goal, wording
from mffit.planning.apart import FittedApart

TRUE = Path(__file__).parents[3] / "samples" / "flat-track-combined" / "true.tir"
SIDESLIP = [-9, -5, -3, -1.5, -0.5, 0.5, 1.5, 3, 5, 9]
NOISE = {"Fy_N": 12.0, "Mz_Nm": 1.5}
TYRE = {
    "name": "t",
    "unloaded_radius": 0.3185,
    "nominal_load": 4200,
    "nominal_pressure": 240,
    "nominal_speed": 16.7,
}


def built(folder: Path, added: str = "", **noise: float) -> mffit.results.BuildResult:
    sweeps = [
        {"file": f"side_{load}.csv", "load_N": load, "alpha_deg": SIDESLIP, "gamma_deg": [0, 3]}
        for load in (2500, 5000)
    ]
    plan = {
        "seed": 3,
        "truth": {"tyre": str(TRUE)},
        "noise": NOISE | noise,
        "tyre": TYRE,
        "rig": {"type": "flat-track", "axes": "sae"},
        "conditions": {"V_mps": 16.7},
        "sweep": sweeps + tomllib.loads(added).get("sweep", []),
    }
    virtual_rig.simulate(virtual_rig.load_plan(plan), folder)
    return mffit.build(folder / "tyre.toml")


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    return built(tmp_path_factory.mktemp("first"))


@pytest.fixture(scope="module")
def goal():
    return read_goal("file", on_disc=False)


@pytest.fixture(scope="module")
def plan(first, goal):
    return plan_of(first, goal, runs=4)


@pytest.fixture(scope="module")
def longer(first, plan, tmp_path_factory):
    """The same project with the runs of the plan."""
    added = simulated(first.config, [step.run for step in plan.steps])
    folder = tmp_path_factory.mktemp("longer")
    return built(folder, added, Fx_N=12.0, RL_m=0.0003, omega_radps=0.02)


def test_what_was_never_run_gains_most(plan):
    """Fx, relaxation length and radius of this project come from priors alone."""
    kinds = {step.run.addition.id for step in plan.steps}
    assert kinds & {"steps", "slip-steps"}
    assert "rolling" in kinds
    assert kinds & {"drive", "combined", "drive-camber", "drive-pressure"}
    assert plan.then < 0.55 * plan.now
    alone = {trial.run.addition.id: trial.u for trial in reversed(plan.trials)}  # the best of each kind
    assert max(alone[kind] for kind in ("drive", "combined", "rolling")) < alone["sideslip"]


def test_the_runs_are_made_as_proposed_and_are_as_good(first, plan, longer, goal):
    runs = [step.run for step in plan.steps]
    for run in runs:
        if not run.addition.steps:
            name = [k for k, file in enumerate(longer.points.files) if file.startswith(run.name)]
            made = longer.points.select(np.isin(longer.points.file, name))
            for column in ("alpha_deg", "gamma_deg", "Fz_N", "p_kPa"):
                assert sorted(made.condition(column)) == pytest.approx(
                    sorted(run.points.condition(column)), abs=1e-3
                )
    assert longer.fit.coefficients["PKX1"].status in ("fitted", "regularised")
    found = [direction.found for direction in longer.fit.relaxation]
    assert "LATERAL_STIFFNESS" in found[0] or "LONGITUDINAL_STIFFNESS" in found[1]
    assert "VERTICAL_STIFFNESS" in longer.fit.radii.found
    expected = FittedApart(first.config, first.fit, first.fit.files.tested).lags
    for forecast, relaxation in zip(expected, longer.fit.relaxation, strict=True):
        for step in relaxation.runs:
            assert step.length.u / step.length.value == pytest.approx(
                forecast.u_of_step(step.load, step.pressure), rel=0.5
            )
    assert plan_of(longer, goal, runs=0).now == pytest.approx(plan.then, rel=0.1)


@pytest.mark.parametrize(("direction", "kind"), [(0, "steps-pressure"), (1, "slip-steps-pressure")])
def test_steps_at_another_pressure_are_proposed_for_what_only_they_show(longer, direction, kind):
    """The stiffness itself is as certain as the build states, the term over pressure is the prior's before this run."""
    relaxation = longer.fit.relaxation[direction]
    nominal, *_, over_pressure = relaxation.direction.names
    now = plan_of(longer, read_goal(nominal, on_disc=False), runs=0).now
    assert now == pytest.approx(relaxation.found[nominal].u, rel=0.05)
    found = plan_of(longer, read_goal(over_pressure, on_disc=False), runs=1)
    assert [step.run.addition.id for step in found.steps] == [kind]
    assert found.then < 0.5 * found.now


def test_the_stiffness_is_forecast_with_the_slip_stiffness_from_which_it_follows(longer):
    """It is cornering stiffness over relaxation length: 10 % in PKY1 are 10 % in it."""
    apart = FittedApart(longer.config, longer.fit, longer.fit.files.tested)
    name, PKY1 = "LATERAL_STIFFNESS", float(longer.fit.tyre["PKY1"])
    exact, unsure = (
        apart.u_carcass(name, [], Posterior(("PKY1",), np.array([[u**2]]))) for u in (0.0, 0.1 * PKY1)
    )
    assert unsure == pytest.approx(np.hypot(exact, 0.1 * longer.fit.tyre[name]), rel=0.02)


def test_sheets_and_goal(first, plan):
    drive = next(t.run for t in plan.trials if t.run.addition.id == "combined")
    table = sheet(first.config, drive.points, drive.addition.measures)
    assert {"kappa", "Fx_N"} <= set(table.columns)
    assert set(np.sign(table["alpha_deg"])) == {-1.0, 1.0}
    assert "relaxation length" in wording.promise(plan)
    with pytest.raises(InputError, match="straight path"):
        read_goal("file", on_disc=True)
