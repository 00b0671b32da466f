"""Starting values of longitudinal and combined slip, read off the data."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping

import numpy as np

from mffit.constants import ZERO_SIDESLIP
from mffit.fit import constants
from mffit.points import Points, levels
from tir.parameters import BY_NAME


def driven_starts(values: Mapping[str, float], points: Points, held: Collection[str]) -> dict[str, float]:
    """Coefficients of Fx, G_xa and G_yk that sweeps of longitudinal slip show directly; those ``held`` by hand are left out.

    Slip stiffness is the slope of Fx at zero slip, friction the largest Fx over load, PEX1 follows from the slip of the peak.
    The slope factors of the weights follow from the loss of slip stiffness with sideslip and of Fy with longitudinal slip.
    """
    found: dict[str, float] = {}
    straight = _sweeps(points, sideslip=False)
    if straight:
        found |= _pure({**values}, straight)
    both = _sweeps(points, sideslip=True)
    if straight and both:
        found |= _weight_of_sideslip({**values, **found}, straight, both)
    found |= _weight_of_slip(values, both)
    return {name: value for name, value in found.items() if name not in held}


def peak_curvature(C: float, B: float, peak: float) -> float:
    """Curvature factor E with which a Magic Formula of shape factor C and slope factor B has its peak at the slip ``peak``.

    There C arctan(B x - E (B x - arctan(B x))) is a right angle; Pacejka, Tire and Vehicle Dynamics, 3rd ed., 4.E14.
    """
    x = B * peak
    return (x - math.tan(0.5 * math.pi / C)) / (x - math.atan(x))


def _sweeps(points: Points, *, sideslip: bool) -> list[Points]:
    """Sweeps of longitudinal slip in which Fx was measured, with sideslip or without."""
    slipping = np.abs(points.alpha) > ZERO_SIDESLIP.rad
    used = np.isfinite(points.Fx) & (slipping == sideslip)
    out = []
    for k in np.unique(points.sweep[used]):
        rows = np.flatnonzero(used & (points.sweep == k))
        kappa = points.kappa[rows]
        if (
            np.ptp(kappa) > constants.SLIP_OF_THE_SLOPE
            and np.min(np.abs(kappa)) < constants.SLIP_OF_THE_SLOPE
        ):
            out.append(points.select(rows))
    return out


def _near_zero(sweep: Points) -> np.ndarray:
    """Mask (n,) of the points around zero slip; of a coarse sweep, those of the two slips next to it."""
    size, reach = np.abs(sweep.kappa), float(constants.SLIP_OF_THE_SLOPE)
    if np.ptp(sweep.kappa[size < reach]) < reach:
        reach = 1.01 * float(np.min(size[size >= reach]))
    near: np.ndarray = size < reach
    return near


def _slope(sweep: Points) -> float:
    """Slip stiffness over load [-] of a sweep."""
    near = _near_zero(sweep)
    slope = np.polyfit(sweep.kappa[near], sweep.Fx[near], 1)[0]
    return float(slope / np.mean(sweep.Fz[near]))


def _relative_loads(values: Mapping[str, float], sweeps: list[Points]) -> np.ndarray:
    nominal = values["FNOMIN"] * values["LFZO"]
    return np.array([float(np.mean(sweep.Fz)) / nominal - 1.0 for sweep in sweeps])


def _pure(values: dict[str, float], sweeps: list[Points]) -> dict[str, float]:
    """Friction, slip stiffness and curvature of Fx."""
    dfz = _relative_loads(values, sweeps)
    slope = np.array([_slope(sweep) for sweep in sweeps])
    friction = np.array([float(np.max(np.abs(sweep.Fx) / sweep.Fz)) for sweep in sweeps])
    PKX1, PKX2 = _line(dfz, slope / np.exp(values["PKX3"] * dfz), values["PKX2"])
    PDX1, PDX2 = _line(dfz, friction, values["PDX2"])
    found = {
        "PKX1": PKX1,
        "PKX2": PKX2,
        "PDX1": BY_NAME["PDX1"].inside(PDX1),
        "PDX2": PDX2,
    }
    curved = []
    for sweep, K, mu in zip(sweeps, slope, friction, strict=True):
        peak = float(np.abs(sweep.kappa[np.argmax(np.abs(sweep.Fx))]))
        C = values["PCX1"]
        x = K / (C * mu) * peak
        if x > 0.0 and 0.0 < peak < constants.PEAK_INSIDE * float(np.max(np.abs(sweep.kappa))):
            curved.append(peak_curvature(C, K / (C * mu), peak))
    if curved:
        found["PEX1"] = BY_NAME["PEX1"].inside(float(np.median(curved)))
    return found


def _line(x: np.ndarray, y: np.ndarray, slope: float) -> tuple[float, float]:
    """Value at x = 0 and slope of the line nearest to values over relative loads; of one load the slope is kept."""
    if levels.count(1.0 + x, levels.LOAD) < 2:
        return float(np.median(y - slope * x)), slope
    slope, value = np.polyfit(x, y, 1)
    return float(value), float(slope)


def _weight_of_sideslip(
    values: Mapping[str, float], straight: list[Points], both: list[Points]
) -> dict[str, float]:
    """RBX1: sideslip reduces the slip stiffness at zero slip by cos(RCX1 arctan(RBX1 alpha))."""
    dfz = _relative_loads(values, both)
    alone = (values["PKX1"] + values["PKX2"] * dfz) * np.exp(values["PKX3"] * dfz)
    ratio = np.array([_slope(sweep) for sweep in both]) / alone
    alpha = np.array([float(np.mean(np.abs(sweep.alpha))) for sweep in both])
    return _slope_factor("RBX1", ratio, alpha, values["RCX1"])


def _weight_of_slip(values: Mapping[str, float], both: list[Points]) -> dict[str, float]:
    """RBY1: longitudinal slip reduces Fy by cos(RCY1 arctan(RBY1 cos(arctan(RBY2 alpha)) kappa))."""
    ratio, slip = [], []
    for sweep in both:
        near = np.abs(sweep.kappa) < constants.SLIP_OF_THE_SLOPE
        far = np.abs(sweep.kappa) > 0.5 * float(np.max(np.abs(sweep.kappa)))
        rolling = float(np.mean(sweep.Fy[near]))
        alpha = float(np.mean(sweep.alpha))
        if rolling:
            ratio.append(float(np.mean(sweep.Fy[far])) / rolling)
            slip.append(
                float(np.mean(np.abs(sweep.kappa[far]))) * math.cos(math.atan(values["RBY2"] * alpha))
            )
    return _slope_factor("RBY1", np.array(ratio), np.array(slip), values["RCY1"])


def _slope_factor(name: str, weight: np.ndarray, slip: np.ndarray, C: float) -> dict[str, float]:
    """The slope factor B with which cos(C arctan(B slip)) has the values ``weight``; nothing where these do not show it."""
    low, high = constants.READABLE_WEIGHTS
    clear = (weight > low) & (weight < high) & (slip > 0.0)
    if not np.any(clear):
        return {}
    angle = np.minimum(np.arccos(weight[clear]) / C, 0.49 * math.pi)
    return {name: BY_NAME[name].inside(float(np.median(np.tan(angle) / slip[clear])))}
