"""From the wheel-carrier frame C to the contact frame W, and from the wheel centre to the contact point.

Both share the x axis. C leans with the wheel: with camber ``gamma > 0`` the top of the wheel goes to -y, so
that ``z_C = (0, -sin gamma, cos gamma)`` and ``y_C = (0, cos gamma, sin gamma)``. A force ``(Fy, Fz)`` of W
reads ``Fy_C = Fy cos gamma + Fz sin gamma``, ``Fz_C = Fz cos gamma - Fy sin gamma``; moments about one point
likewise. The lever from contact point to wheel centre lies along z_C and leaves Mz alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.sweeps.sweep import Sweep

CAMBERED = np.radians(5.0)
"""Below this camber both readings of the load agree within its control."""


def to_contact_frame(sweep: Sweep, *, load_is_vertical: bool) -> Sweep:
    """Turn the forces and moments of a sweep from C to W.

    Parameters
    ----------
    sweep : rows in ISO signs, frame C
    load_is_vertical : the load column is the vertical load, not the component along the wheel plane

    Notes
    -----
    Without My the rolling resistance about the W axis is neglected beside the aligning moment.
    """
    c, s = np.cos(sweep.gamma), np.sin(sweep.gamma)
    if load_is_vertical:
        Fy, Fz = (sweep.Fy - s * sweep.Fz) / c, sweep.Fz
    else:
        Fy, Fz = c * sweep.Fy - s * sweep.Fz, c * sweep.Fz + s * sweep.Fy
    measured = np.isfinite(sweep.My)
    Mz = np.where(measured, c * sweep.Mz + s * np.where(measured, sweep.My, 0.0), sweep.Mz / c)
    return replace(sweep, Fy=Fy, Fz=Fz, My=c * sweep.My - s * sweep.Mz, Mz=Mz)


def to_contact_point(sweep: Sweep, *, unloaded_radius: float) -> Sweep:
    """Moments about the wheel centre as moments about the contact point.

    Parameters
    ----------
    sweep : rows in ISO signs, frame W
    unloaded_radius : lever [m] where the file has no loaded radius (``RL_m``)

    Notes
    -----
    The centre lies at ``l = RL (0, -sin gamma, cos gamma)`` from the contact point, and ``M = M_centre + l x F``: Mx loses
    ``RL (Fy cos gamma + Fz sin gamma)``, My gains ``RL Fx cos gamma`` and Mz ``RL Fx sin gamma``. Where Fx was not
    measured the wheel is taken to roll freely.
    """
    table, zero = sweep.table, np.zeros(len(sweep))
    lever = table["RL_m"].to_numpy(float) if "RL_m" in table else zero + unloaded_radius
    Fx = np.nan_to_num(table["Fx_N"].to_numpy(float)) if "Fx_N" in table else zero
    c, s = np.cos(sweep.gamma), np.sin(sweep.gamma)
    return replace(
        sweep,
        Mx=sweep.Mx - lever * (c * sweep.Fy + s * sweep.Fz),
        My=sweep.My + lever * c * Fx,
        Mz=sweep.Mz + lever * s * Fx,
    )


def load_is_vertical(sweeps: Sequence[Sweep]) -> bool:
    """Whether the load column of rows in frame C is the vertical load all the same.

    Rigs control the vertical load. Along a cambered sweep it changes little from row to row; of the two
    readings of the column the one is taken in which it does so. Without such sweeps it makes no difference.
    """
    as_given, turned = [], []
    for sweep in sweeps:
        if np.max(np.abs(sweep.gamma)) < CAMBERED:
            continue
        as_given.append(np.abs(np.diff(sweep.Fz)) / sweep.Fz[1:])
        vertical = to_contact_frame(sweep, load_is_vertical=False).Fz
        turned.append(np.abs(np.diff(vertical)) / sweep.Fz[1:])
    if not as_given:
        return False
    return bool(np.median(np.concatenate(as_given)) < 0.5 * np.median(np.concatenate(turned)))
