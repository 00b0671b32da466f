"""Sentences of the direct method: notes, warnings, and statements on results for page and terminal."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

from mffit.measured.result import Alignment, LoadResult, Measured, SetupScatter, Source, usual_ply_steer
from tir import Quantity

STRAIGHT_PATH = "A flat track's path is straight: it has no turn slip to measure."
ONE_LOAD = "PECP2 is 0: one load was measured."
EPSILON_IN_NOISE = "PECP2 is 0: eps_gamma itself is within 2 u of zero, so a relative slope has no meaning."
LOAD_SLOPE = "PECP2 = {pecp2:.3f} +- {u:.3f} (k = 1)."
SLOPE_IN_NOISE = "PECP2 is 0: the slope {slope:.3f} per nominal load is within 2 u = {twice:.3f}."
SLOPE_TOO_STEEP = "PECP2 is 0: eps_gamma would reach {largest:.2f} within the loads."
OFF_NOMINAL_PRESSURE = (
    "Everything here holds at {used:.0f} kPa, that of most sweeps; the nominal pressure is {nominal:.0f} kPa."
)
CAMBER_SKEW = (
    "Forward and backward camber sweeps: leaning steers the wheel by {skew} times the sine of the camber angle (camber skew). It "
    "is subtracted from the camber stiffness."
)
CAMBER_SKEW_BEYOND = (
    "the camber axis is not square to the steering axis: forward and backward camber sweeps show a camber skew of {skew}, and "
    "{declared:g} {unit} are declared (u_camber_skew_deg); it is corrected here; square the axis, or declare what it can be"
)
CONICITY = (
    "Zeros on both mounts: the conicity force is {conicity}. It is subtracted from the turn-slip force."
)
GUESSED_STIFFNESS = (
    "no upright forward sideslip sweep at {load:.0f} N gives C_alpha, so what play and camber skew do to eps_gamma is corrected "
    "by the usual stiffness of tyres; add the sweep, or check direction and mount of its file"
)
SLOPE_NOT_POSSIBLE = (
    "at {load:.0f} N the camber sweep is too short for the slope at zero; the secant at {angle:g} deg is used, which is a few "
    "per cent low: add cambers up to 20 deg"
)
SECANT_NOT_POSSIBLE = (
    "at {load:.0f} N the camber sweep does not reach {angle:g} deg; the slope at zero is used in "
    "place of the secant"
)
ZEROS_DISAGREE = (
    "at {load:.0f} N the {way} zeros of {least} and {most} are {low:.0f} N and {high:.0f} N; these zeros cannot come from one "
    "path: look for a sweep whose path_centre, path_radius or direction is not declared, or for an axis that was moved between "
    "them"
)
SETUP_WITHOUT_ZEROS = (
    "set-up {name} has no points at zero sideslip and camber: its zeros are known only as declared in [rig], and it adds nothing "
    "to the turn-slip force; run zeros in every set-up"
)
SWEEPS_WITHOUT_SETUP = (
    "{files}: no setup is given, although other sweeps on this path give one; they count as a set-up of their own. Give setup in "
    "every [[sweep]]"
)
LAST_IS_ALIGNED = "the usual path was run in several set-ups; the correction is that of the last one, {name}"
SETUP_MISALIGNED = (
    "set-up {name}: the sideslip axis is misaligned, alpha_M = {angle} deg; the fit corrects the angles of "
    "this set-up for it"
)
STEERING = (
    "C_alpha holds for a rigid steering, as declared: one that yields by {compliance:g} deg per Nm of Mz would change it by "
    "{percent:.1f} %. Measure the compliance and state it as u_steering_compliance_deg_per_Nm; without a model of the tyre "
    "nothing else shows it."
)
UNKNOWN_WARMTH = (
    "C_alpha and C_gamma are of the tyre as warm as its sweeps leave it at zero: no temperature (T_degC) was recorded, and a "
    "tyre that loses 6 % along each sweep is 3 % stiffer when cold."
)


def lacking(*, camber: bool, zeros: bool, radius: bool) -> list[str]:
    """The inputs that eps_gamma lacks; ``camber``, ``zeros`` and ``radius`` state whether these exist."""
    needed = {
        "a camber sweep at zero sideslip": camber,
        "points at zero sideslip and camber": zeros,
        "the rolling radius (write one turn of the disc under [rolling_radius] of tyre.toml)": radius,
    }
    return [what for what, there in needed.items() if not there]


def taken_elsewhere(
    taken: float, expected: float, pressure: float, others: Mapping[str, float], lacks: Sequence[str]
) -> str:
    """The warning that eps_gamma is taken at another load [N] than expected, where inputs are lacking.

    ``others`` are the sweeps at the expected load and another pressure, with that pressure [Pa].
    """
    said = (
        f"eps_gamma is taken at {taken:.0f} N and not at {expected:.0f} N, the load nearest to the nominal one: at the main "
        f"pressure of {1e-3 * pressure:.0f} kPa there is no complete measurement there"
    )
    if lacks:
        said += f", for lack of {' and '.join(lacks)}"
    if others:
        named = ", ".join(f"{name} ({1e-3 * p:.0f} kPa)" for name, p in others.items())
        said += f"; {named} ran at {expected:.0f} N and another pressure: check p_kPa there"
    return said


def nothing_measured(lacks: Sequence[str]) -> str:
    """The warning that eps_gamma lacks inputs at every load."""
    if not lacks:
        return "eps_gamma could not be measured: camber sweep and zeros are at different loads; it needs both at one load"
    return f"eps_gamma could not be measured, for lack of {' and '.join(lacks)}"


def alignment(row: LoadResult, u: float) -> str:
    """A sentence on the sideslip axis from the zeros; empty if both sides of the disc cancel its effect.

    ``u`` is the declared alignment uncertainty as a force [N].
    """
    assert row.F_phit is not None
    if row.alpha_M is None:
        return "" if min(row.paths) < 0.0 < max(row.paths) else _not_separable(row, row.F_phit.value, u)
    slip = row.slip_force(row.alpha_M.value)
    whole, of_axis, of_tyre = (angle_text(x) for x in (row.alpha_M, row.misalignment, row.ply_steer))
    said = (
        f"misalignment plus ply-steer alpha_M = {whole} deg ({slip:.0f} N); uncorrected it would move eps_gamma by "
        f"{row.shift_by(slip):.2f}. By usual sizes of both, misalignment is {of_axis} deg and ply-steer {of_tyre} deg"
    )
    if row.axis_off(u):
        return (
            f"the sideslip axis is misaligned: {said}; forward and backward forces differ by {abs(2 * slip):.0f} N. The angles "
            "are corrected for the sum"
        )
    end = (
        "exceeds what the alignment is declared to leave, but usual ply-steer can explain it"
        if row.slips_beyond(u)
        else "is within what the alignment leaves"
    )
    return f"Forward and backward runs: {said}. The sum {end}."


def _not_separable(row: LoadResult, force: float, u: float) -> str:
    """The sentence for data without backward runs; C_alpha from a sideslip sweep converts the force to an angle."""
    angle = (
        "an unknown angle (no sideslip sweep gives C_alpha)"
        if row.C_alpha is None
        else f"{math.degrees(abs(force / row.C_alpha.value)):.2f} deg"
    )
    return (
        f"Sideslip misalignment, turn slip and ply-steer cannot be separated here. If the force {force:.0f} N at (0, 0) were "
        f"not turn slip, it would take {angle} of misalignment or ply-steer. The alignment is assumed to leave {u:.0f} N (k = 1)."
    )


def angle_text(x: Quantity | None) -> str:
    """An angle with its standard uncertainty [deg]."""
    return "unknown" if x is None else f"{math.degrees(x.value):.3f} +- {math.degrees(x.u):.3f}"


def paths_contradict(load: float, radii: Sequence[float], C_phit: Sequence[Quantity]) -> str:
    found = ", ".join(
        f"{C.value:.0f} +- {C.u:.0f} Nm (disc's centre {_centre(R)})"
        for R, C in zip(radii, C_phit, strict=True)
    )
    return (
        f"at {load:.0f} N the zeros of the paths contradict each other: they give turn-slip stiffnesses of {found}; look for a "
        "path_centre or path_radius that is not the run's, or for an offset, a camber zero or an alignment worse than declared"
    )


def _centre(R: float) -> str:
    """Place of the disc's centre, to the left for a positive radius [m]."""
    return f"{abs(R):.3g} m to the {'left' if R > 0.0 else 'right'}"


def setup_scatter(found: SetupScatter) -> str:
    n = found.degrees_of_freedom
    end = (
        f": the budget has a line of {found.excess:.1f} N in addition to the declared zeros."
        if found.excess
        else "."
    )
    return (
        f"Repeated set-ups ({', '.join(found.setups)}): from one to the next the force at zero scatters by {found.between:.1f} N "
        f"(standard deviation, {n} degree{'s' * (n > 1)} of freedom), declared in [rig] are {found.declared:.1f} N. "
        f"The larger one counts{end}"
    )


SOURCES: Mapping[Source, str] = {
    "direct": "as measured",
    "debiased": "as measured, less the bias that the finite spin of the disc adds",
    "model": "by the joint estimate of tyre and rig, from all points",
    "hand": "as set in [coefficients]",
}
"""By its source, which eps_gamma the property file carries."""


class OtherEstimate(NamedTuple):
    """An estimate of eps_gamma that the property file does not carry."""

    name: str
    value: Quantity
    why: str  #: why it differs from that of the file


def beside_the_file(measured: Measured) -> list[OtherEstimate]:
    """The other estimates of eps_gamma with uncertainty, each with the reason for its difference."""
    direct, debiased, carried = measured.epsilon_gamma, measured.epsilon_gamma_debiased, measured.carried
    if carried is None or direct is None:
        return []
    apart = abs(direct.value - carried.pecp1.value) / direct.u
    found = []
    if carried.source in ("model", "hand"):
        why = f"from zeros and camber sweeps alone, whose errors of the rig the fit knows better: {apart:.1f} u apart"
        found.append(OtherEstimate("measured", direct, why))
    if debiased is not None:
        why = f"the finite spin of the disc adds {direct.value - debiased.value:+.3f}"
        if carried.source == "debiased":
            found.append(OtherEstimate("measured", direct, why))
        else:
            found.append(OtherEstimate("debiased", debiased, f"{why} to what is measured"))
    return found


def expanded(measured: Measured) -> str:
    """The expanded uncertainty with its coverage factor, in words; empty without a budget."""
    found = measured.nominal.expanded if measured.nominal else None
    if found is None:
        return ""
    dof = "infinite" if math.isinf(found.dof) else f"{found.dof:.0f}"
    return f"U = {found.U:.3f} with k = {found.k:.2f} for {100 * found.probability:.0f} % (effective degrees of freedom: {dof})"


def advice(found: Alignment) -> list[str]:
    """Sentences on the next adjustment of the axis."""
    correction, u = found.correction_deg, found.u_deg
    step = f"{correction:+.3f} +- {u:.3f} deg of the rig's own scale (k = 1)"
    if found.aligned:
        finer = (
            "its uncertainty"
            if abs(correction) <= u
            else f"the smallest step of the axis, {found.resolution_deg:g} deg"
        )
        out = [f"Aligned, stop: the correction {step} is within {finer}."]
    else:
        out = [f"Turn the sideslip axis by {step}, then measure both directions again."]
    out.append(
        "The correction is for the sum of misalignment and ply-steer, which look alike on one rig. With a usual ply-steer of "
        f"{math.degrees(usual_ply_steer()):.2f} deg the axis itself is known to +- {found.u_axis_deg:.2f} deg (k = 1)."
    )
    if any(row.source == "guess" for row in found.last):
        out.append(
            "C_alpha is guessed from the load, so the correction is uncertain; a sideslip sweep in tyre.toml or a second "
            "iteration measures it."
        )
    return out
