"""Members of the posterior: tyres that these data would have given with another draw of their noise."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np

from mffit.fit import constants
from mffit.fit.constraints import violations
from mffit.fit.fitted import Fitted
from mffit.fit.problem import FitProblem
from mffit.least_squares import FreeNumber, solve
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
    members: list[dict[str, float]] = []
    for _ in range(constants.MOST_DRAWS * count):
        if len(members) == count:
            break
        member = _drawn(fitted, random)
        p = SimpleNamespace(**{**fitted.simulation.values, **member})
        if envelope is None or np.max(violations(p, envelope)) <= constants.LIMIT_MARGIN:
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
    drawn = _with_noise(fitted.problem.with_values({**held, **rig}), random)
    solution = solve(
        drawn.free([n.name for n in numbers]),
        numbers,
        max_steps=constants.REFIT_STEPS,
        tolerance=constants.REFIT_TOLERANCE,
    )
    return held | {name: v for name, v in solution.values.items() if error_of(name) is None}


def _with_noise(problem: FitProblem, random: np.random.Generator) -> FitProblem:
    """The problem with readings that another test of the same tyre might have given."""
    readings = {}
    for name, sigma in problem.sigma.items():
        noise = random.standard_normal(len(sigma))
        readings[name] = problem.points.channel(name) + np.where(np.isfinite(sigma), sigma * noise, 0.0)
    radii = tuple(row._replace(value=row.value + row.u * random.standard_normal()) for row in problem.radii)
    return dataclasses.replace(problem, points=problem.points.replace(**readings), radii=radii)


def _with_drawn_prior(number: FreeNumber, random: np.random.Generator) -> FreeNumber:
    """The number with the centre of its prior moved by the prior's spread."""
    shift = random.standard_normal()
    if not np.isfinite(number.spread):
        return number
    return dataclasses.replace(number, expected=number.expected + number.spread * shift)
