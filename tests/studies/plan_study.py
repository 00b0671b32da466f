"""Predictions of ``mffit plan`` against the outcome: ``python tests/studies/plan_study.py [DRAWS]``.

The errors of the rigs are drawn from their declared uncertainties. Each campaign is built, a plan is made for every goal, its
runs are simulated on the same rig with the same tyre, and the longer campaign is built. The predicted uncertainty is compared
with the one that this build states and with the true error over all draws. ``tests/mffit/planning/test_predictions.py`` does so
for one draw.
"""

from __future__ import annotations

import argparse
import copy
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

import tir
from mffit import virtual_rig
from mffit.pipeline.planning import plan_of
from mffit.planning import Goal, Plan, PlannedRun, addition_named, read_goal
from mffit.results import BuildResult
from tests.mffit.small_rigs import SAMPLE, built, disc, truth

FAULTS = {
    "u_loadcell_offset_N": "F0_N",
    "u_camber_alignment_deg": "gamma_0_deg",
    "u_slip_alignment_N": "alpha_0_deg",
    "u_path_radius": "path_radius_m",
}


@dataclass(frozen=True)
class Task:
    """A goal, the source of PECP1, and the runs that the rig cannot make."""

    goal: str
    pecp1: str = "debiased"
    without: tuple[str, ...] = ()
    runs: int = 2


ONE_SIDE = ("other-side", "other-side-camber")
TASKS = (
    Task("eps_gamma"),
    Task("eps_gamma", without=ONE_SIDE),
    Task("eps_gamma", pecp1="direct", without=(*ONE_SIDE, "second-radius")),
    Task("eps_gamma:joint", pecp1="model", without=ONE_SIDE),
    Task("PPY2"),
    Task("bands:Mz"),
)


@dataclass(frozen=True)
class Outcome:
    """One draw of one task."""

    runs: tuple[str, ...]
    now: float
    promised: float
    stated: float
    error: float


def outcomes(seed: int) -> Iterator[tuple[Task, Outcome]]:
    """Outcomes of all tasks for one draw: simulate, build, plan, simulate the plan, build again."""
    content = disc(faults={"draw": True})
    true = truth()
    drawn = virtual_rig.run(virtual_rig.load_plan(content, folder=SAMPLE), true, seed=seed).truth.faults
    content["faults"] = {name: drawn[name] for name in (*FAULTS.values(), "backlash_deg")}
    with tempfile.TemporaryDirectory() as made:
        for pecp1 in dict.fromkeys(task.pecp1 for task in TASKS):
            first = built(content | {"spin": {"pecp1": pecp1}}, Path(made) / f"first-{pecp1}", seed)
            for task in (task for task in TASKS if task.pecp1 == pecp1):
                goal = read_goal(task.goal, on_disc=True)
                plan = plan_of(
                    first, goal, runs=task.runs, without=[addition_named(word) for word in task.without]
                )
                longer = extended(content | {"spin": {"pecp1": pecp1}}, plan)
                second = built(longer, Path(made) / f"second-{TASKS.index(task)}", seed)
                stated, error = stated_and_error(second, goal, true)
                names = tuple(step.run.name for step in plan.steps)
                yield task, Outcome(names, plan.now, plan.then, stated, error)


def extended(content: dict[str, Any], plan: Plan) -> dict[str, Any]:
    """The campaign with the runs of the plan."""
    content = copy.deepcopy(content)
    for step in plan.steps:
        content["sweep"] += list(sweeps(step.run, plan))
    return content


def sweeps(run: PlannedRun, plan: Plan) -> Iterator[dict[str, Any]]:
    """Set-points of a run as sweeps of the virtual rig, one sweep per camber."""
    points = run.points
    usual = plan.config.rig.radius
    for way in (1, -1):
        for k, pressure in enumerate(np.unique(points.p)):
            rows = np.flatnonzero((points.direction == way) & (points.p == pressure))
            alpha, gamma = np.degrees(points.alpha[rows]).round(6), np.degrees(points.gamma[rows]).round(6)
            for j, lean in enumerate(np.unique(gamma)):
                own = rows[gamma == lean]
                yield (
                    {
                        "file": f"{run.name}_{way}_{k}_{j}.csv",
                        "load_N": float(points.Fz[own[0]]),
                        "alpha_deg": alpha[gamma == lean].tolist(),
                        "gamma_deg": [float(lean)],
                        "p_kPa": 1e-3 * float(pressure),
                        "direction": "forward" if way > 0 else "backward",
                        "mount": "normal" if points.mount[own[0]] > 0 else "flipped",
                        "path_centre": "left" if points.phi_t[own[0]] < 0 else "right",
                        "path_radius": round(1.0 / abs(float(points.phi_t[own[0]])), 9) or usual,
                    }
                    if len(own)
                    else {}
                )


def stated_and_error(result: BuildResult, goal: Goal, true: tir.Tyre) -> tuple[float, float]:
    """The uncertainty of the goal in the build of the longer campaign, and its true error."""
    measured, coefficients = result.measured, result.fit.coefficients
    if goal.kind == "eps_gamma":
        debiased = result.config.spin.pecp1 == "debiased"
        found = measured.epsilon_gamma_debiased if debiased else measured.epsilon_gamma
        return found.u, found.value - true["PECP1"]
    if goal.kind == "eps_gamma:joint":
        return coefficients["PECP1"].stderr, result.fit.tyre["PECP1"] - true["PECP1"]
    if goal.kind == "coefficient":
        return coefficients[goal.name].stderr, result.fit.tyre[goal.name] - true[goal.name]
    again = plan_of(result, goal, runs=0)
    return again.now, float("nan")


def rows(found: dict[Task, list[Outcome]]) -> Iterator[str]:
    """The table."""
    head = ("goal", "PECP1", "without", "most frequent list", "u now", "promised")
    head += ("stated over promised: median (range)", "rms error over promised", "draws")
    yield f"| {' | '.join(head)} |"
    yield "|---" * len(head) + "|"
    for task, all_of in found.items():
        if not all_of:
            continue
        lists = [", ".join(o.runs) for o in all_of]
        ratio = np.array([o.stated / o.promised for o in all_of])
        pull = np.array([o.error / o.promised for o in all_of])
        scatter = f"{np.sqrt(np.mean(pull**2)):.2f}" if np.all(np.isfinite(pull)) else "–"
        yield (
            f"| {task.goal} | {task.pecp1} | {', '.join(task.without)} | {max(set(lists), key=lists.count)} "
            f"| {np.median([o.now for o in all_of]):.3g} | {np.median([o.promised for o in all_of]):.3g} "
            f"| {np.median(ratio):.2f} ({ratio.min():.2f} to {ratio.max():.2f}) | {scatter} | {len(all_of)} |"
        )


def main() -> None:
    ask = argparse.ArgumentParser()
    ask.add_argument("draws", type=int, nargs="?", default=20)
    ask.add_argument("--first", type=int, default=0)
    given = ask.parse_args()
    found: dict[Task, list[Outcome]] = {task: [] for task in TASKS}
    for seed in range(given.first, given.first + given.draws):
        for task, outcome in outcomes(seed):
            found[task].append(outcome)
            print(seed, task.goal, task.pecp1, outcome, file=sys.stderr, flush=True)
    print("\n".join(rows(found)))


if __name__ == "__main__":
    main()
