"""The fitted rig and tyre with PECP1 decided by the points."""

from __future__ import annotations

import dataclasses

from mffit.fit.staged import Fitted
from mffit.least_squares import Number, solve
from mffit.rig import Simulation
from tir.parameters import BY_NAME

NAME = "PECP1"


def with_free_epsilon(fitted: Fitted) -> Simulation:
    """The simulation refitted from its solution with PECP1 free.

    A model whose PECP1 is held a little off bends its other spin coefficients to meet the points, and what finite spin
    makes of its slopes with them.
    """
    at = {n.name: fitted.problem.simulation.number(n.name, fitted.problem.points) for n in fitted.numbers}
    if NAME in at:
        return fitted.simulation
    numbers = [dataclasses.replace(n, start=at[n.name]) for n in fitted.numbers]
    row = BY_NAME[NAME]
    held = float(fitted.simulation.values[NAME])
    numbers.append(Number(NAME, row.inside(held), *row.bounds, expected=held))
    solution = solve(fitted.problem.free([n.name for n in numbers]), numbers, tolerance=1e-5)
    return fitted.problem.with_values(solution.values).simulation
