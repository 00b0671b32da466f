"""The direct method on a set of points: stiffnesses, turn-slip force, eps_gamma with budget, load by load."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import USUAL_U_MOMENT
from mffit.measured import camber_reduction as method
from mffit.measured import constants, notes
from mffit.measured.alignment import AxisAtLoad
from mffit.measured.at_zero import (
    PathZeros,
    ZeroReadings,
    refuse_inward,
    turn_slip_of_path,
    unlike_zeros,
    zeros_by_path,
)
from mffit.measured.backlash import backlash_corrected, odd_alpha
from mffit.measured.groups import LoadGroup, load_groups
from mffit.measured.loads import load_dependence
from mffit.measured.paths import (
    PathForce,
    TurnSlipStiffness,
    least_uncertain_mean,
    turn_slip_stiffness,
    u_by_draws,
)
from mffit.measured.radii import effective_radius_at, measured_effective_radius, measured_path_radius
from mffit.measured.result import CONICITY, Contribution, LoadResult, Measured, SetupScatter
from mffit.measured.setups import excess_forces, of_setups, results_of_setups, setup_scatter
from mffit.measured.slopes import Secant, SlopeAtZero, slope_at_zero
from mffit.measured.stiffnesses import (
    Estimates,
    chosen_camber_stiffness,
    cornering,
    estimates,
    number,
    sweep,
    u_odd,
)
from mffit.parts import Parts
from mffit.points import Points
from mffit.rig_errors import DECLARED, AtZero
from tir import Quantity, Tyre


@dataclass(frozen=True, slots=True)
class _Evidence:
    """Input of the direct method, common to all loads."""

    config: Config
    points: Points  #: with sideslip angles corrected for the play
    parts: Parts
    odd_slip: np.ndarray  #: (n,) sideslip to which the odd part of every point belongs [rad]
    rig: method.UncertainRig | None  #: None on a straight path
    scatter: SetupScatter | None  #: of repeated set-ups
    excess: Mapping[str, UFloat]  #: force by which each set-up scatters beyond what is declared [N]
    radii: Mapping[float, UFloat]  #: measured effective radius [m] by load [N]
    base: Tyre | None


@dataclass(frozen=True, slots=True)
class _Slopes:
    """The stiffnesses of one load."""

    C_alpha: UFloat | None  #: [N/rad]
    C_gamma: UFloat | None  #: as read off the forward sweep by the configured method [N/rad]
    C_gamma_backward: UFloat | None  #: the same of a backward sweep
    camber: Estimates  #: of the forward sweep
    exists: bool  #: whether anything could be estimated


@dataclass(frozen=True, slots=True)
class _Turning:
    """Turn-slip force and stiffness of one load."""

    found: tuple[PathZeros, ...]  #: of every path and set-up, the usual path first
    paths: tuple[PathForce, ...]
    stiffness: TurnSlipStiffness
    force: UFloat  #: on the usual path [N]

    @property
    def zeros(self) -> ZeroReadings:
        """The readings on the usual path."""
        return self.found[0].readings

    @property
    def phi_t(self) -> tuple[float, ...]:
        """Turn slip of every path [1/m]."""
        return tuple(dict.fromkeys(path.phi_t for path in self.found))

    @property
    def sign(self) -> float:
        """Sign of the usual path's turn slip."""
        return self.paths[0].sign

    @property
    def alpha_M(self) -> UFloat | None:
        """Sideslip misalignment [rad] of the first path that was run both ways."""
        return next((path.alpha_M for path in self.paths if path.alpha_M is not None), None)


@dataclass(frozen=True, slots=True)
class _AtLoad:
    """The result of one load, with eps_gamma and its derivative for the next steps."""

    row: LoadResult
    epsilon: UFloat | None
    per_newton: float  #: derivative of eps_gamma by a force that is the same on every path [1/N]


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
    evidence = _evidence(config, points, parts, base)
    warnings: list[str] = []
    rows = []
    found_slopes = [(group, *_slopes(evidence, group)) for group in load_groups(evidence.points)]
    evidence, skew = _with_measured_skew(evidence, [slopes for _, slopes, _ in found_slopes])
    stiffnesses = [(group, slopes.C_alpha, slopes.C_gamma) for group, slopes, _ in found_slopes]
    if evidence.rig is not None:
        scatter = setup_scatter(evidence.points, stiffnesses, evidence.rig, config)
        evidence = replace(evidence, scatter=scatter, excess=excess_forces(scatter, evidence.rig))
    for group, slopes, troubles in found_slopes:
        found, more = _at_load(evidence, group, slopes)
        rows += [] if found is None else [found]
        warnings += troubles + more
    measured, troubles = _assembled(evidence, rows, skew)
    remarks = of_setups(points, measured, evidence.scatter, config)
    return replace(
        measured,
        notes=(*measured.notes, *remarks.notes),
        warnings=(*parts.unpaired, *warnings, *troubles, *remarks.warnings),
        setup_scatter=evidence.scatter,
    )


def at_the_axis(config: Config, points: Points, parts: Parts) -> dict[float, AxisAtLoad]:
    """Cornering stiffness and zeros by load [N] for the alignment; an inward turn-slip force is not refused."""
    evidence = _evidence(config, points, parts, None)
    out = {}
    for group in load_groups(evidence.points):
        C_alpha = _cornering_stiffness(evidence, group)
        paths = zeros_by_path(evidence.points, group, C_alpha, config) if evidence.rig else []
        # Of several set-ups on the usual path the last one is aligned.
        zero = [path for path in paths if path.phi_t == paths[0].phi_t][-1].readings if paths else None
        out[group.load] = AxisAtLoad(
            method.quantity(C_alpha, "N/rad"),
            zero.forward if zero else math.nan,
            zero.backward if zero else math.nan,
        )
    return out


def _evidence(config: Config, points: Points, parts: Parts, base: Tyre | None) -> _Evidence:
    R = measured_path_radius(config)
    u = {error.name: config.rig.u(error.name) for error, _ in DECLARED}
    return _Evidence(
        config=config,
        points=backlash_corrected(points, config),
        parts=parts,
        odd_slip=odd_alpha(points, parts, config),
        rig=None if R is None else method.uncertain_rig(u, R, points.used_setups),
        scatter=None,
        excess={},
        radii=measured_effective_radius(config, R),
        base=base,
    )


def _at_load(evidence: _Evidence, group: LoadGroup, slopes: _Slopes) -> tuple[_AtLoad | None, list[str]]:
    """Results and warnings at one load; None if nothing could be measured."""
    if evidence.rig is None:
        straight = _AtLoad(_row(group, slopes, None, slopes.C_gamma), None, 0.0)
        return (straight if slopes.exists else None), []
    turning, troubles = _turning(evidence, group, slopes)
    r_e = effective_radius_at(group.load, evidence.radii, evidence.base)
    return _result(evidence, group, slopes, turning, r_e), troubles


def _slopes(evidence: _Evidence, group: LoadGroup) -> tuple[_Slopes, list[str]]:
    """Cornering and camber stiffness, from the odd curves on a disc and from the curves themselves on a straight path."""
    config = evidence.config
    C_alpha = _cornering_stiffness(evidence, group)
    (camber, largest), (backward, largest_backward) = (
        _camber_estimates(evidence, group, C_alpha, direction) for direction in (1, -1)
    )
    C_gamma, trouble = chosen_camber_stiffness(config, camber, largest, group.load)
    C_backward, _ = chosen_camber_stiffness(config, backward, largest_backward, group.load)
    exists = not (C_alpha is None and camber.slope is None and camber.secant is None)
    slopes = _Slopes(C_alpha, C_gamma, C_backward if evidence.rig else None, camber, exists)
    return slopes, [trouble] if trouble else []


def _camber_estimates(
    evidence: _Evidence, group: LoadGroup, C_alpha: UFloat | None, direction: int
) -> tuple[Estimates, float]:
    """Slope and secant of the camber sweep in one direction, and the largest camber in it [rad]."""
    config, points = evidence.config, evidence.points
    odd_Fy = evidence.parts.Fy_odd if evidence.rig else points.Fy
    index = sweep(points, odd_Fy, group, "gamma", config, direction)
    if C_alpha is not None:  # less the force of the sideslip that backlash leaves in a camber sweep
        in_sweep = np.isin(np.arange(len(points)), index)
        slip_force = direction * C_alpha.nominal_value * evidence.odd_slip
        odd_Fy = np.where(in_sweep, odd_Fy - slip_force, odd_Fy)
    local, angle = constants.CUBIC_CAMBER.rad, math.radians(config.camber_stiffness.angle_deg)
    found = estimates(points.gamma, odd_Fy, u_odd(evidence.parts), index, local, angle)
    return found, float(points.gamma[index].max(initial=0.0))


def _with_measured_skew(evidence: _Evidence, slopes: Sequence[_Slopes]) -> tuple[_Evidence, Quantity | None]:
    """The evidence with rig errors that forward and backward camber sweeps measure, and what was found of the skew.

    Rolling backwards the camber force keeps its sign and the slip force changes it: half the difference of both slopes is
    what the rig adds, half their sum is the camber stiffness.
    """
    both = [
        (row.C_alpha, row.C_gamma, row.C_gamma_backward)
        for row in slopes
        if row.C_alpha is not None and row.C_gamma is not None and row.C_gamma_backward is not None
    ]
    if evidence.rig is None or not both:
        return evidence, None
    errors = dict(evidence.rig.errors)
    skew = None
    for error, declared in DECLARED:
        if declared.camber_stiffness is None:
            continue
        estimates_of_it = [
            (forward - backward) / (2.0 * declared.camber_stiffness(1.0, AtZero(C_alpha, forward, 0.0)))
            for C_alpha, forward, backward in both
        ]
        found = least_uncertain_mean([errors[error.name], *estimates_of_it])
        errors[error.name] = found
        skew = Quantity(found.nominal_value, found.std_dev, declared.unit)
    return replace(evidence, rig=replace(evidence.rig, errors=errors)), skew


def _cornering_stiffness(evidence: _Evidence, group: LoadGroup) -> UFloat | None:
    found = cornering(evidence.points, evidence.parts, evidence.odd_slip, group, evidence.config)
    return number(found.slope or found.secant, "cornering stiffness")


def _turning(evidence: _Evidence, group: LoadGroup, slopes: _Slopes) -> tuple[_Turning | None, list[str]]:
    """Turn-slip force and stiffness from the zeros of every path; None without zeros."""
    config, points, rig = evidence.config, evidence.points, evidence.rig
    assert rig is not None
    found = zeros_by_path(points, group, slopes.C_alpha, config)
    if not found:
        return None, []
    troubles: list[str] = []
    for path in found:
        troubles += unlike_zeros(points, path.group, slopes.C_alpha, config)
    both = (slopes.C_alpha, slopes.C_gamma)
    paths = tuple(
        turn_slip_of_path(path, both, rig, config, evidence.excess.get(path.setup)) for path in found
    )
    combined = turn_slip_stiffness(paths)
    if combined.contradictory:
        alone = [Quantity(C.nominal_value, C.std_dev, "Nm") for C in combined.of_paths]
        troubles.append(notes.paths_contradict(group.load, [-1.0 / path.phi_t for path in found], alone))
    force = paths[0].force if len(paths) == 1 else paths[0].sign * combined.C_phit / rig.R
    turning = _Turning(tuple(found), paths, combined, force)
    if combined.C_phit.nominal_value <= 0.0:
        refuse_inward(force.nominal_value, group.load, turning.alpha_M, config)
    return turning, troubles


def _result(
    evidence: _Evidence, group: LoadGroup, slopes: _Slopes, turning: _Turning | None, r_e: UFloat | None
) -> _AtLoad:
    """The record of one load of a disc, with eps_gamma where everything that it needs was measured."""
    rig = evidence.rig
    assert rig is not None
    C_gamma = slopes.C_gamma
    if C_gamma is not None and slopes.C_alpha is not None:
        C_gamma = method.true_camber_stiffness(
            C_gamma, rig.errors, AtZero(slopes.C_alpha.nominal_value, C_gamma.nominal_value, 0.0)
        )
    row = replace(
        _row(group, slopes, turning, C_gamma), r_e=method.quantity(r_e, "m"), R=method.quantity(rig.R, "m")
    )
    if turning is None or slopes.C_gamma is None or r_e is None:
        return _AtLoad(row, None, 0.0)
    epsilon = method.camber_reduction(turning.force, C_gamma, r_e, rig.R, turning.sign).epsilon_gamma

    def with_estimate(estimate: SlopeAtZero | Secant | None) -> float | None:
        if estimate is None:
            return None
        other = method.camber_reduction(turning.force, estimate.value, r_e, rig.R, turning.sign)
        return float(other.epsilon_gamma.nominal_value)

    row = replace(
        row,
        epsilon_gamma=method.quantity(epsilon, "-"),
        epsilon_slope=with_estimate(slopes.camber.slope),
        epsilon_secant=with_estimate(slopes.camber.secant),
        epsilon_moment=method.quantity(_from_moments(evidence, group, turning, r_e), "-"),
        setups=results_of_setups(turning.found, turning.paths, C_gamma, r_e, evidence.config),
        budget=method.budget(epsilon),
        u_monte_carlo=u_by_draws(turning.paths, turning.stiffness.weights, C_gamma, r_e, rig),
    )
    return _AtLoad(
        row, epsilon, sum(epsilon.derivatives.get(errors["F0_N"], 0.0) for errors in rig.everywhere)
    )


def _row(group: LoadGroup, slopes: _Slopes, turning: _Turning | None, C_gamma: UFloat | None) -> LoadResult:
    """The record of one load without eps_gamma."""
    return LoadResult(
        load=group.load,
        C_alpha=method.quantity(slopes.C_alpha, "N/rad"),
        C_gamma=method.quantity(C_gamma, "N/rad"),
        C_gamma_slope=_estimated(slopes.camber.slope),
        C_gamma_secant=_estimated(slopes.camber.secant),
        F_phit=method.quantity(turning.force, "N") if turning else None,
        C_phit=method.quantity(turning.stiffness.C_phit, "Nm") if turning else None,
        alpha_M=method.quantity(turning.alpha_M, "rad") if turning else None,
        F_forward=turning.zeros.forward if turning else math.nan,
        F_backward=turning.zeros.backward if turning else math.nan,
        paths=turning.phi_t if turning else (),
    )


def _estimated(estimate: SlopeAtZero | Secant | None) -> Quantity | None:
    return None if estimate is None else Quantity(estimate.value, estimate.u, "N/rad")


def _from_moments(evidence: _Evidence, group: LoadGroup, turning: _Turning, r_e: UFloat) -> UFloat | None:
    """eps_gamma from the moments; informational, as it scatters widely."""
    moment, parts, rig = turning.zeros.moment, evidence.parts, evidence.rig
    assert rig is not None
    if moment is None or abs(moment.nominal_value) < constants.CLEAR_MOMENT * moment.std_dev:
        return None
    u = np.where(np.isfinite(parts.u_Mz_odd), parts.u_Mz_odd, USUAL_U_MOMENT / math.sqrt(2.0))
    index = sweep(evidence.points, parts.Mz_odd, group, "gamma", evidence.config)
    slope = slope_at_zero(
        evidence.points.gamma[index], parts.Mz_odd[index], u[index], local=constants.CUBIC_CAMBER.rad
    )
    if slope is None:
        return None
    C = method.named(slope.value, slope.u, "camber moment stiffness", "Nm/rad")
    return 1.0 + r_e * C / (turning.sign * moment * rig.R)


def _assembled(
    evidence: _Evidence, rows: Sequence[_AtLoad], skew: Quantity | None
) -> tuple[Measured, list[str]]:
    """The results of all loads together, with eps_gamma over load and the remarks."""
    nominal_load = evidence.config.tyre.nominal_load
    per_load = tuple(found.row for found in rows)
    r_e_loads = {load: float(r.nominal_value) for load, r in evidence.radii.items()}
    known = [(found, found.epsilon) for found in rows if found.epsilon is not None]
    if not known:
        nothing = Measured(
            per_load=per_load,
            nominal=min(per_load, key=lambda row: abs(row.load - nominal_load), default=None),
            pecp1=None,
            pecp2=0.0,
            u_pecp2=None,
            r_e_loads=r_e_loads,
            misaligned=False,
            notes=() if evidence.rig else (notes.STRAIGHT_PATH,),
            warnings=(),
        )
        return nothing, [notes.NOTHING_MEASURED] if evidence.rig else []
    loads = [found.row.load for found, _ in known]
    at = min(range(len(known)), key=lambda k: abs(loads[k] - nominal_load))
    law = load_dependence(loads, [epsilon for _, epsilon in known], at, nominal_load)
    nominal = known[at][0]
    row, axis = nominal.row, alignment_verdict(evidence.config, nominal.row)
    share = constants.PLAUSIBLE_CONICITY
    # Conicity has the same sign on every path.
    conicity = Contribution(CONICITY, share * row.load, "N", abs(share * row.load * nominal.per_newton))
    measured = Measured(
        per_load=per_load,
        nominal=row,
        pecp1=law.pecp1,
        pecp2=law.pecp2,
        u_pecp2=law.u_pecp2,
        r_e_loads=r_e_loads,
        misaligned=axis.misaligned,
        notes=(
            *([axis.sentence] if axis.sentence and not axis.misaligned else []),
            *([notes.camber_skew(skew)] if skew else []),
            *([_of_paths(row)] if len(row.paths) > 1 else []),
            law.note,
            notes.STANDARD_UNCERTAINTIES,
            notes.conicity(share, conicity.u, conicity.contribution),
            notes.CONTACT_WANDERS,
        ),
        warnings=(),
        load_note=law.note,
        conicity=conicity,
    )
    return measured, [axis.sentence] if axis.misaligned else []


def _of_paths(row: LoadResult) -> str:
    """The remark on several paths."""
    one_setup = len({setup.name for setup in row.setups}) < 2
    return notes.several_paths([-1.0 / phi_t for phi_t in row.paths], one_setup=one_setup)


class AlignmentVerdict(NamedTuple):
    """Whether the sideslip axis is off by more than the rig's own alignment leaves."""

    misaligned: bool
    sentence: str  #: empty where both sides of the disc make the misalignment cancel


def alignment_verdict(config: Config, row: LoadResult) -> AlignmentVerdict:
    """The verdict at one load with a turn-slip force."""
    assert row.F_phit is not None
    force, left = row.F_phit.value, config.rig.u("alpha_0_deg")
    if row.alpha_M is None and min(row.paths) < 0.0 < max(row.paths):
        return AlignmentVerdict(False, "")
    if row.alpha_M is None:
        angle = math.degrees(abs(force / row.C_alpha.value)) if row.C_alpha is not None else None
        return AlignmentVerdict(False, notes.not_separable(force, angle, left))
    slip = (row.F_forward - row.F_backward) / 2.0
    misaligned = abs(slip) > left
    sentence = notes.misaligned if misaligned else notes.aligned
    return AlignmentVerdict(misaligned, sentence(row.alpha_M, slip, _shift(row, slip)))


def _shift(row: LoadResult, force: float) -> float:
    """Change of eps_gamma by a force [N] that is taken for turn slip."""
    assert row.epsilon_gamma is not None
    assert row.F_phit is not None
    return abs((1.0 - row.epsilon_gamma.value) * force / row.F_phit.value)
