"""From the wheel-carrier frame C to the contact frame W, and from the wheel centre to the contact point.

Both frames share the x axis. C leans with the wheel: a camber ``gamma > 0`` moves the top of the wheel to -y, so
that ``z_C = (0, -sin gamma, cos gamma)`` and ``y_C = (0, cos gamma, sin gamma)``. A force ``(Fy, Fz)`` in W
is ``Fy_C = Fy cos gamma + Fz sin gamma``, ``Fz_C = Fz cos gamma - Fy sin gamma`` in C; so are moments about the same point.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.sweeps import constants
from mffit.sweeps.sweep import Sweep


def to_contact_frame(sweep: Sweep, *, load_is_vertical: bool) -> Sweep:
    """The sweep with forces and moments turned from C to W.

    Parameters
    ----------
    sweep : rows in ISO signs, frame C
    load_is_vertical : the load column is the vertical load, not the component along the wheel plane

    Notes
    -----
    If My was not measured, the contribution of rolling resistance to Mz is neglected.
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
    """The sweep with moments about the contact point instead of the wheel centre.

    Parameters
    ----------
    sweep : rows in ISO signs, frame W
    unloaded_radius : lever [m] if the file has no loaded radius (``RL_m``)

    Notes
    -----
    The centre is at ``l = RL (0, -sin gamma, cos gamma)`` from the contact point, and ``M = M_centre + l x F``: Mx decreases
    by ``RL (Fy cos gamma + Fz sin gamma)``, My increases by ``RL Fx cos gamma`` and Mz by ``RL Fx sin gamma``. If Fx was not
    measured, the wheel is assumed to roll freely.
    """
    lever = np.where(np.isfinite(sweep.RL), sweep.RL, unloaded_radius)
    Fx = np.nan_to_num(sweep.Fx)
    c, s = np.cos(sweep.gamma), np.sin(sweep.gamma)
    return replace(
        sweep,
        Mx=sweep.Mx - lever * (c * sweep.Fy + s * sweep.Fz),
        My=sweep.My + lever * c * Fx,
        Mz=sweep.Mz + lever * s * Fx,
    )


def load_is_vertical(sweeps: Sequence[Sweep]) -> bool:
    """Whether the load column is the vertical load, although the forces are in frame C.

    Rigs control the vertical load, so it varies little along a cambered sweep. The interpretation of the column with the
    smaller variation is right. Without cambered sweeps both give the same forces.
    """
    as_given, turned = [], []
    for sweep in sweeps:
        if np.max(np.abs(sweep.gamma)) < constants.CAMBER_THAT_TURNS_LOAD.rad:
            continue
        as_given.append(np.abs(np.diff(sweep.Fz)) / sweep.Fz[1:])
        vertical = to_contact_frame(sweep, load_is_vertical=False).Fz
        turned.append(np.abs(np.diff(vertical)) / sweep.Fz[1:])
    if not as_given:
        return False
    limit = constants.STEADIER_LOAD_RATIO * np.median(np.concatenate(turned))
    return bool(np.median(np.concatenate(as_given)) < limit)
