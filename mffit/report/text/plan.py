"""A plan, for the terminal."""

from __future__ import annotations

from mffit.planning import Plan, wording
from mffit.report import constants
from mffit.report.text import filling


def plan_summary(plan: Plan) -> str:
    """The text that ``mffit plan`` prints: identified numbers, the list of runs, the effect of each run alone."""
    alone = [trial for trial in plan.trials[: constants.MOST_ROWS] if trial.after < plan.now]
    return filling.text("plan", plan=plan, say=wording, alone=alone)
