"""The direct method on a set of points: stiffnesses, turn-slip force, eps_gamma with budget, load by load."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config, path_curvature
from mffit.errors import InputError
from mffit.measured import camber_reduction as method
from mffit.measured import wording
from mffit.measured.alignment import DEFAULT_U_FORCE, DEFAULT_U_MOMENT
from mffit.measured.alignment import AtLoad as AxisAtLoad
from mffit.measured.backlash import backlash_corrected, odd_alpha
from mffit.measured.groups import STRAIGHT, UPRIGHT, LoadGroup, load_groups, zeros
from mffit.measured.loads import load_dependence
from mffit.measured.notes import (
    Aligned,
    Conicity,
    ContactWanders,
    Misaligned,
    Note,
    NothingMeasured,
    NotSeparable,
    SecantNotPossible,
    SeveralPaths,
    SlopeNotPossible,
    StandardUncertainties,
    StraightPath,
    Trouble,
)
from mffit.measured.paths import PathForce, by_path, on_radius, stiffness, u_by_draws
from mffit.measured.radii import effective_radius_at, measured_effective_radius, measured_path_radius
from mffit.measured.result import Contribution, LoadResult, Measured
from mffit.measured.slopes import Secant, Slope, secant_at, slope_at_zero
from mffit.parts import Parts
from mffit.points import Points
from tir import Quantity, Tyre

CONICITY = 0.002
"""A plausible one, of the load."""
CUBIC_CAMBER = math.radians(20.0)
CUBIC_SLIP = math.radians(2.0)
NEAR_ZERO = math.radians(1.2)
"""Within this sideslip a parabola describes the side force to a newton."""
SHORTEST_CAMBER_SWEEP = math.radians(10.0)


@dataclass(frozen=True, slots=True)
class Stiffness:
    """A stiffness at one load as the two estimates of it."""

    slope: Slope | None
    secant: Secant | None


class Zero(NamedTuple):
    """Forces and moment at zero sideslip and camber of one load."""

    forward: float  #: [N], the sideslip of backlash removed
    backward: float  #: NaN without backward runs
    u_forward: float
    u_backward: float
    moment: UFloat | None  #: turn-slip moment [Nm]
    alpha_b: float  #: sideslip that backlash makes at the forward zero [rad]


@dataclass(frozen=True, slots=True)
class AtLoad:
    """Numbers with uncertainty of one load, before they become a record."""

    row: LoadResult
    epsilon: UFloat | None
    per_newton: float = 0.0  #: of eps_gamma by a force that pushes the same way on every path [1/N]


def measure(config: Config, points: Points, parts: Parts, base: Tyre | None = None) -> Measured:
    """Measure stiffnesses, turn-slip force and eps_gamma at every load.

    Parameters
    ----------
    config : the rig, its uncertainties and the method for C_gamma
    points : with the angles as read
    parts : their odd and even parts
    base : gives the shape of Re over load where r_e was not measured

    Returns
    -------
    Measured
        On a flat track with stiffnesses only.

    Raises
    ------
    InputError
        If the turn-slip force points towards the centre of the disc.
    """
    disc = config.rig.on_disc
    warnings: list[Trouble] = []
    slip = odd_alpha(points, parts, config)
    points = backlash_corrected(points, config)
    R = measured_path_radius(config)
    radii = measured_effective_radius(config, R)
    rig = _rig(config, R) if disc else None
    rows = []
    for group in load_groups(points):
        found = _at_load(
            config, points, parts, slip, group, rig, effective_radius_at(group.load, radii, base), warnings
        )
        if found is not None:
            rows.append(found)
    measured_loads = {load: float(r.nominal_value) for load, r in radii.items()}
    measured = _assembled(config, rows, measured_loads, warnings, disc)
    return replace(measured, warnings=(*parts.unpaired, *map(wording.warning, warnings)))


def at_the_axis(config: Config, points: Points, parts: Parts) -> dict[float, AxisAtLoad]:
    """Cornering stiffness and zeros by load [N], for the alignment: whatever the turn-slip force says of the rig."""
    slip = odd_alpha(points, parts, config)
    points = backlash_corrected(points, config)
    out = {}
    for group in load_groups(points):
        C_alpha = _cornering(points, parts, slip, group, config)
        Ca = _number(C_alpha.slope or C_alpha.secant, "cornering stiffness")
        paths = _zeros_by_path(points, group, Ca, config) if config.rig.on_disc else []
        zero = paths[0][1] if paths else None
        out[group.load] = AxisAtLoad(
            method.quantity(Ca, "N/rad"),
            zero.forward if zero else math.nan,
            zero.backward if zero else math.nan,
        )
    return out


def _cornering(points: Points, parts: Parts, odd_slip, group: LoadGroup, config: Config) -> Stiffness:
    odd = parts.Fy_odd if config.rig.on_disc else points.Fy
    slip = _sweep(points, odd, group, "alpha", config)
    return Stiffness(*_estimates(odd_slip, odd, _u_odd(parts), slip, CUBIC_SLIP, CUBIC_SLIP))


def _u_odd(parts: Parts) -> np.ndarray:
    """Standard uncertainty of the odd side force (n,) [N]."""
    return np.where(np.isfinite(parts.u_Fy_odd), parts.u_Fy_odd, DEFAULT_U_FORCE / math.sqrt(2.0))


def _rig(config: Config, R: UFloat) -> method.RigErrors:
    rig = config.rig
    return method.rig_errors(
        u_offset=rig.u_loadcell_offset_N,
        u_gamma_0=math.radians(rig.u_camber_alignment_deg),
        u_slip_force=rig.u_slip_alignment_N,
        half_play=math.radians(rig.backlash_deg) / 2.0,
        u_half_play=math.radians(rig.u_backlash_deg) / 2.0,
        R=R,
    )


def _at_load(config, points, parts, odd_slip, group: LoadGroup, rig, r_e, warnings) -> AtLoad | None:
    u_Fy = _u_odd(parts)
    u_Mz = np.where(np.isfinite(parts.u_Mz_odd), parts.u_Mz_odd, DEFAULT_U_MOMENT / math.sqrt(2.0))
    odd_Fy, odd_Mz = (parts.Fy_odd, parts.Mz_odd) if rig else _raw_odd(points)
    camber = _sweep(points, odd_Fy, group, "gamma", config)
    angle = math.radians(config.camber_stiffness.angle_deg)
    C_alpha = _cornering(points, parts, odd_slip, group, config)
    Ca = _number(C_alpha.slope or C_alpha.secant, "cornering stiffness")
    if Ca is not None:  # the sideslip that backlash leaves in a camber sweep
        odd_Fy = np.where(
            np.isin(np.arange(len(points)), camber), odd_Fy - Ca.nominal_value * odd_slip, odd_Fy
        )
    C_gamma = Stiffness(*_estimates(points.gamma, odd_Fy, u_Fy, camber, CUBIC_CAMBER, angle))
    if C_gamma.slope is None and C_alpha.slope is None and C_gamma.secant is None and rig is None:
        return None
    chosen = _chosen(config, C_gamma, points.gamma[camber], group.load, warnings)
    zeros_of = _zeros_by_path(points, group, Ca, config) if rig else []
    zero = zeros_of[0][1] if zeros_of else None
    epsilon = C_phit = turn = alpha_M = moment = None
    row_budget: tuple[Contribution, ...] = ()
    u_mc = e_slope = e_secant = None
    per_newton = 0.0
    if zero is not None:
        paths = [_turn_slip(z, phi_t, chosen, Ca, rig, config) for phi_t, z in zeros_of]
        alpha_M = next((path.alpha_M for path in paths if path.alpha_M is not None), None)
        C_phit, weights = stiffness(paths)
        sign = paths[0].sign
        turn = paths[0].force if len(paths) == 1 else sign * C_phit / rig.R
        if C_phit.nominal_value <= 0.0:
            _refuse_inward(turn.nominal_value, group.load, alpha_M, config)
        if chosen is not None and r_e is not None:
            result = method.camber_reduction(turn, chosen, r_e, rig.R, sign)
            epsilon, row_budget = result.epsilon_gamma, method.budget(result.epsilon_gamma)
            per_newton = epsilon.derivatives.get(rig.offset, 0.0)
            u_mc = u_by_draws(paths, weights, chosen, r_e, rig)
            e_slope, e_secant = (
                _epsilon_with(s, turn, r_e, rig, sign) for s in (C_gamma.slope, C_gamma.secant)
            )
            moment = _moment_opinion(points, odd_Mz, u_Mz, group, zero, r_e, rig, sign, config)
    row = LoadResult(
        load=group.load,
        C_alpha=method.quantity(Ca, "N/rad"),
        C_gamma=method.quantity(chosen, "N/rad"),
        C_gamma_slope=None
        if C_gamma.slope is None
        else Quantity(C_gamma.slope.value, C_gamma.slope.u, "N/rad"),
        C_gamma_secant=None
        if C_gamma.secant is None
        else Quantity(C_gamma.secant.value, C_gamma.secant.u, "N/rad"),
        r_e=method.quantity(r_e, "m"),
        R=method.quantity(rig.R, "m") if rig else None,
        F_phit=method.quantity(turn, "N"),
        C_phit=method.quantity(C_phit, "Nm"),
        epsilon_gamma=method.quantity(epsilon, "-"),
        epsilon_slope=e_slope,
        epsilon_secant=e_secant,
        epsilon_moment=method.quantity(moment, "-"),
        alpha_M=method.quantity(alpha_M, "rad"),
        F_forward=zero.forward if zero else math.nan,
        F_backward=zero.backward if zero else math.nan,
        budget=row_budget,
        u_monte_carlo=u_mc,
        paths=tuple(phi_t for phi_t, _ in zeros_of),
    )
    return AtLoad(row, epsilon, per_newton)


def _raw_odd(points: Points) -> tuple[np.ndarray, np.ndarray]:
    """On a straight path the curve itself, less its value at zero, stands for the odd part."""
    return points.Fy, points.Mz


def _sweep(points: Points, odd: np.ndarray, group: LoadGroup, angle: str, config: Config) -> np.ndarray:
    """Indices of the group's forward points on the positive branch of a pure camber or sideslip sweep at the usual radius."""
    i = group.index if config.rig.radius is None else on_radius(points, group.index, config.rig.radius)
    i = i[(points.direction[i] > 0) & np.isfinite(odd[i])]
    if angle == "gamma":
        return i[(np.abs(points.alpha[i]) < STRAIGHT) & (points.gamma[i] > UPRIGHT)]
    return i[(np.abs(points.gamma[i]) < UPRIGHT) & (points.alpha[i] > np.radians(0.15))]


def _estimates(x, odd, u, index, local, angle) -> tuple[Slope | None, Secant | None]:
    x, y, u = x[index], odd[index], u[index]
    return slope_at_zero(x, y, u, local=local), secant_at(x, y, u, angle)


def _chosen(config, stiffness: Stiffness, gamma, load: float, warnings: list[Trouble]) -> UFloat | None:
    """C_gamma by the configured method; the other one, with a warning, if the sweep is too short for it."""
    wanted = config.camber_stiffness.method
    angle = config.camber_stiffness.angle_deg
    slope_possible = stiffness.slope is not None and gamma.max() >= SHORTEST_CAMBER_SWEEP
    if wanted == "slope" and not slope_possible and stiffness.secant is not None:
        warnings.append(SlopeNotPossible(load, angle))
        return _number(stiffness.secant, "camber stiffness")
    if wanted == "secant" and stiffness.secant is None and stiffness.slope is not None:
        warnings.append(SecantNotPossible(load, angle))
        return _number(stiffness.slope, "camber stiffness")
    return _number(stiffness.slope if wanted == "slope" else stiffness.secant, "camber stiffness")


def _number(estimate: Slope | Secant | None, source: str) -> UFloat | None:
    return None if estimate is None else method.named(estimate.value, estimate.u, source, "N/rad")


def _zero(points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config) -> Zero:
    """Forces and moments at zero sideslip in both directions, backlash taken off."""
    slope = C_alpha.nominal_value if C_alpha is not None else -10.0 * group.load
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


def _zeros_by_path(
    points: Points, group: LoadGroup, C_alpha: UFloat | None, config: Config
) -> list[tuple[float, Zero]]:
    """Turn slip of every path with forward zeros at this load, the usual one first, and what was read there."""
    paths = by_path(points, group, path_curvature(config.rig))
    found = [(phi_t, _zero(points, part, C_alpha, config)) for phi_t, part in paths]
    return [(phi_t, zero) for phi_t, zero in found if np.isfinite(zero.forward)]


def _turn_slip(zero: Zero, phi_t: float, C_gamma, C_alpha, rig, config: Config) -> PathForce:
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


def _refuse_inward(force: float, load: float, alpha_M, config) -> None:
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


def _epsilon_with(estimate, force, r_e, rig, sign) -> float | None:
    if estimate is None:
        return None
    return float(method.camber_reduction(force, estimate.value, r_e, rig.R, sign).epsilon_gamma.nominal_value)


def _moment_opinion(points, odd_Mz, u_Mz, group, zero, r_e, rig, sign, config) -> UFloat | None:
    """eps_gamma from the moments; informational, as it scatters widely."""
    if zero.moment is None:
        return None
    index = _sweep(points, odd_Mz, group, "gamma", config)
    slope = slope_at_zero(points.gamma[index], odd_Mz[index], u_Mz[index], local=CUBIC_CAMBER)
    if slope is None or abs(zero.moment.nominal_value) < 2.0 * zero.moment.std_dev:
        return None
    C = method.named(slope.value, slope.u, "camber moment stiffness", "Nm/rad")
    return 1.0 + r_e * C / (sign * zero.moment * rig.R)


def _assembled(
    config: Config,
    rows: list[AtLoad],
    r_e_loads: Mapping[float, float],
    warnings: list[Trouble],
    disc: bool,
) -> Measured:
    nominal_load = config.tyre.nominal_load
    per_load = tuple(found.row for found in rows)
    known = [(found.row.load, found.epsilon) for found in rows if found.epsilon is not None]
    if not known:
        nearest = min(per_load, key=lambda row: abs(row.load - nominal_load), default=None)
        if disc:
            warnings.append(NothingMeasured())
        notes: tuple[Note, ...] = () if disc else (StraightPath(),)
        return Measured(per_load, nearest, None, 0.0, None, r_e_loads, False, notes, ())
    loads = [load for load, _ in known]
    at = min(range(len(known)), key=lambda k: abs(loads[k] - nominal_load))
    law = load_dependence(loads, [epsilon for _, epsilon in known], at, nominal_load)
    row = next(row for row in per_load if row.load == loads[at])
    axis = alignment_verdict(config, row)
    misaligned = isinstance(axis, Misaligned)
    if isinstance(axis, Misaligned):
        warnings.append(axis)
    said: tuple[Note, ...] = () if axis is None or isinstance(axis, Misaligned) else (axis,)
    if len(row.paths) > 1:
        said = (*said, SeveralPaths(tuple(-1.0 / phi_t for phi_t in row.paths)))
    notes = (*said, law.note, StandardUncertainties(), _conicity(rows, row), ContactWanders())
    return Measured(per_load, row, law.pecp1, law.pecp2, law.u_pecp2, r_e_loads, misaligned, notes, ())


def alignment_verdict(config: Config, row: LoadResult) -> NotSeparable | Aligned | Misaligned | None:
    """Whether the sideslip axis is off by more than the rig's own alignment leaves; None where it does not matter."""
    assert row.F_phit is not None
    force, left = row.F_phit.value, config.rig.u_slip_alignment_N
    if row.alpha_M is None and min(row.paths) < 0.0 < max(row.paths):
        return None
    if row.alpha_M is None:
        angle = math.degrees(abs(force / row.C_alpha.value)) if row.C_alpha is not None else None
        return NotSeparable(force, angle, left)
    slip = (row.F_forward - row.F_backward) / 2.0
    verdict = Aligned if abs(slip) <= left else Misaligned
    return verdict(row.alpha_M, slip, _shift(row, slip))


def _conicity(rows: list[AtLoad], row: LoadResult) -> Conicity:
    """What a plausible conicity would do, which pushes the same way on every path."""
    force = CONICITY * row.load
    return Conicity(
        CONICITY, force, abs(force * next(found.per_newton for found in rows if found.row is row))
    )


def _shift(row: LoadResult, force: float) -> float:
    """How far eps_gamma moves by a force [N] that is taken for turn slip."""
    assert row.epsilon_gamma is not None
    assert row.F_phit is not None
    return abs((1.0 - row.epsilon_gamma.value) * force / row.F_phit.value)
