"""The covariance of residuals: noise of the readings, and changes that several readings share."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.as_json import keys
from mffit.linearised.chained import NO_MEMORY, ChainedErrors, Memory, chains_of
from mffit.linearised.gaussian import Directions
from mffit.points import Points
from mffit.quantities import SIDEWAYS, column
from mffit.scatter import finite_median, rms
from tir.frozen import ReadOnlyArrays


class Origin(Enum):
    """Origin of the uncertainties of the readings, in words."""

    STATED = "stated uncertainties"
    SCATTER = "scatter between neighbouring points"


class MemorySpan(Enum):
    """The unit along which autocorrelated errors continue before they start independently."""

    SWEEP = "sweep"
    FILE = "file"
    PROGRAMME = "programme"


@dataclass(frozen=True, slots=True)
class Scatter:
    """Scatter of the readings of one channel, relative to their stated uncertainties."""

    scale: float = 1.0  #: uncertainty over the stated one
    growth: float = 0.0  #: standard uncertainty over the reading, added in quadrature
    memory: Memory = NO_MEMORY  #: autocorrelation along a chain
    tails: float = np.inf  #: degrees of freedom of Student's t; infinite for normal scatter
    beyond_weights: float = 1.0
    """Standard error of an estimate from weighted readings over the standard error that the weights alone suggest."""
    span: MemorySpan = MemorySpan.SWEEP  #: the chains along which errors are autocorrelated
    without_noise: bool = False
    """Whether readings hardly scatter, like those of a simulation; the noise is then assumed."""


keys(
    Scatter,
    "scale growth memory=memory.correlation independent=memory.independent tails beyond_weights span without_noise",
)


class RunOffsets(NamedTuple):
    """Offsets of whole runs, compared with autocorrelated errors alone."""

    log_odds: float  #: log Bayes factor of the offsets over autocorrelation alone
    needed: float
    """Required log Bayes factor: prior odds against offsets, which are divided among their kinds."""
    size: float  #: estimated size over the usual one
    channels: frozenset[str]  #: autocorrelated channels in which the offsets appear

    @property
    def beyond(self) -> float:
        """Log posterior odds of the offsets; negative if autocorrelation alone is more likely."""
        return self.log_odds - self.needed


@dataclass(frozen=True)
class Noise(ReadOnlyArrays):
    """Covariance of the readings, and the corresponding whitening.

    The readings (c n,) are those of n points in c channels, channel by channel. Their covariance is D M D + S S'. D are the
    standard uncertainties. M is the correlation along chains: ``memory`` to the power of the distance, times 1 less the
    ``independent`` share. The columns S are changes that several readings share, one standard deviation each: those of numbers
    that act on all channels, and of structure that each channel has of its own.
    """

    u: np.ndarray  #: (c n,) standard uncertainty of every reading; inf where missing
    stated: np.ndarray  #: (c n,) stated standard uncertainty; inf where missing
    chain: np.ndarray  #: (c n,) index of the sweep and channel along which errors may be correlated
    origin: Origin | None  #: of the uncertainties of Fy; None if it was not measured
    scatter: Mapping[str, Scatter] = field(default_factory=lambda: dict.fromkeys(SIDEWAYS, Scatter()))
    """By channel, in the order of the readings."""
    longer: Mapping[MemorySpan, np.ndarray] = field(default_factory=dict)
    """Possible chains longer than sweeps, (c n,) each."""
    turn: np.ndarray | None = None
    """(c n,) rank in time of every reading within its channel; None without longer chains."""
    weight: np.ndarray | None = None  #: (c n,) weight of each reading, below 1 for outliers; None: all 1
    shared: np.ndarray | None = None  #: (c n, k) changes that readings share, one standard deviation each
    structure: Mapping[str, Directions] = field(default_factory=dict)
    """By channel, further such changes of its used readings, whitened for these D and M; not in :meth:`error_of_sum`."""
    offsets: Mapping[str, RunOffsets] = field(default_factory=dict)
    """By id of the effect, offsets of runs that compete with autocorrelated errors; empty without autocorrelation."""

    @property
    def channels(self) -> tuple[str, ...]:
        """Names (c,) of the channels."""
        return tuple(self.scatter)

    @property
    def offset(self) -> frozenset[str]:
        """Ids of the offsets of runs that are significant beyond autocorrelated errors."""
        return frozenset(effect for effect, found in self.offsets.items() if found.beyond > 0.0)

    def measured(self, points: Points) -> np.ndarray:
        """The readings (c n,) of points."""
        return np.concatenate([points.channel(name) for name in self.channels])

    def of_channel(self, readings: np.ndarray, channel: str) -> np.ndarray:
        """The readings (n,) of one channel, out of (c n,)."""
        part: np.ndarray = np.split(readings, len(self.channels))[self.channels.index(channel)]
        return part

    def by_channel(self, readings: np.ndarray) -> dict[str, np.ndarray]:
        """Readings (c n,) by channel, (n,) each."""
        return dict(zip(self.channels, np.split(readings, len(self.channels)), strict=True))

    def typical(self, channel: str) -> float:
        """Typical standard uncertainty of a channel; NaN if it was not measured."""
        return finite_median(self.of_channel(self.u, channel))

    def typically_stated(self, channel: str) -> float:
        """Typical stated standard uncertainty of a channel."""
        return finite_median(self.of_channel(self.stated, channel))

    @cached_property
    def used(self) -> np.ndarray:
        """Indices (m,) of the readings that were measured."""
        return np.flatnonzero(np.isfinite(self.u))

    @property
    def beyond_weights(self) -> np.ndarray:
        """:attr:`Scatter.beyond_weights` (m,) of every used reading."""
        of_channel = np.array([found.beyond_weights for found in self.scatter.values()])
        return of_channel[self.used // (len(self.u) // len(self.channels))]

    @cached_property
    def _errors(self) -> list[tuple[np.ndarray, ChainedErrors]]:
        """For every channel, the positions among the used readings and their autocorrelated errors."""
        channel, out = self.used // (len(self.u) // len(self.channels)), []
        for k, found in enumerate(self.scatter.values()):
            own = np.flatnonzero(channel == k)
            chains = self.chains(self.used[own], found.span)
            out.append((own, ChainedErrors(chains, found.memory)))
        return out

    def chains(self, rows: np.ndarray, span: MemorySpan) -> list[np.ndarray]:
        """Chains along which errors may be correlated, as positions among the ``rows`` (m,) of a channel."""
        chain, turn = (self.longer[span], self.turn) if span in self.longer else (self.chain, None)
        return chains_of(chain[rows], None if turn is None else turn[rows])

    @cached_property
    def directions(self) -> Directions:
        """Directions of the shared changes among the used readings, whitened for D, M and structure."""
        shared = np.zeros((len(self.u), 0)) if self.shared is None else self.shared
        return Directions.of(self._through_structure(Directions.less, self._independent(shared[self.used])))

    @cached_property
    def directions_alone(self) -> Directions:
        """The same for products with differences that are whitened for D and M only."""
        return self.directions._replace(axes=self._through_structure(Directions.less, self.directions.axes))

    @property
    def half_log_determinant(self) -> float:
        """Half the log determinant of the covariance of all that readings share, relative to the errors alone."""
        return sum(of.half_log_determinant for of in (self.directions, *self.structure.values()))

    def _through_structure(
        self, change: Callable[[Directions, np.ndarray], np.ndarray], z: np.ndarray
    ) -> np.ndarray:
        """Rows (m,) or (m, k), those of every channel with structure changed by its directions."""
        if not self.structure:
            return z
        out = z.copy()
        for name, (own, _) in zip(self.scatter, self._errors, strict=True):
            if name in self.structure:
                out[own] = change(self.structure[name], z[own])
        return out

    def _independent(self, x: np.ndarray) -> np.ndarray:
        """Differences of used readings (m,) or (m, k), whitened for D and M only."""
        out: np.ndarray = (x.T / self.u[self.used]).T
        for own, errors in self._errors:
            if not errors.trivial:
                out[own] = errors.whiten(out[own])
        return out

    def whiten(self, x: np.ndarray) -> np.ndarray:
        """Whitened differences (m,) or (m, k) of the used readings, from readings (c n,) or (c n, k)."""
        return self.directions.less(self._through_structure(Directions.less, self._independent(x[self.used])))

    def unshared(self, white: np.ndarray) -> np.ndarray:
        """Whitened differences (m,) or (m, k) as if readings shared no changes: the inverse of that part of the whitening."""
        return self._through_structure(Directions.more, self.directions.more(white))

    def backwards(self, white: np.ndarray) -> np.ndarray:
        """The transpose of the whitening for shared changes, applied to whitened differences (m,) or (m, k)."""
        return self._through_structure(Directions.less, self.directions.less(white))

    def whitened_alone(self, channel: str, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Positions (m,) of a channel's readings among the used ones, and its differences (n, k) whitened for D and M only."""
        k = self.channels.index(channel)
        own, errors = self._errors[k]
        rows = self.used[own]
        return own, errors.whiten((x[rows - k * len(x)].T / self.u[rows]).T)

    def error_of_sum(self, rows: np.ndarray) -> float:
        """Standard error of the sum of some used readings, given by their positions among the used ones."""
        chosen = np.zeros(len(self.used))
        chosen[rows] = 1.0
        chosen *= self.u[self.used]
        alone = sum(errors.variance_of_sum(chosen[own]) for own, errors in self._errors)
        shared = 0.0 if self.shared is None else float(np.sum(self.shared[self.used[rows]].sum(axis=0) ** 2))
        return float(np.sqrt(alone + shared))

    def without(self, points: np.ndarray) -> Noise:
        """The noise in which the readings of some points (mask (n,)) count as not measured."""
        rows = np.tile(points, len(self.channels))
        u, stated = (np.where(rows, np.inf, values) for values in (self.u, self.stated))
        return replace(self, u=u, stated=stated) if rows.any() else self

    def assumed(self, channels: Mapping[str, float]) -> Noise:
        """The noise with independent errors of the given size [N], [Nm] in some channels."""
        u, weight = self.u.copy(), np.ones(len(self.u)) if self.weight is None else self.weight.copy()
        scatter = dict(self.scatter)
        for name, size in channels.items():
            self.of_channel(weight, name)[:] = 1.0
            self.of_channel(u, name)[:] = np.where(
                np.isfinite(self.of_channel(self.stated, name)), size, np.inf
            )
            scatter[name] = Scatter(scale=size / self.typically_stated(name), without_noise=True)
        return replace(self, u=u, weight=weight, scatter=scatter)

    def at_least(self, misfit: np.ndarray) -> Noise:
        """The noise, enlarged in every channel to at least the rms of a misfit (c n,)."""
        sizes = self.by_channel(np.where(np.isfinite(self.u), misfit / self.u, np.nan))
        factor = {name: max(1.0, float(np.nan_to_num(rms(z)))) for name, z in sizes.items()}
        scatter = {
            name: replace(one, scale=factor[name] * one.scale, growth=factor[name] * one.growth)
            for name, one in self.scatter.items()
        }
        wider = np.repeat([*factor.values()], len(self.u) // len(self.channels))
        return replace(self, u=self.u * wider, scatter=scatter)

    def alone(self) -> Noise:
        """The scatter of the readings without shared changes."""
        return replace(self, shared=None, structure={})

    def sharing(self, *columns: np.ndarray | None) -> Noise:
        """The noise with these shared changes (c n, k) only."""
        given = [c for c in columns if c is not None and c.size]
        return replace(self, shared=np.column_stack(given) if given else None)


keys(
    Noise,
    "**typical source **stated scatter",
    typical=lambda noise: {column(name): noise.typical(name) for name in noise.channels},
    source="mffit.diagnosis.wording.source",
    stated=lambda noise: {f"stated_{column(name)}": noise.typically_stated(name) for name in noise.channels},
)
