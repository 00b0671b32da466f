"""Estimation of the real scatter of the readings: scale, growth with the reading, autocorrelation along sweeps, heavy tails.

Effects, inexact coefficients and smooth structure are integrated out with their priors, so the scatter is the part that none of
them explains. Models of the errors (descriptions) are compared by evidence, in which their parameters are integrated out too.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from mffit.constants import ASSUMED_NOISE_SHARE
from mffit.diagnosis import constants
from mffit.diagnosis.noise import MemorySpan, Noise, RunOffsets, Scatter
from mffit.diagnosis.tails import beyond_weights, heavy_tails, weights
from mffit.linearised.chained import Chained, Memory, chains_of
from mffit.linearised.search import (
    ParameterSearch,
    SearchedParameter,
    arcsine,
    half_cauchy,
    normal,
    share_of,
    uniform,
)
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
    """A model of the errors of a channel."""

    span: MemorySpan | None = None  #: chains of the autocorrelation; None without autocorrelation
    independent: bool = False  #: whether there is also an independent part
    growth: bool = False  #: whether the noise grows with the reading
    offsets: bool = False  #: whether runs have offsets
    probability: float = 1.0  #: prior probability

    @property
    def parameters(self) -> dict[str, SearchedParameter]:
        """The parameters: logarithms of sizes over the usual ones, and log odds of shares."""
        size = SearchedParameter(0.0, -LARGEST, LARGEST, half_cauchy)
        scale = size._replace(prior=normal(0.0, math.log(constants.STATED_NOISE_FACTOR)))
        found = {"scale": scale, "smooth": size}
        if self.growth:
            found["growth"] = size
        if self.offsets:
            found["offsets"] = size
        if self.span is not None:
            start = float(constants.USUAL_LOG_ODDS_OF_MEMORY)
            found["correlation"] = SearchedParameter(start, -LARGEST, LARGEST_MEMORY, arcsine)
        if self.independent:
            found["independent"] = size._replace(prior=uniform)
        return found


class ScatterNumbers(NamedTuple):
    """The numbers of a description."""

    scale: float  #: uncertainty over the stated one
    smooth: float  #: amplitude of smooth structure over the usual one
    growth: float  #: growth over the usual one
    offsets: float  #: offsets of runs over the usual ones
    memory: Memory

    @classmethod
    def of(cls, x: Mapping[str, float]) -> ScatterNumbers:
        """The numbers from their logarithms and log odds."""
        scale, smooth, growth, offsets = (
            math.exp(x.get(name, -math.inf)) for name in ("scale", "smooth", "growth", "offsets")
        )
        correlation, independent = (
            share_of(x.get(name, -math.inf)) for name in ("correlation", "independent")
        )
        return cls(scale, smooth, growth, offsets, Memory(correlation, independent))


@dataclass(frozen=True, slots=True)
class Described:
    """A description at its most probable parameters."""

    by: Description
    x: Mapping[str, float]  #: most probable parameters, logarithms and log odds
    log_probability: float  #: log of prior probability times evidence

    @property
    def numbers(self) -> ScatterNumbers:
        return ScatterNumbers.of(self.x)


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

    def uncertainty(self, at: ScatterNumbers) -> np.ndarray:
        """Standard uncertainty (m,) of every reading."""
        return np.sqrt(self._squares(at).sum(axis=0) / self.weight)

    def _squares(self, at: ScatterNumbers) -> np.ndarray:
        """Components of the variances (3, m) at weight 1: scaled stated one, growing one, constant one."""
        stated = at.scale * self.stated
        growing = at.growth * constants.USUAL_GROWTH * self.size
        return np.array([stated**2, growing**2, np.full(len(stated), self.least**2)])

    def _sizes(self, at: ScatterNumbers) -> np.ndarray:
        counts = [self.named.shape[1], self.smooth.shape[1], self.runs.shape[1]]
        return np.repeat([1.0, at.smooth, at.offsets], counts)

    def _model(self, by: Description) -> Chained:
        """The linear model of a description."""
        columns = np.column_stack([self.named, self.smooth, self.runs])
        return Chained(self.residual, columns, self.chains[by.span or MemorySpan.SWEEP])

    def likeliest(self, by: Description, near: Described | None = None) -> Described:
        """A description at its most probable parameters; the search starts at those of ``near``."""
        model, parameters = self._model(by), by.parameters
        names = tuple(parameters)
        first, last = self.named.shape[1], self.named.shape[1] + self.smooth.shape[1]

        def evidence(x: np.ndarray) -> tuple[float, np.ndarray]:
            at = ScatterNumbers.of(dict(zip(names, x.tolist(), strict=True)))
            squares = self._squares(at)
            total = squares.sum(axis=0)
            found = model.evidence(np.sqrt(total / self.weight), self._sizes(at), at.memory)
            slopes = {
                "scale": found.u @ (squares[0] / total),
                "smooth": np.sum(found.sizes[first:last]),
                "growth": found.u @ (squares[1] / total),
                "offsets": np.sum(found.sizes[last:]),
                "correlation": found.memory[0] * at.memory.correlation * (1.0 - at.memory.correlation),
                "independent": found.memory[1] * at.memory.independent * (1.0 - at.memory.independent),
            }
            return found.value, np.array([slopes[name] for name in names])

        search = ParameterSearch(parameters, evidence, len(self.residual))
        x = search.most_probable(None if near is None else near.x)
        probability = search.log_probability(x) + math.log(by.probability)
        return Described(by, dict(zip(names, x.tolist(), strict=True)), probability)

    def standardised(self, found: Described) -> np.ndarray:
        """Error (m,) of every reading's prediction from all others, over its standard uncertainty at weight 1."""
        at = found.numbers
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
        at = found.numbers
        u[rows], weight[rows] = channel.uncertainty(at), channel.weight
        scatter[name] = Scatter(
            scale=at.scale,
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
                size = beside[0].numbers.offsets
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
        found = [channel.sample.likeliest(found[0].by, found[0])]
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
    growing = some.likeliest(replace(first.by, growth=True), first)
    if growing.log_probability - first.log_probability > constants.SURPRISING_LOG_ODDS:
        first = growing
    share = 1.0 / len(some.chains)
    found = [
        some.likeliest(replace(first.by, span=span, probability=with_memory * share), first)
        for span in ((only,) if only else some.chains)
    ]
    best = max(found, key=lambda one: one.log_probability)
    both = replace(best.by, independent=True, probability=with_both * share)
    found += [first, some.likeliest(both, best)]
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
