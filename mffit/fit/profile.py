"""Profile intervals along a bent valley of equally good fits, where the curvature at the best fit misleads."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import constants
from mffit.fit.problem import FitProblem
from mffit.fit.start import SHAPES
from mffit.least_squares import FreeNumber, Solution, broken, inverse, minimum

ALLOWED_RISE = COVERAGE_FACTOR_95**2
"""Rise of the sum of squares up to which a fit belongs to the 95 % interval of one number."""

BENDING = ("PKX3",)
"""Numbers whose valley always bends: slip stiffness over load is a line times an exponential, and PKX2 makes up for PKX3."""


@dataclass(frozen=True, slots=True)
class Valley:
    """Equally good fits along one or two numbers, up to the ends of their 95 % intervals."""

    along: tuple[str, ...]  #: the numbers that were moved, one after the other
    intervals: Mapping[str, tuple[float, float]]  #: 95 % intervals of all numbers that move with it
    better: Mapping[str, float]  #: a fit on the way that is better than the best one; empty if there is none


def follow(
    problem: FitProblem, numbers: Sequence[FreeNumber], solution: Solution, among: Collection[str]
) -> Valley | None:
    """The most bent and the softest valley, and those of ``BENDING``, followed to both sides until the sum has risen by 3.84.

    ``problem`` is at the solution. ``among`` names the numbers that the points determine; the prior's spread suffices as
    interval of the others.
    None where the sum of squares is close to its quadratic form along all directions.
    """
    bent, soft = (find(problem, numbers, solution, among) for find in (_most_bent, _softest))
    exponents = [name for name in BENDING if _movable(numbers, solution, {name}.intersection(among))]
    moved = tuple(dict.fromkeys(name for name in (bent, soft, *exponents) if name))
    if not moved:
        return None
    best, errors = np.array(list(solution.values.values())), np.sqrt(np.diag(solution.covariance))
    low, high = best - COVERAGE_FACTOR_95 * errors, best + COVERAGE_FACTOR_95 * errors
    better, least = {}, solution.cost
    for along, side in itertools.product(moved, (-1.0, 1.0)):
        for place, rise in _walk(problem, numbers, solution, along, side):
            if solution.cost + rise < least:
                better, least = dict(zip(solution.names, place.tolist(), strict=True)), solution.cost + rise
            # The rest of the allowed rise is the width across the valley.
            across = errors * np.sqrt(np.maximum(ALLOWED_RISE - max(rise, 0.0), 0.0))
            across[solution.names.index(along)] = 0.0
            low, high = np.minimum(low, place - across), np.maximum(high, place + across)
    return Valley(
        along=moved,
        intervals=wider(numbers, best, errors, low, high),
        better=better if least < constants.BETTER_ON_PROFILE * solution.cost else {},
    )


def wider(
    numbers: Sequence[FreeNumber], best: np.ndarray, errors: np.ndarray, low: np.ndarray, high: np.ndarray
) -> dict[str, tuple[float, float]]:
    """The intervals (k,), within the bounds, that exceed those from the curvature around the best values (k,)."""
    usual = constants.WIDER_INTERVAL * COVERAGE_FACTOR_95 * errors
    wider = (best - low > usual) | (high - best > usual)
    return {
        n.name: (float(max(low[i], n.lower)), float(min(high[i], n.upper)))
        for i, n in enumerate(numbers)
        if wider[i]
    }


def _movable(numbers: Sequence[FreeNumber], solution: Solution, among: Collection[str]) -> list[int]:
    """Positions of the named numbers that no bound and no limit holds."""
    held = solution.at_bound | solution.at_limit
    return [i for i, n in enumerate(numbers) if n.name in among and n.name not in held]


def _most_bent(
    problem: FitProblem, numbers: Sequence[FreeNumber], solution: Solution, among: Collection[str]
) -> str:
    """The number that moves most along the direction in which the sum of squares differs most from its quadratic form.

    The least determined directions are probed; empty if the quadratic form is good along all of them.
    """
    best = np.array(list(solution.values.values()))
    rows = _movable(numbers, solution, among)
    if not rows:
        return ""
    stride = max(len(problem.points) // constants.PROBE_POINTS, 1)
    part = problem.select(np.arange(0, len(problem.points), stride)).free(solution.names)
    here = part.linear(best)
    probe = constants.PROBE_DISTANCE
    worst, name = float(constants.BENT_VALLEY_RATIO), ""
    for direction in _least_determined(solution.covariance, rows, [numbers[i].spread for i in rows]):
        for side in (-probe, probe):
            trial = best + side * direction
            if any(not n.lower <= v <= n.upper for n, v in zip(numbers, trial, strict=True)):
                continue
            data, limits = part.residual(trial)
            expected = here.data + here.slope @ (trial - best)
            excess = (
                data @ data - expected @ expected + np.sum(broken(limits) ** 2 - broken(here.limits) ** 2)
            )
            ratio = 1.0 + excess * stride / probe**2
            if ratio > worst:
                own = np.abs(direction) / np.sqrt(np.diag(solution.covariance))
                worst, name = ratio, numbers[max(rows, key=lambda i: own[i])].name
    return name


def _softest(
    problem: FitProblem, numbers: Sequence[FreeNumber], solution: Solution, among: Collection[str]
) -> str:
    """The shape whose standard error grows most within one standard error of the best fit; empty if none doubles."""
    best, covariance = np.array(list(solution.values.values())), solution.covariance
    rows = [i for i in _movable(numbers, solution, among) if numbers[i].name in SHAPES]
    if not rows:
        return ""
    thinned = problem.thinned(max(len(problem.points) // constants.PROBE_POINTS, 1))
    part = thinned.without_limits().free(solution.names)  # limits are not information

    def errors(place: np.ndarray) -> np.ndarray:
        slope = part.linear(place).slope
        return np.sqrt(np.diag(inverse(slope.T @ slope + np.diag(solution.prior))))

    usual = errors(best)
    worst, name = float(constants.SOFT_VALLEY_RATIO), ""
    for i in rows:
        step = covariance[:, i] / np.sqrt(covariance[i, i])
        ratio = max(errors(best + side * step)[i] / usual[i] for side in (-1.0, 1.0))
        if ratio > worst:
            worst, name = ratio, solution.names[i]
    return name


def _least_determined(covariance: np.ndarray, rows: list[int], spread: list[float]) -> list[np.ndarray]:
    """Directions (k,) of one standard error in the named rows, the widest first; the other numbers are refitted."""
    scale = np.where(np.isfinite(spread), spread, 1.0)
    own = covariance[np.ix_(rows, rows)]
    size, axes = np.linalg.eigh(own / np.outer(scale, scale))
    refitted = covariance[:, rows] @ np.linalg.inv(own)
    widest = np.argsort(-size)[: constants.PROBED_DIRECTIONS]
    return [refitted @ (scale * axes[:, j] * np.sqrt(max(size[j], 0.0))) for j in widest]


def _walk(
    problem: FitProblem, numbers: Sequence[FreeNumber], solution: Solution, along: str, side: float
) -> Iterator[tuple[np.ndarray, float]]:
    """Fits with one number moved further and further, all others refitted, and the rise of the sum of squares."""
    i = solution.names.index(along)
    before, risen = np.array(list(solution.values.values())), 0.0
    length = side * COVERAGE_FACTOR_95 * float(np.sqrt(solution.covariance[i, i]))
    for _ in range(constants.PROFILE_STEPS):
        value = float(np.clip(before[i] + length, numbers[i].lower, numbers[i].upper))
        if value == before[i]:
            return
        place, cost = _refitted(problem, numbers, before, i, value)
        rise = cost - solution.cost
        if rise > ALLOWED_RISE:  # the end lies in between, where the sum of squares is taken as quadratic
            near, far = np.sqrt(max(risen, 0.0)), np.sqrt(rise)
            yield before + (np.sqrt(ALLOWED_RISE) - near) / (far - near) * (place - before), ALLOWED_RISE
            return
        yield place, rise
        before, risen, length = place, rise, constants.PROFILE_STEP_GROWTH * length


def _refitted(
    problem: FitProblem, numbers: Sequence[FreeNumber], start: np.ndarray, i: int, value: float
) -> tuple[np.ndarray, float]:
    """The best fit with one number held at a value, and its sum of squares."""
    moving = [replace(n, start=x) for n, x in zip(numbers, start.tolist(), strict=True)]
    held = moving.pop(i)
    found = minimum(
        problem.with_values({held.name: value}).free([n.name for n in moving]),
        moving,
        max_steps=constants.REFIT_STEPS,
        tolerance=constants.REFIT_TOLERANCE,
    )
    place = np.insert(found.x, i, value)
    return place, found.cost + ((value - held.expected) / held.spread) ** 2
