"""JSON of a plan and of a comparison."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from mffit.comparison import Comparison, Difference
from mffit.comparison import wording as compared
from mffit.planning import Plan, PlannedRun
from mffit.planning import wording as planned
from mffit.results.as_json.values import picked


def plan(found: Plan) -> dict[str, Any]:
    """The content of ``plan.json``; uncertainties in the goal's unit, k = 1 except for bands; null if not measured."""
    seen = found.identified
    return {
        "goal": picked(found.goal, "kind", "name", "label", "unit"),
        "headline": planned.headline(found),
        "promise": planned.promise(found),
        "identified": planned.identified(seen),
        "ties": [{**asdict(tie), "told": tie.told} for tie in seen.ties],
        "u_now": found.now,
        "u_then": found.then,
        "told_below": found.told_below,
        "u_epsilon_gamma_direct": found.direct_now,
        "u_epsilon_gamma_joint": found.joint_now,
        "runs": [
            _run(step.run)
            | {
                "u_before": step.before,
                "u_after": step.after,
                "u_epsilon_gamma_direct": step.direct,
                "u_epsilon_gamma_joint": step.joint,
            }
            for step in found.steps
        ],
        "alone": [_run(trial.run) | {"u_after": trial.u} for trial in found.trials],
    }


def comparison(found: Comparison) -> dict[str, Any]:
    """The content of ``compare.json``; SI units, ISO signs, u with k = 1, null if unknown."""
    return {
        "first": found.first,
        "second": found.second,
        "headline": compared.headline(found),
        "numbers": [_difference(row) for row in found.numbers],
        "coefficients": [_difference(row) for row in found.coefficients],
        "curves": [
            picked(gap, "channel", "over")
            | {
                "load_N": gap.load,
                "rms": gap.rms,
                "largest": gap.largest[0],
                **(
                    {"at_kappa": gap.largest[1]}
                    if gap.over == "kappa"
                    else {"at_deg": math.degrees(gap.largest[1])}
                ),
            }
            for gap in found.curves
        ],
        "sweeps": [asdict(gap) for gap in found.sweeps],
        "notes": list(found.notes),
    }


def _difference(row: Difference) -> dict[str, Any]:
    return {**asdict(row), "change": row.change, "u_change": row.u, "in_u": row.z}


def _run(run: PlannedRun) -> dict[str, Any]:
    return {
        "name": run.name,
        "kind": run.addition.id,
        "title": planned.title(run),
        "reason": run.addition.reason,
        "points": run.cost,
        "rig": dict(run.rig),
    }
