"""Runs of longitudinal slip on a belt: ranked by their gain, made by the virtual rig as proposed, and as good."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

import mffit
from mffit import virtual_rig
from mffit.pipeline.planning import plan_of, sheet
from mffit.planning import read_goal, wording

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


def built(folder: Path, added: Sequence[dict] = (), **noise: float) -> mffit.results.BuildResult:
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
        "sweep": [*sweeps, *added],
    }
    virtual_rig.simulate(virtual_rig.load_plan(plan), folder)
    return mffit.build(folder / "tyre.toml")


@pytest.fixture(scope="module")
def first(tmp_path_factory):
    return built(tmp_path_factory.mktemp("first"))


@pytest.fixture(scope="module")
def goal():
    return read_goal("bands:Fx", on_disc=False)


@pytest.fixture(scope="module")
def plan(first, goal):
    return plan_of(first, goal, runs=3)


def sweep_of(run):
    """A run as a sweep of the virtual rig: every combination of its angles and slips."""
    points = run.points
    values = {
        name: np.unique(points.condition(name).round(6)) for name in ("alpha_deg", "gamma_deg", "kappa")
    }
    return {"file": f"{run.name}.csv", "load_N": run.load, "p_kPa": run.pressure_kPa or 240.0} | {
        name: found.tolist() for name, found in values.items()
    }


@pytest.fixture(scope="module")
def longer(plan, tmp_path_factory):
    """The same project with the runs of the plan."""
    added = [sweep_of(step.run) for step in plan.steps]
    return built(tmp_path_factory.mktemp("longer"), added, Fx_N=12.0)


def test_what_was_never_run_gains_most(plan):
    """Fx of this project comes from priors alone."""
    kinds = {step.run.addition.id for step in plan.steps}
    assert kinds <= {"drive", "combined", "drive-camber", "drive-pressure"}
    assert plan.then < 0.25 * plan.now
    alone = {trial.run.addition.id: trial.after for trial in reversed(plan.trials)}  # the best of each kind
    assert max(alone[kind] for kind in ("drive", "combined")) < alone["sideslip"]


def test_the_runs_are_made_as_proposed_and_are_as_good(plan, longer, goal):
    """The forecast is linear about the Fx of similar tyres, which none of the runs showed yet: a third off here."""
    for run in (step.run for step in plan.steps):
        name = [k for k, file in enumerate(longer.points.files) if file.startswith(run.name)]
        made = longer.points.select(np.isin(longer.points.file, name))
        for column in ("alpha_deg", "gamma_deg", "Fz_N", "p_kPa", "kappa"):
            assert sorted(made.condition(column)) == pytest.approx(
                sorted(run.points.condition(column)), abs=1e-3
            )
    assert longer.fit.coefficients["PKX1"].status in ("fitted", "regularised")
    assert plan_of(longer, goal, runs=0).now == pytest.approx(plan.then, rel=0.35)


def test_one_number_ranks_runs_of_all_forces(first):
    """Over its largest value a force that was never measured is the most uncertain one; one run leaves how it falls with
    sideslip to similar tyres.
    """
    found = plan_of(first, read_goal("file", on_disc=False), runs=1)
    assert found.steps[0].run.addition.id in {"drive", "combined", "drive-camber"}
    assert found.then < 0.5 * found.now < 0.25
    assert "Fx, Fy, Mx and Mz over their largest values" in wording.promise(found)


def test_sheets_have_the_columns_of_slip(first, plan):
    drive = next(t.run for t in plan.trials if t.run.addition.id == "combined")
    table = sheet(first.config, drive.points, drive.addition.measures)
    assert {"kappa", "Fx_N"} <= set(table.columns)
    assert set(np.sign(table["alpha_deg"])) == {-1.0, 1.0}
