"""Structure that no effect describes: a local bump anywhere in the programme, as the rival of every named effect."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from mffit.diagnosis.candidates import Hypothesis
from mffit.diagnosis.noise import Noise
from mffit.points import Points, levels

WIDTHS = {"alpha": (0.7, 1.4, 3.0), "gamma": (3.0, 8.0)}  # deg
AMPLITUDE = 0.03
"""How large an unknown bump may be, 1 sigma, relative to the channel's largest value."""
MOST_LOADS = 7
"""More loads than this are not looked at one by one."""
NEEDED = 8.0
"""Log evidence, after the price of having searched everywhere, at which a bump counts as found."""


@dataclass(frozen=True, slots=True)
class Bump:
    """The best-fitting local structure."""

    channel: str  #: "Fy" | "Mz"
    region: dict[str, tuple[float, float]]  #: column -> range
    amplitude: float  #: [N] or [Nm]
    gain: float  #: log evidence, the search paid for

    @property
    def found(self) -> bool:
        return self.gain > NEEDED


@dataclass(frozen=True, slots=True)
class BumpScan:
    """All bumps that the programme could show, whitened once."""

    shapes: np.ndarray  #: (m, k) whitened unit bumps
    channels: tuple[str, ...]
    regions: tuple[dict[str, tuple[float, float]], ...]
    spread: np.ndarray  #: (k,) plausible amplitude

    def best(self, hypothesis: Hypothesis) -> Bump:
        """The bump that explains most of what the hypothesis leaves, its own freed numbers projected out."""
        shapes, residual = self.shapes, hypothesis.residual
        if hypothesis.jacobian.shape[1]:
            Q, _ = np.linalg.qr(hypothesis.jacobian)
            shapes = shapes - Q @ (Q.T @ shapes)
        power = np.einsum("ij,ij->j", shapes, shapes)
        score = shapes.T @ residual
        precision = power + self.spread**-2.0
        gain = 0.5 * score**2 / precision - 0.5 * np.log(precision * self.spread**2) - math.log(len(power))
        k = int(np.argmax(gain))
        return Bump(self.channels[k], self.regions[k], float(score[k] / precision[k]), float(gain[k]))


def bump_scan(points: Points, noise: Noise) -> BumpScan:
    """Bumps over sideslip or camber, everywhere or within one load, one side of camber, or one direction."""
    masks = _masks(points)
    shapes, channels, regions, spread = [], [], [], []
    n = len(points)
    for name, values in (("alpha", np.degrees(points.alpha)), ("gamma", np.degrees(points.gamma))):
        for centre in _centres(values):
            for width in WIDTHS[name]:
                bell = np.exp(-0.5 * ((values - centre) / width) ** 2)
                bell[bell < 0.02] = 0.0
                for region, mask in masks:
                    shape = bell * mask
                    if np.sum(shape > 0.5) < 2:
                        continue
                    for channel, measured in (("Fy", points.Fy), ("Mz", points.Mz)):
                        if not np.any(np.isfinite(measured)):
                            continue
                        column = np.zeros(2 * n)
                        column[slice(0, n) if channel == "Fy" else slice(n, 2 * n)] = shape
                        shapes.append(column)
                        channels.append(channel)
                        regions.append(_narrowed(region, f"{name}_deg", centre - width, centre + width))
                        spread.append(AMPLITUDE * np.nanmax(np.abs(measured)))
    whitened = noise.whiten(np.column_stack(shapes)) if shapes else np.empty((len(noise.used), 0))
    return BumpScan(whitened, tuple(channels), tuple(regions), np.array(spread))


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
