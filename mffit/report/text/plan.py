"""A plan, for the terminal."""

from __future__ import annotations

import textwrap

from mffit.planning import Plan, wording
from mffit.report.text.layout import WIDTH, blocks, paragraphs, table

ALONE = 6
"""Candidates shown at most."""


def plan_summary(plan: Plan) -> str:
    """What ``mffit plan`` prints: what is identified, the list, what others would bring alone."""
    head = ("run", "points", f"{wording.measure(plan)} now", f"{wording.measure(plan)} then")
    rows = [
        (
            wording.title(step.run),
            _cost(step.run.cost),
            wording.shown(plan, step.before),
            wording.shown(plan, step.after),
        )
        for step in plan.steps
    ]
    alone = [
        (
            wording.title(trial.run),
            _cost(trial.run.cost),
            wording.shown(plan, plan.now),
            wording.shown(plan, trial.u),
        )
        for trial in plan.trials[:ALONE]
        if trial.u < plan.now
    ]
    reasons = [f"{wording.title(step.run)}: {wording.reason(step.run)}" for step in plan.steps]
    parts = [
        "What these sweeps identify",
        paragraphs(wording.identified(plan.identified)),
        textwrap.fill(wording.headline(plan), WIDTH),
        table(head, rows) if rows else "",
        paragraphs(reasons),
        "Each alone:" if alone else "",
        table(head, alone) if alone else "",
        wording.estimates(plan),
        textwrap.fill(wording.promise(plan), WIDTH),
    ]
    return blocks(parts)


def _cost(points: int) -> str:
    return str(points) if points else "-"
