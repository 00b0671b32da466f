"""Structure that no effect describes: a local bump anywhere in the programme, as the rival of every named effect."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from mffit.diagnosis.candidates import Hypothesis
from mffit.diagnosis.noise import Noise
from mffit.points import Points, levels

WIDTHS = {"alpha": (0.7, 1.4, 3.0), "gamma": (3.0, 8.0)}  # deg
AMPLITUDE = 0.03
"""How large an unknown bump may be, 1 sigma, relative to the channel's largest value."""
MOST_LOADS = 7
"""More loads than this are not looked at one by one."""
AT_ONCE = 256
"""Bumps that are whitened together."""
NEEDED = 8.0
"""Log evidence, after the price of having searched everywhere, at which a bump counts as found."""


@dataclass(frozen=True, slots=True)
class Bump:
    """The best-fitting local structure."""

    channel: str  #: "Fy" | "Mz"
    region: dict[str, tuple[float, float]]  #: column -> range
    amplitude: float  #: [N] or [Nm]
    gain: float  #: log evidence, the search paid for
    number: int = -1  #: of its shape among those tried

    @property
    def found(self) -> bool:
        return self.gain > NEEDED


@dataclass(frozen=True)
class BumpScan:
    """All bumps that the programme could show."""

    noise: Noise
    bumps: np.ndarray  #: (n, k) unit bumps over the points
    regions: tuple[dict[str, tuple[float, float]], ...]
    spread: Mapping[str, float]  #: plausible amplitude by channel

    @cached_property
    def _white(self) -> list[tuple[str, int, np.ndarray, np.ndarray]]:
        """All bumps as seen through the noise: channel, number of the first, shapes (m, k) and their power (k,)."""
        out = []
        for channel in self.spread:
            for first in range(0, len(self.regions), AT_ONCE):
                shapes = self.noise.whiten(self.column(channel, slice(first, first + AT_ONCE)))
                power = np.einsum("ij,ij->j", shapes, shapes)
                out.append((channel, first, shapes.astype(np.float32), power))
        return out

    def best(self, hypothesis: Hypothesis, limit: float = math.inf) -> Bump:
        """The bump that explains most of what the hypothesis leaves, its own freed numbers projected out.

        Parameters
        ----------
        hypothesis : with the residuals that the bump has to explain
        limit : residuals count no more than this many standard deviations, so that a wild reading is no bump
        """
        Q = None
        if hypothesis.jacobian.shape[1]:
            Q, _ = np.linalg.qr(hypothesis.jacobian)
        residual = np.clip(hypothesis.residual, -limit, limit)
        tried = math.log(max(len(self.regions) * len(self.spread), 1))
        best = Bump("Fy", {}, 0.0, -math.inf)
        for channel, first, shapes, whole in self._white:
            spread = self.spread[channel]
            score = (shapes.T @ residual.astype(np.float32)).astype(float)
            power = whole.copy()
            if Q is not None:
                inside = (Q.astype(np.float32).T @ shapes).astype(float)
                score -= inside.T @ (Q.T @ residual)
                power -= np.einsum("ij,ij->j", inside, inside)
            precision = np.maximum(power, 0.0) + spread**-2.0
            gain = 0.5 * score**2 / precision - 0.5 * np.log(precision * spread**2) - tried
            k = int(np.argmax(gain))
            if gain[k] > best.gain:
                amplitude = float(score[k] / precision[k])
                best = Bump(channel, self.regions[first + k], amplitude, float(gain[k]), first + k)
        return best

    def column(self, channel: str, which: slice) -> np.ndarray:
        """Some unit bumps of a channel as changes of the readings (2n, k)."""
        shapes = self.bumps[:, which].astype(float)
        nothing = np.zeros_like(shapes)
        return np.vstack([shapes, nothing] if channel == "Fy" else [nothing, shapes])

    def plausible(self, bump: Bump) -> np.ndarray:
        """A bump as a change of the readings (2n, 1), as large as it may be."""
        return self.spread[bump.channel] * self.column(bump.channel, slice(bump.number, bump.number + 1))


def bump_scan(points: Points, noise: Noise) -> BumpScan:
    """Bumps over sideslip or camber, everywhere or within one load, one side of camber, or one direction."""
    masks = _masks(points)
    shapes, regions = [], []
    for name, values in (("alpha", np.degrees(points.alpha)), ("gamma", np.degrees(points.gamma))):
        for centre in _centres(values):
            for width in WIDTHS[name]:
                bell = np.exp(-0.5 * ((values - centre) / width) ** 2)
                bell[bell < 0.02] = 0.0
                for region, mask in masks:
                    shape = bell * mask
                    if np.sum(shape > 0.5) < 2:
                        continue
                    shapes.append(shape.astype(np.float32))
                    regions.append(_narrowed(region, f"{name}_deg", centre - width, centre + width))
    measured = {"Fy": points.Fy, "Mz": points.Mz}
    spread = {
        name: AMPLITUDE * float(np.nanmax(np.abs(values)))
        for name, values in measured.items()
        if np.any(np.isfinite(values))
    }
    bumps = np.column_stack(shapes) if shapes else np.empty((len(points), 0), np.float32)
    return BumpScan(noise, bumps, tuple(regions), spread)


def _narrowed(
    region: dict[str, tuple[float, float]], name: str, low: float, high: float
) -> dict[str, tuple[float, float]]:
    """The region with one range cut to the bump."""
    before = region.get(name, (-np.inf, np.inf))
    return {**region, name: (float(max(low, before[0])), float(min(high, before[1])))}


def _centres(values: np.ndarray) -> np.ndarray:
    levels = np.unique(np.round(values * 2.0) / 2.0)
    return levels if len(levels) <= 41 else np.linspace(levels[0], levels[-1], 41)


def _masks(points: Points) -> list[tuple[dict[str, tuple[float, float]], np.ndarray]]:
    gamma = np.degrees(points.gamma)
    out: list[tuple[dict[str, tuple[float, float]], np.ndarray]] = [({}, np.ones(len(points)))]
    for low, high in ((-90.0, -1.0), (-1.0, 1.0), (1.0, 90.0)):
        mask = (gamma >= low) & (gamma <= high)
        if 2 <= mask.sum() < len(points):
            out.append(
                ({"gamma_deg": (max(low, float(gamma.min())), min(high, float(gamma.max())))}, mask * 1.0)
            )
    load = levels.nearest_labels(points.Fz, levels.LOAD)
    if 1 < load.max() + 1 <= MOST_LOADS:
        for k in range(load.max() + 1):
            mask = load == k
            out.append(({"Fz_N": (float(points.Fz[mask].min()), float(points.Fz[mask].max()))}, mask * 1.0))
    if np.any(points.direction < 0):
        out.append(({"direction": (-1.0, -1.0)}, (points.direction < 0) * 1.0))
    return out
