"""Other ends of a search: values of a few coefficients that fit about as well, beyond a rise of the sum of squares.

A curve with the same slope at zero and the same value at the largest slip can have little curvature and a small shape factor, or
much of both. Three loads give two pairs of PKX2 and PKX3. No interval around one end contains the other, so a search
that starts at the other end shows whether it is as good.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import constants
from mffit.fit.driven_start import curvature_through
from mffit.fit.problem import FitProblem
from mffit.fit.profile import ALLOWED_RISE, wider
from mffit.least_squares import FreeNumber, Solution, solve
from mffit.points import Points, levels


class OtherEnds(NamedTuple):
    """What searches from the other ends found."""

    intervals: Mapping[str, tuple[float, float]]  #: 95 % intervals that contain every end that is as good
    better: Mapping[str, float]  #: the numbers of a better end; empty if there is none


def other_ends(problem: FitProblem, numbers: Sequence[FreeNumber], solution: Solution) -> OtherEnds:
    """The ends beside ``solution``, at which ``problem`` is; no intervals where none is as good."""
    best, errors = _place(solution)
    low, high = best - COVERAGE_FACTOR_95 * errors, best + COVERAGE_FACTOR_95 * errors
    better, least, found = {}, solution.cost, False
    names = solution.names
    for start in _starts(solution.values, problem):
        begin = [replace(n, start=start.get(n.name, n.start)) for n in numbers]
        if any(not n.lower < n.start < n.upper for n in begin if n.name in start):
            continue
        end = _searched(problem, begin, solution.cost)
        if end is None:
            continue
        place, own = _place(end)
        rise = end.cost - solution.cost
        apart = np.abs(place - best) > COVERAGE_FACTOR_95 * errors
        if rise > ALLOWED_RISE or not apart[[names.index(name) for name in start]].any():
            continue
        found = True
        reach = own * math.sqrt(ALLOWED_RISE - max(rise, 0.0))
        low, high = np.minimum(low, place - reach), np.maximum(high, place + reach)
        if end.cost < least:
            better, least = dict(end.values), end.cost
    if not found:
        return OtherEnds({}, {})
    intervals = wider(numbers, best, errors, low, high)
    return OtherEnds(intervals, better if least < solution.cost - constants.CLEARLY_BETTER_END else {})


def _searched(problem: FitProblem, begin: Sequence[FreeNumber], cost: float) -> Solution | None:
    """The end of a search; None if some of many points show already that it is far worse than ``cost``."""
    names = [n.name for n in begin]
    stride = max(1, len(problem.points) // constants.POINTS_OF_A_STAGE)
    tolerance = constants.REFIT_TOLERANCE
    if stride > 1:
        near = solve(
            problem.thinned(stride).free(names), begin, max_steps=constants.REFIT_STEPS, tolerance=tolerance
        )
        begin = [replace(n, start=near.values[n.name]) for n in begin]
        if solve(problem.free(names), begin, max_steps=1).cost > constants.HOPELESS_END * cost:
            return None
    return solve(problem.free(names), begin, max_steps=constants.REFIT_STEPS_UNDER_SLIP, tolerance=tolerance)


def _place(end: Solution) -> tuple[np.ndarray, np.ndarray]:
    """Numbers (k,) and their standard errors (k,)."""
    return np.array(list(end.values.values())), np.sqrt(np.diag(end.covariance))


def _starts(free: Mapping[str, float], problem: FitProblem) -> Iterator[dict[str, float]]:
    """Coefficients, all among the free ones, near the other end of each group that has one."""
    points, values = problem.points, {**problem.simulation.values, **free}
    kappa, alpha = (float(np.max(np.abs(x))) for x in (points.kappa, points.alpha))
    for C, B, E, slip in (("RCX1", "RBX1", "REX1", alpha), ("RCY1", "RBY1", "REY1", kappa)):
        if {C, B, E} <= free.keys():
            curve = _other_curve(free[C], free[B] * free[C], free[E], slip)
            if curve:
                yield {C: curve[0], B: free[B] * free[C] / curve[0], E: curve[1]}
    if {"PCX1", "PEX1"} <= free.keys():
        curve = _other_curve(free["PCX1"], values["PKX1"] / values["PDX1"], free["PEX1"], kappa)
        if curve:
            yield {"PCX1": curve[0], "PEX1": curve[1]}
    if {"PKX1", "PKX2", "PKX3"} <= free.keys():
        yield from _other_exponents(free, points, float(values["FNOMIN"] * values["LFZO"]))


def _other_curve(C: float, slope: float, E: float, slip: float) -> tuple[float, float] | None:
    """Shape and curvature factor of the other curve with this slope BC and the same value at a slip; None without one."""
    angle = C * math.atan(_bent(slope / C * slip, E))
    little, much = constants.OTHER_CURVATURES
    other = little if E > constants.CURVATURE_BETWEEN_ENDS else much
    low, high = constants.SHAPES_OF_OTHER_ENDS
    before = math.nan
    for shape in np.linspace(
        max(low, angle / (0.49 * math.pi)), high, constants.STEPS_TO_OTHER_ENDS
    ).tolist():
        missed = curvature_through(shape, slope / shape, slip, angle) - other
        if missed * before <= 0.0:
            return shape, other
        before = missed
    return None


def _bent(x: float, E: float) -> float:
    """B x - E (B x - arctan(B x)) of the Magic Formula, for x = B x."""
    return x - E * (x - math.atan(x))


def _other_exponents(free: Mapping[str, float], points: Points, nominal: float) -> Iterator[dict[str, float]]:
    """PKX1-3 with nearly the same slip stiffness at the loads that were run, and another exponent."""
    loads = levels.level_values(points.Fz[~points.free_rolling], levels.LOAD)
    dfz = np.unique(loads[np.isfinite(loads)]) / nominal - 1.0
    here = (free["PKX1"] + free["PKX2"] * dfz) * np.exp(free["PKX3"] * dfz)
    low, high = constants.EXPONENTS_OF_OTHER_ENDS
    exponents = np.linspace(low, high, constants.STEPS_TO_OTHER_ENDS)
    line = np.column_stack([np.ones(len(dfz)), dfz])
    found, missed = [], []
    for exponent in exponents:
        growth = np.exp(exponent * dfz)
        a_b = np.linalg.lstsq(line * growth[:, None], here, rcond=None)[0]
        found.append(a_b)
        missed.append(float(np.sum((line @ a_b * growth / here - 1.0) ** 2)))
    lowest = [i for i in range(1, len(exponents) - 1) if missed[i] <= min(missed[i - 1], missed[i + 1])]
    for i in sorted(lowest, key=lambda i: missed[i])[:2]:
        if abs(exponents[i] - free["PKX3"]) > 0.1:
            yield {"PKX1": float(found[i][0]), "PKX2": float(found[i][1]), "PKX3": float(exponents[i])}
