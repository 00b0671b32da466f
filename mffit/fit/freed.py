"""The fitted tyre and rig with PECP1 decided by the points."""

from __future__ import annotations

from mffit.fit import constants
from mffit.fit.fitted import Fitted
from mffit.least_squares import Number, solve
from mffit.rig import Simulation
from tir.parameters import BY_NAME


def with_free_epsilon(fitted: Fitted) -> Simulation:
    """The simulation refitted from its solution with PECP1 free.

    If PECP1 is held at a value that is a little off, the other spin coefficients compensate for it, which distorts the effect of
    finite spin on the slopes of the model.
    """
    name, problem = "PECP1", fitted.problem
    if any(number.name == name for number in fitted.numbers):
        return fitted.simulation
    row, held = BY_NAME[name], float(fitted.simulation.values[name])
    free = Number(name, row.inside(held), *row.bounds, expected=held)
    numbers = [*problem.starting_here(fitted.numbers), free]
    solution = solve(
        problem.free([n.name for n in numbers]), numbers, tolerance=constants.FREE_EPSILON_TOLERANCE
    )
    return problem.with_values(solution.values).simulation
