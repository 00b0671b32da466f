"""The sentences about the direct method, for page, terminal and JSON: written here and nowhere else."""

from __future__ import annotations

import math
from typing import assert_never

from mffit.measured.notes import (
    Aligned,
    AxisOff,
    CamberSkew,
    Conicity,
    ContactWanders,
    EpsilonInNoise,
    LoadSlope,
    Misaligned,
    Note,
    NothingMeasured,
    NotSeparable,
    OneLoad,
    PathsContradict,
    SecantNotPossible,
    SeveralPaths,
    SlopeInNoise,
    SlopeNotPossible,
    SlopeTooSteep,
    StandardUncertainties,
    StraightPath,
    Trouble,
    ZerosDisagree,
)
from mffit.measured.result import CONICITY, FINITE_SPIN, Measured
from mffit.rounding import to_uncertainty


def epsilon_values(measured: Measured) -> str:
    """Which estimate of eps_gamma differs from which, and why; one line, empty where there is one only."""
    direct, debiased, model = (
        measured.epsilon_gamma,
        measured.epsilon_gamma_debiased,
        measured.epsilon_gamma_model,
    )
    if direct is None or debiased is None:
        return ""
    joint = f"; the fitted model's own turn-slip force stands for {model:.3f}" if model is not None else ""
    return (
        f"measured {direct.value:.3f}, of which {direct.value - debiased.value:+.3f} is what the finite spin of the disc adds to "
        f"the direct method{joint}; all are within their uncertainty if they differ by less than {2.0 * direct.u:.3f}"
    )


def why_no_slope(measured: Measured) -> str:
    """The one reason for which the file has no load slope; empty if it has one."""
    for fact in measured.notes:
        if isinstance(fact, OneLoad | SlopeInNoise | EpsilonInNoise | SlopeTooSteep):
            return note(fact)
    return ""


def by_draws(measured: Measured) -> str:
    """u(eps_gamma) by random draws, and what of the budget it is to be compared with; empty without draws."""
    row = measured.nominal
    if row is None or row.u_monte_carlo is None or row.epsilon_gamma is None:
        return ""
    said = f"{row.u_monte_carlo:.4f} by random draws"
    later = [line for line in row.budget if line.source in (CONICITY, FINITE_SPIN)]
    if not later:
        return said
    rest = math.sqrt(max(row.epsilon_gamma.u**2 - sum(line.contribution**2 for line in later), 0.0))
    sources = " and ".join(line.source for line in later)
    return f"{said}, which leave out {sources}; without them the budget gives {rest:.4f}"


def note(fact: Note) -> str:
    """A note as a sentence."""
    match fact:
        case StraightPath():
            return "A flat track's path is straight: it has no turn slip to measure."
        case NotSeparable(force, angle, u):
            # Without a sideslip sweep nobody knows what angle the force would take.
            taken = (
                "an unknown angle (no sideslip sweep gives C_alpha)" if angle is None else f"{angle:.2f} deg"
            )
            return (
                f"Sideslip misalignment, turn slip and ply-steer are not separable here; the force {force:.0f} N at (0, 0) "
                f"would take {taken} of misalignment or ply-steer if it were not turn slip, and {u:.0f} N (k = 1) is assumed "
                "for the alignment."
            )
        case SeveralPaths(radii):
            paths = ", ".join(map(_where, radii))
            return (
                f"The turn-slip stiffness combines the zeros of {len(radii)} paths (disc's centre {paths}) so that its "
                "uncertainty is least: what pushes alike on all of them drops out."
            )
        case CamberSkew(skew):
            return (
                f"Forward and backward camber sweeps: leaning steers the wheel by {to_uncertainty(skew.value, skew.u)} "
                f"+- {to_uncertainty(skew.u, skew.u)} {skew.unit} times "
                "the sine of the camber angle (camber skew). It is taken off the camber stiffness."
            )
        case Aligned():
            return (
                f"Forward and backward runs: {_found(fact)}. It is within what the alignment leaves and stays in the model "
                "as ply-steer."
            )
        case LoadSlope(pecp2, u):
            return f"PECP2 = {pecp2:.3f} +- {u:.3f} (k = 1)."
        case OneLoad():
            return "PECP2 is 0: one load was measured."
        case SlopeInNoise(slope, u):
            return f"PECP2 is 0: the slope {slope:.3f} per nominal load is within 2 u = {2 * u:.3f}."
        case EpsilonInNoise():
            return "PECP2 is 0: eps_gamma itself is within 2 u of zero, so a relative slope has no meaning."
        case SlopeTooSteep(largest):
            return f"PECP2 is 0: eps_gamma would reach {largest:.2f} within the loads."
        case StandardUncertainties():
            return "All uncertainties are standard uncertainties (k = 1)."
        case Conicity(share, force, shift):
            return (
                f"Conicity cannot be removed: a plausible {force:.0f} N ({100 * share:.1f} % of the load) would move "
                f"eps_gamma by {shift:.3f}."
            )
        case ContactWanders():
            return (
                "With camber the contact point wanders over the crown and changes the path radius; R holds for the upright "
                "wheel."
            )
        case _:
            assert_never(fact)


def warning(fact: Trouble) -> str:
    """A warning as a sentence."""
    match fact:
        case SlopeNotPossible(load, angle):
            return (
                f"at {load:.0f} N the camber sweep is too short for the slope at zero; the secant at {angle:g} deg is used, "
                "which is a few per cent low: add cambers up to 20 deg"
            )
        case SecantNotPossible(load, angle):
            return (
                f"at {load:.0f} N the camber sweep does not reach {angle:g} deg; the slope at zero is used instead of the "
                "secant"
            )
        case NothingMeasured():
            return "eps_gamma could not be measured: it needs a camber sweep, points at (0, 0) and a [rolling_radius]"
        case Misaligned(_, slip, _):
            return (
                f"the sideslip axis is misaligned: {_found(fact)}; forward and backward forces differ by "
                f"{abs(2 * slip):.0f} N. It is taken off the angles; ply-steer cannot be told from it"
            )
        case AxisOff(load, difference, limit, correction):
            return (
                f"at {load:.0f} N forward and backward forces differ by {difference:.0f} N ({limit:.0f} N is the limit): the "
                f"sideslip axis is off by about {correction:.2f} deg"
            )
        case ZerosDisagree(load, backward, sweeps, forces):
            return (
                f"at {load:.0f} N the {'backward' if backward else 'forward'} zeros of {sweeps[0]} and {sweeps[1]} are "
                f"{forces[0]:.0f} N and {forces[1]:.0f} N, which are no readings of one path: look for a sweep whose "
                "path_centre, path_radius or direction is not declared, or an axis that was moved between them"
            )
        case PathsContradict(load, radii, C_phit):
            said = ", ".join(
                f"{C.value:.0f} +- {C.u:.0f} Nm (disc's centre {_where(R)})"
                for R, C in zip(radii, C_phit, strict=True)
            )
            return (
                f"at {load:.0f} N the zeros of the paths contradict each other: they say turn-slip stiffnesses of {said}; "
                "look for a path_centre or path_radius that is not the run's, or an offset, a camber zero or an alignment worse "
                "than declared"
            )
        case _:
            assert_never(fact)


def _where(R: float) -> str:
    return f"{abs(R):.3g} m to the {'left' if R > 0.0 else 'right'}"


def _found(fact: Aligned | Misaligned) -> str:
    alpha_M, u = math.degrees(fact.alpha_M.value), math.degrees(fact.alpha_M.u)
    return (
        f"alpha_M = {alpha_M:.3f} +- {u:.3f} deg ({fact.slip:.0f} N); uncorrected it would move eps_gamma by "
        f"{fact.shift:.2f}"
    )
