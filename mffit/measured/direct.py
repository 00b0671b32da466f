"""The direct method on a set of points: stiffnesses, turn-slip force, eps_gamma with budget, load by load."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
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
from mffit.measured.calibration import Factors, calibration, powers_of_load
from mffit.measured.drift import shares_of_sweeps
from mffit.measured.epsilon import (
    LoadDependence,
    carried_by_file,
    corrected,
    epsilon_from_moments,
    factor,
    load_dependence,
    stiffer_in_camber,
)
from mffit.measured.evidence import DirectEvidence, evidence_of, rest_of_play
from mffit.measured.radii import effective_radius_at
from mffit.measured.result import (
    NO_FIT,
    AfterFit,
    Drift,
    LoadResult,
    Measured,
    MeasuredFacts,
    SetupScatter,
    SideslipZeros,
    SpinStatement,
)
from mffit.measured.setups import excess_forces, results_of_setups, setup_scatter, warnings_of_setups
from mffit.measured.stiffnesses import LoadSlopes, assumed_stiffness, cornering_stiffness, load_slopes
from mffit.measured.turning import Turning, turning
from mffit.measured.uncertain import agreed, budget, quantity, quantity_if
from mffit.measured.zeros import LoadGroup, load_groups, zeros_by_path
from mffit.parts import Parts
from mffit.points import Points, levels, main_pressure
from mffit.quantities import DIRECT
from mffit.rig_errors import BY_NAME, DECLARED, AtZero, Declared, RigError
from mffit.scatter import ALARM
from tir import Quantity, Tyre

COMPLIANCE = BY_NAME["compliance_deg_per_Nm"]


@dataclass(frozen=True, slots=True)
class _AtLoad:
    """The result of one load, with eps_gamma as an uncertain number for later steps."""

    row: LoadResult
    epsilon: UFloat | None
    yields: float  #: relative change of C_alpha by a compliance of the steering of 1 deg/Nm


Judge = Callable[[MeasuredFacts], SpinStatement]
"""Judges direct measurements before they are stated."""


def without_judgement(_: MeasuredFacts) -> SpinStatement:
    """No judgement: a build judges the whole result."""
    return SpinStatement()


def measure(
    config: Config,
    points: Points,
    parts: Parts,
    base: Tyre | None = None,
    after: AfterFit = NO_FIT,
    judge: Judge = without_judgement,
) -> Measured:
    """Stiffnesses, turn-slip force and eps_gamma at every load, from points with the angles as read; stiffnesses only on a flat
    track.

    ``base`` is the property file that supplies the shape of Re over load for loads at which r_e was not measured, ``after`` what
    a fit to these points adds. Raises InputError if the turn-slip force points towards the centre of the disc.
    """
    evidence = evidence_of(config, points, parts, base, after.spin)
    slopes = [(group, *load_slopes(evidence, group)) for group in load_groups(evidence.points)]
    stiffnesses = [(group, own) for group, own, _ in slopes]
    evidence, skew = _with_measured_skew(evidence, [own for _, own in stiffnesses])
    evidence, scatter, zeros, drift = _with_setups(evidence, stiffnesses)
    tried = []
    for group, own in stiffnesses:
        calibrated = partial(calibration, evidence, group, powers_of_load(stiffnesses, group.load))
        # With camber sweeps in both directions (skew), no correction is needed: their mean holds at true zero sideslip.
        at_zero = own if skew else _at_true_sideslip(evidence, group, own)
        tried.append(_at_load(evidence, group, at_zero, calibrated, after))
    rows = [found for found, _ in tried if found is not None]
    rows = sorted([*rows, *_of_model_alone(after, rows)], key=lambda found: found.row.load)
    row, law, notes, of_nominal = _at_nominal(evidence, rows, skew)
    stated, left = judge(MeasuredFacts(row, zeros, drift)), config.rig.u("alpha_0_deg")
    on_disc = None if law is None else row
    of_loads = chain(*(said for *_, said in slopes), *(said for _, said in tried))
    troubles = (*parts.unpaired, *of_loads, *of_nominal)
    return Measured(
        per_load=tuple(found.row for found in rows),
        nominal=row,
        carried=carried_by_file(config, row, law, after.pecp1) if row and law else None,
        r_e_loads={load: float(r.nominal_value) for load, r in evidence.radii.items()},
        misaligned=on_disc is not None and on_disc.slips_beyond(left),
        notes=notes,
        warnings=(*stated.warnings, *troubles, *warnings_of_setups(points, row, scatter, config)),
        load_note=law.note if law else "",
        setup_scatter=scatter,
        sideslip_zeros=zeros,
        drift=drift,
        misaligned_setups=_misaligned_setups(evidence, on_disc) if on_disc else {},
        axis_off=on_disc is not None and on_disc.axis_off(left),
        camber_skew=skew,
        epsilon_gamma_model=after.epsilon_gamma,
        made=stated.made,
        reasons=stated.reasons,
    )


class _WithSetups(NamedTuple):
    """The evidence with what differs between set-ups and sweeps."""

    evidence: DirectEvidence
    scatter: SetupScatter | None = None
    zeros: tuple[SideslipZeros, ...] = ()
    drift: Drift | None = None


def _with_setups(
    evidence: DirectEvidence, stiffnesses: Sequence[tuple[LoadGroup, LoadSlopes]]
) -> _WithSetups:
    """The evidence with scatter and sideslip zeros of the set-ups and with a drift; unchanged on a straight path."""
    if evidence.rig is None:
        return _WithSetups(evidence)
    scatter = setup_scatter(evidence, stiffnesses)
    evidence = replace(evidence, excess=excess_forces(scatter, evidence.rig.of_setups))
    evidence, drift = _with_drift(evidence)
    axes, zeros = _sideslip_zeros(evidence, stiffnesses)
    return _WithSetups(replace(evidence, axes=axes), scatter, zeros, drift)


def _with_drift(evidence: DirectEvidence) -> tuple[DirectEvidence, Drift | None]:
    """The evidence, with the relative forces of the sweeps if they clearly drift, and the drift.

    The drift is None if the recorded temperature varies, which may explain it.
    """
    points = evidence.points
    if np.ptp(points.T) > VISIBLE_TEMPERATURE:
        return evidence, None
    shares = shares_of_sweeps(points)
    if shares is None:
        return evidence, None
    return (replace(evidence, shares=shares) if shares.drift.counts else evidence), shares.drift


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


def _at_load(
    evidence: DirectEvidence,
    group: LoadGroup,
    slopes: LoadSlopes,
    calibrated: Callable[[LoadSlopes, Turning | None], Factors],
    after: AfterFit,
) -> tuple[_AtLoad | None, list[str]]:
    """Results and warnings at one load, with eps_gamma if all its inputs were measured; None without any result."""
    C_alpha, rig = slopes.C_alpha, evidence.rig
    assumed = assumed_stiffness(evidence, group, C_alpha)
    slopes = slopes.of_camber(lambda C_gamma: corrected(evidence, C_gamma, assumed))
    found, troubles = (None, []) if rig is None else turning(evidence, group, slopes)
    factors = calibrated(slopes, found)
    slopes = slopes.calibrated(factors.C_alpha, factors.C_gamma)
    if rig is None and not slopes.exists:
        return None, []
    found = found and found.calibrated(factors.F_phit)
    numbers = _numbers(evidence, group, slopes, found)
    fields: dict[str, Any] = {} if found is None else _of_zeros(evidence, group, found, slopes)
    epsilon, r_e = None, numbers["r_e"]
    if found is not None and slopes.C_gamma is not None and r_e is not None:
        epsilon, of_epsilon = _epsilons(evidence, group, slopes, found, r_e)
        fields |= of_epsilon
        fields["setups"] = results_of_setups(evidence, found, C_alpha, slopes.C_gamma, r_e)
    own = after.stiffnesses.get(group.load, {})
    measured = {name: x for name, x in numbers.items() if x is not None and name not in own}
    fields |= {name: quantity(x, DIRECT[name].unit) for name, x in measured.items()} | {**own}
    fields |= {"budgets": {name: budget(x) for name, x in measured.items()}}
    return _AtLoad(LoadResult(load=group.load, **fields), epsilon, factors.yields), troubles


def _of_model_alone(after: AfterFit, rows: Sequence[_AtLoad]) -> list[_AtLoad]:
    """Results at loads at which only the fitted model has any; a steering yields there as at the nearest other load."""
    yields = {found.row.load: found.yields for found in rows}
    return [
        _AtLoad(
            LoadResult(load, **dict[str, Any](own)),
            None,
            yields[min(yields, key=lambda other: abs(other - load))] if yields else 0.0,
        )
        for load, own in after.stiffnesses.items()
        if load not in yields
    ]


def _numbers(
    evidence: DirectEvidence, group: LoadGroup, slopes: LoadSlopes, found: Turning | None
) -> dict[str, UFloat | None]:
    """The quantities at one load that eps_gamma is made of, by their names in :class:`LoadResult`."""
    u_axis = evidence.config.rig.u("alpha_0_deg") if evidence.rig else 0.0
    stiffness = at_true_zero(slopes.C_alpha, slopes.bend, _split(evidence, group, found, slopes), u_axis)
    return {
        "C_alpha": stiffness,
        "C_gamma": slopes.C_gamma,
        "C_phit": found and found.C_phit,
        "F_phit": found and found.force,
        "r_e": effective_radius_at(group.load, evidence.radii, evidence.base) if evidence.rig else None,
        "R": evidence.rig and evidence.rig.R,
    }


def _split(
    evidence: DirectEvidence, group: LoadGroup, found: Turning | None, slopes: LoadSlopes
) -> ZeroSplit | None:
    """The parts of alpha_M from axis and tyre; None if it was not measured."""
    if found is None:
        return None
    C_alpha = slope_at(slopes.C_alpha, group.load)
    return split_of_zero(found.alpha_M, C_alpha, evidence.config.rig.u("alpha_0_deg"))


def _of_zeros(
    evidence: DirectEvidence, group: LoadGroup, found: Turning, slopes: LoadSlopes
) -> dict[str, Any]:
    """Fields of :class:`LoadResult` from the zeros."""
    zeros, split = found.zeros, _split(evidence, group, found, slopes)
    return {
        "alpha_M": quantity_if(found.alpha_M, "rad"),
        "misalignment": quantity_if(split.misalignment, "rad") if split else None,
        "ply_steer": quantity_if(split.ply_steer, "rad") if split else None,
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
    """The result at the nominal load, and what is said of it."""

    row: LoadResult | None
    law: LoadDependence | None = None  #: None if eps_gamma was not measured
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


def _at_nominal(evidence: DirectEvidence, rows: Sequence[_AtLoad], skew: Quantity | None) -> _AtNominal:
    """The result at the load nearest to the nominal one that has eps_gamma, and eps_gamma over load; else the nearest result."""
    nominal_load = evidence.config.tyre.nominal_load
    nearest = min(rows, key=lambda found: abs(found.row.load - nominal_load), default=None)
    of_slopes = [] if nearest is None else _if_steering_yields(evidence.config, nearest)
    if nearest is not None and not np.any(np.isfinite(evidence.points.T)):
        of_slopes.append(wording.UNKNOWN_WARMTH)
    known = [(found, found.epsilon) for found in rows if found.epsilon is not None]
    if not known:
        per_load = [found.row for found in rows]
        lacking = wording.nothing_measured(
            camber=any(row.C_gamma is not None for row in per_load),
            zeros=any(row.C_phit is not None for row in per_load),
            radius=bool(evidence.radii),
        )
        notes = (*(() if evidence.rig else (wording.STRAIGHT_PATH,)), *of_slopes)
        return _AtNominal(nearest.row if nearest else None, None, notes, (lacking,) if evidence.rig else ())
    loads = [found.row.load for found, _ in known]
    at = min(range(len(known)), key=lambda k: abs(loads[k] - nominal_load))
    law = load_dependence(loads, [epsilon for _, epsilon in known], at, nominal_load)
    row, left = known[at][0].row, evidence.config.rig.u("alpha_0_deg")
    said, off = wording.alignment(row, left), row.axis_off(left)
    notes = (*_notes(evidence, row, skew, law.note), *of_slopes)
    elsewhere = _taken_elsewhere(evidence, [found.row for found in rows], row.load)
    return _AtNominal(
        row,
        law,
        notes if off or not said else (said, *notes),
        (*elsewhere, *([said] if off else []), *_skew_warning(evidence, skew)),
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
    said = wording.taken_elsewhere(
        taken,
        expected,
        float(np.median(points.p[main])),
        others,
        camber=row is not None and row.C_gamma is not None,
        zeros=row is not None and row.F_phit is not None,
        radius=row is not None and row.r_e is not None,
    )
    return [said]


def _with_measured_skew(
    evidence: DirectEvidence, slopes: Sequence[LoadSlopes]
) -> tuple[DirectEvidence, Quantity | None]:
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
        return evidence, None
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
    measured = replace(evidence, rig=replace(evidence.rig, errors=errors))
    return measured, quantity(found, declared.unit)


def _if_steering_yields(config: Config, found: _AtLoad) -> list[str]:
    """A sentence if the steering is declared rigid, but a usual compliance would change C_alpha by more than its uncertainty."""
    C_alpha, usual = found.row.C_alpha, COMPLIANCE.spread
    if C_alpha is None or config.rig.u(COMPLIANCE.name) > 0.0:
        return []
    change = abs(usual * found.yields)
    return [wording.steering(usual, change)] if change > abs(C_alpha.u / C_alpha.value) else []


def _skew_warning(evidence: DirectEvidence, skew: Quantity | None) -> list[str]:
    """A sentence if the measured skew far exceeds its declared uncertainty."""
    if skew is None:
        return []
    declared = max(evidence.config.rig.u(error.name) for error, _ in adding_to_camber())
    beyond = abs(skew.value) > ALARM * math.hypot(declared, skew.u)
    return [wording.camber_skew_beyond(skew, declared)] if beyond else []


def adding_to_camber() -> tuple[tuple[RigError, Declared], ...]:
    """The declared rig errors that add to the slope over camber, each with its declaration."""
    return tuple((error, declared) for error, declared in DECLARED if declared.camber_stiffness)


def _notes(
    evidence: DirectEvidence, row: LoadResult, skew: Quantity | None, load_note: str
) -> tuple[str, ...]:
    """Notes on the results at the nominal load: skew, conicity, load dependence, pressure."""
    used = float(np.mean(evidence.points.p[main_pressure(evidence.points)]))
    nominal = 1e3 * evidence.config.tyre.nominal_pressure
    near = abs(used - nominal) < levels.PRESSURE.tolerance
    return (
        *([wording.camber_skew(skew)] if skew else []),
        *([] if row.conicity is None else [wording.conicity_measured(row.conicity)]),
        load_note,
        *([] if near else [wording.off_nominal_pressure(used, nominal)]),
    )
