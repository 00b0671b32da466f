"""What the sweeps of a project identify, and which further runs would tell most."""

from mffit.planning.goals import GOALS, Goal, read_goal
from mffit.planning.record import Identified, Plan, Step, Tie, Trial
from mffit.planning.runs import Kind, Run, candidates
from mffit.planning.search import plan

__all__ = [
    "GOALS",
    "Goal",
    "Identified",
    "Kind",
    "Plan",
    "Run",
    "Step",
    "Tie",
    "Trial",
    "candidates",
    "plan",
    "read_goal",
]
