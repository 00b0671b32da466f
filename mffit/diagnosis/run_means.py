"""Probability of the readings with offsets of whole runs, and with errors whose memory shifts the means of runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from mffit.diagnosis import constants
from mffit.diagnosis.marginal import MarginalChannel, MarginalParts

LARGEST = math.log(1e4)
"""Bound of the coordinates: log odds, or the logarithm of a size."""


@dataclass(frozen=True, slots=True)
class MemoryModel:
    """A description of the errors along a run, with its prior probability."""

    memory: bool
    independent: bool  #: whether a part without memory is beside it
    probability: float


MODELS = tuple(
    MemoryModel(memory, independent, probability)
    for (memory, independent), probability in zip(
        ((False, False), (True, False), (True, True)), constants.MEMORY_MODEL_PROBABILITIES, strict=True
    )
)


def log_evidence(channels: Sequence[MarginalChannel], parts: MarginalParts) -> float:
    """Logarithm of the probability of the readings, with offsets of runs if the channel considers them, else without.

    ``channels`` are one channel with a memory along different chains, equally probable. They, the descriptions of the errors,
    and in each of these scale, memory, independent share and size of the offsets, are integrated over their priors. The search
    begins at ``parts``.
    """
    logs = []
    for model in MODELS:
        alike = channels if model.memory else channels[:1]
        share = math.log(model.probability / len(alike))
        logs += [share + _of_model(channel, parts, model) for channel in alike]
    return float(np.logaddexp.reduce(logs))


def _of_model(channel: MarginalChannel, parts: MarginalParts, model: MemoryModel) -> float:
    """Logarithm of the probability of the readings under one description (Laplace approximation)."""
    offsets = channel.runs is not None
    starts = [parts.memory] if model.memory else [0.0]
    if model.independent and not parts.independent:  # errors that drift within a run
        starts.append(float(constants.LONG_MEMORY))
    share = parts.independent or constants.SCATTER_START_INDEPENDENT

    def density(x: np.ndarray) -> float:
        return -channel.likelihood(_at(x, parts, model, offsets=offsets)) - _log_prior(x, model, offsets)

    def with_slopes(x: np.ndarray) -> tuple[float, np.ndarray]:
        at = _at(x, parts, model, offsets=offsets)
        value, by = channel.likelihood_and_slopes(at)
        slopes = [by.log_scale]
        slopes += [by.memory * at.memory * (1.0 - at.memory)] if model.memory else []
        slopes += [by.independent * at.independent * (1.0 - at.independent)] if model.independent else []
        slopes += [by.offsets * at.offsets] if offsets else []
        prior, of_prior = _log_prior(x, model, offsets), _prior_slopes(at, model, offsets)
        return -value - prior, -np.array(slopes) - of_prior

    found = []
    for memory in starts:
        x = [parts.log_scale]
        x += [_logit(memory)] if model.memory else []
        x += [_logit(share)] if model.independent else []
        x += [math.log(max(parts.offsets, constants.SMALLEST_RUN_OFFSETS))] if offsets else []
        bounds = [constants.LOG_SCALE_BOUNDS, *[(-LARGEST, LARGEST)] * (len(x) - 1)]
        options = {"maxiter": int(constants.MOST_SCATTER_STEPS), "ftol": 1e-5}
        best = minimize(with_slopes, np.array(x), jac=True, bounds=bounds, method="L-BFGS-B", options=options)
        found.append((float(best.fun), best.x))
    value, x = min(found, key=lambda row: row[0])
    return -value + _log_volume(density, x, value)


def _at(x: np.ndarray, parts: MarginalParts, model: MemoryModel, *, offsets: bool) -> MarginalParts:
    """The parts at coordinates: log scale, log odds of memory and of independent share, log size of the offsets."""
    left = x.tolist()
    scale = left.pop(0)
    memory = _share(left.pop(0)) if model.memory else 0.0
    independent = _share(left.pop(0)) if model.independent else 0.0
    size = math.exp(left.pop(0)) if offsets else 0.0
    return parts._replace(log_scale=scale, memory=memory, independent=independent, offsets=size)


def _log_prior(x: np.ndarray, model: MemoryModel, offsets: bool) -> float:
    """Log prior density of the coordinates, apart from that of the scale, which the likelihood contains.

    The memory has Jeffreys' prior, the arcsine law between 0 and 1, so that long memories are no surprise. The independent
    share is uniform. The size of offsets is half-Cauchy about the usual one.
    """
    log = 0.0
    for value in x[1 : 1 + model.memory + model.independent]:
        share = _share(float(value))
        log += math.log(share) + math.log1p(-share)
    if model.memory:
        memory = _share(float(x[1]))
        log += math.log(2.0 / math.pi) - 0.5 * math.log1p(-(memory**2))
    if offsets:
        size = math.exp(float(x[-1]))
        log += math.log(2.0 / math.pi) + math.log(size / (1.0 + size**2))
    return log


def _prior_slopes(at: MarginalParts, model: MemoryModel, offsets: bool) -> np.ndarray:
    """Slopes of the same by the coordinates."""
    out = [0.0]
    if model.memory:
        out.append(1.0 - 2.0 * at.memory + at.memory**2 / (1.0 + at.memory))
    if model.independent:
        out.append(1.0 - 2.0 * at.independent)
    if offsets:
        out.append((1.0 - at.offsets**2) / (1.0 + at.offsets**2))
    return np.array(out)


def _log_volume(density: Callable[[np.ndarray], float], x: np.ndarray, value: float) -> float:
    """Logarithm of the volume of a maximum, from second differences of its negative logarithm."""
    step, k = float(constants.EVIDENCE_STEP), len(x)
    unit = step * np.eye(k)
    up, down = (np.array([density(x + sign * unit[i]) for i in range(k)]) for sign in (1.0, -1.0))
    curvature = np.diag(up + down - 2.0 * value)
    for i in range(k):
        for j in range(i):
            both = density(x + unit[i] + unit[j]) + density(x - unit[i] - unit[j])
            curvature[i, j] = curvature[j, i] = 0.5 * (both - up[i] - up[j] - down[i] - down[j] + 2.0 * value)
    axes = np.maximum(np.linalg.eigvalsh(curvature / step**2), constants.LEAST_CURVATURE)
    return 0.5 * (k * math.log(2.0 * math.pi) - float(np.sum(np.log(axes))))


def _share(log_odds: float) -> float:
    return 1.0 / (1.0 + math.exp(-log_odds))


def _logit(share: float) -> float:
    inside = min(max(share, 0.02), 0.999)
    return math.log(inside / (1.0 - inside))
