"""How the readings really scatter: scale, growth with the reading, memory along sweeps, heavy tails.

Every part is accepted only if the data ask for it. Effects, inexact coefficients and smooth structure are integrated out with
their priors, so that the scatter is what none of them explains.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from mffit.constants import ASSUMED_NOISE_SHARE
from mffit.diagnosis import constants
from mffit.diagnosis.chains import MemorySpan
from mffit.diagnosis.marginal import MarginalChannel, MarginalParts
from mffit.diagnosis.noise import Noise, RunOffsets, Scatter
from mffit.diagnosis.run_means import log_evidence
from mffit.diagnosis.tails import heavy_tails, weights
from mffit.scatter import rms

BOUNDS = np.array(
    [
        constants.LOG_SCALE_BOUNDS,
        (0.0, constants.LARGEST_NOISE_GROWTH),
        constants.MEMORY_BOUNDS,
        constants.SCATTER_SMOOTH_BOUNDS,
        constants.RUN_OFFSET_BOUNDS,
        constants.INDEPENDENT_BOUNDS,
    ]
)
ALL = (0, 1, 2, 3)
GROWTH, MEMORY, OFFSETS, INDEPENDENT = 1, 2, 4, 5
"""Positions in :class:`MarginalParts`."""


@dataclass(frozen=True, slots=True)
class ExplainingColumns:
    """What could explain a residual, one prior standard deviation of each as a column (c n, k)."""

    named: np.ndarray  #: effects, coefficients, bumps
    runs: Mapping[str, np.ndarray]  #: by id, effects that differ by run: rivals of errors correlated along it
    smooth: np.ndarray  #: low-order structure; its amplitude is found with the scatter
    withdrawn: bool = (
        False  #: whether none of the effects that differ by run is there, however likely beside the memory
    )


def learned(noise: Noise, residual: np.ndarray, explained: ExplainingColumns, size: np.ndarray) -> Noise:
    """The noise with the scatter that the residual shows.

    The search starts from ``noise``, which may grow in proportion to ``size`` (c n,).
    """
    weight, scatter = np.ones(len(residual)), dict(noise.scatter)
    offsets: dict[str, RunOffsets] = {}
    for name, rows in noise.by_channel(np.arange(len(residual))).items():
        rows = rows[np.isfinite(noise.stated[rows])]
        if not len(rows):
            continue
        channel = MarginalChannel(
            stated=noise.stated[rows],
            residual=np.nan_to_num(residual[rows]),
            size=np.abs(np.nan_to_num(size[rows])),
            chain=noise.chain[rows],
            turn=None if noise.turn is None else noise.turn[rows],
            named=_occurring(explained.named[rows]),
            smooth=_occurring(explained.smooth[rows]),
            weight=np.ones(len(rows)),
            least=0.5 * constants.NO_NOISE_SHARE * rms(size[rows]),
        )
        runs = {effect: _occurring(columns[rows]) for effect, columns in explained.runs.items()}
        courses = _courses(channel, {span: chain[rows] for span, chain in noise.longer.items()})
        needed = constants.RUN_OFFSET_LOG_ODDS + math.log(max(len(runs), 1))
        needed = math.inf if explained.withdrawn else needed
        scatter[name], weight[rows], here = _of_channel(courses, runs, noise.scatter[name], needed)
        for effect, (odds, needed, larger, _) in here.items():
            other = offsets.get(effect, here[effect])
            both = odds + other.log_odds if effect in offsets else odds
            offsets[effect] = RunOffsets(both, needed, max(other.size, larger), other.channels | {name})
    found = replace(noise.scattering(scatter, size, weight), offsets=offsets)
    return _at_least_of_a_rig(found, size)


def _at_least_of_a_rig(noise: Noise, size: np.ndarray) -> Noise:
    """The noise, with that of the best rigs in channels that hardly scatter, such as those of a simulation.

    Between two points of a sweep, errors with a memory change by their part without memory.
    """
    assumed = {}
    for name, readings in noise.by_channel(size).items():
        change = noise.typical(name) * math.sqrt(1.0 - noise.scatter[name].memory ** 2)
        if change < constants.NO_NOISE_SHARE * rms(readings):
            assumed[name] = ASSUMED_NOISE_SHARE * rms(readings)
    return noise.assumed(assumed) if assumed else noise


def _occurring(columns: np.ndarray) -> np.ndarray:
    """The columns that are not zero throughout."""
    return columns[:, np.any(columns != 0.0, axis=0)]


def _courses(channel: MarginalChannel, longer: Mapping[MemorySpan, np.ndarray]) -> list[MarginalChannel]:
    """The channel with a memory along each sweep, and along those longer chains (m,) that differ from shorter ones."""
    found = [channel]
    for span, course in longer.items():
        other = channel.along(span, course)
        if not any(other.chains.same_as(one.chains) for one in found):
            found.append(other)
    return found


def _of_channel(
    courses: Sequence[MarginalChannel], runs: Mapping[str, np.ndarray], start: Scatter, needed: float
) -> tuple[Scatter, np.ndarray, dict[str, RunOffsets]]:
    """The scatter, the weight of every reading (m,), and the offsets of runs by effect.

    ``courses`` are the channel with a memory along each of several chains; ``needed`` are log odds that offsets need. There are
    none if the readings show no memory: nothing else looks like them.
    """
    first = MarginalParts(
        math.log(start.scale), start.growth, start.memory, constants.SCATTER_START_SMOOTH
    )._replace(independent=start.independent if start.memory else 0.0)
    several = any(columns.shape[1] for columns in runs.values())
    # A memory shows most along the longest chains.
    known = [one for one in courses if start.memory and one.span is start.span]
    channel, parts, tails = _weighted((known or courses)[-1], first, drift=several)
    offsets: dict[str, RunOffsets] = {}
    if parts.memory:
        courses = _likeliest([one.weighing(channel.weight) for one in courses], parts)
        if courses[0].span is not channel.span:
            channel, parts, tails = _weighted(courses[0], parts, drift=several, near=True)
            courses = [one.weighing(channel.weight) for one in courses]
        # Offsets of whole runs and a memory give runs the same means: each is fitted beside the other.
        most, best = needed, None
        alone = log_evidence([one.condensed(parts.smooth) for one in courses], parts)
        for effect, columns in runs.items():
            if not columns.shape[1]:
                continue
            found = _with_offsets(channel.beside(columns), columns, parts)
            beside = [one.beside(columns) for one in courses]
            odds = log_evidence([one.condensed(found.smooth) for one in beside], found) - alone
            if odds > needed:  # the memory may have as much smooth structure beside it
                other = log_evidence([one.condensed(found.smooth) for one in courses], parts)
                odds -= max(other - alone, 0.0)
            offsets[effect] = RunOffsets(odds, needed, found.offsets, frozenset())
            if odds > most:
                most, best = odds, (beside, found)
        if best is not None:
            beside, parts = best
            channel, parts, tails = _weighted(_likeliest(beside, parts)[0], parts, drift=True)
    scatter = Scatter(
        math.exp(parts.log_scale),
        parts.growth,
        parts.memory,
        independent=parts.independent,
        span=channel.span,
        tails=tails,
    )
    return scatter, channel.weight, offsets


def _likeliest(courses: Sequence[MarginalChannel], parts: MarginalParts) -> list[MarginalChannel]:
    """Those along chains that are likely, the likeliest first."""
    if len(courses) == 1:
        return list(courses)
    free = [k for k in ALL if k != GROWTH or parts.growth]
    free += [OFFSETS] * (courses[0].runs is not None) + [INDEPENDENT] * (parts.independent > 0.0)
    climbed = [(one, _climb(one, parts, tuple(free))[1]) for one in courses]
    climbed.sort(key=lambda row: -row[1])
    return [one for one, value in climbed if value > climbed[0][1] - constants.LIKELY_SPAN]


def _with_offsets(channel: MarginalChannel, runs: np.ndarray, parts: MarginalParts) -> MarginalParts:
    """The likeliest parts with offsets of runs, which replace the memory or shorten it."""
    size = rms(channel.residual @ runs / np.maximum(np.sum(runs**2, axis=0), 1e-30))
    shorter = parts._replace(memory=0.5 * parts.memory, offsets=0.5 * size)
    replaced = MarginalParts(*constants.SCATTER_SECOND_START)._replace(offsets=size)
    climbs = (_climb(channel, x, (*ALL, OFFSETS)) for x in (shorter, replaced))
    return max(climbs, key=lambda climb: climb[1])[0]


def _weighted(
    channel: MarginalChannel, parts: MarginalParts, *, drift: bool, near: bool = False
) -> tuple[MarginalChannel, MarginalParts, float]:
    """The channel with its weights, and the parts and degrees of freedom that were found in turn with them.

    ``drift``: whether errors without memory beside those with one are considered, which tells drifts from offsets of runs.
    ``near``: no other maximum than that near the start is sought.
    """
    tails = math.inf
    for again in range(constants.MOST_READING_WEIGHT_ROUNDS):
        parts = _accepted(channel, parts, drift=drift, near=near or again > 0)
        z = channel.standardised(parts)
        before, (tails, width) = tails, heavy_tails(z)
        weight = weights(z, tails, width)
        change = np.max(np.abs(np.sqrt(weight) - np.sqrt(channel.weight)))
        channel = replace(channel, weight=weight)
        if change < constants.READING_WEIGHT_SETTLED or (math.isinf(tails) and math.isinf(before)):
            break
    return channel, parts, tails


def _accepted(
    channel: MarginalChannel, start: MarginalParts, *, drift: bool, near: bool = False
) -> MarginalParts:
    """The likeliest parts, without growth or memory if the data do not ask for them.

    ``near``: the start is the solution for slightly different weights, so that no other maximum is sought.
    """
    second = MarginalParts(*constants.SCATTER_SECOND_START)._replace(offsets=start.offsets)
    every = (*ALL, OFFSETS) if channel.runs is not None else ALL
    every = (*every, INDEPENDENT) if start.independent else every
    starts = (start,) if near else (start, second)
    best, whole = max((_climb(channel, x, every) for x in starts), key=lambda climb: climb[1])
    if drift and not (near and best.independent):
        # A single memory may be a compromise between both parts that is no better than none.
        longer = float(constants.LONG_MEMORY)
        two = best._replace(memory=longer, independent=float(constants.SCATTER_START_INDEPENDENT))
        free = tuple(dict.fromkeys((*every, INDEPENDENT)))
        other, more = _climb(channel, two, free)
        if more - whole > (0.0 if best.independent else constants.SCATTER_PART_GAIN):
            best, whole, every = other, more, free
    # Beside offsets of runs a memory stays that was found without them: drifts within the runs are no structure of the model.
    for part in (GROWTH, MEMORY) if channel.runs is None else (GROWTH,):
        lost = (MEMORY, INDEPENDENT) if part == MEMORY else (part,)
        reduced = [0.0 if k in lost else value for k, value in enumerate(best)]
        free = tuple(k for k in every if k not in lost and (k not in (GROWTH, MEMORY) or best[k]))
        other, less = _climb(channel, MarginalParts(*reduced), free)
        if whole - less < constants.SCATTER_PART_GAIN:
            best, whole = other, less
    return best


def _climb(
    channel: MarginalChannel, start: MarginalParts, free: tuple[int, ...]
) -> tuple[MarginalParts, float]:
    """The maximum of the likelihood over the free parts, and its value."""
    chosen, unit = list(free), np.array(constants.SCATTER_STEPS)

    def full(y: np.ndarray) -> MarginalParts:
        x = np.array(start)
        x[chosen] = y * unit[chosen]
        if MEMORY in free:
            x[MEMORY] = math.tanh(x[MEMORY])
        return MarginalParts(*x.tolist())

    first, bounds = np.array(start), BOUNDS.copy()
    if GROWTH in free and not start.growth:
        first[GROWTH] = constants.SCATTER_START_GROWTH
    first[MEMORY], bounds[MEMORY] = np.arctanh(first[MEMORY]), np.arctanh(bounds[MEMORY])

    def falling(y: np.ndarray) -> tuple[float, np.ndarray]:
        parts = full(y)
        value, by = channel.likelihood_and_slopes(parts)
        slopes = np.array(by._replace(memory=by.memory * (1.0 - parts.memory**2)))
        return -value, -slopes[chosen] * unit[chosen]

    found = minimize(
        falling,
        first[chosen] / unit[chosen],
        jac=True,
        bounds=bounds[chosen] / unit[chosen][:, None],
        method="L-BFGS-B",
        options={"maxiter": int(constants.MOST_SCATTER_STEPS), "ftol": 1e-6},
    )
    return full(found.x), -float(found.fun)
