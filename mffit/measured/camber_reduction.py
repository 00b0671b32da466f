"""The direct method proper: turn-slip force (23), its stiffness (21), eps_gamma (17), with correlated uncertainties.

Numbers that carry an uncertainty are those of the ``uncertainties`` package: first-order propagation in which a source
that enters twice (R is in r_e and in C_phit) is counted with its correlation.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from uncertainties import UFloat

from mffit.measured.uncertain import named
from mffit.rig_errors import DECLARED, AtZero, Declared

_DECLARATIONS = {error.name: declared for error, declared in DECLARED}


@dataclass(frozen=True, slots=True)
class UncertainRig:
    """The uncertain rig errors and path radius, common to all loads; the zeros are independent from set-up to set-up."""

    errors: Mapping[
        str, UFloat
    ]  #: deviation of each declared rig error from its declared value, in the declared unit
    R: UFloat  #: path radius [m]
    of_setups: Mapping[str, Mapping[str, UFloat]] = field(default_factory=dict)
    """Errors that each set-up has anew, by its name; empty if there is one set-up only."""

    def at(self, setup: str) -> Mapping[str, UFloat]:
        """All rig errors in a set-up."""
        own = self.of_setups.get(setup)
        return self.errors if own is None else {**self.errors, **own}

    @property
    def everywhere(self) -> tuple[Mapping[str, UFloat], ...]:
        """The rig errors of every set-up."""
        return tuple(self.at(setup) for setup in self.of_setups) or (self.errors,)


class TurnSlip(NamedTuple):
    """Result at one load."""

    F_phit: UFloat  #: [N]
    C_phit: UFloat  #: [Nm]
    epsilon_gamma: UFloat


def uncertain_rig(u: Mapping[str, float], R: UFloat, setups: Sequence[str] = ()) -> UncertainRig:
    """The declared rig errors with their standard uncertainties ``u``, by name and in the declared unit.

    With two or more ``setups``, each has zeros of its own.
    """
    several = setups if len(setups) > 1 else ()
    return UncertainRig(
        {error.name: _uncertain(error.name, declared, u) for error, declared in DECLARED if _acts(declared)},
        R,
        {
            setup: {
                error.name: _uncertain(error.name, declared, u)
                for error, declared in DECLARED
                if error.of_setup and _acts(declared)
            }
            for setup in several
        },
    )


def _acts(declared: Declared) -> bool:
    """Whether a declared error changes what the direct method reads."""
    return bool(declared.force_at_zero or declared.camber_stiffness)


def _uncertain(name: str, declared: Declared, u: Mapping[str, float]) -> UFloat:
    return named(0.0, u.get(name, 0.0), declared.source, declared.unit)


def turn_slip_force(F_raw: Any, errors: Mapping[str, Any], at: AtZero, *, both_directions: bool) -> Any:
    """Turn-slip force [N]: the raw force at (0, 0) less what the rig errors add to it; (23) in ISO signs.

    Parameters
    ----------
    F_raw : raw force [N], the mean of both directions if both were run
    errors : rig errors by name, in the declared unit
    at : stiffnesses of the tyre and side of the play
    both_directions : errors that change sign with the direction of rolling cancel in the mean
    """
    force = F_raw
    for name, number in errors.items():
        declared = _DECLARATIONS[name]
        if declared.force_at_zero and not (both_directions and declared.turns_with_direction):
            force = force - declared.force_at_zero(number, at)
    return force


def true_camber_stiffness(C_gamma: Any, errors: Mapping[str, Any], at: AtZero) -> Any:
    """Camber stiffness [N/rad]: the slope over the camber reading, rolling forwards, less what the rig errors add to it."""
    for name, number in errors.items():
        declared = _DECLARATIONS[name]
        if declared.camber_stiffness:
            C_gamma = C_gamma - declared.camber_stiffness(number, at)
    return C_gamma


def camber_reduction(F_phit: Any, C_gamma: Any, r_e: Any, R: Any, phi_sign: float) -> TurnSlip:
    """C_phit = F/phi_t (21) and eps_gamma = 1 + r_e C_gamma / C_phit, (17) in ISO signs.

    Parameters
    ----------
    F_phit : turn-slip force [N]
    C_gamma : camber stiffness [N/rad], negative
    r_e, R : effective and path radius [m]
    phi_sign : -1 with the disc's centre to the left, +1 to the right
    """
    C_phit = phi_sign * F_phit * R
    return TurnSlip(F_phit, C_phit, 1.0 + r_e * C_gamma / C_phit)


@dataclass(frozen=True, slots=True)
class DirectInputs:
    """The direct method as plain numbers, for tables like the paper's; SI, ISO signs, u with k = 1."""

    F_raw: float  #: raw or already corrected turn-slip force [N]
    C_gamma: float  #: [N/rad], negative
    r_e: float  #: [m]
    R: float  #: [m]
    C_alpha: float = 0.0  #: [N/rad]
    alpha_b: float = 0.0  #: [rad]
    u_C_gamma: float = 0.0
    u_r_e: float = 0.0
    u_R: float = 0.0
    u_offset: float = 10.0  #: [N]
    u_gamma_0: float = math.radians(0.5)
    u_slip_force: float = 25.0  #: [N]
    u_F_raw: float = 0.0
    u_alpha_b: float = 0.0


def direct_method(given: DirectInputs) -> TurnSlip:
    """Turn-slip force, stiffness and eps_gamma from plain numbers."""
    R = named(given.R, given.u_R, "path radius", "m")
    rig = uncertain_rig(
        {
            "F0_N": given.u_offset,
            "gamma_0_deg": math.degrees(given.u_gamma_0),
            "alpha_0_deg": given.u_slip_force,
            "backlash_deg": math.degrees(2.0 * given.u_alpha_b),
        },
        R,
    )
    C_gamma = named(given.C_gamma, given.u_C_gamma, "camber stiffness", "N/rad")
    F = named(given.F_raw, given.u_F_raw, "noise of the zeros", "N")
    at = AtZero(given.C_alpha, C_gamma, math.copysign(1.0, given.alpha_b))
    force = turn_slip_force(F - given.C_alpha * given.alpha_b, rig.errors, at, both_directions=False)
    r_e = named(given.r_e, given.u_r_e, "effective radius", "m")
    return camber_reduction(force, C_gamma, r_e, R, math.copysign(1.0, given.F_raw))
