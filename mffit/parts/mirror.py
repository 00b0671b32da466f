"""Pairs of points at (alpha, gamma) and (-alpha, -gamma) under the same condition."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.interpolate import PchipInterpolator

from mffit.constants import SAME_SIDESLIP
from mffit.parts import constants
from mffit.points import Points, levels

READ = ("Fy", "Mz", "u_Fy", "u_Mz")


class Mirrors(NamedTuple):
    """Readings of the mirror of every point (n,), and how they were found."""

    partner: np.ndarray  #: index of the mirror; -1 if interpolated or unpaired
    Fy: np.ndarray  #: side force of the mirror [N]; NaN if unpaired
    Mz: np.ndarray  #: [Nm]
    u_Fy: np.ndarray
    u_Mz: np.ndarray
    paired: np.ndarray  #: "exact" | "interpolated" | "unpaired"


def conditions(points: Points) -> list[np.ndarray]:
    """Rows (m,) of the points run at one level of load, pressure, speed and slip, on one path, in one set-up, mount and way."""
    settings = {
        levels.LOAD: points.Fz,
        levels.PRESSURE: points.p,
        levels.SPEED: points.V,
        levels.SLIP: points.kappa,
    }
    keys = [levels.nearest_labels(values, kind) for kind, values in settings.items()]
    return levels.rows_of_equal(
        np.column_stack([*keys, points.phi_t, points.setup, points.mount, points.direction])
    )


def find_mirrors(points: Points) -> Mirrors:
    """The mirror of every point: a measured one within tolerance, otherwise one interpolated along the mirrored sweep.

    A mirror in the same sweep is preferred. Readings are interpolated over alpha at the mirrored camber, or over gamma at
    the mirrored sideslip, within one condition and without extrapolation. On a straight path, which has no turn slip to
    remove, all points stay unpaired.
    """
    n = len(points)
    partner = np.full(n, -1)
    paired = np.full(n, "unpaired", dtype="<U12")
    found = {name: np.full(n, np.nan) for name in READ}
    angles = np.degrees(np.column_stack([points.alpha, points.gamma]))
    tolerance = np.array([SAME_SIDESLIP, constants.SAME_CAMBER])
    for rows in conditions(points) if np.any(points.phi_t) else ():
        for i in rows.tolist():
            off = np.abs(angles[rows] + angles[i])
            near = off < tolerance
            close = rows[np.all(near, axis=1)]
            values: dict[str, float] | None
            if len(close):
                other = points.sweep[close] != points.sweep[i]
                j = int(close[np.lexsort((np.sum(off[np.all(near, axis=1)], axis=1), other))[0]])
                partner[i], paired[i] = j, "exact"
                values = {name: float(getattr(points, name)[j]) for name in READ}
            else:
                along = (
                    _interpolated(points, rows[near[:, 1 - k]], angles[:, k], -angles[i, k]) for k in (0, 1)
                )
                values = next((line for line in along if line is not None), None)
                paired[i] = "unpaired" if values is None else "interpolated"
            for name, value in (values or {}).items():
                found[name][i] = value
    return Mirrors(partner=partner, paired=paired, **found)


def _interpolated(points: Points, index: np.ndarray, angle: np.ndarray, at: float) -> dict[str, float] | None:
    """Readings at ``at`` [deg], interpolated along some points; None outside their range or with too few angles."""
    angles, own = np.unique(np.round(angle[index], 3), return_inverse=True)
    if len(angles) < constants.FEWEST_ANGLES_TO_INTERPOLATE or not angles[0] <= at <= angles[-1]:
        return None
    out = {}
    for name in ("Fy", "Mz"):
        means = np.bincount(own, getattr(points, name)[index]) / np.bincount(own)
        out[name] = float(PchipInterpolator(angles, means)(at)) if np.all(np.isfinite(means)) else np.nan
    nearest = index[own == np.argmin(np.abs(angles - at))][0]
    return out | {"u_Fy": float(points.u_Fy[nearest]), "u_Mz": float(points.u_Mz[nearest])}
