"""Members of the posterior: tyres that these data would have given with another draw of their noise."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np

from mffit.fit import constants
from mffit.fit.constraints import violations
from mffit.fit.fitted import Fitted
from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, solve
from mffit.rig_errors import error_of


def ensemble(fitted: Fitted, count: int, *, seed: int = 0) -> list[dict[str, float]]:
    """Coefficients of ``count`` tyres drawn from the posterior, each within the physical limits of the fit.

    Each measurement is moved by its own uncertainty, each prior and each held value by its spread, and the fit is repeated from
    its solution. This is exact for a linear problem, and every member keeps the limits.

    Parameters
    ----------
    fitted : the result of the fit
    count : number of members
    seed : of the random numbers; the same seed gives the same members
    """
    random = np.random.default_rng(seed)
    envelope = fitted.problem.envelope
    allowed = constants.DRAWN_LIMIT_MARGINS * constants.LIMIT_MARGIN
    members: list[dict[str, float]] = []
    for _ in range(constants.DRAWS_PER_MEMBER * count):
        if len(members) == count:
            break
        member = _drawn(fitted, random)
        p = SimpleNamespace(**{**fitted.simulation.values, **member})
        if envelope is None or np.max(violations(p, envelope)) <= allowed:
            members.append(member)
    return members


def _drawn(fitted: Fitted, random: np.random.Generator) -> dict[str, float]:
    """Coefficients of one tyre."""
    values = fitted.simulation.values
    held = {
        name: float(np.clip(values[name] + u * random.standard_normal(), *fitted.hand.bounds(name)))
        for name, u in fitted.held.items()
    }
    rig = {n: fitted.problem.value(n) + u * random.standard_normal() for n, u in fitted.held_rig.items()}
    starts = fitted.problem.starting_here(fitted.numbers)
    numbers = [_with_drawn_prior(number, random) for number in starts]
    free = fitted.problem.with_values({**held, **rig}).free([n.name for n in numbers])
    rows = len(free.residual(np.array([n.start for n in numbers]))[0])
    noise = random.standard_normal(rows)

    def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        data, limits = free.residual(x)
        return data - noise, limits

    def linear(x: np.ndarray) -> Linear:
        here = free.linear(x)
        return dataclasses.replace(here, data=here.data - noise)

    solution = solve(
        LeastSquaresProblem(residual, linear),
        numbers,
        max_steps=constants.REFIT_STEPS,
        tolerance=constants.REFIT_TOLERANCE,
    )
    return held | {name: v for name, v in solution.values.items() if error_of(name) is None}


def _with_drawn_prior(number: FreeNumber, random: np.random.Generator) -> FreeNumber:
    """The number with the centre of its prior moved by the prior's spread."""
    shift = random.standard_normal()
    if not np.isfinite(number.spread):
        return number
    return dataclasses.replace(number, expected=number.expected + number.spread * shift)
