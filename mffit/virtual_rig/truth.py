"""The true values of the direct method's quantities, from the tyre itself."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

import numpy as np

from mffit.rig_errors import Faults
from mffit.virtual_rig.machine import loaded_radius
from tir import Tyre
from tir.parameters import TABLE

SECTIONS = ("LATERAL_COEFFICIENTS", "ALIGNING_COEFFICIENTS", "TURNSLIP_COEFFICIENTS")
DRIVEN_SECTIONS = (
    "VERTICAL",
    "STRUCTURAL",
    "LONGITUDINAL_COEFFICIENTS",
    "OVERTURNING_COEFFICIENTS",
    "ROLLING_COEFFICIENTS",
)
"""Sections with coefficients of the other channels."""


@dataclass(frozen=True, slots=True)
class DirectTruth:
    """True values at one load, nominal pressure and the rig's path curvature, in ISO-W axes.

    Slopes are on a straight path unless stated otherwise, with turn slip on or off.
    """

    load_N: float
    epsilon_gamma: float  #: by (17), from the slopes with turn slip on
    C_phit_Nm: float  #: slope of Fy over phi_t at zero [N m]
    C_phit_secant_Nm: float | None  #: F_phit / phi_t, as measured on a disc [N m]
    C_gamma_N_per_rad: float  #: camber stiffness without turn slip
    C_gamma_turn_slip_N_per_rad: float  #: camber stiffness with turn slip on, larger by R0/r_e
    C_alpha_N_per_rad: float  #: cornering stiffness without turn slip
    C_alpha_disc_N_per_rad: float  #: slope over alpha on the path, reduced by spin
    r_e_m: float
    R_m: float | None  #: true radius of the path
    F_phit_N: float | None  #: part of Fy at zero angles that changes sign with the path's curvature
    Fy_zero_N: float  #: Fy at zero angles on the path, shifts of the tyre included


@dataclass(frozen=True, slots=True)
class DrivenTruth:
    """True values of the other channels at one load, upright, without sideslip, at nominal pressure and the usual speed."""

    load_N: float
    K_x_N: float  #: slip stiffness
    mu_drive: float  #: largest driving force over load
    mu_brake: float  #: largest braking force over load, positive
    r_e_m: float
    R_L_m: float  #: loaded radius
    sigma_x_m: float  #: relaxation lengths
    sigma_y_m: float


@dataclass(frozen=True, slots=True)
class Truth:
    """The true values behind the data of a campaign."""

    nominal: DirectTruth
    per_load: tuple[DirectTruth, ...]
    faults: Faults  #: rig errors in the first set-up
    faults_of_sweeps: dict[str, dict[str, float]]  #: additional errors of single sweeps, by file
    faults_of_setups: dict[str, dict[str, float]]  #: zeros of every set-up, if there are several
    coefficients: dict[str, float]
    """Of the tyre's side force, aligning moment and turn slip; of all channels that were measured."""
    seed: int
    driven: tuple[DrivenTruth, ...] = ()  #: per load, if Fx, Mx, a radius or the wheel speed was measured
    drive: Mapping[str, Any] = field(default_factory=dict)  #: the table [drive], if the rig reports slip

    def to_json(self) -> dict[str, Any]:
        """The content of truth.json; the path radius of a flat track is null, and errors that are NaN are left out."""
        faults: dict[str, float | None] = {
            n: value for n, value in self.faults.items() if not math.isnan(value)
        }
        if math.isinf(self.faults["path_radius_m"]):
            faults["path_radius_m"] = None
        of_drive = {"drive": dict(self.drive), "driven_per_load": [asdict(row) for row in self.driven]}
        return {
            **asdict(self.nominal),
            "pecp1": self.coefficients["PECP1"],
            "pecp2": self.coefficients["PECP2"],
            "faults": faults,
            "faults_of_sweeps": self.faults_of_sweeps,
            "faults_of_setups": self.faults_of_setups,
            "per_load": [asdict(row) for row in self.per_load],
            "coefficients": self.coefficients,
            **(of_drive if self.driven else {}),
            "seed": self.seed,
        }


def direct_truth(
    tyre: Tyre, load: float, speed: float, pressure: float, phi_t: float, R: float
) -> DirectTruth:
    """True values of the direct method's quantities at one load; SI, ``phi_t`` is 0 on a flat track, R the true path radius."""

    def Fy(alpha: float = 0.0, gamma: float = 0.0, curvature: float = 0.0, turn_slip: bool = True) -> float:
        out = tyre(load, alpha, gamma, 0.0, curvature, speed, pressure, turn_slip=turn_slip)
        return float(out.Fy)

    r_e = float(tyre.state(load, Vx=speed, p=pressure).Re)
    C_phit = slope(lambda x: Fy(curvature=x))
    C_gamma_turn_slip = slope(lambda x: Fy(gamma=x))
    on_disc = phi_t != 0.0
    F_phit = (Fy(curvature=phi_t) - Fy(curvature=-phi_t)) / 2.0
    return DirectTruth(
        load_N=load,
        epsilon_gamma=1.0 + r_e * C_gamma_turn_slip / C_phit,
        C_phit_Nm=C_phit,
        C_phit_secant_Nm=F_phit / phi_t if on_disc else None,
        C_gamma_N_per_rad=slope(lambda x: Fy(gamma=x, turn_slip=False)),
        C_gamma_turn_slip_N_per_rad=C_gamma_turn_slip,
        C_alpha_N_per_rad=slope(lambda x: Fy(alpha=x, turn_slip=False)),
        C_alpha_disc_N_per_rad=slope(lambda x: Fy(alpha=x, curvature=phi_t)),
        r_e_m=r_e,
        R_m=R if on_disc else None,
        F_phit_N=F_phit if on_disc else None,
        Fy_zero_N=Fy(curvature=phi_t, turn_slip=on_disc),
    )


def slope(force: Callable[[float], float]) -> float:
    """Slope at zero by central differences."""
    step = 1e-6  # rounding and curvature stay below 1e-6 of the slope
    return (force(step) - force(-step)) / (2.0 * step)


def driven_truth(tyre: Tyre, load: float, speed: float) -> DrivenTruth:
    """True values of the other channels at one load [N] and speed [m/s]."""
    pressure = float(tyre["NOMPRES"])
    state = tyre.state(load, Vx=speed, p=pressure)
    rolling = tyre(load, Vx=speed, p=pressure)
    Fx = np.asarray(tyre(load, kappa=np.linspace(-1.0, 1.0, 2001), Vx=speed, p=pressure).Fx)
    radius = loaded_radius(tyre.values, rolling, 0.0, float(state.omega), pressure)
    return DrivenTruth(
        load_N=load,
        K_x_N=float(state.K_xk),
        mu_drive=float(Fx.max()) / load,
        mu_brake=-float(Fx.min()) / load,
        r_e_m=float(state.Re),
        R_L_m=float(radius),
        sigma_x_m=float(state.sigma_x),
        sigma_y_m=float(state.sigma_y),
    )


def coefficients_of(tyre: Tyre, *, driven: bool = False) -> dict[str, float]:
    """By name, the coefficients that disc data can determine; with ``driven``, those of all channels."""
    sections = (*DRIVEN_SECTIONS, *SECTIONS) if driven else SECTIONS
    return {row.name: float(tyre[row.name]) for row in TABLE if row.section in sections}
