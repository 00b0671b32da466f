"""The direct method on a set of points: stiffnesses, turn-slip force, eps_gamma with budget, load by load."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.measured import camber_reduction as method
from mffit.measured import wording
from mffit.measured.alignment import DEFAULT_U_MOMENT
from mffit.measured.alignment import AtLoad as AxisAtLoad
from mffit.measured.at_zero import (
    epsilon_with,
    moment_opinion,
    refuse_inward,
    turn_slip,
    unlike_zeros,
    zeros_by_path,
)
from mffit.measured.backlash import backlash_corrected, odd_alpha
from mffit.measured.groups import LoadGroup, load_groups
from mffit.measured.loads import load_dependence
from mffit.measured.notes import (
    Aligned,
    Conicity,
    ContactWanders,
    Misaligned,
    Note,
    NothingMeasured,
    NotSeparable,
    PathsContradict,
    SeveralPaths,
    StandardUncertainties,
    StraightPath,
    Trouble,
)
from mffit.measured.paths import stiffness, u_by_draws
from mffit.measured.radii import effective_radius_at, measured_effective_radius, measured_path_radius
from mffit.measured.result import Contribution, LoadResult, Measured
from mffit.measured.stiffnesses import (
    CUBIC_CAMBER,
    Stiffness,
    camber_stiffness,
    cornering,
    estimates,
    number,
    raw_odd,
    sweep,
    u_odd,
)
from mffit.parts import Parts
from mffit.points import Points
from tir import Quantity, Tyre

CONICITY = 0.002
"""A plausible one, of the load."""


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
        C_alpha = cornering(points, parts, slip, group, config)
        Ca = number(C_alpha.slope or C_alpha.secant, "cornering stiffness")
        paths = zeros_by_path(points, group, Ca, config) if config.rig.on_disc else []
        zero = paths[0][1] if paths else None
        out[group.load] = AxisAtLoad(
            method.quantity(Ca, "N/rad"),
            zero.forward if zero else math.nan,
            zero.backward if zero else math.nan,
        )
    return out


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
    u_Fy = u_odd(parts)
    u_Mz = np.where(np.isfinite(parts.u_Mz_odd), parts.u_Mz_odd, DEFAULT_U_MOMENT / math.sqrt(2.0))
    odd_Fy, odd_Mz = (parts.Fy_odd, parts.Mz_odd) if rig else raw_odd(points)
    camber = sweep(points, odd_Fy, group, "gamma", config)
    angle = math.radians(config.camber_stiffness.angle_deg)
    C_alpha = cornering(points, parts, odd_slip, group, config)
    Ca = number(C_alpha.slope or C_alpha.secant, "cornering stiffness")
    if Ca is not None:  # the sideslip that backlash leaves in a camber sweep
        odd_Fy = np.where(
            np.isin(np.arange(len(points)), camber), odd_Fy - Ca.nominal_value * odd_slip, odd_Fy
        )
    C_gamma = Stiffness(*estimates(points.gamma, odd_Fy, u_Fy, camber, CUBIC_CAMBER, angle))
    if C_gamma.slope is None and C_alpha.slope is None and C_gamma.secant is None and rig is None:
        return None
    chosen = camber_stiffness(config, C_gamma, points.gamma[camber], group.load, warnings)
    zeros_of = zeros_by_path(points, group, Ca, config) if rig else []
    zero = zeros_of[0][1] if zeros_of else None
    epsilon = C_phit = turn = alpha_M = moment = None
    row_budget: tuple[Contribution, ...] = ()
    u_mc = e_slope = e_secant = None
    per_newton = 0.0
    if zero is not None:
        for phi_t, _ in zeros_of:
            warnings += unlike_zeros(points, phi_t, group, Ca, config)
        paths = [turn_slip(z, phi_t, chosen, Ca, rig, config) for phi_t, z in zeros_of]
        alpha_M = next((path.alpha_M for path in paths if path.alpha_M is not None), None)
        combined = stiffness(paths)
        C_phit = combined.C_phit
        if combined.contradictory:
            said = tuple(Quantity(C.nominal_value, C.std_dev, "Nm") for C in combined.of_paths)
            warnings.append(PathsContradict(group.load, tuple(-1.0 / phi_t for phi_t, _ in zeros_of), said))
        sign = paths[0].sign
        turn = paths[0].force if len(paths) == 1 else sign * C_phit / rig.R
        if C_phit.nominal_value <= 0.0:
            refuse_inward(turn.nominal_value, group.load, alpha_M, config)
        if chosen is not None and r_e is not None:
            result = method.camber_reduction(turn, chosen, r_e, rig.R, sign)
            epsilon, row_budget = result.epsilon_gamma, method.budget(result.epsilon_gamma)
            per_newton = epsilon.derivatives.get(rig.offset, 0.0)
            u_mc = u_by_draws(paths, combined.weights, chosen, r_e, rig)
            e_slope, e_secant = (
                epsilon_with(s, turn, r_e, rig, sign) for s in (C_gamma.slope, C_gamma.secant)
            )
            moment = moment_opinion(points, odd_Mz, u_Mz, group, zero, r_e, rig, sign, config)
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
