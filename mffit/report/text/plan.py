"""A plan, for the terminal."""

from mffit.planning import Plan, wording
from mffit.report.text import filling


def plan_summary(plan: Plan) -> str:
    """The text that ``mffit plan`` prints: identified numbers, the list of runs, the effect of each run alone."""
    return filling.text("plan", plan=plan, say=wording)
