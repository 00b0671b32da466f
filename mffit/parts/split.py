"""Symmetric decomposition (4), (25): the part of the readings that changes sign with the angles, and the rest.

It takes pairs of points at (alpha, gamma) and (-alpha, -gamma) under the same condition.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from mffit.brief import Brief
from mffit.constants import SAME_SIDESLIP, STRAIGHT, UPRIGHT
from mffit.parts import constants
from mffit.points import Points, levels
from tir.errors import counted, listed, some
from tir.frozen import ReadOnlyArrays

READ = ("Fy", "Mz", "u_Fy", "u_Mz")


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


def _interpolated(points: Points, index: np.ndarray, angle: np.ndarray, at: float) -> dict[str, float] | None:
    """Readings at ``at`` [deg], interpolated along some points; None clearly outside their range or with too few angles."""
    angles, own = np.unique(np.round(angle[index], 3), return_inverse=True)
    if len(angles) < constants.FEWEST_ANGLES_TO_INTERPOLATE:
        return None
    first, last = constants.BEYOND_THE_END * np.diff(angles)[[0, -1]]
    if not angles[0] - first <= at <= angles[-1] + last:
        return None
    from scipy.interpolate import PchipInterpolator  # loads in a third of a second, which other data save

    out = {}
    for name in ("Fy", "Mz"):
        means = np.bincount(own, getattr(points, name)[index]) / np.bincount(own)
        out[name] = float(PchipInterpolator(angles, means)(at)) if np.all(np.isfinite(means)) else np.nan
    nearest = index[own == np.argmin(np.abs(angles - at))][0]
    return out | {"u_Fy": float(points.u_Fy[nearest]), "u_Mz": float(points.u_Mz[nearest])}


@dataclass(frozen=True, slots=True, repr=False)
class Parts(ReadOnlyArrays, Brief):
    """Odd and even part at every point; arrays (n,), NaN where a point has no mirror."""

    Fy_odd: np.ndarray  #: [F(a, g) - F(-a, -g)] / 2 [N]
    Fy_even: np.ndarray  #: F - odd part [N]
    Mz_odd: np.ndarray  #: [Nm]
    Mz_even: np.ndarray  #: [Nm]
    u_Fy_odd: np.ndarray  #: standard uncertainty of either part [N]
    u_Mz_odd: np.ndarray  #: [Nm]
    paired: np.ndarray  #: "exact" | "interpolated" | "unpaired"
    partner: np.ndarray  #: index of the mirror, -1 if interpolated or unpaired
    unpaired: tuple[str, ...]  #: a sentence about points whose mirror the programme lacks, if there are any
    alpha_odd: np.ndarray  #: sideslip of the odd part [rad]: the reading, corrected for known play

    def among(self, points: Points, rows: np.ndarray) -> Parts:
        """The parts of a larger set of ``points`` (n,) that contains these (mask (n,)); the others have no mirror."""

        def spread(name: str, others: Any) -> np.ndarray:
            own = getattr(self, name)
            out = np.full(len(points), others, dtype=own.dtype)
            out[rows] = own
            return out

        index = np.flatnonzero(rows)
        return Parts(
            **{name: spread(name, np.nan) for name in NUMBERS},
            paired=spread("paired", "unpaired"),
            partner=np.where((partner := spread("partner", -1)) < 0, -1, index[partner]),
            unpaired=self.unpaired,
            alpha_odd=np.where(rows, spread("alpha_odd", 0.0), points.alpha),
        )


NUMBERS = ("Fy_odd", "Fy_even", "Mz_odd", "Mz_even", "u_Fy_odd", "u_Mz_odd")
"""Fields of :class:`Parts` that are NaN without a mirror."""


def split(points: Points) -> Parts:
    """Decompose Fy and Mz of every point by mirror symmetry.

    The mirror of a point is a measured one within tolerance, if possible of the same sweep; otherwise readings are interpolated
    over alpha at the mirrored camber, or over gamma at the mirrored sideslip, within one condition and hardly beyond
    its ends. On a straight path, which has no turn slip to remove, all points stay unpaired, without a remark, as do points
    whose mirrored set-point was run but is not held closely enough.
    """
    n = len(points)
    partner = np.full(n, -1)
    paired = np.full(n, "unpaired", dtype="<U12")
    mirror = {name: np.full(n, np.nan) for name in READ}
    angles = np.degrees(np.column_stack([points.alpha, points.gamma]))
    tolerance = np.array([SAME_SIDESLIP, constants.SAME_CAMBER])
    of_programme, lacking = np.array([STRAIGHT, UPRIGHT]), np.zeros(n, dtype=bool)
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
                lacking[i] = values is None and not np.any(np.all(off < of_programme, axis=1))
            for name, value in (values or {}).items():
                mirror[name][i] = value
    Fy_odd, Mz_odd = (points.Fy - mirror["Fy"]) / 2.0, (points.Mz - mirror["Mz"]) / 2.0
    return Parts(
        Fy_odd=Fy_odd,
        Fy_even=points.Fy - Fy_odd,
        Mz_odd=Mz_odd,
        Mz_even=points.Mz - Mz_odd,
        u_Fy_odd=np.hypot(points.u_Fy, mirror["u_Fy"]) / 2.0,
        u_Mz_odd=np.hypot(points.u_Mz, mirror["u_Mz"]) / 2.0,
        paired=paired,
        partner=partner,
        unpaired=_without_mirror(points, lacking),
        alpha_odd=points.alpha,
    )


def _without_mirror(points: Points, lacking: np.ndarray) -> tuple[str, ...]:
    """A sentence about the points of the mask (n,), which have no mirror, with their sweeps and angles; none without any."""
    if not np.any(lacking):
        return ()
    alpha_deg, gamma_deg = np.degrees(points.alpha[lacking]), np.degrees(points.gamma[lacking])
    angles = [f"({a:.2g}, {g:.2g})" for a, g in zip(alpha_deg, gamma_deg, strict=True)]
    sweeps, numbers = np.unique(points.sweep[lacking], return_counts=True)
    each = [f"{n} in {points.sweep_names[k]}" for k, n in zip(sweeps, numbers, strict=True)]
    return (
        f"no mirror (-alpha, -gamma) was measured for {counted(len(angles), 'point')}, which can only be used raw: "
        f"{listed(each)}; (alpha, gamma) = {some(list(dict.fromkeys(angles)))} deg",
    )
