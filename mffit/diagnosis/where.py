"""Where measurement and simulation disagree: regions that stand out, with size and significance."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from scipy.stats import false_discovery_control, norm

from mffit.diagnosis.noise import Noise
from mffit.points import Points, levels

FALSE_DISCOVERY = 0.01
FEWEST = 4
MOST_REGIONS = 12
MOST_BINS = 6
PAIRS = (
    ("alpha_deg", "gamma_deg"),
    ("alpha_deg", "Fz_N"),
    ("gamma_deg", "Fz_N"),
    ("alpha_deg", "direction"),
    ("Fz_N", "p_kPa"),
)


@dataclass(frozen=True, slots=True)
class Region:
    """A part of the programme in which one channel is off on average."""

    channel: str  #: "Fy" | "Mz"
    region: dict[str, tuple[float, float]]
    bias: float  #: mean of measured minus simulated [N] or [Nm]
    z: float  #: in standard errors, correlations counted


def where(points: Points, residual: np.ndarray, noise: Noise) -> tuple[Region, ...]:
    """Regions whose mean residual differs from zero, false discovery held at 1 %.

    Parameters
    ----------
    points : (n,) conditions
    residual : (2n,) measured minus simulated, Fy then Mz
    noise : covariance of the readings

    Returns
    -------
    Up to twelve regions, the most significant first; one that only repeats a stronger one's points is left out.
    """
    found, p_values = [], []
    position = np.full(len(residual), -1)
    position[noise.used] = np.arange(len(noise.used))
    n = len(points)
    for region, mask in _cells(points):
        for channel, offset in (("Fy", 0), ("Mz", n)):
            rows = position[np.flatnonzero(mask) + offset]
            rows = rows[rows >= 0]
            if len(rows) < FEWEST:
                continue
            values = residual[noise.used[rows]]
            error = noise.error_of_sum(rows) / len(rows)
            z = float(values.mean()) / error
            found.append((Region(channel, region, float(values.mean()), z), frozenset(rows.tolist())))
            p_values.append(2.0 * norm.sf(abs(z)))
    if not found:
        return ()
    adjusted = false_discovery_control(np.clip(p_values, 1e-300, 1.0))
    passing = [found[i] for i in np.flatnonzero(adjusted < FALSE_DISCOVERY)]
    passing.sort(key=lambda item: -abs(item[0].z))
    kept: list[tuple[Region, frozenset]] = []
    for region, members in passing:
        if all(len(members & other) < 0.6 * min(len(members), len(other)) for _, other in kept):
            kept.append((region, members))
        if len(kept) == MOST_REGIONS:
            break
    return tuple(region for region, _ in kept)


def _cells(points: Points):
    """Cells of single variables and of pairs."""
    bins = _bins(points)
    for name, cells in bins.items():
        for limits, mask in cells:
            yield {name: limits}, mask
    for a, b in PAIRS:
        for limits_a, mask_a in bins.get(a, ()):
            for limits_b, mask_b in bins.get(b, ()):
                mask = mask_a & mask_b
                if mask.sum() >= FEWEST:
                    yield {a: limits_a, b: limits_b}, mask


def _bins(points: Points) -> dict[str, list[tuple[tuple[float, float], np.ndarray]]]:
    variables = {
        "alpha_deg": np.degrees(points.alpha),
        "gamma_deg": np.degrees(points.gamma),
        "Fz_N": points.Fz,
        "p_kPa": points.p / 1e3,
        "V_mps": points.V,
        "T_degC": points.T,
        "t_s": points.t,
        "direction": points.direction.astype(float),
    }
    return {name: cells for name, values in variables.items() if len(cells := _cut(values)) > 1}


def _cut(values: np.ndarray) -> list[tuple[tuple[float, float], np.ndarray]]:
    """At most six bins: the levels that the values keep to where there are few, else equal counts."""
    finite = values[np.isfinite(values)]
    if len(finite) < 2 * FEWEST or np.ptp(finite) == 0.0:
        return []
    tenth = levels.LevelKind("tenth of the range", 0.1 * float(np.ptp(finite)))
    level = levels.nearest_labels(values, tenth)
    number = int(level.max()) + 1
    if 1 < number <= MOST_BINS and not levels.spread(values, tenth):
        masks = [level == k for k in range(number)]
    else:
        edges = np.unique(np.quantile(finite, np.linspace(0.0, 1.0, MOST_BINS + 1)))
        masks = [(values >= low) & (values <= high) for low, high in pairwise(edges)]
    return [
        ((float(values[mask].min()), float(values[mask].max())), mask)
        for mask in masks
        if mask.sum() >= FEWEST
    ]
