"""Coefficients that the points push out of their usual range although nothing is predicted better there.

Three degrees of camber do not show what the square of camber does. Where the formula misses the points by more than their
noise, such a coefficient takes up some of the misfit and becomes large.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence

import numpy as np

from mffit.constants import FEWEST_SWEEPS_TO_PREDICT
from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.fit.influences.nuisance_choice import NearSolution, NuisanceChoice, solved
from mffit.fit.plan import FitPlan
from mffit.least_squares import touches
from mffit.suspicion import parts_of_sweeps
from tir.parameters import BY_NAME


def without_runaways(fitted: Fitted, plan: FitPlan, choice: NuisanceChoice) -> FitPlan:
    """The plan with coefficients held at their expected values that leave their usual range for nothing.

    One after the other is held if left-out sweeps are then predicted as well as before, both without and with the influences that
    are modelled: each of the two fits gives a file. Bounds that somebody set stay.
    """
    group = parts_of_sweeps(fitted.problem.points)
    names = _pushed(fitted, plan)
    if not names or len(np.unique(group)) < FEWEST_SWEEPS_TO_PREDICT:
        return plan
    names = _needless(NearSolution(fitted.problem, fitted.numbers, ()), plan, names, fitted.at_bound, group)
    if choice.near.chosen:
        own = {number.name for number in fitted.numbers}
        added = [number for number in choice.near.numbers if number.name not in own]
        near = choice.near._replace(numbers=[*fitted.numbers, *added])
        names = _needless(near, plan, names, fitted.at_bound, group)
    return plan.without(names, _said(names)) if names else plan


def _pushed(fitted: Fitted, plan: FitPlan) -> list[str]:
    """Coefficients at or beyond the end of their usual range, the one first whose return costs least."""
    own = set(plan.free) - plan.hand.bounded.keys()
    cost = {
        n.name: abs(fitted.values[n.name] - n.expected) / fitted.stderr[n.name]
        for n in fitted.numbers
        if n.name in own and _beyond(n.name, fitted.values[n.name])
    }
    return sorted(cost, key=lambda name: cost[name])


def _beyond(name: str, value: float) -> bool:
    return BY_NAME[name].rare(value) or touches(value, *BY_NAME[name].usual)


def _needless(
    model: NearSolution, plan: FitPlan, names: Sequence[str], held: Collection[str], group: np.ndarray
) -> list[str]:
    """Those of the names without which left-out sweeps are predicted as well; found with some of the points.

    In ``model`` the names are where the points push them; numbers in ``held``, at a bound or limit, stay there.
    """
    if not names:
        return []
    model = model._replace(numbers=[number for number in model.numbers if number.name not in names])
    stride = max(1, len(group) // constants.POINTS_OF_A_STAGE)
    group = group[::stride]

    def predicted(there: NearSolution) -> float:
        inner = [number for number in there.numbers if number.name not in held]
        return float(np.sum(there._replace(numbers=inner).left_out(group).density))

    model = solved(model._replace(problem=model.problem.thinned(stride)))
    first = predicted(model)
    found: list[str] = []
    for name in names:
        back = solved(model._replace(problem=model.problem.with_values({name: plan.expected[name]})))
        if predicted(back) >= first:
            found, model = [*found, name], back
    return found


def _said(names: Sequence[str]) -> str:
    them, value = ("them", "their expected values") if len(names) > 1 else ("it", "its expected value")
    return (
        f"these sweeps do not determine {', '.join(names)}: the misfit pushes {them} out of the usual range, and "
        f"left-out sweeps are predicted as well with {value}"
    )
