"""Cornering and camber stiffness at one load: slopes at zero and secants of the odd part."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.measured import camber_reduction as method
from mffit.measured.alignment import DEFAULT_U_FORCE
from mffit.measured.groups import STRAIGHT, UPRIGHT, LoadGroup
from mffit.measured.notes import SecantNotPossible, SlopeNotPossible, Trouble
from mffit.measured.paths import on_radius
from mffit.measured.slopes import Secant, Slope, secant_at, slope_at_zero
from mffit.parts import Parts
from mffit.points import Points

CUBIC_CAMBER = math.radians(20.0)
CUBIC_SLIP = math.radians(2.0)
"""Angles within which a cubic describes the odd part."""
SHORTEST_CAMBER_SWEEP = math.radians(10.0)


@dataclass(frozen=True, slots=True)
class Stiffness:
    """A stiffness at one load as the two estimates of it."""

    slope: Slope | None
    secant: Secant | None


def cornering(points: Points, parts: Parts, odd_slip, group: LoadGroup, config: Config) -> Stiffness:
    """Of sideslip at zero camber."""
    odd = parts.Fy_odd if config.rig.on_disc else points.Fy
    slip = sweep(points, odd, group, "alpha", config)
    return Stiffness(*estimates(odd_slip, odd, u_odd(parts), slip, CUBIC_SLIP, CUBIC_SLIP))


def camber_stiffness(
    config, stiffness: Stiffness, gamma, load: float, warnings: list[Trouble]
) -> UFloat | None:
    """C_gamma by the configured method; the other one, with a warning, if the sweep is too short for it."""
    wanted = config.camber_stiffness.method
    angle = config.camber_stiffness.angle_deg
    slope_possible = stiffness.slope is not None and gamma.max() >= SHORTEST_CAMBER_SWEEP
    if wanted == "slope" and not slope_possible and stiffness.secant is not None:
        warnings.append(SlopeNotPossible(load, angle))
        return number(stiffness.secant, "camber stiffness")
    if wanted == "secant" and stiffness.secant is None and stiffness.slope is not None:
        warnings.append(SecantNotPossible(load, angle))
        return number(stiffness.slope, "camber stiffness")
    return number(stiffness.slope if wanted == "slope" else stiffness.secant, "camber stiffness")


def u_odd(parts: Parts) -> np.ndarray:
    """Standard uncertainty of the odd side force (n,) [N]."""
    return np.where(np.isfinite(parts.u_Fy_odd), parts.u_Fy_odd, DEFAULT_U_FORCE / math.sqrt(2.0))


def raw_odd(points: Points) -> tuple[np.ndarray, np.ndarray]:
    """On a straight path the curve itself, less its value at zero, stands for the odd part."""
    return points.Fy, points.Mz


def sweep(points: Points, odd: np.ndarray, group: LoadGroup, angle: str, config: Config) -> np.ndarray:
    """Indices of the group's forward points on the positive branch of a pure camber or sideslip sweep at the usual radius."""
    i = group.index if config.rig.radius is None else on_radius(points, group.index, config.rig.radius)
    i = i[(points.direction[i] > 0) & np.isfinite(odd[i])]
    if angle == "gamma":
        return i[(np.abs(points.alpha[i]) < STRAIGHT) & (points.gamma[i] > UPRIGHT)]
    return i[(np.abs(points.gamma[i]) < UPRIGHT) & (points.alpha[i] > np.radians(0.15))]


def estimates(x, odd, u, index, local, angle) -> tuple[Slope | None, Secant | None]:
    x, y, u = x[index], odd[index], u[index]
    return slope_at_zero(x, y, u, local=local), secant_at(x, y, u, angle)


def number(estimate: Slope | Secant | None, source: str) -> UFloat | None:
    return None if estimate is None else method.named(estimate.value, estimate.u, source, "N/rad")
