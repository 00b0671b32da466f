"""How the readings really scatter: scale, growth with the reading, memory along sweeps, heavy tails.

Every part is accepted only if the data ask for it. Effects, inexact coefficients and smooth structure are integrated out with
their priors, so that the scatter is what none of them explains.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import minimize

from mffit.diagnosis import constants
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
            named=_occurring(explained.named[rows]),
            smooth=_occurring(explained.smooth[rows]),
            weight=np.ones(len(rows)),
            least=0.5 * constants.NO_NOISE_SHARE * rms(size[rows]),
        )
        runs = {effect: _occurring(columns[rows]) for effect, columns in explained.runs.items()}
        scatter[name], weight[rows], here = _of_channel(channel, runs, noise.scatter[name])
        for effect, (odds, larger, _) in here.items():
            other = offsets.get(effect, RunOffsets(0.0, 0.0, frozenset()))
            offsets[effect] = RunOffsets(
                other.log_odds + odds, max(other.size, larger), other.channels | {name}
            )
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
            assumed[name] = constants.ASSUMED_NOISE_SHARE * rms(readings)
    return noise.assumed(assumed) if assumed else noise


def _occurring(columns: np.ndarray) -> np.ndarray:
    """The columns that are not zero throughout."""
    return columns[:, np.any(columns != 0.0, axis=0)]


def _of_channel(
    channel: MarginalChannel, runs: Mapping[str, np.ndarray], start: Scatter
) -> tuple[Scatter, np.ndarray, dict[str, RunOffsets]]:
    """The scatter, the weight of every reading (m,), and the offsets of runs by effect.

    There are no offsets if the readings show no memory: nothing else looks like them.
    """
    first = MarginalParts(math.log(start.scale), start.growth, start.memory, constants.SCATTER_START_SMOOTH)
    several = any(columns.shape[1] for columns in runs.values())
    channel, parts, tails = _weighted(channel, first, drift=several)
    offsets: dict[str, RunOffsets] = {}
    if parts.memory:
        # Offsets of whole runs and a memory give runs the same means: each is fitted beside the other.
        most, best = float(constants.RUN_OFFSET_LOG_ODDS), None
        alone = log_evidence(channel, parts)
        for effect, columns in runs.items():
            if columns.shape[1]:
                beside = channel.beside(columns)
                found = _with_offsets(beside, columns, parts)
                odds = log_evidence(beside, found) - alone
                offsets[effect] = RunOffsets(odds, found.offsets, frozenset())
                if odds > most:
                    most, best = odds, (beside, found)
        if best is not None:
            channel, parts, tails = _weighted(*best, drift=True)
    scatter = Scatter(
        math.exp(parts.log_scale), parts.growth, parts.memory, independent=parts.independent, tails=tails
    )
    return scatter, channel.weight, offsets


def _with_offsets(channel: MarginalChannel, runs: np.ndarray, parts: MarginalParts) -> MarginalParts:
    """The likeliest parts with offsets of runs, which replace the memory or shorten it."""
    size = rms(channel.residual @ runs / np.maximum(np.sum(runs**2, axis=0), 1e-30))
    shorter = parts._replace(memory=0.5 * parts.memory, offsets=0.5 * size)
    replaced = MarginalParts(*constants.SCATTER_SECOND_START)._replace(offsets=size)
    climbs = (_climb(channel, x, (*ALL, OFFSETS)) for x in (shorter, replaced))
    return max(climbs, key=lambda climb: climb[1])[0]


def _weighted(
    channel: MarginalChannel, parts: MarginalParts, *, drift: bool
) -> tuple[MarginalChannel, MarginalParts, float]:
    """The channel with its weights, and the parts and degrees of freedom that were found in turn with them.

    ``drift``: whether errors without memory beside those with one are considered, which tells drifts from offsets of runs.
    """
    tails = math.inf
    for again in range(constants.MOST_READING_WEIGHT_ROUNDS):
        parts = _accepted(channel, parts, drift=drift, near=again > 0)
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
    starts = (start,) if near else (start, second)
    best, whole = max((_climb(channel, x, every) for x in starts), key=lambda climb: climb[1])
    for part in (GROWTH, MEMORY):
        reduced = [0.0 if k == part else value for k, value in enumerate(best)]
        free = tuple(k for k in every if k != part and (k not in (GROWTH, MEMORY) or best[k]))
        other, less = _climb(channel, MarginalParts(*reduced), free)
        if whole - less < constants.SCATTER_PART_GAIN:
            best, whole = other, less
    if best.memory and drift:
        longer = float(constants.LONG_MEMORY)
        two = best._replace(memory=longer, independent=float(constants.SCATTER_START_INDEPENDENT))
        free = tuple(k for k in (*every, INDEPENDENT) if k != GROWTH or best.growth)
        other, more = _climb(channel, two, free)
        if more - whole > constants.SCATTER_PART_GAIN:
            best = other
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
