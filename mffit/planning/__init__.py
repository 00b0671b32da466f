"""Identifiability of the coefficients by the sweeps of a project, and the most informative further runs."""

from mffit.planning.goals import Goal, read_goal
from mffit.planning.plan import Identified, NextRun, Plan, PlanStep, next_run, plan
