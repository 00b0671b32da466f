"""Formulae of the direct method: turn-slip force (23), its stiffness (21), eps_gamma (17), with correlated uncertainties.

Uncertain numbers are those of the ``uncertainties`` package: first-order propagation that includes correlations, such as that of
R, which enters both r_e and C_phit.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from uncertainties import UFloat

from mffit.measured.result import Measured
from mffit.measured.uncertain import named
from mffit.points import Points, levels, main_path
from mffit.rig_errors import DECLARED, AtZero

READ = {
    error.name: (error, declared)
    for error, declared in DECLARED
    if declared.force_at_zero or declared.camber_stiffness
}
"""By name, the declared rig errors that change readings of the direct method."""


@dataclass(frozen=True, slots=True)
class UncertainRig:
    """Uncertain deviations of the rig errors from their declared values, in the declared units, and the path radius."""

    errors: Mapping[str, UFloat]  #: errors common to all loads
    of_setups: Mapping[str, Mapping[str, UFloat]]
    """By set-up, its own zeros; empty with only one set-up."""
    R: UFloat  #: path radius [m]

    def at(self, setup: str) -> Mapping[str, UFloat]:
        """All rig errors in a set-up."""
        return {**self.errors, **self.of_setups.get(setup, {})}


def uncertain_rig(u: Mapping[str, float], R: UFloat, setups: Sequence[str] = ()) -> UncertainRig:
    """The declared rig errors with their standard uncertainties ``u``, by name and in the declared unit.

    With two or more ``setups``, each has zeros of its own.
    """

    def numbers(names: Sequence[str]) -> dict[str, UFloat]:
        return {
            name: named(0.0, u.get(name, 0.0), READ[name][1].source, READ[name][1].unit) for name in names
        }

    zeros = [name for name, (error, _) in READ.items() if error.of_setup]
    several = setups if len(setups) > 1 else ()
    return UncertainRig(numbers([*READ]), {setup: numbers(zeros) for setup in several}, R)


def turn_slip_force(
    F_raw: UFloat, errors: Mapping[str, UFloat], at: AtZero, *, both_directions: bool
) -> UFloat:
    """Turn-slip force [N]: the raw force at (0, 0) less the forces of the rig errors; (23) in ISO signs.

    ``errors`` are in the declared units. With ``both_directions``, ``F_raw`` is their mean, in which errors that change sign
    with the direction of rolling cancel.
    """
    for name, number in errors.items():
        declared = READ[name][1]
        if declared.force_at_zero and not (both_directions and declared.turns_with_direction):
            F_raw = F_raw - declared.force_at_zero(number, at)
    return F_raw


def true_camber_stiffness(C_gamma: UFloat, errors: Mapping[str, UFloat], at: AtZero) -> UFloat:
    """Camber stiffness [N/rad]: the slope over the camber reading, rolling forwards, less the parts from rig errors."""
    for name, number in errors.items():
        declared = READ[name][1]
        if declared.camber_stiffness:
            C_gamma = C_gamma - declared.camber_stiffness(number, at)
    return C_gamma


def camber_reduction(C_phit: UFloat, C_gamma: UFloat, r_e: UFloat) -> UFloat:
    """eps_gamma = 1 + r_e C_gamma / C_phit, (17) in ISO signs: C_phit > 0 [Nm], C_gamma < 0 [N/rad], r_e [m]."""
    return 1.0 + r_e * C_gamma / C_phit


def camber_of_no_spin(phi_t: float, r_e: float, epsilon: float) -> float | None:
    """The camber [rad] that takes the spin of a path of curvature ``phi_t`` [1/m]; None if no camber does.

    The total spin phi_t - (1 - eps_gamma) sin(gamma) / r_e is zero there: the wheel rolls as on a straight road, but leaned.
    """
    sine = phi_t * r_e / (1.0 - epsilon) if epsilon < 1.0 else math.inf
    return math.asin(sine) if abs(sine) < 1.0 else None


def unspun(points: Points, measured: Measured) -> float | None:
    """The camber [rad] at which the usual path of a disc gives no spin; None if it is not known, out of reach, or on a belt."""
    row = measured.nominal
    if row is None or row.epsilon_gamma is None or row.r_e is None:
        return None
    camber = camber_of_no_spin(main_path(points), row.r_e.value, row.epsilon_gamma.value)
    return camber if camber and abs(camber) <= np.max(np.abs(points.gamma)) else None


def was_coupled(points: Points, camber: float) -> bool:
    """Whether sideslip was run at a camber [rad]."""
    near = np.abs(points.gamma - camber) < levels.CAMBER.tolerance
    return bool(np.any(near & (np.abs(points.alpha) > levels.SIDESLIP.tolerance)))
