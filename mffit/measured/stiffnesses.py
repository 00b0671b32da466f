"""Cornering and camber stiffness at one load: slopes at zero and secants of the odd part."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import USUAL_U_FORCE, ZERO_CAMBER, ZERO_SIDESLIP
from mffit.measured import constants, notes
from mffit.measured.groups import LoadGroup
from mffit.measured.paths import on_radius
from mffit.measured.slopes import Secant, SlopeAtZero, secant_at, slope_at_zero
from mffit.measured.sources import named
from mffit.parts import Parts
from mffit.points import Points


@dataclass(frozen=True, slots=True)
class Estimates:
    """The two estimates of a stiffness at one load."""

    slope: SlopeAtZero | None
    secant: Secant | None


def cornering(points: Points, parts: Parts, odd_slip, group: LoadGroup, config: Config) -> Estimates:
    """Cornering stiffness at zero camber."""
    odd = parts.Fy_odd if config.rig.on_disc else points.Fy
    slip, local = sweep(points, odd, group, "alpha", config), constants.CUBIC_SIDESLIP.rad
    return estimates(odd_slip, odd, u_odd(parts), slip, local, local, float(constants.CURVATURE_SPREAD))


def chosen_camber_stiffness(
    config: Config, found: Estimates, largest: float, load: float
) -> tuple[SlopeAtZero | Secant | None, str | None]:
    """C_gamma by the configured method; the other one, with a warning, if the sweep is too short for it.

    Parameters
    ----------
    config : names the method
    found : both estimates
    largest : camber that the sweep reaches [rad]
    load : [N]
    """
    wanted, angle = config.camber_stiffness.method, config.camber_stiffness.angle_deg
    slope_possible = found.slope is not None and largest >= constants.SHORTEST_CAMBER_SWEEP.rad
    if wanted == "slope" and not slope_possible and found.secant is not None:
        return found.secant, notes.slope_not_possible(load, angle)
    if wanted == "secant" and found.secant is None and found.slope is not None:
        return found.slope, notes.secant_not_possible(load, angle)
    return (found.slope if wanted == "slope" else found.secant), None


def u_odd(parts: Parts) -> np.ndarray:
    """Standard uncertainty of the odd side force (n,) [N]."""
    return np.where(np.isfinite(parts.u_Fy_odd), parts.u_Fy_odd, USUAL_U_FORCE / math.sqrt(2.0))


def on_usual_radius(points: Points, group: LoadGroup, config: Config) -> np.ndarray:
    """Indices of the group's points at the usual radius, on either side of the disc."""
    return group.index if config.rig.radius is None else on_radius(points, group.index, config.rig.radius)


def sweep(
    points: Points, odd: np.ndarray, group: LoadGroup, angle: str, config: Config, direction: int = 1
) -> np.ndarray:
    """Indices of the group's points on the positive branch of a pure camber or sideslip sweep at the usual radius.

    ``direction`` is 1 for points rolled forwards, -1 backwards.
    """
    i = on_usual_radius(points, group, config)
    i = i[(points.direction[i] == direction) & np.isfinite(odd[i])]
    if angle == "gamma":
        return i[(np.abs(points.alpha[i]) < ZERO_SIDESLIP.rad) & (points.gamma[i] > ZERO_CAMBER.rad)]
    return i[
        (np.abs(points.gamma[i]) < ZERO_CAMBER.rad) & (points.alpha[i] > constants.SMALLEST_SIDESLIP.rad)
    ]


def estimates(
    x: np.ndarray,
    odd: np.ndarray,
    u: np.ndarray,
    index: np.ndarray,
    local: float,
    angle: float,
    curvature: float = 0.0,
) -> Estimates:
    """Slope at zero and secant at an angle of an odd curve.

    Parameters
    ----------
    x, odd, u : (n,) angles [rad], odd part and its standard uncertainty
    index : of the points to use
    local : up to where a cubic describes the curve [rad]
    angle : of the secant [rad]
    curvature : prior standard deviation of the curvature of the shape
    """
    x, y, u = x[index], odd[index], u[index]
    return Estimates(slope_at_zero(x, y, u, local=local, curvature=curvature), secant_at(x, y, u, angle))


def number(estimate: SlopeAtZero | Secant | None, source: str, shape: UFloat | None = None) -> UFloat | None:
    """An estimate as a number with uncertainty [N/rad].

    Parameters
    ----------
    estimate : slope or secant
    source : its name in the budget
    shape : relative error of the slope due to the shape of the curve, where several slopes share it
    """
    if estimate is None:
        return None
    if isinstance(estimate, Secant):
        return named(estimate.value, estimate.u, source, "N/rad", kind="A")
    noise = named(estimate.value, estimate.u_noise, source, "N/rad", kind="A", dof=estimate.dof)
    if shape is None:
        shape = shape_error([estimate], source)
    own = named(0.0, estimate.u_own, f"{source}, shape of the curve", "N/rad")
    return noise + own + abs(estimate.value) * shape


def shape_error(estimates: Sequence[SlopeAtZero], source: str) -> UFloat:
    """Relative error of slopes at zero due to the shape of the curve, common to curves of one shape."""
    u = max((found.u_shape / abs(found.value) for found in estimates if found.value), default=0.0)
    return named(0.0, u, f"{source}, difference of shapes", "-")
