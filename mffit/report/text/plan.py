"""A plan, for the terminal."""

from __future__ import annotations

from mffit.planning import Plan, wording
from mffit.report import constants
from mffit.report.text.layout import blocks, paragraphs, table, wrapped


def plan_summary(plan: Plan) -> str:
    """The text that ``mffit plan`` prints: identified numbers, the list of runs, the effect of each run alone."""
    head = ("run", "points", f"{wording.measure(plan)} now", f"{wording.measure(plan)} then")
    rows = [
        (
            wording.title(step.run),
            str(step.run.cost),
            wording.shown(plan, step.before),
            wording.shown(plan, step.after),
        )
        for step in plan.steps
    ]
    alone = [
        (
            wording.title(trial.run),
            str(trial.run.cost),
            wording.shown(plan, trial.before),
            wording.shown(plan, trial.after),
        )
        for trial in plan.trials[: constants.MOST_ROWS]
        if trial.after < plan.now
    ]
    reasons = [f"{wording.title(step.run)}: {step.run.addition.reason}" for step in plan.steps]
    parts = [
        "What these sweeps identify",
        paragraphs(wording.identified(plan.identified)),
        wrapped(wording.headline(plan)),
        table(head, rows) if rows else "",
        paragraphs(reasons),
        "Each alone:" if alone else "",
        table(head, alone) if alone else "",
        wrapped(wording.promise(plan)),
    ]
    return blocks(parts)
