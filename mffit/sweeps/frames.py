"""Conversion from the wheel-carrier frame C to the contact frame W, and from the wheel centre to the contact point.

TYDEX names axes and reference point with the last letter of a channel: C is turned with the wheel carrier and H is horizontal,
both at the wheel centre; W is horizontal at the contact point. On a flat road H and W are parallel, and x is the same in all.

Frames C and W share the x axis. C leans with the wheel: a camber ``gamma > 0`` moves the top of the wheel to -y, so
that ``z_C = (0, -sin gamma, cos gamma)`` and ``y_C = (0, cos gamma, sin gamma)``. A force ``(Fy, Fz)`` in W
is ``Fy_C = Fy cos gamma + Fz sin gamma``, ``Fz_C = Fz cos gamma - Fy sin gamma`` in C; moments about the same point
transform likewise.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.config.models import MachineTable
from mffit.constants import MOST
from mffit.sweeps import constants
from mffit.sweeps.sweep import Sweep

TYDEX_NAME = re.compile(r"[FM][XYZ]([CHW])", re.IGNORECASE)
FORCES, MOMENTS = ("Fy_N", "Fz_N"), ("Mx_Nm", "My_Nm", "Mz_Nm")


class FileFrame(NamedTuple):
    """Axes and reference point in which a file reports."""

    forces_lean: bool  #: the forces are in frame C
    moments_lean: bool
    at_centre: bool  #: the moments are about the wheel centre
    load_is_vertical: bool | None = None  #: None if the headings do not state it


class MixedAxesError(ValueError):
    """Forces, or moments, of one file are in different axes."""


def letter_of(heading: str) -> str:
    """The letter by which TYDEX names the axes of a channel, C, H or W; "" for another heading."""
    found = TYDEX_NAME.fullmatch(heading)
    return found[1].upper() if found else ""


def frame_of(headings: Mapping[str, str], rig: MachineTable) -> FileFrame:
    """The frame of a file: by TYDEX's letters in its headings (by contract column), else as ``[rig]`` declares.

    Raises MixedAxesError if the moments are not all in the same axes, or the load is in C and the side force is not.
    """
    letters = {name: letter_of(headings[name]) for name in (*FORCES, *MOMENTS) if name in headings}
    of_moments = {letters[name] for name in MOMENTS if name in letters}
    side, load = (letters.get(name, "") for name in FORCES)
    if len(of_moments) > 1:
        raise MixedAxesError(_mixed([headings[name] for name in MOMENTS if name in headings]))
    if load == "C" and side != "C":
        raise MixedAxesError(_mixed([headings[name] for name in FORCES]))
    letter = "".join(of_moments)
    declared = rig.force_frame == "C"
    return FileFrame(
        forces_lean=side == "C" if side else declared,
        moments_lean=letter == "C" if letter else declared,
        at_centre=letter in ("C", "H") if letter else rig.moments == "wheel-centre",
        load_is_vertical=load != "C" if side and load else None,
    )


def _mixed(headings: Sequence[str]) -> str:
    return f"{' and '.join(headings)} are in different axes by TYDEX's letters; take columns with the same letter"


def forces_turned(sweep: Sweep, *, load_is_vertical: bool) -> Sweep:
    """The sweep, in ISO signs, with forces turned from C to W; ``load_is_vertical``: the load column is not along the wheel
    plane.
    """
    c, s = np.cos(sweep.gamma), np.sin(sweep.gamma)
    if load_is_vertical:
        return replace(sweep, Fy=(sweep.Fy - s * sweep.Fz) / c)
    return replace(sweep, Fy=c * sweep.Fy - s * sweep.Fz, Fz=c * sweep.Fz + s * sweep.Fy)


def moments_turned(sweep: Sweep) -> Sweep:
    """The sweep with moments turned from C to W, in ISO signs. Without My, the part of rolling resistance in Mz is neglected."""
    c, s = np.cos(sweep.gamma), np.sin(sweep.gamma)
    measured = np.isfinite(sweep.My)
    Mz = np.where(measured, c * sweep.Mz + s * np.where(measured, sweep.My, 0.0), sweep.Mz / c)
    return replace(sweep, My=c * sweep.My - s * sweep.Mz, Mz=Mz)


def to_contact_point(sweep: Sweep, *, unloaded_radius: float) -> Sweep:
    """The sweep, in ISO signs and frame W, with moments about the contact point instead of the wheel centre.

    The centre is at ``l = RL (0, -sin gamma, cos gamma)`` from the contact point, and ``M = M_centre + l x F``: Mx decreases by
    ``RL (Fy cos gamma + Fz sin gamma)``, My increases by ``RL Fx cos gamma`` and Mz by ``RL Fx sin gamma``. Without a loaded
    radius (``RL_m``) the unloaded one [m] is the lever; without Fx, the wheel is assumed to roll freely.
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

    Rigs control the vertical load, so it varies little along a cambered sweep. The column is therefore interpreted in the way
    that makes the vertical load vary less. Without cambered sweeps both interpretations give the same forces.
    """
    as_given, turned = [], []
    for sweep in sweeps:
        if np.max(np.abs(sweep.gamma)) < constants.CAMBER_THAT_TURNS_LOAD.rad:
            continue
        as_given.append(np.abs(np.diff(sweep.Fz)) / sweep.Fz[1:])
        vertical = forces_turned(sweep, load_is_vertical=False).Fz
        turned.append(np.abs(np.diff(vertical)) / sweep.Fz[1:])
    if not as_given:
        return False
    limit = MOST * np.median(np.concatenate(turned))
    return bool(np.median(np.concatenate(as_given)) < limit)
