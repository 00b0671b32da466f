"""Members of the posterior: tyres that these data would have given with another draw of their noise."""

from __future__ import annotations

import dataclasses
from types import SimpleNamespace

import numpy as np

from mffit import least_squares
from mffit.fit.constraints import MARGIN, violations
from mffit.fit.problem import Problem
from mffit.fit.staged import Fitted
from mffit.least_squares import Number
from mffit.rig_errors import BY_NAME as RIG_ERRORS
from tir.parameters import BY_NAME

SPARE = 3
"""Draws per member, at most, before one that breaks a physical limit ends the search."""


def ensemble(fitted: Fitted, count: int, *, seed: int = 0) -> list[dict[str, float]]:
    """Coefficients of ``count`` tyres drawn from the posterior, each within the physical limits of the fit.

    Every measurement is moved by its own uncertainty, every prior and every held value by its spread, and the fit is made
    anew from where it ended: exact for a linear problem, and the limits hold in every member.

    Parameters
    ----------
    fitted : the result of the fit
    count : number of members
    seed : of the random numbers; the same seed gives the same members
    """
    random = np.random.default_rng(seed)
    members: list[dict[str, float]] = []
    for _ in range(SPARE * count):
        if len(members) == count:
            break
        member = _member(fitted, random)
        values = {**fitted.simulation.values, **member}
        envelope = fitted.problem.envelope
        if envelope is None or np.max(violations(SimpleNamespace(**values), envelope)) <= 2.0 * MARGIN:
            members.append(member)
    return members


def _member(fitted: Fitted, random: np.random.Generator) -> dict[str, float]:
    at = {
        n: float(np.clip(fitted.simulation.values[n] + u * random.standard_normal(), *BY_NAME[n].bounds))
        for n, u in fitted.held.items()
    }
    problem = fitted.problem.with_values(at)
    numbers = [_moved(number, fitted.problem, random) for number in fitted.numbers]
    free = problem.free([n.name for n in numbers])
    rows = len(free.residual(np.array([n.start for n in numbers]))[0])
    noise = random.standard_normal(rows)

    def residual(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        data, limits = free.residual(x)
        return data - noise, limits

    def linear(x: np.ndarray) -> least_squares.Linear:
        here = free.linear(x)
        return dataclasses.replace(here, data=here.data - noise)

    solution = least_squares.solve(
        least_squares.Problem(residual, linear), numbers, max_steps=12, tolerance=1e-4
    )
    return at | {n: v for n, v in solution.values.items() if n not in RIG_ERRORS}


def _moved(number: Number, problem: Problem, random: np.random.Generator) -> Number:
    """The number from where the fit ended, with what is known of it moved by its spread."""
    start = problem.simulation.number(number.name, problem.points)
    shift = random.standard_normal()
    known = number.expected + number.spread * shift if np.isfinite(number.spread) else number.expected
    return dataclasses.replace(
        number, start=float(np.clip(start, number.lower, number.upper)), expected=known
    )
