"""Identifiability of the coefficients by the sweeps of a project, and the most informative further runs."""

from mffit.planning.additions import ADDITIONS, BY_ID, Addition, addition_named
from mffit.planning.goals import Goal, read_goal
from mffit.planning.plan import Identified, Plan, PlanStep, plan
from mffit.planning.runs import PlannedRun, candidates

__all__ = [
    "ADDITIONS",
    "BY_ID",
    "Addition",
    "Goal",
    "Identified",
    "Plan",
    "PlanStep",
    "PlannedRun",
    "addition_named",
    "candidates",
    "plan",
    "read_goal",
]
