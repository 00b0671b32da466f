"""The direct method on a set of points: stiffnesses, turn-slip force, eps_gamma with budget, load by load."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

from uncertainties import UFloat

from mffit.config import Config
from mffit.measured import camber_reduction as method
from mffit.measured import notes
from mffit.measured.alignment import AxisAtLoad
from mffit.measured.at_zero import angle_at_zero, zeros_by_path
from mffit.measured.backlash import rest_of_play
from mffit.measured.both_directions import skew_warning, with_measured_skew
from mffit.measured.budget import budget
from mffit.measured.budget_rows import Contribution
from mffit.measured.evidence import DirectEvidence, evidence_of
from mffit.measured.factor import corrected, factor, warmer_in_camber
from mffit.measured.groups import LoadGroup, load_groups
from mffit.measured.load_slopes import LoadSlopes, cornering_stiffness, load_slopes
from mffit.measured.loads import load_dependence
from mffit.measured.moments import epsilon_from_moments
from mffit.measured.radii import effective_radius_at
from mffit.measured.remarks import remarks
from mffit.measured.result import CONICITY, LoadResult, Measured, SideslipZeros
from mffit.measured.setups import excess_forces, of_setups, results_of_setups, setup_scatter
from mffit.measured.sideslip_zero import SetupAngle, ZeroAngle, angles_of_setups
from mffit.measured.slip_stiffness import slip_stiffness
from mffit.measured.turning import Turning, turning
from mffit.measured.zero_split import alignment_verdict, at_true_zero, camber_at_true_zero, split_of_zero
from mffit.parts import Parts
from mffit.points import Points
from tir import Quantity, Tyre


@dataclass(frozen=True, slots=True)
class _AtLoad:
    """The result of one load, with eps_gamma for the next steps."""

    row: LoadResult
    epsilon: UFloat | None
    warmer: float = 0.0  #: temperature of the camber sweep above that of the zeros [K]


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
    evidence = evidence_of(config, points, parts, base)
    warnings: list[str] = []
    rows = []
    found_slopes = [(group, *load_slopes(evidence, group)) for group in load_groups(evidence.points)]
    evidence, skew = with_measured_skew(evidence, [slopes for _, slopes, _ in found_slopes])
    stiffnesses = [(group, slopes.C_alpha, slopes.C_gamma) for group, slopes, _ in found_slopes]
    if evidence.rig is not None:
        scatter = setup_scatter(evidence.points, stiffnesses, evidence.rig, config)
        evidence = replace(evidence, scatter=scatter, excess=excess_forces(scatter, evidence.rig))
    axes, zeros = _sideslip_zeros(evidence, [(group, slopes) for group, slopes, _ in found_slopes])
    evidence = replace(evidence, axes=axes)
    for group, slopes, troubles in found_slopes:
        # Camber sweeps in both directions are free of it: their mean is the stiffness at true zero.
        found, more = _at_load(
            evidence, group, slopes if skew else _at_true_sideslip(evidence, group, slopes)
        )
        rows += [] if found is None else [found]
        warnings += troubles + more
    measured, troubles = _assembled(evidence, rows, skew)
    repeated = of_setups(points, measured, evidence.scatter, config)
    return replace(
        measured,
        notes=(*measured.notes, *repeated.notes),
        warnings=(*parts.unpaired, *warnings, *troubles, *repeated.warnings),
        setup_scatter=evidence.scatter,
        sideslip_zeros=zeros,
    )


def _of_other_loads(rows: Sequence[LoadResult]) -> list[str]:
    """A sentence on the loads whose sideslip zero is that of the others."""
    zeros = [row for row in rows if row.alpha_M is not None]
    without = [row.load for row in zeros if not math.isfinite(row.F_backward)]
    known = [row.load for row in zeros if math.isfinite(row.F_backward)]
    return [notes.axis_of_other_loads(without, known)] if without and known else []


def _at_true_sideslip(evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes) -> LoadSlopes:
    """The slopes with the camber stiffness at true zero of sideslip, where the axis is known to be off."""
    axis = next(iter(evidence.axes.values()), None)
    if axis is None or slopes.C_alpha is None or slopes.bend is None:
        return slopes
    C_alpha = float(slopes.C_alpha.nominal_value)
    split = split_of_zero(axis.at(group.load), C_alpha, evidence.config.rig.u("alpha_0_deg"))
    assert split is not None
    factor = camber_at_true_zero(C_alpha, slopes.bend, split)
    C_gamma, slope, secant = (
        None if C is None else C * factor for C in (slopes.C_gamma, slopes.slope, slopes.secant)
    )
    return replace(slopes, C_gamma=C_gamma, slope=slope, secant=secant)


def _misaligned_setups(evidence: DirectEvidence, nominal: LoadResult) -> dict[str, float]:
    """alpha_M [rad] of the set-ups whose sideslip zero makes more force than the alignment is declared to leave."""
    found = {name: float(axis.at(nominal.load).nominal_value) for name, axis in evidence.axes.items()}
    left = evidence.config.rig.u("alpha_0_deg")
    return {name: angle for name, angle in found.items() if abs(nominal.slip_force(angle)) > left}


def _sideslip_zeros(
    evidence: DirectEvidence, found: Sequence[tuple[LoadGroup, LoadSlopes]]
) -> tuple[dict[str, SetupAngle], tuple[SideslipZeros, ...]]:
    """alpha_M of every set-up from all its loads, and how well these agree; nothing on a straight path."""
    readings = []
    for group, slopes in found if evidence.rig is not None else ():
        if slopes.C_alpha is None:
            continue
        stiffness = slip_stiffness(slopes.C_alpha, slopes.bend, group.load)
        for path in zeros_by_path(evidence.points, group, slopes.C_alpha, evidence.config):
            angle = angle_at_zero(path, stiffness)
            if angle is not None:
                angle = angle + rest_of_play(evidence.config)
                readings.append(ZeroAngle(path.setup, group.load, path.phi_t, angle))
    return angles_of_setups(readings, evidence.config.tyre.nominal_load)


def at_the_axis(config: Config, points: Points, parts: Parts) -> dict[float, AxisAtLoad]:
    """Cornering stiffness and zeros by load [N] for the alignment; an inward turn-slip force is not refused."""
    evidence = evidence_of(config, points, parts, None)
    out = {}
    for group in load_groups(evidence.points):
        C_alpha = cornering_stiffness(evidence, group)
        paths = zeros_by_path(evidence.points, group, C_alpha, config) if evidence.rig else []
        # Of several set-ups on the usual path the last one is aligned.
        zero = [path for path in paths if path.phi_t == paths[0].phi_t][-1].readings if paths else None
        out[group.load] = AxisAtLoad(
            method.quantity(C_alpha, "N/rad"),
            zero.forward if zero else math.nan,
            zero.backward if zero else math.nan,
        )
    return out


def _at_load(
    evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes
) -> tuple[_AtLoad | None, list[str]]:
    """Results and warnings at one load; None if nothing could be measured."""
    if evidence.rig is None:
        straight = _AtLoad(_row(evidence, group, slopes, None), None)
        return (straight if slopes.exists else None), []
    found, troubles = turning(evidence, group, slopes)
    r_e = effective_radius_at(group.load, evidence.radii, evidence.base)
    return _on_disc(evidence, group, slopes, found, r_e), troubles


def _on_disc(
    evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes, found: Turning | None, r_e: UFloat | None
) -> _AtLoad:
    """The record of one load of a disc, with eps_gamma where everything that it needs was measured."""
    rig = evidence.rig
    assert rig is not None
    row = replace(
        _row(evidence, group, slopes, found),
        r_e=method.quantity(r_e, "m"),
        R=method.quantity(rig.R, "m"),
    )
    C_gamma = corrected(evidence, slopes.C_gamma, slopes.C_alpha)
    if found is None or C_gamma is None or r_e is None:
        return _AtLoad(row, None)
    warmer = warmer_in_camber(evidence, group)
    epsilon = factor(evidence, C_gamma, found, r_e, warmer)
    slope, secant = (
        None if C is None else factor(evidence, C, found, r_e, warmer)
        for C in (corrected(evidence, x, slopes.C_alpha) for x in (slopes.slope, slopes.secant))
    )
    # The secant is larger by far more than finite spin, so only the slope can be corrected.
    debiased = slope.debiased if slope is not None else None
    draws = epsilon.draws
    row = replace(
        row,
        epsilon_gamma=method.quantity(epsilon.plain, "-"),
        epsilon_debiased=method.quantity(debiased, "-"),
        epsilon_slope=None if slope is None else float(slope.plain.nominal_value),
        epsilon_secant=None if secant is None else float(secant.plain.nominal_value),
        epsilon_moment=epsilon_from_moments(evidence, group, found, r_e),
        setups=results_of_setups(found.found, found.paths, evidence.axes, C_gamma, r_e, evidence.config),
        budget=budget(epsilon.plain),
        u_monte_carlo=draws.u,
        interval=draws.interval,
    )
    return _AtLoad(_with_left_out(evidence, row), epsilon.plain, warmer)


def _with_left_out(evidence: DirectEvidence, row: LoadResult) -> LoadResult:
    """The row with the conicity that the budget of the published procedure leaves out, for a build to add."""
    if not evidence.published:
        return row
    u = evidence.config.rig.u_conicity
    shift = row.shift_by(u * row.load)
    return replace(
        row, left_out=(Contribution(CONICITY, u, "-", shift, sensitivity=shift / u if u else 0.0),)
    )


def _row(evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes, found: Turning | None) -> LoadResult:
    """The record of one load without eps_gamma."""
    C_gamma, slope, secant = (
        method.quantity(corrected(evidence, C, slopes.C_alpha), "N/rad")
        for C in (slopes.C_gamma, slopes.slope, slopes.secant)
    )
    u_axis = evidence.config.rig.u("alpha_0_deg") if evidence.rig else 0.0
    C_alpha = float(slip_stiffness(slopes.C_alpha, slopes.bend, group.load).C_alpha.nominal_value)
    split = split_of_zero(found.alpha_M if found else None, C_alpha, u_axis)
    row = LoadResult(
        load=group.load,
        C_alpha=method.quantity(at_true_zero(slopes.C_alpha, slopes.bend, split, u_axis), "N/rad"),
        C_gamma=C_gamma,
        C_gamma_slope=slope,
        C_gamma_secant=secant,
    )
    if found is None:
        return row
    return replace(
        row,
        F_phit=method.quantity(found.force, "N"),
        C_phit=method.quantity(found.stiffness.C_phit, "Nm"),
        alpha_M=method.quantity(found.alpha_M, "rad"),
        misalignment=method.quantity(split.misalignment, "rad") if split else None,
        ply_steer=method.quantity(split.ply_steer, "rad") if split else None,
        conicity=method.quantity(found.conicity, "N"),
        F_forward=found.zeros.forward,
        F_backward=found.zeros.backward,
        paths=found.phi_t,
    )


def _assembled(
    evidence: DirectEvidence, rows: Sequence[_AtLoad], skew: Quantity | None
) -> tuple[Measured, list[str]]:
    """The results of all loads together, with eps_gamma over load and the remarks."""
    nominal_load = evidence.config.tyre.nominal_load
    per_load = tuple(found.row for found in rows)
    known = [(found, found.epsilon) for found in rows if found.epsilon is not None]
    measured = Measured(
        per_load=per_load,
        nominal=min(per_load, key=lambda row: abs(row.load - nominal_load), default=None),
        pecp1=None,
        pecp2=0.0,
        u_pecp2=None,
        r_e_loads={load: float(r.nominal_value) for load, r in evidence.radii.items()},
        misaligned=False,
        notes=() if evidence.rig else (notes.STRAIGHT_PATH,),
        warnings=(),
        camber_skew=skew,
    )
    if not known:
        lacking = notes.nothing_measured(
            camber=any(row.C_gamma is not None for row in per_load),
            zeros=any(row.C_phit is not None for row in per_load),
            radius=bool(evidence.radii),
        )
        return measured, [lacking] if evidence.rig else []
    loads = [found.row.load for found, _ in known]
    at = min(range(len(known)), key=lambda k: abs(loads[k] - nominal_load))
    law = load_dependence(loads, [epsilon for _, epsilon in known], at, nominal_load)
    nominal = known[at][0]
    axis = alignment_verdict(evidence.config, nominal.row)
    measured = replace(
        measured,
        nominal=nominal.row,
        epsilon_gamma_debiased=nominal.row.epsilon_debiased,
        pecp1=law.pecp1,
        pecp2=law.pecp2,
        u_pecp2=law.u_pecp2,
        misaligned=axis.beyond,
        misaligned_setups=_misaligned_setups(evidence, nominal.row),
        axis_off=axis.misaligned,
        notes=(
            *remarks(evidence, nominal.row, skew, nominal.warmer, axis, law.note),
            *_of_other_loads(per_load),
        ),
        load_note=law.note,
    )
    return measured, [*([axis.sentence] if axis.misaligned else []), *skew_warning(evidence, skew)]
