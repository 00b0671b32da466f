"""The tyre on the faulty rig: what it really does, and what the rig reports of it.

The faults are worked out here a second time, apart from :mod:`mffit.rig`, so that a mistake there cannot
hide in the data that are meant to show it. Everything is in ISO-W, contact frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from mffit.virtual_rig.faults import Faults
from mffit.virtual_rig.settings import Settings
from tir import Tyre
from tir.evaluate import evaluate, turned_on_rim

REFERENCE_TEMPERATURE = 25.0  # degC, where the property file holds
HALVINGS = 20  # of the play, which leave a millionth of it


class Channels(NamedTuple):
    """Forces [N] and moments [Nm] on the wheel; arrays (n,)."""

    Fy: np.ndarray
    Fz: np.ndarray
    Mx: np.ndarray
    My: np.ndarray
    Mz: np.ndarray


class Machine(NamedTuple):
    """A tyre on a rig."""

    tyre: Tyre  #: the one that is really on it
    faults: Faults
    phi_t_sign: int  #: of the usual path: -1 with the centre to the left, 0 on a flat track
    usual_speed: float  #: [m/s], where the speed has no influence


def steady(machine: Machine, settings: Settings) -> Channels:
    """What the rig reports once everything has settled, without noise."""
    return reported(machine, settings, at_the_tyre(machine, settings, true_alpha(machine, settings)))


def true_alpha(machine: Machine, settings: Settings) -> np.ndarray:
    """Sideslip angle (n,) that the tyre really has [rad]: reading, misalignment and play."""
    alpha = settings.alpha + math.radians(machine.faults.alpha_0_deg)
    half_play = math.radians(machine.faults.backlash_deg) / 2.0
    if half_play == 0.0:
        return alpha
    return taken_up(lambda x: at_the_tyre(machine, settings, x).Mz, alpha, half_play)


def taken_up(moment: Callable[[np.ndarray], np.ndarray], alpha: np.ndarray, half_play: float) -> np.ndarray:
    """Where the moment holds a wheel that is free by ``half_play`` on either side of ``alpha``; (n,) [rad].

    A positive moment holds it at ``alpha - half_play``, a negative one at ``alpha + half_play``. Where the
    moment changes sign within the play, the wheel floats at the angle without moment.
    """
    lower, upper = alpha - half_play, alpha + half_play
    at_lower, at_upper = moment(lower) > 0.0, moment(upper) < 0.0
    either = moment(alpha) > 0.0
    held_at_lower = at_lower & (~at_upper | either)
    floats = ~at_lower & ~at_upper
    for _ in range(HALVINGS if floats.any() else 0):
        middle = 0.5 * (lower + upper)
        turns_back = moment(middle) > 0.0
        lower, upper = np.where(turns_back, lower, middle), np.where(turns_back, middle, upper)
    held = np.where(held_at_lower, alpha - half_play, alpha + half_play)
    return np.where(floats, 0.5 * (lower + upper), held)


def at_the_tyre(machine: Machine, settings: Settings, alpha: np.ndarray) -> Channels:
    """Forces and moments (n,) of the tyre at the true sideslip angle ``alpha`` (n,) [rad]."""
    gamma = settings.gamma + math.radians(machine.faults.gamma_0_deg)
    # The scale along which the wheel is moved from path to path is right; its zero is what the radius is off.
    phi_t = machine.phi_t_sign * settings.side / (machine.faults.path_radius_m + settings.outward)
    mounted = turned_on_rim(machine.tyre.p, settings.mount)
    out, _ = evaluate(
        mounted,
        settings.Fz,
        alpha,
        gamma,
        0.0,
        phi_t,
        settings.Vx,
        settings.p,
        turn_slip=machine.phi_t_sign != 0,
    )
    return Channels(out.Fy, out.Fz, out.Mx, out.My, out.Mz)


def reported(machine: Machine, settings: Settings, true: Channels) -> Channels:
    """What the load cells make of the true forces and moments."""
    faults = machine.faults
    warmth = 1.0 + faults.k_T_per_K * (settings.T - REFERENCE_TEMPERATURE)
    speed = 1.0 + faults.k_V_per_mps * (settings.V - machine.usual_speed)
    surroundings = warmth * speed * (1.0 + faults.k_t_per_s * settings.t)
    Fy = faults.gain * surroundings * true.Fy + faults.F0_N + faults.crosstalk * true.Fz
    return true._replace(Fy=Fy, Mz=surroundings * true.Mz + faults.M0_Nm)
