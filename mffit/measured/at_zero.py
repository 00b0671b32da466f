"""What the wheel reads at zero sideslip and camber of one load, and the turn-slip force, moment and eps_gamma in it."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config, path_curvature
from mffit.errors import InputError
from mffit.measured import camber_reduction as method
from mffit.measured.alignment import DEFAULT_U_FORCE, DEFAULT_U_MOMENT
from mffit.measured.groups import UPRIGHT, LoadGroup, zeros
from mffit.measured.notes import ZerosDisagree
from mffit.measured.paths import PathForce, by_path
from mffit.measured.slopes import slope_at_zero
from mffit.measured.stiffnesses import CUBIC_CAMBER, sweep
from mffit.points import Points

UNLIKE = 5.0
"""Standard uncertainties of a difference beyond which two zeros are not of the same path."""
NEAR_ZERO = math.radians(1.2)
"""Within this sideslip a parabola describes the side force to a newton."""


class Zero(NamedTuple):
    """Forces and moment at zero sideslip and camber of one load."""

    forward: float  #: [N], the sideslip of backlash removed
    backward: float  #: NaN without backward runs
    u_forward: float
    u_backward: float
    moment: UFloat | None  #: turn-slip moment [Nm]
    alpha_b: float  #: sideslip that backlash makes at the forward zero [rad]


def _zero(points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config) -> Zero:
    """Forces and moments at zero sideslip in both directions, backlash taken off."""
    slope = _slope(C_alpha, group)
    u_Fy = np.where(np.isfinite(points.u_Fy), points.u_Fy, DEFAULT_U_FORCE)
    u_Mz = np.where(np.isfinite(points.u_Mz), points.u_Mz, DEFAULT_U_MOMENT)
    forward = _at_zero(points, group, 1, points.Fy, u_Fy, slope)
    backward = _at_zero(points, group, -1, points.Fy, u_Fy, -slope)
    moments = [_at_zero(points, group, direction, points.Mz, u_Mz, None) for direction in (1, -1)]
    known = [
        method.named(value, u, "noise of the zero moment", "Nm")
        for value, u in moments
        if math.isfinite(value)
    ]
    moment = (known[0] - known[1]) / 2.0 if len(known) == 2 else known[0] if known else None
    i = zeros(points, group, 1)
    play_sign = float(np.sign(np.mean(points.alpha[i]))) if len(i) and config.rig.backlash_deg else 0.0
    return Zero(forward[0], backward[0], forward[1], backward[1], moment, play_sign)


def _slope(C_alpha: UFloat | None, group: LoadGroup) -> float:
    """The cornering stiffness [N/rad]; a usual one where none was measured."""
    return float(C_alpha.nominal_value) if C_alpha is not None else -10.0 * group.load


def _at_zero(
    points: Points, group: LoadGroup, direction: int, y, u, slope: float | None
) -> tuple[float, float]:
    """Value at zero sideslip and its u: a local parabola through five points or more, else the mean of the zeros.

    ``slope`` takes the zeros that backlash has moved off zero back to it; NaN if the direction was not run.
    """
    i = zeros(points, group, direction)
    i = i[np.isfinite(y[i])]
    if not len(i):
        return math.nan, math.nan
    near = group.index[
        (np.abs(points.alpha[group.index]) < NEAR_ZERO)
        & (np.abs(points.gamma[group.index]) < UPRIGHT)
        & (points.direction[group.index] == direction)
        & np.isfinite(y[group.index])
    ]
    x = points.alpha[near]
    if len(np.unique(np.round(x, 3))) >= 5 and x.min() < -NEAR_ZERO / 2 and x.max() > NEAR_ZERO / 2:
        A = np.vander(x, 3) / u[near, None]
        cov = np.linalg.inv(A.T @ A)
        return float((cov @ A.T @ (y[near] / u[near]))[2]), float(np.sqrt(cov[2, 2]))
    values = y[i] - (slope * points.alpha[i] if slope is not None else 0.0)
    return float(np.mean(values)), float(np.sqrt(np.sum(u[i] ** 2)) / len(i))


def unlike_zeros(
    points: Points, phi_t: float, group: LoadGroup, C_alpha: UFloat | None, config: Config
) -> list[ZerosDisagree]:
    """Sweeps of one load, path and direction whose zeros are further apart than mounting the wheel again explains."""
    slope = _slope(C_alpha, group)
    group = LoadGroup(group.load, group.index[np.isclose(points.phi_t[group.index], phi_t)])
    u_again = config.rig.u_slip_alignment_N
    out = []
    for direction in (1, -1):
        i = zeros(points, group, direction)
        i = i[np.isfinite(points.Fy[i])]
        force = points.Fy[i] - direction * slope * points.alpha[i]
        found = sorted(
            (float(np.mean(force[points.sweep[i] == k])), int(k)) for k in np.unique(points.sweep[i])
        )
        if found and found[-1][0] - found[0][0] > UNLIKE * math.sqrt(2.0) * math.hypot(
            u_again, DEFAULT_U_FORCE
        ):
            (least, a), (most, b) = found[0], found[-1]
            names = (points.sweep_names[a], points.sweep_names[b])
            out.append(ZerosDisagree(group.load, direction < 0, names, (least, most)))
    return out


def zeros_by_path(
    points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config
) -> list[tuple[float, Zero]]:
    """Turn slip of every path with forward zeros at this load, the usual one first, and what was read there."""
    paths = by_path(points, group, path_curvature(config.rig))
    found = [(phi_t, _zero(points, part, C_alpha, config)) for phi_t, part in paths]
    return [(phi_t, zero) for phi_t, zero in found if np.isfinite(zero.forward)]


def turn_slip(zero: Zero, phi_t: float, C_gamma, C_alpha, rig, config: Config) -> PathForce:
    """Corrected turn-slip force of one path, alpha_M if known, and the raw forces that enter."""
    forward = method.named(zero.forward, zero.u_forward, "noise of the forward zeros", "N")
    Cg = C_gamma if C_gamma is not None else 0.0
    Ca = C_alpha if C_alpha is not None else 0.0
    # The play was taken off the angles already, so only its uncertainty is left to propagate.
    play_error = zero.alpha_b * (rig.half_play - rig.half_play.nominal_value)
    # The wheel is moved from path to path by known distances, so one error of R is common to all.
    usual = config.rig.radius
    assert usual is not None
    path: dict[str, Any] = {"sign": float(np.sign(phi_t)), "R": rig.R + (1.0 / abs(phi_t) - usual)}
    if not math.isfinite(zero.backward):
        force = method.turn_slip_force(forward, Cg, Ca, rig, play_error, slip_known=False)
        return PathForce(force=force, readings=(forward,), alpha_M=None, **path)
    backward = method.named(zero.backward, zero.u_backward, "noise of the backward zeros", "N")
    force = method.turn_slip_force((forward + backward) / 2.0, Cg, Ca, rig, play_error, slip_known=True)
    alpha_M = (forward - backward) / 2.0 / Ca if C_alpha is not None else None
    return PathForce(force=force, readings=(forward, backward), alpha_M=alpha_M, **path)


def refuse_inward(force: float, load: float, alpha_M, config) -> None:
    if alpha_M is None:
        cause = "sideslip misaligned by a degree or more (run mffit align with forward and backward zeros), or path_centre wrong"
    else:
        cause = "path_centre or axes are wrong, as forward and backward runs agree on it"
    raise InputError(
        f"the turn-slip force at {load:.0f} N is {force:.0f} N in ISO-W, towards the disc's centre, and a disc pushes "
        f"outwards: {cause}",
        file=config.path,
        key="rig.path_centre",
    )


def epsilon_with(estimate, force, r_e, rig, sign) -> float | None:
    if estimate is None:
        return None
    return float(method.camber_reduction(force, estimate.value, r_e, rig.R, sign).epsilon_gamma.nominal_value)


def moment_opinion(points, odd_Mz, u_Mz, group, zero, r_e, rig, sign, config) -> UFloat | None:
    """eps_gamma from the moments; informational, as it scatters widely."""
    if zero.moment is None:
        return None
    index = sweep(points, odd_Mz, group, "gamma", config)
    slope = slope_at_zero(points.gamma[index], odd_Mz[index], u_Mz[index], local=CUBIC_CAMBER)
    if slope is None or abs(zero.moment.nominal_value) < 2.0 * zero.moment.std_dev:
        return None
    C = method.named(slope.value, slope.u, "camber moment stiffness", "Nm/rad")
    return 1.0 + r_e * C / (sign * zero.moment * rig.R)
