"""Identifiability of the coefficients by the sweeps of a project, and the most informative further runs."""

from mffit.planning.additions import ADDITIONS, BY_ID, Addition, addition_named
from mffit.planning.goals import Goal, read_goal
from mffit.planning.plan import Identified, NextRun, Plan, PlanStep, next_run, plan
from mffit.planning.runs import PlannedRun, candidates

__all__ = [
    "ADDITIONS",
    "BY_ID",
    "Addition",
    "Goal",
    "Identified",
    "NextRun",
    "Plan",
    "PlanStep",
    "PlannedRun",
    "addition_named",
    "candidates",
    "next_run",
    "plan",
    "read_goal",
]
