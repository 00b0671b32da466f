"""Intervals where the curvature at the best fit misleads: the valley of equally good fits is followed instead."""

from __future__ import annotations

import dataclasses
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.fit.posterior import COVERING
from mffit.fit.problem import Problem
from mffit.least_squares import Number, Solution, solve

PROBE = 2.0
"""Standard errors away from the best fit at which the sum of squares is compared with its quadratic form."""
BENT = 3.0
"""Ratio of the two from which on the valley counts as bent."""
ENOUGH = 300
"""Points that show whether a valley is bent."""
DIRECTIONS = 8
"""The least determined directions, along which valleys are looked for."""
MOST_STEPS = 7
"""Steps along the valley to either side."""
STRIDE = 1.7
"""Growth of the steps."""


@dataclass(frozen=True, slots=True)
class Valley:
    """Equally good fits along one coefficient, as far as 95 % reach."""

    along: str  #: the coefficient that was moved
    intervals: Mapping[str, tuple[float, float]]  #: 95 % intervals of all that move with it
    better: Mapping[
        str, float
    ]  #: a fit met on the way that is better than the best one; empty if there is none


def follow(
    problem: Problem, numbers: Sequence[Number], solution: Solution, among: Collection[str]
) -> Valley | None:
    """Follow the most bent valley to both sides until the sum of squares has risen by 3.84.

    Parameters
    ----------
    problem : at the solution
    numbers : that were free
    solution : the best fit
    among : the numbers that the data decide; of the others the prior's spread is interval enough

    Returns
    -------
    Valley, or None where the quadratic form is a fair picture of the sum of squares everywhere
    """
    along = _most_bent(problem, numbers, solution, among)
    if not along:
        return None
    best = np.array(list(solution.values.values()))
    errors = np.sqrt(np.diag(solution.covariance))
    ends, better, least = [best - COVERING * errors, best + COVERING * errors], {}, solution.cost
    for side in (-1.0, 1.0):
        for place, rise in _walk(problem, numbers, solution, along, side):
            if solution.cost + rise < least:
                better, least = dict(zip(solution.names, place.tolist(), strict=True)), solution.cost + rise
            # What is left of the allowed rise is the width across the valley.
            across = errors * np.sqrt(np.maximum(COVERING**2 - max(rise, 0.0), 0.0))
            across[solution.names.index(along)] = 0.0
            ends = [np.minimum(ends[0], place - across), np.maximum(ends[1], place + across)]
    moved = (best - ends[0] > 1.01 * COVERING * errors) | (ends[1] - best > 1.01 * COVERING * errors)
    lower, upper = (np.array([getattr(n, end) for n in numbers]) for end in ("lower", "upper"))
    intervals = {
        name: (float(max(ends[0][i], lower[i])), float(min(ends[1][i], upper[i])))
        for i, name in enumerate(solution.names)
        if moved[i]
    }
    return Valley(along, intervals, better if least < 0.999 * solution.cost else {})


def _most_bent(
    problem: Problem, numbers: Sequence[Number], solution: Solution, among: Collection[str]
) -> str:
    """The number that moves most along the direction in which the sum of squares is least like its quadratic form.

    Looked at are the directions that the data determine least; empty if it is a fair picture along all of them.
    """
    best = np.array(list(solution.values.values()))
    held = solution.at_bound | solution.at_limit
    rows = [i for i, n in enumerate(numbers) if n.name in among and n.name not in held]
    if not rows:
        return ""
    step = max(len(problem.points) // ENOUGH, 1)
    part = problem.select(np.arange(0, len(problem.points), step))
    at = part.free(solution.names)
    here = at.linear(best)
    worst, name = BENT, ""
    for direction in _least_determined(solution.covariance, rows, [numbers[i].spread for i in rows]):
        for side in (-PROBE, PROBE):
            trial = best + side * direction
            if any(not n.lower <= v <= n.upper for n, v in zip(numbers, trial, strict=True)):
                continue
            data, limits = at.residual(trial)
            expected = here.data + here.slope @ (trial - best)
            bent = data @ data + limits @ limits - here.limits @ here.limits - expected @ expected
            ratio = 1.0 + bent * step / PROBE**2
            if ratio > worst:
                own = np.abs(direction) / np.sqrt(np.diag(solution.covariance))
                worst, name = ratio, numbers[max(rows, key=lambda i: own[i])].name
    return name


def _least_determined(covariance: np.ndarray, rows: list[int], spread: list[float]) -> list[np.ndarray]:
    """Directions (k,) of one standard error in the named rows, the widest first, everything else following."""
    scale = np.where(np.isfinite(spread), spread, 1.0)
    own = covariance[np.ix_(rows, rows)]
    size, axes = np.linalg.eigh(own / np.outer(scale, scale))
    follow_up = covariance[:, rows] @ np.linalg.inv(own)
    return [
        follow_up @ (scale * axes[:, j] * np.sqrt(max(size[j], 0.0))) for j in np.argsort(-size)[:DIRECTIONS]
    ]


def _known(number: Number, value: float) -> float:
    """What a number's prior adds to the sum of squares; nothing where nothing is known."""
    return ((value - number.expected) / number.spread) ** 2


def _walk(
    problem: Problem, numbers: Sequence[Number], solution: Solution, along: str, side: float
) -> Iterator[tuple[np.ndarray, float]]:
    """Fits with one number moved further and further, everything else refitted; with the rise of the sum of squares."""
    i = solution.names.index(along)
    lower, upper = numbers[i].lower, numbers[i].upper
    allowed = COVERING**2
    before, risen = np.array(list(solution.values.values())), 0.0
    length = side * COVERING * float(np.sqrt(solution.covariance[i, i]))
    for _ in range(MOST_STEPS):
        value = float(np.clip(before[i] + length, lower, upper))
        if value == before[i]:
            return
        place, cost = _refitted(problem, numbers, before, i, value)
        rise = cost - solution.cost
        if rise > allowed:  # the end lies in between, where the sum of squares is taken as quadratic
            near, far = np.sqrt(max(risen, 0.0)), np.sqrt(rise)
            yield before + (np.sqrt(allowed) - near) / (far - near) * (place - before), allowed
            return
        yield place, rise
        before, risen, length = place, rise, STRIDE * length


def _refitted(
    problem: Problem, numbers: Sequence[Number], start: np.ndarray, i: int, value: float
) -> tuple[np.ndarray, float]:
    """The best fit with one number held at a value, and its sum of squares."""
    begun = [dataclasses.replace(n, start=x) for n, x in zip(numbers, start.tolist(), strict=True)]
    others = begun[:i] + begun[i + 1 :]
    held = problem.with_values({numbers[i].name: value})
    found = solve(held.free([n.name for n in others]), others, max_steps=12, tolerance=1e-4)
    place = np.insert(np.array(list(found.values.values())), i, value)
    return place, found.cost + _known(numbers[i], value)
