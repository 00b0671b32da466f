"""Predictions of ``mffit plan`` against the outcome: ``python tests/studies/plan_study.py 20``.

The errors of the rigs are drawn from their declared uncertainties. Each campaign is built, a plan is made for every goal, its
runs are simulated on the same rig with the same tyre, and the longer campaign is built. The predicted uncertainty is compared
with the one that this build states and with the true error over all draws. ``tests/mffit/planning/test_predictions.py`` does so
for one draw.
"""

from __future__ import annotations

import copy
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import Any

import harness
import numpy as np
from small_rigs import SAMPLE, built, disc, truth

import tir
from mffit import virtual_rig
from mffit.additions import PlannedRun, addition_named
from mffit.pipeline.planning import plan_of
from mffit.planning import Goal, Plan, read_goal
from mffit.results import BuildResult
from mffit.scatter import rms

FAULTS = ("F0_N", "gamma_0_deg", "alpha_0_deg", "path_radius_m", "backlash_deg")
MOST_RUNS = 2


@dataclass(frozen=True)
class Task:
    """A goal, the source of PECP1, and the runs that the rig cannot make."""

    goal: str
    pecp1: str = "debiased"
    without: tuple[str, ...] = ()


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


def one(job: harness.Job) -> dict[Task, Outcome]:
    """Outcomes of all tasks for one draw: simulate, build, plan, simulate the plan, build again."""
    content, true, seed, out = disc(faults={"draw": True}), truth(), job.seed, {}
    drawn = virtual_rig.run(virtual_rig.load_plan(content, folder=SAMPLE), true, seed=seed).truth.faults
    content["faults"] = {name: drawn[name] for name in FAULTS}
    with tempfile.TemporaryDirectory() as made:
        for pecp1 in dict.fromkeys(task.pecp1 for task in TASKS):
            first = built(content | {"spin": {"pecp1": pecp1}}, Path(made) / f"first-{pecp1}", seed)
            for task in (task for task in TASKS if task.pecp1 == pecp1):
                goal = read_goal(task.goal, on_disc=True)
                without = [addition_named(word) for word in task.without]
                plan = plan_of(first, goal, runs=MOST_RUNS, without=without)
                longer = copy.deepcopy(content) | {"spin": {"pecp1": pecp1}}
                longer["sweep"] += [sweep for step in plan.steps for sweep in sweeps(step.run, plan)]
                second = built(longer, Path(made) / f"second-{TASKS.index(task)}", seed)
                names = tuple(step.run.name for step in plan.steps)
                stated, error = stated_and_error(second, goal, true)
                out[task] = Outcome(names, plan.now, plan.then, stated, error)
    return out


def sweeps(run: PlannedRun, plan: Plan) -> Iterator[dict[str, Any]]:
    """Set-points of a run as sweeps of the virtual rig, one per direction, pressure and camber."""
    points = run.points
    alpha, gamma = np.degrees(points.alpha).round(6), np.degrees(points.gamma).round(6)
    for way, pressure, lean in product((1, -1), np.unique(points.p), np.unique(gamma)):
        own = np.flatnonzero((points.direction == way) & (points.p == pressure) & (gamma == lean))
        if not len(own):
            continue
        phi_t = float(points.phi_t[own[0]])
        yield {
            "file": f"{run.name}_{way}_{pressure:.0f}_{lean:g}.csv",
            "load_N": float(points.Fz[own[0]]),
            "alpha_deg": alpha[own].tolist(),
            "gamma_deg": [float(lean)],
            "p_kPa": 1e-3 * float(pressure),
            "direction": "forward" if way > 0 else "backward",
            "mount": "normal" if points.mount[own[0]] > 0 else "flipped",
            "path_centre": "left" if phi_t < 0 else "right",
            "path_radius": round(1.0 / abs(phi_t), 9) or plan.config.rig.radius,
        }


def stated_and_error(result: BuildResult, goal: Goal, true: tir.Tyre) -> tuple[float, float]:
    """The uncertainty of the goal in the build of the longer campaign, and its true error."""
    measured, coefficients = result.measured, result.fit.coefficients
    if goal.kind == "eps_gamma":
        debiased = result.config.spin.pecp1 == "debiased"
        found = measured.epsilon_gamma_debiased if debiased else measured.epsilon_gamma
        return found.u, found.value - true["PECP1"]
    if goal.kind in ("eps_gamma:joint", "coefficient"):
        name = "PECP1" if goal.kind == "eps_gamma:joint" else goal.name
        return coefficients[name].stderr, result.fit.tyre[name] - true[name]
    return plan_of(result, goal, runs=0).now, float("nan")


def page(_: Any, draws: list[dict[Task, Outcome]]) -> Iterator[str]:
    head = ("goal", "PECP1", "without", "most frequent list", "u now", "promised")
    head += ("stated over promised: median (range)", "rms error over promised", "draws")
    yield from harness.table(head, (_row(task, [draw[task] for draw in draws]) for task in TASKS))


def _row(task: Task, found: list[Outcome]) -> tuple[object, ...]:
    lists = [", ".join(o.runs) for o in found]
    now, promised, ratio, pull = np.array(
        [(o.now, o.promised, o.stated / o.promised, o.error / o.promised) for o in found]
    ).T
    return (
        task.goal, task.pecp1, ", ".join(task.without), max(set(lists), key=lists.count), f"{np.median(now):.3g}",
        f"{np.median(promised):.3g}", f"{np.median(ratio):.2f} ({ratio.min():.2f} to {ratio.max():.2f})",
        f"{rms(pull):.2f}", len(found),
    )  # fmt: skip


if __name__ == "__main__":
    harness.study(one, page, draws=20)
