"""Estimation of the real scatter of the readings: scale, growth with the reading, autocorrelation along sweeps, heavy tails.

Effects, inexact coefficients and smooth structure are integrated out with their priors, so the scatter is the part that none of
them explains. Models of the errors (descriptions) are compared by evidence, in which their parameters are integrated out too.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from mffit.constants import ASSUMED_NOISE_SHARE, FEWEST_SWEEPS_TO_PREDICT
from mffit.diagnosis import constants
from mffit.diagnosis.inexact import columns_of
from mffit.diagnosis.noise import MemorySpan, Noise, RunOffsets, Scatter
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.search import Search
from mffit.diagnosis.tails import beyond_weights, heavy_tails, weights
from mffit.effects import Effect
from mffit.linearised.chained import Chained, Memory
from mffit.linearised.gaussian import Directions
from mffit.linearised.search import (
    ParameterSearch,
    SearchedParameter,
    arcsine,
    half_cauchy,
    normal,
    uniform,
)
from mffit.rig import Simulation
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


SIZE = SearchedParameter(0.0, -LARGEST, LARGEST, half_cauchy)
PARAMETERS: Mapping[str, SearchedParameter] = {
    "scale": SIZE._replace(prior=normal(0.0, math.log(constants.STATED_NOISE_FACTOR))),
    "smooth": SIZE,
    "growth": SIZE,
    "offsets": SIZE,
    "correlation": SearchedParameter(
        float(constants.USUAL_LOG_ODDS_OF_MEMORY), -LARGEST, LARGEST_MEMORY, arcsine
    ),
    "independent": SIZE._replace(prior=uniform),
}
"""Parameters of the terms of a channel: logarithms of sizes over the usual ones, and log odds of shares."""
ALWAYS = ("named", "least")
"""Terms whose size is known."""


@dataclass(frozen=True, slots=True)
class Description:
    """A model of the errors of a channel."""

    names: tuple[str, ...]  #: parameters of its terms
    probability: float  #: prior probability
    span: MemorySpan | None = None  #: chains of the autocorrelation; None without autocorrelation

    def plus(
        self, name: str, probability: float | None = None, span: MemorySpan | None = None
    ) -> Description:
        """The description with one parameter more."""
        return Description((*self.names, name), probability or self.probability, span or self.span)


@dataclass(frozen=True, slots=True)
class Described:
    """A description at its most probable parameters."""

    by: Description
    x: Mapping[str, float]  #: most probable parameters, logarithms and log odds
    log_probability: float  #: log of prior probability times evidence

    def size(self, name: str) -> float:
        """Size of a term over the usual one; 0 without it."""
        return math.exp(self.x.get(name, -math.inf))


@dataclass(frozen=True, eq=False)
class ScatterOfChannel(ReadOnlyArrays):
    """The used readings (m,) of one channel, and every term that could explain them."""

    terms: Chained  #: at their usual sizes, without chains
    chains: Mapping[MemorySpan, Sequence[np.ndarray]]  #: chains along which errors may be autocorrelated
    sweep: np.ndarray

    def described(self, by: Description) -> Chained:
        """The terms of a description."""
        columns, noise = (
            {name: term for name, term in terms.items() if name in (*by.names, *ALWAYS)}
            for terms in (self.terms.columns, self.terms.noise)
        )
        chains = self.chains[by.span or MemorySpan.SWEEP]
        return replace(self.terms, columns=columns, noise=noise, chains=chains)

    def likeliest(self, by: Description, near: Described | None = None) -> Described:
        """A description at its most probable parameters; the search starts at those of ``near``."""
        model = self.described(by)

        def evidence(x: np.ndarray) -> tuple[float, np.ndarray]:
            value, slopes = model.evidence(dict(zip(by.names, x.tolist(), strict=True)))
            return value, np.array([*slopes.values()])

        search = ParameterSearch({n: PARAMETERS[n] for n in by.names}, evidence, len(self.sweep))
        x, log = search.most_probable(None if near is None else near.x)
        return Described(by, dict(zip(by.names, x.tolist(), strict=True)), log + math.log(by.probability))

    def standardised(self, found: Described) -> np.ndarray:
        """Error (m,) of every reading's prediction from all others, over its standard uncertainty at weight 1."""
        return self.described(found.by).standardised(found.x)

    def plus(self, name: str, columns: np.ndarray) -> ScatterOfChannel:
        """The channel with another term (m, k)."""
        return replace(self, terms=replace(self.terms, columns={**self.terms.columns, name: columns}))

    @property
    def sample(self) -> ScatterOfChannel:
        """The channel thinned to every k-th sweep, if it has more readings than the estimation of scatter needs."""
        names = np.unique(self.sweep)
        most = max(len(names) // int(FEWEST_SWEEPS_TO_PREDICT), 1)
        stride = min(math.ceil(len(self.sweep) / constants.READINGS_FOR_SCATTER), most)
        return self if stride == 1 else self._select(np.flatnonzero(np.isin(self.sweep, names[::stride])))

    def _select(self, rows: np.ndarray) -> ScatterOfChannel:
        """The channel with some of its readings only."""
        place = np.full(len(self.sweep), -1)
        place[rows] = np.arange(len(rows))
        chains = {
            span: [p[p >= 0] for p in (place[c] for c in found) if np.any(p >= 0)]
            for span, found in self.chains.items()
        }
        columns, noise = (
            {name: term[rows] for name, term in terms.items()}
            for terms in (self.terms.columns, self.terms.noise)
        )
        terms = Chained(self.terms.residual[rows], columns, noise, (), self.terms.weight[rows])
        return ScatterOfChannel(terms, chains, self.sweep[rows])


def learned_noise(search: Search, state: Simulation) -> Noise:
    """The noise with the scatter around ``state`` that remains if all candidates, coefficients and structure may explain it."""
    points = search.points
    stated = search.stated.without(state.floats(points))
    problem = DiagnosisProblem(points, state, stated)
    predicted = np.nan_to_num(problem.predict(state))
    residual = problem.measured - predicted
    nothing = np.zeros((len(predicted), 0))
    # The derivative by each effect, and its first finite step for numbers whose derivative vanishes at zero.
    columns = problem.columns(state, search.candidates, steps=1)
    runs = {e.id: g[0] for e, g in columns.items() if e.differs_by_run}
    others = [g for e, groups in columns.items() if not e.differs_by_run for g in groups]
    generous = constants.GENEROUS_EFFECT_SIZE
    named = np.column_stack(
        [
            nothing,
            *(generous * g for g in others),
            columns_of(search.inexact, state, points, problem.channels),
        ]
    )
    return learned(stated, residual, ExplainingColumns(named, runs, search.coarse), predicted)


def learned(noise: Noise, residual: np.ndarray, explained: ExplainingColumns, size: np.ndarray) -> Noise:
    """The noise with the scatter estimated from the residual (c n,); it may grow in proportion to ``size`` (c n,)."""
    u, weight, scatter = noise.u.copy(), np.ones(len(residual)), dict(noise.scatter)
    offsets: dict[str, RunOffsets] = {}
    for name, rows in noise.by_channel(np.arange(len(residual))).items():
        rows = rows[np.isfinite(noise.stated[rows])]
        if not len(rows):
            continue
        channel = _channel(noise, np.nan_to_num(residual), explained, size, rows)
        runs = {n: _condensed(columns[rows], noise.stated[rows]) for n, columns in explained.runs.items()}
        found, channel, tails, here = _of_channel(channel, runs)
        u[rows], weight[rows] = channel.described(found.by).uncertainty(found.x), channel.terms.weight
        scatter[name] = Scatter(
            scale=found.size("scale"),
            growth=float(constants.USUAL_GROWTH) * found.size("growth"),
            memory=Memory.of(found.x),
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


def _channel(
    noise: Noise, residual: np.ndarray, explained: ExplainingColumns, size: np.ndarray, rows: np.ndarray
) -> ScatterOfChannel:
    """The terms of the readings (c n,) in the ``rows`` (m,) of one channel."""
    stated, chains = noise.stated[rows], dict[MemorySpan, list[np.ndarray]]()
    for span in (MemorySpan.SWEEP, *noise.longer):
        found = noise.chains(rows, span)
        if not any(_same(found, known) for known in chains.values()):
            chains[span] = found
    growing = constants.USUAL_GROWTH * np.nan_to_num(size[rows])
    least = 0.5 * constants.NO_NOISE_SHARE * rms(size[rows])  # for readings without noise
    terms = Chained(
        residual=residual[rows],
        columns={
            "named": _condensed(explained.named[rows], stated),
            "smooth": _condensed(constants.USUAL_MISS_OF_A_FORMULA * explained.smooth[rows], stated),
        },
        noise={"scale": stated**2, "growth": growing**2, "least": np.full(len(rows), least**2)},
        chains=(),
        weight=np.ones(len(rows)),
    )
    return ScatterOfChannel(terms, chains, noise.chain[rows])


def _same(one: Sequence[np.ndarray], other: Sequence[np.ndarray]) -> bool:
    """Whether two sets of chains are the same."""
    return {rows.tobytes() for rows in one} == {rows.tobytes() for rows in other}


def _condensed(columns: np.ndarray, u: np.ndarray) -> np.ndarray:
    """Fewer equivalent columns, without directions of negligible change."""
    axes, variance = Directions.of(
        columns[:, np.any(columns, axis=0)] / u[:, None], constants.NEGLIGIBLE_CHANGE
    )
    return axes * np.sqrt(variance) * u[:, None]


def _at_least_of_a_rig(noise: Noise, size: np.ndarray) -> Noise:
    """The noise, replaced by an assumed one in channels that hardly scatter, such as those of a simulation.

    For autocorrelated errors the innovation from one point to the next is compared, not the total scatter.
    """
    assumed = {}
    for name, readings in noise.by_channel(size).items():
        change = noise.typical(name) * math.sqrt(1.0 - noise.scatter[name].memory.correlation ** 2)
        if change < constants.NO_NOISE_SHARE * rms(readings):
            assumed[name] = ASSUMED_NOISE_SHARE * rms(readings)
    return noise.assumed(assumed) if assumed else noise


def _of_channel(
    channel: ScatterOfChannel, runs: Mapping[str, np.ndarray]
) -> tuple[Described, ScatterOfChannel, float, dict[str, RunOffsets]]:
    """The description of a channel, the channel with weights, its degrees of freedom, and offsets of runs by effect.

    Offsets are considered only if the errors are autocorrelated, because only autocorrelation resembles them.
    """
    plain, needed = channel, constants.SURPRISING_LOG_ODDS + math.log(max(len(runs), 1))
    found, channel, tails = _weighted(channel)
    offsets: dict[str, RunOffsets] = {}
    span, runs = found[0].by.span, {name: columns for name, columns in runs.items() if columns.shape[1]}
    if span is None or not runs:
        return found[0], channel, tails, offsets
    # The weights of outliers follow from a description without offsets, so offsets must be likelier without weights, too.
    weighing = [plain] if math.isinf(tails) else [plain, channel]
    rivals = [(one, _descriptions(one, only=span)) for one in weighing]
    most, best = needed, None
    for effect, columns in runs.items():
        odds, size = math.inf, 0.0
        for one, alone in rivals:
            beside = _descriptions(one.plus("offsets", columns), only=span)
            size = beside[0].size("offsets")
            odds = min(odds, _log_sum(beside) - _log_sum(alone))
        offsets[effect] = RunOffsets(odds, needed, size, frozenset())
        if odds > most:
            most, best = odds, columns
    if best is not None:
        found, channel, tails = _weighted(plain.plus("offsets", best), only=span)
    return found[0], channel, tails, offsets


def _weighted(
    channel: ScatterOfChannel, only: MemorySpan | None = None
) -> tuple[list[Described], ScatterOfChannel, float]:
    """The descriptions, most likely first, the weighted channel, and the degrees of freedom of its tails, by iteration."""
    found, tails = _descriptions(channel, only), math.inf
    for _ in range(constants.MOST_READING_WEIGHT_ROUNDS):
        z = channel.standardised(found[0])
        tails, width = heavy_tails(z)
        weight = weights(z, tails, width)
        change = np.max(np.abs(np.sqrt(weight) - np.sqrt(channel.terms.weight)))
        channel = replace(channel, terms=replace(channel.terms, weight=weight))
        if change < constants.SCATTER_SETTLED:
            break
        found = [channel.sample.likeliest(found[0].by, found[0])]
    return found, channel, tails


def _descriptions(channel: ScatterOfChannel, only: MemorySpan | None = None) -> list[Described]:
    """All descriptions of the errors, the chosen one first: autocorrelation only if proven, along the shortest likely chains.

    The possible chains, or the ``only`` ones, have equal prior probabilities. An additional independent part is tried for the
    most likely chains only.
    """
    some = channel.sample
    never, with_memory, with_both = constants.MEMORY_MODEL_PROBABILITIES
    always = ("scale", "smooth", "offsets") if "offsets" in some.terms.columns else ("scale", "smooth")
    first = some.likeliest(Description(always, never))
    growing = some.likeliest(first.by.plus("growth"), first)
    if growing.log_probability - first.log_probability > constants.SURPRISING_LOG_ODDS:
        first = growing
    share = 1.0 / len(some.chains)
    found = [
        some.likeliest(first.by.plus("correlation", with_memory * share, span), first)
        for span in ((only,) if only else some.chains)
    ]
    best = max(found, key=lambda one: one.log_probability)
    found += [first, some.likeliest(best.by.plus("independent", with_both * share), best)]
    found.sort(key=lambda one: -one.log_probability)
    proven = found[0].log_probability - constants.SURPRISING_LOG_ODDS
    if found[0].by.span is None:
        return found
    alike = [one for one in found if one.by.names == found[0].by.names]
    spans = [one.by.span for one in alike if one.log_probability > proven]
    shortest = next((span for span in some.chains if span in spans), alike[0].by.span)
    chosen = first if first.log_probability > proven else next(x for x in alike if x.by.span is shortest)
    found.insert(0, found.pop(found.index(chosen)))
    return found


def _log_sum(found: Sequence[Described]) -> float:
    return float(np.logaddexp.reduce([one.log_probability for one in found]))


def beyond_memory(noise: Noise, candidates: Sequence[Effect]) -> list[Effect]:
    """The candidates without offsets of runs that autocorrelated errors explain as well.

    Offsets that are significant beyond the autocorrelation get the size that was estimated together with it as spread.
    """
    kept = []
    for effect in candidates:
        offsets = noise.offsets.get(effect.id)
        if offsets is None:
            kept.append(effect)
        elif effect.id in noise.offset:
            wider = max(offsets.size, 1.0)
            kept.append(replace(effect, free=tuple(replace(f, spread=wider * f.spread) for f in effect.free)))
    return kept
