"""Pairs of points at (alpha, gamma) and (-alpha, -gamma) under the same condition."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from mffit.constants import SAME_SIDESLIP
from mffit.parts import constants
from mffit.points import Points


class Mirrors(NamedTuple):
    """Readings of the mirror of every point (n,), and how they were found."""

    partner: np.ndarray  #: index of the mirror; -1 if interpolated or unpaired
    Fy: np.ndarray  #: side force of the mirror [N]; NaN if unpaired
    Mz: np.ndarray  #: [Nm]
    u_Fy: np.ndarray
    u_Mz: np.ndarray
    paired: np.ndarray  #: "exact" | "interpolated" | "unpaired"


def same_condition(points: Points, i: int) -> np.ndarray:
    """Mask (n,) of the points run at the load, pressure, speed, direction, mount, path and set-up of point i."""
    same: np.ndarray = (
        (np.abs(points.Fz - points.Fz[i]) < constants.SAME_LOAD * points.Fz[i])
        & (np.abs(points.p - points.p[i]) < constants.SAME_PRESSURE * 1e3)
        & (np.abs(points.V - points.V[i]) <= constants.SAME_SPEED * points.V[i])
        & (points.direction == points.direction[i])
        & (points.mount == points.mount[i])
        & np.isclose(points.phi_t, points.phi_t[i])
        & (points.setup == points.setup[i])
        & (np.abs(points.kappa - points.kappa[i]) < constants.SAME_SLIP)
    )
    return same


def find_mirrors(points: Points) -> Mirrors:
    """The mirror of every point: a measured one within tolerance, otherwise one interpolated along the mirrored sweep.

    A mirror in the same sweep is preferred. Readings are interpolated over alpha at the mirrored camber, or over gamma at
    the mirrored sideslip, within one condition and without extrapolation. On a straight path, which has no turn slip to
    remove, all points stay unpaired.
    """
    n = len(points)
    partner = np.full(n, -1)
    paired = np.full(n, "unpaired", dtype="<U12")
    values = {name: np.full(n, np.nan) for name in ("Fy", "Mz", "u_Fy", "u_Mz")}
    alpha, gamma = np.degrees(points.alpha), np.degrees(points.gamma)
    for i in range(n) if np.any(points.phi_t) else ():
        same = same_condition(points, i)
        d_alpha, d_gamma = np.abs(alpha + alpha[i]), np.abs(gamma + gamma[i])
        close = same & (d_alpha < SAME_SIDESLIP) & (d_gamma < constants.SAME_CAMBER)
        if np.any(close):
            distance = d_alpha + d_gamma + constants.OTHER_SWEEP_DISTANCE * (points.sweep != points.sweep[i])
            j = int(np.argmin(np.where(close, distance, np.inf)))
            partner[i], paired[i] = j, "exact"
            for name, found in values.items():
                found[i] = getattr(points, name)[j]
            continue
        line = same & (d_gamma < constants.SAME_CAMBER)
        found_values = _interpolated(points, line, alpha, -alpha[i])
        if found_values is None:
            line = same & (d_alpha < SAME_SIDESLIP)
            found_values = _interpolated(points, line, gamma, -gamma[i])
        if found_values is not None:
            paired[i] = "interpolated"
            for name, found in values.items():
                found[i] = found_values[name]
    return Mirrors(partner, values["Fy"], values["Mz"], values["u_Fy"], values["u_Mz"], paired)


def _interpolated(points: Points, line: np.ndarray, x: np.ndarray, at: float) -> dict[str, float] | None:
    """Readings at ``at``, interpolated along the points of ``line``; None outside their range or with too few of them."""
    index = np.flatnonzero(line)
    angles = np.unique(np.round(x[index], 3))
    if len(angles) < constants.FEWEST_ANGLES_TO_INTERPOLATE or not angles[0] <= at <= angles[-1]:
        return None
    groups = [index[np.abs(x[index] - angle) < constants.REPEATED_ANGLE] for angle in angles]
    out = {}
    for name in ("Fy", "Mz"):
        means = np.array([np.mean(getattr(points, name)[g]) for g in groups])
        out[name] = float(PchipInterpolator(angles, means)(at)) if np.all(np.isfinite(means)) else np.nan
    nearest = groups[int(np.argmin(np.abs(angles - at)))][0]
    out["u_Fy"], out["u_Mz"] = float(points.u_Fy[nearest]), float(points.u_Mz[nearest])
    return out
