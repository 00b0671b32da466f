"""The direct method on a set of points: stiffnesses, turn-slip force, eps_gamma with budget, load by load."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import chain
from typing import Any, NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import VISIBLE_TEMPERATURE
from mffit.measured import wording
from mffit.measured.axis import (
    SetupAngle,
    ZeroAngle,
    ZeroSplit,
    angles_of_setups,
    at_true_zero,
    camber_at_true_zero,
    slip_stiffness,
    slope_at,
    split_of_zero,
)
from mffit.measured.calibration import calibration, powers_of_load
from mffit.measured.drift import shares_of_sweeps
from mffit.measured.epsilon import (
    carried_by_file,
    corrected,
    epsilon_from_moments,
    factor,
    load_dependence,
    stiffer_in_camber,
)
from mffit.measured.evidence import DirectEvidence, evidence_of, rest_of_play
from mffit.measured.one_way import one_way_lag
from mffit.measured.published import published
from mffit.measured.radii import effective_radius_at
from mffit.measured.result import NO_FIT, AfterFit, LoadDependence, LoadResult, Measured, SideslipZeros
from mffit.measured.setups import excess_forces, results_of_setups, setup_scatter, warnings_of_setups
from mffit.measured.stiffnesses import LoadSlopes, assumed_stiffness, cornering_stiffness, load_slopes
from mffit.measured.turning import Turning, turning
from mffit.measured.uncertain import agreed, budget, quantity, quantity_if
from mffit.measured.zeros import LoadGroup, load_groups, zeros_by_path
from mffit.parts import Parts
from mffit.points import Points, levels, main_pressure
from mffit.quantities import DIRECT
from mffit.rig_errors import BY_NAME, DECLARED, AtZero, Declared, RigError
from mffit.rounding import ascii_only, stated
from mffit.scatter import ALARM
from tir import Quantity, Tyre

COMPLIANCE = BY_NAME["compliance_deg_per_Nm"]


def measure(
    config: Config, points: Points, parts: Parts, base: Tyre | None = None, after: AfterFit = NO_FIT
) -> Measured:
    """Stiffnesses, turn-slip force and eps_gamma at every load, from points with the angles as read; stiffnesses only on a flat
    track.

    ``base`` is the property file that supplies the shape of Re over load for loads at which r_e was not measured, ``after`` what
    a fit to these points adds. Raises InputError if the turn-slip force points towards the centre of the disc.
    """
    evidence = evidence_of(config, points, parts, base, after.spin)
    slopes = [(group, *load_slopes(evidence, group)) for group in load_groups(evidence.points)]
    stiffnesses = [(group, own) for group, own, _ in slopes]
    evidence = _with_setups(_with_measured_skew(evidence, [own for _, own in stiffnesses]), stiffnesses)
    of_loads = [_at_load(evidence, group, own, stiffnesses, after) for group, own in stiffnesses]
    measured = [found.row for found in of_loads if found.row is not None]
    per_load = sorted([*measured, *_of_model_alone(after, measured)], key=lambda row: row.load)
    epsilons = {x.row.load: x.epsilon for x in of_loads if x.row is not None and x.epsilon is not None}
    row, law, notes, of_nominal = _at_nominal(evidence, per_load, epsilons)
    left = config.rig.u("alpha_0_deg")
    on_disc = None if law is None else row
    troubles = chain(*(said for *_, said in slopes), *(found.troubles for found in of_loads), of_nominal)
    of_setups = warnings_of_setups(points, row, evidence.scatter, config)
    return Measured(
        per_load=tuple(per_load),
        nominal=row,
        carried=carried_by_file(config, row, law, after.pecp1) if row and law else None,
        r_e_loads={load: float(r.nominal_value) for load, r in evidence.radii.items()},
        misaligned=on_disc is not None and on_disc.slips_beyond(left),
        notes=notes,
        warnings=(*parts.unpaired, *troubles, *of_setups),
        setup_scatter=evidence.scatter,
        sideslip_zeros=evidence.zeros,
        drift=evidence.drift,
        lag=one_way_lag(points, config.tyre.unloaded_radius),
        misaligned_setups=_misaligned_setups(evidence, on_disc) if on_disc else {},
        axis_off=on_disc is not None and on_disc.axis_off(left),
        camber_skew=evidence.skew,
        epsilon_gamma_model=after.epsilon_gamma,
        published=published(evidence, points, row) if row else None,
    )


def _with_setups(
    evidence: DirectEvidence, stiffnesses: Sequence[tuple[LoadGroup, LoadSlopes]]
) -> DirectEvidence:
    """The evidence with scatter and sideslip zeros of the set-ups and with a drift; unchanged on a straight path."""
    if evidence.rig is None:
        return evidence
    scatter = setup_scatter(evidence, stiffnesses)
    excess = excess_forces(scatter, evidence.rig.of_setups)
    evidence = _with_drift(replace(evidence, scatter=scatter, excess=excess))
    axes, zeros = _sideslip_zeros(evidence, stiffnesses)
    return replace(evidence, axes=axes, zeros=zeros)


def _with_drift(evidence: DirectEvidence) -> DirectEvidence:
    """The evidence with the drift between sweeps, and with their relative forces if they clearly drift."""
    points = evidence.points
    found = None if np.ptp(points.T) > VISIBLE_TEMPERATURE else shares_of_sweeps(points)
    if found is None:
        return evidence
    return replace(evidence, drift=found.drift, shares=found if found.drift.counts else None)


def _at_true_sideslip(evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes) -> LoadSlopes:
    """The slopes with the camber stiffness corrected to true zero sideslip, if alpha_M and the bend are known."""
    axis = next(iter(evidence.axes.values()), None)
    if axis is None or slopes.C_alpha is None or slopes.bend is None:
        return slopes
    C_alpha = float(slopes.C_alpha.nominal_value)
    split = split_of_zero(axis.at(group.load), C_alpha, evidence.config.rig.u("alpha_0_deg"))
    assert split is not None
    factor = camber_at_true_zero(C_alpha, slopes.bend, split)
    return slopes.of_camber(lambda C_gamma: C_gamma * factor)


def _misaligned_setups(evidence: DirectEvidence, nominal: LoadResult) -> dict[str, float]:
    """alpha_M [rad] of the set-ups whose sideslip zero causes more force than the declared alignment uncertainty."""
    found = {name: float(axis.at(nominal.load).nominal_value) for name, axis in evidence.axes.items()}
    left = evidence.config.rig.u("alpha_0_deg")
    return {name: angle for name, angle in found.items() if abs(nominal.slip_force(angle)) > left}


def _sideslip_zeros(
    evidence: DirectEvidence, found: Sequence[tuple[LoadGroup, LoadSlopes]]
) -> tuple[dict[str, SetupAngle], tuple[SideslipZeros, ...]]:
    """alpha_M of every set-up from all its loads, and the consistency of these."""
    readings = []
    for group, slopes in found:
        if slopes.C_alpha is None:
            continue
        stiffness = slip_stiffness(slopes.C_alpha, slopes.bend, group.load)
        for path in zeros_by_path(evidence.points, group, slopes.C_alpha, evidence.config):
            if path.backward is not None:
                # The difference of both directions is odd in the angle, so the slope at true zero applies.
                angle = path.slip / stiffness.at(path.slip / stiffness.C_alpha)
                angle = angle + rest_of_play(evidence.config)
                readings.append(ZeroAngle(path.setup, group.load, path.phi_t, angle))
    return angles_of_setups(readings, evidence.config.tyre.nominal_load)


def at_the_axis(config: Config, points: Points, parts: Parts) -> tuple[Points, dict[float, Quantity]]:
    """Inputs of the alignment: the points corrected for play, and the cornering stiffness by load [N]."""
    evidence = evidence_of(config, points, parts, None)
    found = {group.load: cornering_stiffness(evidence, group) for group in load_groups(evidence.points)}
    return evidence.points, {load: quantity(C, "N/rad") for load, C in found.items() if C is not None}


class _AtLoad(NamedTuple):
    """The result of one load, None if nothing was measured there, with eps_gamma as an uncertain number, and warnings."""

    row: LoadResult | None
    epsilon: UFloat | None = None
    troubles: Sequence[str] = ()


def _at_load(
    evidence: DirectEvidence,
    group: LoadGroup,
    slopes: LoadSlopes,
    stiffnesses: Sequence[tuple[LoadGroup, LoadSlopes]],
    after: AfterFit,
) -> _AtLoad:
    """The result at one load, with eps_gamma if all its inputs were measured; ``stiffnesses`` are those of all loads."""
    rig = evidence.rig
    if evidence.skew is None:  # the mean of camber sweeps in both directions holds at true zero sideslip
        slopes = _at_true_sideslip(evidence, group, slopes)
    C_alpha = slopes.C_alpha
    assumed = assumed_stiffness(evidence, group, C_alpha)
    slopes = slopes.of_camber(lambda C_gamma: corrected(evidence, C_gamma, assumed))
    found, troubles = (None, []) if rig is None else turning(evidence, group, slopes)
    factors = calibration(evidence, group, powers_of_load(stiffnesses, group.load), slopes, found)
    slopes = slopes.calibrated(factors.C_alpha, factors.C_gamma)
    if rig is None and not slopes.exists:
        return _AtLoad(None)
    found = found and found.calibrated(factors.F_phit)
    u_axis = evidence.config.rig.u("alpha_0_deg")
    C_zero = slope_at(slopes.C_alpha, group.load)
    split = None if found is None else split_of_zero(found.alpha_M, C_zero, u_axis)
    r_e = effective_radius_at(group.load, evidence.radii, evidence.base) if rig else None
    numbers = {
        "C_alpha": at_true_zero(slopes.C_alpha, slopes.bend, split, u_axis if rig else 0.0),
        "C_gamma": slopes.C_gamma,
        "C_phit": found and found.C_phit,
        "F_phit": found and found.force,
        "r_e": r_e,
        "R": rig and rig.R,
    }
    fields = {} if found is None else _of_zeros(found, split)
    epsilon = None
    if found is not None and slopes.C_gamma is not None and r_e is not None:
        epsilon, of_epsilon = _epsilons(evidence, group, slopes, found, r_e)
        fields |= of_epsilon
        fields["setups"] = results_of_setups(evidence, found, C_alpha, slopes.C_gamma, r_e)
    own = after.stiffnesses.get(group.load, {})
    measured = {name: x for name, x in numbers.items() if x is not None and name not in own}
    fields |= {name: quantity(x, DIRECT[name].unit) for name, x in measured.items()} | {**own}
    fields |= {"budgets": {name: budget(x) for name, x in measured.items()}, "yields": factors.yields}
    return _AtLoad(LoadResult(load=group.load, **fields), epsilon, troubles)


def _of_model_alone(after: AfterFit, rows: Sequence[LoadResult]) -> list[LoadResult]:
    """Results at loads at which only the fitted model has any; a steering yields there as at the nearest other load."""
    yields = {row.load: row.yields for row in rows}
    return [
        LoadResult(
            load,
            yields=yields[min(yields, key=lambda other: abs(other - load))] if yields else 0.0,
            **dict[str, Any](own),
        )
        for load, own in after.stiffnesses.items()
        if load not in yields
    ]


def _of_zeros(found: Turning, split: ZeroSplit | None) -> dict[str, Any]:
    """Fields of :class:`LoadResult` from the zeros; ``split`` is alpha_M, split into axis and tyre."""
    zeros = found.zeros
    return {
        "alpha_M": quantity_if(found.alpha_M, "rad"),
        "misalignment": quantity_if(split and split.misalignment, "rad"),
        "ply_steer": quantity_if(split and split.ply_steer, "rad"),
        "conicity": quantity_if(found.conicity, "N"),
        "F_forward": float(zeros.forward.nominal_value),
        "F_backward": math.nan if zeros.backward is None else float(zeros.backward.nominal_value),
        "paths": found.phi_t,
    }


def _epsilons(
    evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes, found: Turning, r_e: UFloat
) -> tuple[UFloat, dict[str, Any]]:
    """eps_gamma at one load, and the fields of :class:`LoadResult` with all its estimates."""
    assert slopes.C_gamma is not None
    stiffer = stiffer_in_camber(evidence, group)
    epsilon = factor(evidence, slopes.C_gamma, found, r_e, stiffer)
    slope, secant = (
        None if C is None else factor(evidence, C, found, r_e, stiffer) for C in (slopes.slope, slopes.secant)
    )
    # The bias of the secant is far larger than the usual one of finite spin, so without a model only the slope is corrected.
    corrected = epsilon if evidence.spin_of_model else slope
    return epsilon.plain, {
        "epsilon_gamma": quantity(epsilon.plain, "-"),
        "epsilon_debiased": None if corrected is None else quantity(corrected.debiased, "-"),
        "epsilon_slope": None if slope is None else float(slope.plain.nominal_value),
        "epsilon_secant": None if secant is None else float(secant.plain.nominal_value),
        "epsilon_moment": epsilon_from_moments(evidence, group, found, r_e),
        "budget": budget(epsilon.plain),
    }


class _AtNominal(NamedTuple):
    """The result at the nominal load, with notes and warnings."""

    row: LoadResult | None
    law: LoadDependence | None = None  #: None if eps_gamma was not measured
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def _at_nominal(
    evidence: DirectEvidence, per_load: Sequence[LoadResult], epsilons: Mapping[float, UFloat]
) -> _AtNominal:
    """The result at the load nearest to the nominal one that has eps_gamma, and eps_gamma over load; else the nearest result.

    ``epsilons`` are those measured, by load [N].
    """
    nominal_load = evidence.config.tyre.nominal_load
    nearest = min(per_load, key=lambda row: abs(row.load - nominal_load), default=None)
    of_slopes = [] if nearest is None else _if_steering_yields(evidence.config, nearest)
    if nearest is not None and not np.any(np.isfinite(evidence.points.T)):
        of_slopes.append(wording.UNKNOWN_WARMTH)
    if not epsilons:
        lacks = wording.lacking(
            camber=any(row.C_gamma is not None for row in per_load),
            zeros=any(row.C_phit is not None for row in per_load),
            radius=bool(evidence.radii),
        )
        notes = (*(() if evidence.rig else (wording.STRAIGHT_PATH,)), *of_slopes)
        return _AtNominal(nearest, None, notes, (wording.nothing_measured(lacks),) if evidence.rig else ())
    loads = [row.load for row in per_load if row.load in epsilons]
    at = min(range(len(loads)), key=lambda k: abs(loads[k] - nominal_load))
    law = load_dependence(loads, [epsilons[load] for load in loads], at, nominal_load)
    row, left = next(row for row in per_load if row.load == loads[at]), evidence.config.rig.u("alpha_0_deg")
    said, off = wording.alignment(row, left), row.axis_off(left)
    notes = (*_notes(evidence, row, law.note), *of_slopes)
    return _AtNominal(
        row,
        law,
        notes if off or not said else (said, *notes),
        (*_taken_elsewhere(evidence, per_load, row.load), *([said] if off else []), *_skew_warning(evidence)),
    )


def _taken_elsewhere(evidence: DirectEvidence, per_load: Sequence[LoadResult], taken: float) -> list[str]:
    """A sentence if eps_gamma is not measured at the run load nearest to the nominal one: where it is taken, and why."""
    points, nominal = evidence.points, evidence.config.tyre.nominal_load
    steady = points.free_rolling & ~points.continuous
    loads = levels.level_values(np.where(steady, points.Fz, np.nan), levels.LOAD)
    if not np.any(np.isfinite(loads)):
        return []
    expected = float(loads[np.nanargmin(np.abs(loads - nominal))])
    if abs(math.log(expected / taken)) < levels.LOAD.tolerance:
        return []
    row = next((row for row in per_load if abs(math.log(row.load / expected)) < levels.LOAD.tolerance), None)
    main = main_pressure(points)
    there = steady & ~main & (loads == expected)
    others = {
        points.sweep_names[k]: float(np.median(points.p[there & (points.sweep == k)]))
        for k in np.unique(points.sweep[there]).tolist()
    }
    lacks = wording.lacking(
        camber=row is not None and row.C_gamma is not None,
        zeros=row is not None and row.F_phit is not None,
        radius=row is not None and row.r_e is not None,
    )
    return [wording.taken_elsewhere(taken, expected, float(np.median(points.p[main])), others, lacks)]


def _with_measured_skew(evidence: DirectEvidence, slopes: Sequence[LoadSlopes]) -> DirectEvidence:
    """The evidence with the measured value of the rig error that adds to the camber stiffness, and this value in declared units.

    Rolling backwards, the camber force keeps its sign and the slip force changes sign. Therefore half the sum of the two slopes
    is the camber stiffness, and half their difference is the contribution of the rig. Only the sum of several such errors is
    measurable; it is assigned to the error with the largest declared uncertainty.
    """
    both = [
        (row.C_alpha, row.C_gamma, row.C_gamma_backward)
        for row in slopes
        if row.C_alpha is not None and row.C_gamma is not None and row.C_gamma_backward is not None
    ]
    if evidence.rig is None or not both:
        return evidence
    errors = dict(evidence.rig.errors)
    error, declared = max(adding_to_camber(), key=lambda pair: errors[pair[0].name].std_dev)
    assert declared.camber_stiffness is not None
    found = agreed(
        errors[error.name],
        [
            (forward - backward) / (2.0 * declared.camber_stiffness(1.0, AtZero(C_alpha, forward, 0.0)))
            for C_alpha, forward, backward in both
        ],
    )
    errors[error.name] = found
    rig = replace(evidence.rig, errors=errors)
    return replace(evidence, rig=rig, skew=quantity(found, declared.unit))


def _if_steering_yields(config: Config, row: LoadResult) -> list[str]:
    """A sentence if the steering is declared rigid, but a usual compliance would change C_alpha by more than its uncertainty."""
    C_alpha, usual = row.C_alpha, COMPLIANCE.spread
    if C_alpha is None or config.rig.u(COMPLIANCE.name) > 0.0:
        return []
    change = abs(usual * row.yields)
    said = wording.STEERING.format(compliance=usual, percent=100.0 * change)
    return [said] if change > abs(C_alpha.u / C_alpha.value) else []


def _skew_warning(evidence: DirectEvidence) -> list[str]:
    """A sentence if the measured skew far exceeds its declared uncertainty."""
    skew = evidence.skew
    if skew is None:
        return []
    declared = max(evidence.config.rig.u(error.name) for error, _ in adding_to_camber())
    beyond = abs(skew.value) > ALARM * math.hypot(declared, skew.u)
    said = wording.CAMBER_SKEW_BEYOND.format(skew=_stated(skew), declared=declared, unit=skew.unit)
    return [said] if beyond else []


def _stated(found: Quantity) -> str:
    return ascii_only(stated(found, found.unit))


def adding_to_camber() -> tuple[tuple[RigError, Declared], ...]:
    """The declared rig errors that add to the slope over camber, each with its declaration."""
    return tuple((error, declared) for error, declared in DECLARED if declared.camber_stiffness)


def _notes(evidence: DirectEvidence, row: LoadResult, load_note: str) -> tuple[str, ...]:
    """Notes on the results at the nominal load: skew, conicity, load dependence, pressure."""
    used = float(np.mean(evidence.points.p[main_pressure(evidence.points)]))
    nominal = 1e3 * evidence.config.tyre.nominal_pressure
    near = abs(used - nominal) < levels.PRESSURE.tolerance
    return (
        *([wording.CAMBER_SKEW.format(skew=_stated(evidence.skew))] if evidence.skew else []),
        *([] if row.conicity is None else [wording.CONICITY.format(conicity=_stated(row.conicity))]),
        load_note,
        *([] if near else [wording.OFF_NOMINAL_PRESSURE.format(used=used / 1e3, nominal=nominal / 1e3)]),
    )
