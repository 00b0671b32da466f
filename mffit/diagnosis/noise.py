"""The covariance that residuals are judged by: noise of the readings, and changes that several readings share."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.linearised.chained import ChainedErrors, Memory, chains_of
from mffit.quantities import SIDEWAYS
from mffit.scatter import finite_median, rms


class Origin(Enum):
    """Where the uncertainties of the readings come from, in words."""

    STATED = "stated uncertainties"
    SCATTER = "scatter between neighbouring points"


class MemorySpan(Enum):
    """What errors with a memory run through before they begin anew."""

    SWEEP = "sweep"
    FILE = "file"
    PROGRAMME = "programme"


@dataclass(frozen=True, slots=True)
class Scatter:
    """How the readings of one channel scatter, relative to their stated uncertainties."""

    scale: float = 1.0  #: uncertainty over the stated one
    growth: float = 0.0  #: standard uncertainty over the reading, added in quadrature
    memory: float = 0.0  #: correlation from one point to the next along a chain, of the part that has one
    independent: float = 0.0  #: share of the variance without memory, beside a part with one
    tails: float = np.inf  #: degrees of freedom of Student's t, infinite where the scatter is normal
    beyond_weights: float = 1.0
    """Standard error of what the readings determine, over that which the weights of outliers state."""
    span: MemorySpan = MemorySpan.SWEEP  #: the chains along which errors have their memory
    without_noise: bool = (
        False  #: whether the readings hardly scatter, as those of a simulation; the noise is assumed
    )


class RunOffsets(NamedTuple):
    """Offsets of whole runs, as the likelihood of the scatter sees them beside errors with a memory."""

    log_odds: float  #: logarithm of the odds against the memory alone that the readings give
    needed: (
        float  #: the same that are needed: the prior odds of any such offsets are shared among their kinds
    )
    size: float  #: over the usual one
    channels: frozenset[str]  #: with a memory, in which the offsets appear

    @property
    def beyond(self) -> float:
        """Logarithm of the odds for these offsets after the readings, negative if a memory alone is likelier."""
        return self.log_odds - self.needed


class SharedDirections(NamedTuple):
    """Orthonormal directions along which some whitened readings change together."""

    rows: slice  #: of the readings
    axes: np.ndarray  #: (m, k)
    variance: np.ndarray  #: (k,) of the changes; a whitened reading has 1

    def less(self, z: np.ndarray) -> np.ndarray:
        """Differences (m,) or (m, j) in units of their uncertainty with these changes; a symmetric operation."""
        return self._along(z, 1.0 / np.sqrt(1.0 + self.variance) - 1.0)

    def more(self, z: np.ndarray) -> np.ndarray:
        """The inverse."""
        return self._along(z, np.sqrt(1.0 + self.variance) - 1.0)

    def power(self, along: np.ndarray) -> np.ndarray:
        """By how much the sum of squares (j,) of differences falls, from their parts (k, j) along the directions."""
        return (self.variance / (1.0 + self.variance)) @ along**2

    def _along(self, z: np.ndarray, gain: np.ndarray) -> np.ndarray:
        return z + self.axes @ (gain * (self.axes.T @ z).T).T if len(gain) else z


@dataclass(frozen=True)
class Noise:
    """Covariance of the readings, and the whitening that goes with it.

    The readings (c n,) are those of n points in c channels, one channel after the other. Their covariance is D M D + S S':
    independent uncertainties D; M with ``memory`` to the power of the distance along each chain, times 1 less the
    ``independent`` share; and columns S of changes that several readings share, one standard deviation each. Smooth
    ``structure`` of single channels is added along directions of the readings that D and M have whitened.
    """

    u: np.ndarray  #: (c n,) standard uncertainty of every reading; inf where missing
    stated: np.ndarray  #: (c n,) the same as stated
    chain: np.ndarray  #: (c n,) number of the sweep and channel along which errors may be correlated
    origin: Origin | None  #: of the uncertainties of Fy; None if it was not measured
    scatter: Mapping[str, Scatter] = field(default_factory=lambda: dict.fromkeys(SIDEWAYS, Scatter()))
    """By channel, in the order of the readings."""
    longer: Mapping[MemorySpan, np.ndarray] = field(default_factory=dict)
    """Longer chains than sweeps that are possible, (c n,) each."""
    turn: np.ndarray | None = (
        None  #: (c n,) place of every reading in time among those of its channel; None if no chain is longer
    )
    weight: np.ndarray | None = None  #: (c n,) of each reading, below 1 for outliers; None: all 1
    shared: np.ndarray | None = None  #: (c n, k) changes that readings share, one standard deviation each
    structure: tuple[SharedDirections, ...] = ()
    offsets: Mapping[str, RunOffsets] = field(default_factory=dict)
    """By id of the effect: offsets of runs that errors with a memory look like; empty without a memory."""

    @property
    def channels(self) -> tuple[str, ...]:
        """Names (c,) of the channels."""
        return tuple(self.scatter)

    @property
    def offset(self) -> frozenset[str]:
        """Ids of the effects that offset runs beyond what errors with a memory explain."""
        return frozenset(effect for effect, found in self.offsets.items() if found.beyond > 0.0)

    def of_channel(self, readings: np.ndarray, channel: str) -> np.ndarray:
        """The part (n,) of readings (c n,) that belongs to a channel."""
        part: np.ndarray = np.split(readings, len(self.channels))[self.channels.index(channel)]
        return part

    def by_channel(self, readings: np.ndarray) -> dict[str, np.ndarray]:
        """Readings (c n,) by channel, (n,) each."""
        return dict(zip(self.channels, np.split(readings, len(self.channels)), strict=True))

    def typical(self, channel: str) -> float:
        """Typical noise of a channel; NaN if it was not measured."""
        return finite_median(self.of_channel(self.u, channel))

    def typically_stated(self, channel: str) -> float:
        """Typical uncertainty of a channel as stated."""
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
        """Positions among the used readings of every channel whose errors have a memory, and these errors."""
        channel, out = self.used // (len(self.u) // len(self.channels)), []
        for k, found in enumerate(self.scatter.values()):
            own = np.flatnonzero(channel == k)
            chain, turn = self.chain, None
            if found.span in self.longer:
                chain, turn = self.longer[found.span], self.turn
            rows = self.used[own]
            chains = chains_of(chain[rows], None if turn is None else turn[rows])
            out.append((own, ChainedErrors(chains, Memory(found.memory, found.independent))))
        return out

    @cached_property
    def _directions(self) -> SharedDirections:
        """Of the shared changes, beside the structure."""
        if self.shared is None or not self.shared.shape[1]:
            return SharedDirections(slice(None), np.empty((len(self.used), 0)), np.empty(0))
        white = self._less_structure(self._independent(self.shared[self.used]))
        variance, turn = np.linalg.eigh(white.T @ white)
        some = variance > 1e-9 * max(float(variance[-1]), 1e-9)
        axes = white @ (turn[:, some] / np.sqrt(variance[some]))
        return SharedDirections(slice(None), axes, variance[some])

    def _independent(self, x: np.ndarray) -> np.ndarray:
        """Differences of used readings (m,) or (m, k), whitened without shared changes and structure."""
        out: np.ndarray = (x.T / self.u[self.used]).T
        for own, errors in self._errors:
            if not errors.trivial:
                out[own] = errors.whiten(out[own])
        return out

    def whiten(self, x: np.ndarray) -> np.ndarray:
        """Differences of readings (c n,) or (c n, k) in units of their joint uncertainty: (m,) or (m, k)."""
        return self._directions.less(self._less_structure(self._independent(x[self.used])))

    def _less_structure(self, z: np.ndarray) -> np.ndarray:
        """Whitened differences (m,) or (m, k) of which smooth structure explains a part, in units of the joint uncertainty."""
        out = z.copy() if self.structure else z
        for one in self.structure:
            out[one.rows] = one.less(z[one.rows])
        return out

    def unshared(self, x: np.ndarray) -> np.ndarray:
        """The inverse of what shared changes and structure do to whitened differences (m,) or (m, k)."""
        out = self._directions.more(x)
        for one in self.structure:
            out[one.rows] = one.more(out[one.rows])
        return out

    def back(self, x: np.ndarray) -> np.ndarray:
        """The transposed of what shared changes and structure do to whitened differences (m,) or (m, k)."""
        return self._less_structure(self._directions.less(x))

    def shared_power(self, rows: np.ndarray, z: np.ndarray) -> np.ndarray:
        """By how much the sum of squares (k,) of whitened differences (m, k) falls with shared changes and structure.

        Only the given ``rows`` of the differences, all in one channel, are not 0, and ``z`` has only these.
        """
        fall = self._directions.power(self._directions_back[rows].T @ z)
        for one in self.structure:
            if one.rows.start <= rows[0] < one.rows.stop:
                fall = fall + one.power(one.axes.T @ z)
        return fall

    @cached_property
    def _directions_back(self) -> np.ndarray:
        """Directions of shared changes beside structure, as sums over differences without it."""
        return self._less_structure(self._directions.axes)

    def only(self, channel: str) -> Noise:
        """The scatter of one channel."""
        return replace(
            self,
            u=self.of_channel(self.u, channel),
            stated=self.of_channel(self.stated, channel),
            chain=self.of_channel(self.chain, channel),
            longer={span: self.of_channel(chain, channel) for span, chain in self.longer.items()},
            turn=None if self.turn is None else self.of_channel(self.turn, channel),
            weight=None if self.weight is None else self.of_channel(self.weight, channel),
            scatter={channel: self.scatter[channel]},
            shared=None,
            structure=(),
        )

    def error_of_sum(self, rows: np.ndarray) -> float:
        """Standard error of the sum of some used readings, by their position among the used ones."""
        chosen = np.zeros(len(self.used))
        chosen[rows] = 1.0
        chosen *= self.u[self.used]
        alone = sum(errors.variance_of_sum(chosen[own]) for own, errors in self._errors)
        shared = 0.0 if self.shared is None else float(np.sum(self.shared[self.used[rows]].sum(axis=0) ** 2))
        return float(np.sqrt(alone + shared))

    def assumed(self, channels: Mapping[str, float]) -> Noise:
        """The noise with independent errors of the given size [N], [Nm] in some channels."""
        u, weight = self.u.copy(), np.ones(len(self.u)) if self.weight is None else self.weight.copy()
        scatter = dict(self.scatter)
        for name, rows in self.by_channel(np.arange(len(u))).items():
            if name in channels:
                weight[rows] = 1.0
                u[rows] = np.where(np.isfinite(self.stated[rows]), channels[name], np.inf)
                scale = channels[name] / self.typically_stated(name)
                scatter[name] = Scatter(scale=scale, without_noise=True)
        return replace(self, u=u, weight=weight, scatter=scatter)

    def at_least(self, misfit: np.ndarray) -> Noise:
        """The noise, in every channel so large that a misfit (c n,) has at most its variance on average."""
        z = np.zeros(len(self.u))
        z[self.used] = misfit[self.used] / self.u[self.used]
        factors, scatter = [], dict(self.scatter)
        for name, rows in self.by_channel(z).items():
            known = np.isfinite(self.of_channel(self.u, name))
            factor = max(1.0, np.nan_to_num(rms(rows[known]))) if known.any() else 1.0
            factors.append(np.full(len(rows), factor))
            here = scatter[name]
            scatter[name] = replace(here, scale=factor * here.scale, growth=factor * here.growth)
        return replace(self, u=self.u * np.concatenate(factors), scatter=scatter)

    def alone(self) -> Noise:
        """The scatter of the readings without shared changes and structure."""
        return replace(self, shared=None, structure=())

    def sharing(self, *columns: np.ndarray) -> Noise:
        """The same scatter with these shared changes (c n, k), and no others."""
        given = [c for c in columns if c.size]
        return replace(self, shared=np.column_stack(given) if given else None, structure=())
