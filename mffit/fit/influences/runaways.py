"""Coefficients that the points push to the end of their plausible range although nothing is predicted better there.

Three degrees of camber do not show what the square of camber does. Where the formula misses the points by more than their
noise, such a coefficient takes up some of the misfit and ends at its bound.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.constants import FEWEST_SWEEPS_TO_PREDICT, LEAST_PREDICTED_SHARE
from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.influences.nuisance_choice import NearSolution, predicted_left_out, solved
from mffit.fit.plan import FitPlan
from mffit.fit.polish import polish
from mffit.least_squares import touches
from mffit.left_out import Predicted
from mffit.suspicion import parts_of_sweeps


def with_runaways_put_back(fitted: Fitted, plan: FitPlan) -> tuple[Fitted, FitPlan]:
    """The fit and its plan with coefficients held at their expected values that end at a bound of the table for nothing.

    One after the other is put back if left-out sweeps are then predicted as well as before. Bounds that somebody set stay.
    """
    group = parts_of_sweeps(fitted.problem.points)
    names = _pushed(fitted, plan)
    if not names or len(np.unique(group)) < FEWEST_SWEEPS_TO_PREDICT:
        return fitted, plan
    found = _needless(fitted, plan, names, group)
    if not found:
        return fitted, plan
    plan = plan.without(found, _said(found))
    here = fitted.problem.with_values({name: plan.expected[name] for name in found})
    return replace(polish(here, plan), stages=fitted.stages, attempts=fitted.attempts), plan


def _pushed(fitted: Fitted, plan: FitPlan) -> list[str]:
    """Coefficients at a bound of the table, the one first whose return costs least."""
    own = set(plan.free) - plan.hand.bounded.keys()
    cost = {
        n.name: abs(fitted.values[n.name] - n.expected) / fitted.stderr[n.name]
        for n in fitted.numbers
        if n.name in own and touches(fitted.values[n.name], n.lower, n.upper)
    }
    return sorted(cost, key=lambda name: cost[name])


def _needless(fitted: Fitted, plan: FitPlan, names: Sequence[str], group: np.ndarray) -> list[str]:
    """Those of the names without which left-out sweeps are predicted as well; found with some of the points."""
    stride = max(1, len(group) // constants.POINTS_OF_A_STAGE)
    part, group = fitted.problem.thinned(stride), group[::stride]

    def predicted(back: Sequence[str]) -> tuple[NearSolution, Predicted]:
        """The fit with some of the names at their expected values and the others at their bounds."""
        free = [number for number in fitted.numbers if number.name not in names]
        problem = part.with_values({name: plan.expected[name] for name in back})
        near = solved(NearSolution(problem, free, ()), most=constants.STEPS_BACK_FROM_A_BOUND)
        inner = [number for number in free if number.name not in fitted.at_bound]
        return near, predicted_left_out(near._replace(numbers=inner), (), group).by_sweep

    near, first = predicted(())
    part = near.problem
    found: list[str] = []
    for name in names:
        near, there = predicted([*found, name])
        if there.total < (1.0 + LEAST_PREDICTED_SHARE) * first.total and not first.raised(there):
            found, part = [*found, name], near.problem
    return found


def _said(names: Sequence[str]) -> str:
    them, value = ("them", "their expected values") if len(names) > 1 else ("it", "its expected value")
    return (
        f"these sweeps do not determine {', '.join(names)}: the misfit pushes {them} to the end of the plausible range, and "
        f"left-out sweeps are predicted as well with {value}"
    )
