"""Estimation of the real scatter of the readings: scale, growth with the reading, autocorrelation along sweeps, heavy tails.

Effects, inexact coefficients and smooth structure are integrated out with their priors, so the scatter is the part that none of
them explains. Models of the errors (descriptions) are compared by evidence, in which their parameters are integrated out too.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from mffit.constants import ASSUMED_NOISE_SHARE
from mffit.diagnosis import constants
from mffit.diagnosis.noise import MemorySpan, Noise, RunOffsets, Scatter
from mffit.diagnosis.tails import beyond_weights, heavy_tails, weights
from mffit.linearised.chained import Chained, Memory, chains_of
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

LARGEST = math.log(1e4)
"""Bound of the coordinates, which are log odds or logarithms of sizes."""


LARGEST_MEMORY = math.log(constants.LARGEST_MEMORY / (1.0 - constants.LARGEST_MEMORY))
"""Upper bound of the log odds of an autocorrelation."""


@dataclass(frozen=True, slots=True)
class ExplainingColumns(ReadOnlyArrays):
    """Columns (c n, k) that could explain a residual, one prior standard deviation each."""

    named: np.ndarray  #: effects and coefficients
    runs: Mapping[str, np.ndarray]  #: by id, effects that differ by run: rivals of autocorrelated errors
    smooth: np.ndarray  #: low-order structure, whose amplitude is estimated with the scatter
    withdrawn: bool = False  #: whether effects that differ by run are excluded, however likely they are


@dataclass(frozen=True, slots=True)
class Description:
    """A model of the errors of a channel: its parameters are a scale, an amplitude of smooth structure, and these."""

    span: MemorySpan | None = None  #: chains of the autocorrelation; None without autocorrelation
    independent: bool = False  #: whether there is also an independent part
    growth: bool = False  #: whether the noise grows with the reading
    offsets: bool = False  #: whether runs have offsets
    probability: float = 1.0  #: prior probability

    @property
    def shapes(self) -> tuple[Callable[[float], tuple[float, float]], ...]:
        """For every parameter after the scale, a function of its coordinate that returns the log prior and its derivative."""
        memory = [_arcsine] * (self.span is not None) + [_uniform] * self.independent
        return (*[_half_cauchy] * (1 + self.growth + self.offsets), *memory)


class ScatterNumbers(NamedTuple):
    """The parameters of a description."""

    log_scale: float
    smooth: float  #: amplitude of smooth structure over the usual one
    growth: float = 0.0  #: growth over the usual one
    offsets: float = 0.0  #: offsets of runs over the usual ones
    memory: Memory = Memory()


def _half_cauchy(x: float) -> tuple[float, float]:
    """Log prior and derivative of a size over its usual one, by its logarithm: half-Cauchy."""
    square = math.exp(2.0 * x)
    return math.log(2.0 / math.pi) + x - math.log1p(square), (1.0 - square) / (1.0 + square)


def _arcsine(x: float) -> tuple[float, float]:
    """Log prior and derivative of a correlation between 0 and 1, by its log odds: Jeffreys' prior, which allows values near 1."""
    share = _share(x)
    log = math.log(2.0 / math.pi) + math.log(share) + 0.5 * (math.log1p(-share) - math.log1p(share))
    return log, 1.0 - share - 0.5 * share - 0.5 * share * (1.0 - share) / (1.0 + share)


def _uniform(x: float) -> tuple[float, float]:
    """Log prior and derivative of a share, by its log odds: uniform."""
    share = _share(x)
    return math.log(share) + math.log1p(-share), 1.0 - 2.0 * share


def _share(log_odds: float) -> float:
    return 1.0 / (1.0 + math.exp(-log_odds))


@dataclass(frozen=True, slots=True, eq=False)
class Described(ReadOnlyArrays):
    """A description at its most probable parameters."""

    by: Description
    x: np.ndarray  #: coordinates of the parameters
    log_probability: float  #: log of prior probability times evidence


@dataclass(frozen=True, eq=False)
class ScatterOfChannel(ReadOnlyArrays):
    """The used readings (m,) of one channel, and the columns that could explain them."""

    stated: np.ndarray  #: stated standard uncertainty
    residual: np.ndarray  #: measured minus simulated
    size: np.ndarray  #: sizes of the readings, to which growing noise is proportional
    chains: Mapping[MemorySpan, Sequence[np.ndarray]]  #: chains along which errors may be autocorrelated
    sweep: np.ndarray
    named: np.ndarray  #: (m, k) changes by effects and coefficients, one prior standard deviation each
    smooth: np.ndarray  #: (m, k) changes by smooth structure at its usual amplitude
    least: float  #: standard uncertainty that is always added, for readings without noise
    weight: np.ndarray
    runs: np.ndarray  #: (m, k) offsets of runs at their usual size, if a description has them

    def numbers(self, x: np.ndarray, by: Description) -> ScatterNumbers:
        """The parameters from coordinates, which are logarithms of sizes and log odds of shares."""
        log_scale, *rest = x.tolist()
        left = iter(rest)
        smooth = math.exp(next(left))
        growth = math.exp(next(left)) if by.growth else 0.0
        offsets = math.exp(next(left)) if by.offsets else 0.0
        memory = _share(next(left)) if by.span else 0.0
        return ScatterNumbers(
            log_scale, smooth, growth, offsets, Memory(memory, _share(next(left)) if by.independent else 0.0)
        )

    def uncertainty(self, at: ScatterNumbers) -> np.ndarray:
        """Standard uncertainty (m,) of every reading."""
        return np.sqrt(self._squares(at).sum(axis=0) / self.weight)

    def _squares(self, at: ScatterNumbers) -> np.ndarray:
        """Components of the variances (3, m) at weight 1: scaled stated one, growing one, constant one."""
        stated = math.exp(at.log_scale) * self.stated
        growing = at.growth * constants.USUAL_GROWTH * self.size
        return np.array([stated**2, growing**2, np.full(len(stated), self.least**2)])

    def _sizes(self, at: ScatterNumbers) -> np.ndarray:
        counts = [self.named.shape[1], self.smooth.shape[1], self.runs.shape[1]]
        return np.repeat([1.0, at.smooth, at.offsets], counts)

    def _model(self, by: Description) -> Chained:
        """The linear model of a description."""
        columns = np.column_stack([self.named, self.smooth, self.runs])
        return Chained(self.residual, columns, self.chains[by.span or MemorySpan.SWEEP])

    def likeliest(self, by: Description, near: np.ndarray | None = None) -> Described:
        """A description at its most probable parameters, with evidence by Laplace approximation; ``near`` starts the search."""
        model, shapes = self._model(by), by.shapes
        wide = math.log(constants.STATED_NOISE_FACTOR)
        first, last = self.named.shape[1], self.named.shape[1] + self.smooth.shape[1]

        def falling(x: np.ndarray) -> tuple[float, np.ndarray]:
            at = self.numbers(x, by)
            squares = self._squares(at)
            total = squares.sum(axis=0)
            found = model.evidence(np.sqrt(total / self.weight), self._sizes(at), at.memory)
            slopes = [found.u @ (squares[0] / total) - x[0] / wide**2, np.sum(found.sizes[first:last])]
            slopes += [found.u @ (squares[1] / total)] if by.growth else []
            slopes += [np.sum(found.sizes[last:])] if by.offsets else []
            shares = [at.memory.correlation, at.memory.independent][: (by.span is not None) + by.independent]
            slopes += [found.memory[k] * s * (1.0 - s) for k, s in enumerate(shares)]
            priors = np.array([shape(value) for shape, value in zip(shapes, x[1:].tolist(), strict=True)])
            slope = np.array(slopes)
            slope[1:] += priors[:, 1]
            value = found.value - 0.5 * float(x[0]) ** 2 / wide**2 + float(np.sum(priors[:, 0]))
            return -value, -slope

        start, bounds = np.zeros(1 + len(shapes)), [(-LARGEST, LARGEST)] * (1 + len(shapes))
        if by.span is not None:
            start[2 + by.growth + by.offsets] = constants.USUAL_LOG_ODDS_OF_MEMORY
        if near is not None:
            start[: len(near)] = near
        if by.span is not None:
            bounds[2 + by.growth + by.offsets] = (-LARGEST, LARGEST_MEMORY)
        found = minimize(
            falling,
            start,
            jac=True,
            bounds=bounds,
            method="L-BFGS-B",
            options={"maxiter": int(constants.MOST_SCATTER_STEPS), "ftol": 1e-5},
        )
        slope, step = falling(found.x)[1], float(constants.EVIDENCE_STEP) * np.eye(len(found.x))
        curvature = np.array([falling(found.x + d)[1] - slope for d in step]) / constants.EVIDENCE_STEP
        curvature = 0.5 * (curvature + curvature.T)
        axes = np.maximum(np.linalg.eigvalsh(curvature), constants.LEAST_CURVATURE)
        volume = 0.5 * float(np.sum(np.log(2.0 * math.pi / axes)))
        return Described(by, found.x, volume - float(found.fun) + math.log(by.probability))

    def standardised(self, found: Described) -> np.ndarray:
        """Error (m,) of every reading's prediction from all others, over its standard uncertainty at weight 1."""
        at = self.numbers(found.x, found.by)
        seen = self._model(found.by).foretold(self.uncertainty(at), self._sizes(at), at.memory)
        return seen.error / np.sqrt(seen.variance + (self.weight - 1.0) * seen.own)

    def select(self, rows: np.ndarray) -> ScatterOfChannel:
        """The channel with some of its readings only."""
        place = np.full(len(self.stated), -1)
        place[rows] = np.arange(len(rows))
        chains = {
            span: [p[p >= 0] for p in (place[c] for c in found) if np.any(p >= 0)]
            for span, found in self.chains.items()
        }
        parts = {
            name: getattr(self, name)[rows]
            for name in ("stated", "residual", "size", "sweep", "named", "smooth", "weight", "runs")
        }
        return replace(self, chains=chains, **parts)

    @property
    def sample(self) -> ScatterOfChannel:
        """The channel thinned to every k-th sweep, if it has more readings than the estimation of scatter needs."""
        names = np.unique(self.sweep)
        most = max(len(names) // int(constants.FEWEST_SWEEPS_FOR_SCATTER), 1)
        stride = min(math.ceil(len(self.sweep) / constants.READINGS_FOR_SCATTER), most)
        rows = np.flatnonzero(np.isin(self.sweep, names[::stride]))
        return self if stride == 1 else self.select(rows)


def learned(noise: Noise, residual: np.ndarray, explained: ExplainingColumns, size: np.ndarray) -> Noise:
    """The noise with the scatter estimated from the residual (c n,); it may grow in proportion to ``size`` (c n,)."""
    u, weight, scatter = noise.u.copy(), np.ones(len(residual)), dict(noise.scatter)
    offsets: dict[str, RunOffsets] = {}
    for name, rows in noise.by_channel(np.arange(len(residual))).items():
        rows = rows[np.isfinite(noise.stated[rows])]
        if not len(rows):
            continue
        stated, turn = noise.stated[rows], None if noise.turn is None else noise.turn[rows]
        chains = {MemorySpan.SWEEP: chains_of(noise.chain[rows])}
        for span, chain in noise.longer.items():
            longer = chains_of(chain[rows], turn)
            if not any(_same(longer, known) for known in chains.values()):
                chains[span] = longer
        channel = ScatterOfChannel(
            stated=stated,
            residual=np.nan_to_num(residual[rows]),
            size=np.abs(np.nan_to_num(size[rows])),
            chains=chains,
            sweep=noise.chain[rows],
            named=_condensed(explained.named[rows], stated),
            smooth=_condensed(constants.USUAL_MISS_OF_A_FORMULA * explained.smooth[rows], stated),
            least=0.5 * constants.NO_NOISE_SHARE * rms(size[rows]),
            weight=np.ones(len(rows)),
            runs=np.zeros((len(rows), 0)),
        )
        runs = {effect: _condensed(columns[rows], stated) for effect, columns in explained.runs.items()}
        needed = constants.SURPRISING_LOG_ODDS + math.log(max(len(runs), 1))
        found, channel, tails, here = _of_channel(
            channel, runs, math.inf if explained.withdrawn else float(needed)
        )
        at = channel.numbers(found.x, found.by)
        u[rows], weight[rows] = channel.uncertainty(at), channel.weight
        scatter[name] = Scatter(
            scale=math.exp(at.log_scale),
            growth=float(constants.USUAL_GROWTH) * at.growth,
            memory=at.memory.correlation,
            independent=at.memory.independent,
            tails=tails,
            beyond_weights=beyond_weights(channel.standardised(found), tails),
            span=found.by.span or MemorySpan.SWEEP,
        )
        for effect, (odds, needed, larger, _) in here.items():
            other = offsets.get(effect, here[effect])
            both = odds + other.log_odds if effect in offsets else odds
            offsets[effect] = RunOffsets(both, needed, max(other.size, larger), other.channels | {name})
    found_noise = replace(noise, u=u, scatter=scatter, weight=weight, offsets=offsets)
    return _at_least_of_a_rig(found_noise, size)


def _same(one: Sequence[np.ndarray], other: Sequence[np.ndarray]) -> bool:
    """Whether two sets of chains are the same."""
    return {rows.tobytes() for rows in one} == {rows.tobytes() for rows in other}


def _condensed(columns: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Fewer equivalent columns, without directions of negligible change."""
    columns = columns[:, np.any(columns != 0.0, axis=0)]
    white = columns / u[:, None]
    power, turn = np.linalg.eigh(white.T @ white)
    return columns @ turn[:, power > constants.NEGLIGIBLE_CHANGE]


def _at_least_of_a_rig(noise: Noise, size: np.ndarray) -> Noise:
    """The noise, replaced by an assumed one in channels that hardly scatter, such as those of a simulation.

    For autocorrelated errors the innovation from one point to the next is compared, not the total scatter.
    """
    assumed = {}
    for name, readings in noise.by_channel(size).items():
        change = noise.typical(name) * math.sqrt(1.0 - noise.scatter[name].memory ** 2)
        if change < constants.NO_NOISE_SHARE * rms(readings):
            assumed[name] = ASSUMED_NOISE_SHARE * rms(readings)
    return noise.assumed(assumed) if assumed else noise


def _of_channel(
    channel: ScatterOfChannel, runs: Mapping[str, np.ndarray], needed: float
) -> tuple[Described, ScatterOfChannel, float, dict[str, RunOffsets]]:
    """The description of a channel, the channel with weights, its degrees of freedom, and offsets of runs by effect.

    ``needed`` is the log Bayes factor that offsets need. Offsets are considered only if the errors are autocorrelated, because
    only autocorrelation resembles them.
    """
    plain = channel
    found, channel, tails = _weighted(channel)
    offsets: dict[str, RunOffsets] = {}
    span = found[0].by.span
    if span is None:
        return found[0], channel, tails, offsets
    # The weights of outliers follow from a description without offsets, so offsets must be likelier without weights, too.
    weighing = [plain] if math.isinf(tails) else [plain, channel]
    rivals = [(one, _descriptions(one, offsets=False, only=span)) for one in weighing]
    most, best = needed, None
    for effect, columns in runs.items():
        if columns.shape[1]:
            odds, size = math.inf, 0.0
            for one, alone in rivals:
                shifted = replace(one, runs=columns)
                beside = _descriptions(shifted, offsets=True, only=span)
                size = shifted.numbers(beside[0].x, beside[0].by).offsets
                odds = min(odds, _log_sum(beside) - _log_sum(alone))
            offsets[effect] = RunOffsets(odds, needed, size, frozenset())
            if odds > most:
                most, best = odds, columns
    if best is not None:
        found, channel, tails = _weighted(replace(plain, runs=best), offsets=True, only=span)
    return found[0], channel, tails, offsets


def _weighted(
    channel: ScatterOfChannel, *, offsets: bool = False, only: MemorySpan | None = None
) -> tuple[list[Described], ScatterOfChannel, float]:
    """The descriptions, most likely first, the weighted channel, and the degrees of freedom of its tails, by iteration."""
    found, tails = _descriptions(channel, offsets=offsets, only=only), math.inf
    for _ in range(constants.MOST_READING_WEIGHT_ROUNDS):
        z = channel.standardised(found[0])
        tails, width = heavy_tails(z)
        weight = weights(z, tails, width)
        change = np.max(np.abs(np.sqrt(weight) - np.sqrt(channel.weight)))
        channel = replace(channel, weight=weight)
        if change < constants.SCATTER_SETTLED:
            break
        found = [channel.sample.likeliest(found[0].by, found[0].x)]
    return found, channel, tails


def _descriptions(
    channel: ScatterOfChannel, *, offsets: bool, only: MemorySpan | None = None
) -> list[Described]:
    """All descriptions of the errors, the chosen one first: autocorrelation only if proven, along the shortest likely chains.

    The possible chains, or the ``only`` ones, have equal prior probabilities. An additional independent part is tried for the
    most likely chains only.
    """
    some = channel.sample
    never, with_memory, with_both = constants.MEMORY_MODEL_PROBABILITIES
    first = some.likeliest(Description(offsets=offsets, probability=never))
    growing = some.likeliest(replace(first.by, growth=True), first.x[:-1] if offsets else first.x)
    if growing.log_probability - first.log_probability > constants.SURPRISING_LOG_ODDS:
        first = growing
    share = 1.0 / len(some.chains)
    found = [
        some.likeliest(replace(first.by, span=span, probability=with_memory * share), first.x)
        for span in ((only,) if only else some.chains)
    ]
    best = max(found, key=lambda one: one.log_probability)
    both = replace(best.by, independent=True, probability=with_both * share)
    found += [first, some.likeliest(both, best.x)]
    found.sort(key=lambda one: -one.log_probability)
    proven = found[0].log_probability - constants.SURPRISING_LOG_ODDS
    if found[0].by.span is None:
        return found
    alike = [
        one for one in found if one.by.independent == found[0].by.independent and one.by.span is not None
    ]
    spans = [one.by.span for one in alike if one.log_probability > proven]
    shortest = next((span for span in some.chains if span in spans), alike[0].by.span)
    chosen = first if first.log_probability > proven else next(x for x in alike if x.by.span is shortest)
    found.insert(0, found.pop(found.index(chosen)))
    return found


def _log_sum(found: Sequence[Described]) -> float:
    return float(np.logaddexp.reduce([one.log_probability for one in found]))
