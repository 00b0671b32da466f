"""Points as the rig would report them if the tyre were the given model."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from mffit.points import Points
from mffit.rig.faults import NO_FAULTS, REFERENCE_TEMPERATURE, RigFaults
from tir.evaluate import evaluate, turned_on_rim


class Readings(NamedTuple):
    """What the rig reports; arrays (n,)."""

    Fy: np.ndarray  #: [N]
    Mz: np.ndarray  #: [Nm]


class Conditions(NamedTuple):
    """What the tyre really sees; arrays (n,)."""

    alpha: np.ndarray  #: [rad]
    gamma: np.ndarray  #: [rad]
    phi_t: np.ndarray  #: [1/m]


def readings(
    tyre: Any, points: Points, faults: RigFaults = NO_FAULTS, *, turn_slip: bool = True, star: bool = False
) -> Readings:
    """Simulate the rig at every point.

    Parameters
    ----------
    tyre : a ``tir.Tyre`` or any object with the file's parameter names as attributes
    points : set-points (n,): angles as read, load, pressure, speed, direction, mount and path curvature
    faults : rig faults and environment
    turn_slip : whether the simulation knows path curvature and spin
    star : tan(alpha), sin(gamma) as inputs

    Returns
    -------
    Readings
        Fy [N] and Mz [Nm] in ISO-W, contact frame, rig-fixed also when rolling backwards.
    """
    p = getattr(tyre, "p", tyre)
    if np.any(points.mount < 0):
        p = turned_on_rim(p, points.mount)
    seen = true_conditions(points, faults)

    def forces(alpha):
        return evaluate(
            p,
            points.Fz,
            alpha,
            seen.gamma,
            0.0,
            seen.phi_t,
            points.Vx,
            points.p,
            turn_slip=turn_slip,
            star=star,
        )[0]

    out = forces(seen.alpha)
    if faults.backlash_deg:
        play = math.radians(faults.backlash_deg) / 2.0
        out = forces(seen.alpha - play * np.sign(out.Mz))
    environment = environment_factor(points, faults)
    Fy = faults.gain * out.Fy * environment + faults.F0_N + faults.crosstalk * points.Fz
    return Readings(Fy, out.Mz * environment + faults.M0_Nm)


def true_conditions(points: Points, faults: RigFaults) -> Conditions:
    """Angles and path curvature behind the readings, but for backlash, which depends on the moment."""
    phi_t = points.phi_t
    if not math.isnan(faults.path_radius_m):
        phi_t = np.sign(phi_t) / faults.path_radius_m
    return Conditions(
        points.alpha + math.radians(faults.alpha_0_deg),
        points.gamma + math.radians(faults.gamma_0_deg),
        phi_t,
    )


def environment_factor(points: Points, faults: RigFaults) -> np.ndarray:
    """Factor (n,) on Fy and Mz; a channel that was not measured has no influence."""
    factor = np.ones(len(points))
    factor += faults.k_T_per_K * np.nan_to_num(points.T - REFERENCE_TEMPERATURE)
    if faults.k_V_per_mps:
        factor *= 1.0 + faults.k_V_per_mps * np.nan_to_num(points.V - reference_speed(points))
    return factor * (1.0 + faults.k_t_per_s * np.nan_to_num(points.t))


def reference_speed(points: Points) -> float:
    """The most frequent speed of the data [m/s], to 0.1 m/s."""
    values, counts = np.unique(np.round(points.V[np.isfinite(points.V)], 1), return_counts=True)
    return float(values[counts.argmax()])
