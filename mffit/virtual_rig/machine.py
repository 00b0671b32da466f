"""A tyre on a rig with errors: true angles and forces of the tyre, and the readings of the rig.

Every rig error has a formula here that is independent of the one in its record, so these data reveal a mistake in the record.
All quantities are in ISO-W axes, contact frame.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from mffit.rig_errors import T_REF, Faults
from mffit.virtual_rig.settings import Settings
from tir import Tyre
from tir.evaluate import evaluate, turned_on_rim


class Channels(NamedTuple):
    """Forces [N] and moments [Nm] on the wheel; arrays (n,)."""

    Fy: np.ndarray
    Fz: np.ndarray
    Mx: np.ndarray
    My: np.ndarray
    Mz: np.ndarray
    Fx: np.ndarray | float = 0.0
    RL: np.ndarray | float = np.nan  #: loaded radius [m]
    omega: np.ndarray | float = np.nan  #: wheel speed [rad/s], negative rolling backwards
    slip: np.ndarray | float = 0.0  #: longitudinal slip reported by the rig


class Machine(NamedTuple):
    """A tyre on a rig with its errors."""

    tyre: Tyre  #: the true one
    faults: Faults  #: rig errors, with the true path radius
    phi_t_sign: int  #: sign of the usual path's turn slip: -1 with the centre to the left, 0 on a flat track
    usual_speed: float  #: speed at which speed has no influence [m/s]
    drag: float = 0.0  #: moment against the rotation of a freely rolling wheel [Nm]
    slip_against: str = "free-rolling"  #: reference of the reported slip

    def with_faults(self, added: Mapping[str, float]) -> Machine:
        """The machine with additional rig errors, for a sweep that has its own errors."""
        return self._replace(
            faults=self.faults.replace(**{name: self.faults[name] + x for name, x in added.items()})
        )


Formula = Callable[[float, Settings, Machine], np.ndarray | float]
"""(size of the error, settings (n,), machine) -> additive term or factor."""


def _leant(s: Settings, m: Machine) -> np.ndarray:
    """True camber (n,) [rad]."""
    return np.asarray(s.gamma + sum(_effects(LEANS, s, m)))


def _kelvin(s: Settings, m: Machine) -> np.ndarray:
    return s.T - m.faults[T_REF]


def _grip(s: Settings, m: Machine) -> np.ndarray:
    """Ratio (n,) of the friction at the settings' temperature to that at the reference, with the linear term only."""
    return 1.0 + m.faults["k_T_grip_per_K"] * _kelvin(s, m)


def _usual_pressure(m: Machine) -> float:
    """Pressure at which the coefficients of the tyre hold [kPa]."""
    stated = m.faults["p_ref_kPa"]
    return m.tyre["NOMPRES"] / 1000.0 if np.isnan(stated) else stated


def _faster(s: Settings, m: Machine) -> np.ndarray:
    """Speed (n,) above that at which speed has no influence [m/s]."""
    stated = m.faults["V_ref_mps"]
    return s.V - (m.usual_speed if np.isnan(stated) else stated)


STEERS: dict[str, Formula] = {
    "gain_alpha": lambda x, s, m: x * s.alpha - s.alpha,
    "alpha_0_deg": lambda x, s, m: np.deg2rad(x),
    "camber_skew_deg": lambda x, s, m: np.deg2rad(x * np.sin(_leant(s, m))),
    "hysteresis_deg": lambda x, s, m: np.where(s.sense > 0, -1.0, np.where(s.sense < 0, 1.0, 0.0)) * np.deg2rad(x),
}  # fmt: skip
"""Terms added to the sideslip angle as read [rad]."""
LEANS: dict[str, Formula] = {
    "gain_gamma": lambda x, s, m: x * s.gamma - s.gamma,
    "gamma_0_deg": lambda x, s, m: np.deg2rad(x),
    "gamma_0_deg_per_kN": lambda x, s, m: np.deg2rad(x * (s.Fz / 1000.0 - m.tyre["FNOMIN"] / 1000.0)),
    "disc_tilt_deg_per_kN": lambda x, s, m: m.phi_t_sign * s.side * np.deg2rad(x * s.Fz / 1000.0),
}
"""Terms added to the camber as read [rad]."""
SLIPS: dict[str, Formula] = {"kappa_0": lambda x, s, m: x}
"""Terms added to the longitudinal slip as read."""
LOADS: dict[str, Formula] = {
    "gain_Fz": lambda x, s, m: x,
    "load_camber": lambda x, s, m: 1.0 + x * (1.0 - np.cos(2.0 * _leant(s, m))) / 2.0,
    "load_camber_odd": lambda x, s, m: 1.0 - x * np.cos(np.pi / 2.0 + _leant(s, m)),
}
"""Factors on the load."""
SCALES: dict[str, tuple[str, Formula]] = {
    "k_T_grip_per_K": ("LMUY", lambda x, s, m: 1.0 + x * _kelvin(s, m)),
    "k_T_grip_per_K2": (
        "LMUY",
        lambda x, s, m: (_grip(s, m) + x * _kelvin(s, m) * _kelvin(s, m)) / _grip(s, m),
    ),
    "k_T_stiffness_per_K": ("LKY", lambda x, s, m: 1.0 + x * _kelvin(s, m)),
    "k_T_camber_per_K": ("LKYC", lambda x, s, m: 1.0 + x * _kelvin(s, m)),
    "k_T_drive_grip_per_K": ("LMUX", lambda x, s, m: 1.0 + x * _kelvin(s, m)),
    "k_T_slip_stiffness_per_K": ("LKX", lambda x, s, m: 1.0 + x * _kelvin(s, m)),
    "k_V_grip_per_mps": ("LMUY", lambda x, s, m: 1.0 + x * _faster(s, m)),
    "k_V_stiffness_per_mps": ("LKY", lambda x, s, m: 1.0 + x * _faster(s, m)),
    "k_V_drive_grip_per_mps": ("LMUX", lambda x, s, m: 1.0 + x * _faster(s, m)),
    "k_V_slip_stiffness_per_mps": ("LKX", lambda x, s, m: 1.0 + x * _faster(s, m)),
    "run_grip": ("LMUY", lambda x, s, m: 1.0 + x),
    "run_stiffness": ("LKY", lambda x, s, m: 1.0 + x),
    "sweep_heating": ("LMUY", lambda x, s, m: 1.0 + x * np.arange(len(s)) / max(len(s) - 1, 1)),
}
"""Factors on scaling factors of the tyre."""
ADDED: dict[str, tuple[str, Formula]] = {
    "k_p_arm_per_kPa": ("QSX3", lambda x, s, m: x * (s.p / 1000.0 - _usual_pressure(m)))
}
"""Terms added to coefficients of the tyre."""
SURROUNDINGS: dict[str, Formula] = {
    "k_T_per_K": lambda x, s, m: 1.0 + x * _kelvin(s, m),
    "k_V_per_mps": lambda x, s, m: 1.0 + x * _faster(s, m),
    "k_t_per_s": lambda x, s, m: 1.0 + x * s.t,
    "wear_per_km": lambda x, s, m: 1.0 + x * s.rolled_m / 1000.0,
    "warm_up": lambda x, s, m: 1.0 - x / np.exp(s.rolled_m / 1000.0),
}
"""Factors on Fy and Mz."""
YIELDS = ("compliance_deg_per_Nm", "backlash_deg")
"""Errors of the angle that depend on the tyre's moment at that angle; see :func:`true_alpha`. Those of the load cells are in
:func:`reported`, path radius and crown in :func:`at_the_tyre`, the lag in :mod:`mffit.virtual_rig.recording`."""


def steady(machine: Machine, settings: Settings) -> Channels:
    """The steady readings of the rig, without noise."""
    if settings.free:
        settings = replace(settings, kappa=rolling_slip(machine, settings))
    return reported(machine, settings, at_the_tyre(machine, settings, true_alpha(machine, settings)))


def rolling_slip(machine: Machine, settings: Settings) -> np.ndarray:
    """Slip (n,) of an undriven wheel, at which Fx balances rolling resistance and drag."""

    def unbalanced(kappa: np.ndarray) -> np.ndarray:
        """Moment (n,) about the wheel's axis that slows its rotation [Nm]."""
        out = at_the_tyre(machine, replace(settings, kappa=kappa), settings.alpha)
        forwards = np.sign(settings.Vx)
        return np.asarray(forwards * (out.Fx * out.RL - out.My) + machine.drag)

    before, now = np.full(len(settings), -1e-3), np.zeros(len(settings))
    rest, last = unbalanced(before), unbalanced(now)
    for _ in range(8):  # secant steps; force and slip are nearly proportional here
        slope = np.where(last == rest, 1.0, last - rest)
        before, now, rest = now, now - last * (now - before) / slope, last
        last = unbalanced(now)
    return now


def true_alpha(machine: Machine, settings: Settings) -> np.ndarray:
    """True sideslip angle (n,) [rad]: reading, misalignment, compliance and play."""
    alpha = settings.alpha + sum(_effects(STEERS, settings, machine))

    def moment(x: np.ndarray) -> np.ndarray:
        return at_the_tyre(machine, settings, x).Mz

    give, play = (np.deg2rad(machine.faults[name]) for name in YIELDS)
    if give:
        alpha = yielded(moment, alpha, give)
    return taken_up(moment, alpha, play / 2.0) if play else alpha


def yielded(moment: Callable[[np.ndarray], np.ndarray], alpha: np.ndarray, give: float) -> np.ndarray:
    """Angle (n,) [rad] of a steering with compliance ``give`` [rad/Nm] in equilibrium with the moment of the wheel."""
    held = alpha
    for _ in range(60):  # each iteration reduces the error to a tenth or less
        held = alpha + give * moment(held)
    return held


def taken_up(moment: Callable[[np.ndarray], np.ndarray], alpha: np.ndarray, half_play: float) -> np.ndarray:
    """Angle (n,) [rad] at which the moment holds a wheel with ``half_play`` on either side of ``alpha``.

    A positive moment holds it at ``alpha - half_play``, a negative one at ``alpha + half_play``. Where the
    moment changes sign within the play, the wheel floats at the angle without moment.
    """
    lower, upper = alpha - half_play, alpha + half_play
    at_lower, at_upper = moment(lower) > 0.0, moment(upper) < 0.0
    either = moment(alpha) > 0.0
    held_at_lower = at_lower & (~at_upper | either)
    floats = ~at_lower & ~at_upper
    for _ in range(20 if floats.any() else 0):  # bisections, to a millionth of the play
        middle = 0.5 * (lower + upper)
        turns_back = moment(middle) > 0.0
        lower, upper = np.where(turns_back, lower, middle), np.where(turns_back, middle, upper)
    held = np.where(held_at_lower, alpha - half_play, alpha + half_play)
    return np.where(floats, 0.5 * (lower + upper), held)


def at_the_tyre(machine: Machine, settings: Settings, alpha: np.ndarray) -> Channels:
    """Forces and moments (n,) of the tyre at the true sideslip angle ``alpha`` (n,) [rad]."""
    # Distances between paths are known, so the error of the radius is common to all paths.
    lean = _leant(settings, machine)
    side = machine.phi_t_sign * settings.side  # side of the disc's centre: -1 left
    crown = side * machine.faults["crown_m"] * np.sin(lean)  # towards the centre
    phi_t = side / (machine.faults["path_radius_m"] + settings.outward - crown)
    mounted = turned_on_rim(_scaled(machine, settings), settings.mount)
    load = settings.Fz * math.prod(_effects(LOADS, settings, machine))
    out, state = evaluate(
        mounted,
        load,
        alpha,
        lean,
        true_slip(machine, settings),
        phi_t,
        settings.Vx,
        settings.p,
        turn_slip=machine.phi_t_sign != 0,
    )
    radius = loaded_radius(machine.tyre.values, out._replace(Fz=load), lean, state.omega, settings.p)
    slip = settings.kappa
    if machine.slip_against == "loaded-radius":
        slip = (1.0 + slip) * radius / state.Re - 1.0
    return Channels(out.Fy, out.Fz, out.Mx, out.My, out.Mz, out.Fx, radius, state.omega, slip)


def true_slip(machine: Machine, settings: Settings) -> np.ndarray | float:
    """True longitudinal slip (n,); the number 0 if the wheel is never driven or braked."""
    slip = settings.kappa + sum(_effects(SLIPS, settings, machine))
    return slip if np.any(slip) else 0.0


def reported(machine: Machine, settings: Settings, true: Channels) -> Channels:
    """Readings of the load cells for the true forces and moments; the reading of the load is its set-point."""
    faults, surroundings = machine.faults, math.prod(_effects(SURROUNDINGS, settings, machine))
    seen = faults["gain"] * surroundings * true.Fy
    bent = seen + faults["nonlinearity_per_kN"] * np.sign(seen) * seen**2 / 1000.0
    return true._replace(
        Fy=bent
        + faults["F0_N"]
        + np.sign(settings.Vx) * faults["F0_direction_N"]
        + (faults["crosstalk"] + faults["crosstalk_camber"] * np.sin(_leant(settings, machine))) * true.Fz,
        Mz=faults["gain_Mz"] * surroundings * true.Mz
        + faults["M0_Nm"]
        + faults["crosstalk_Fx_Mz_m"] * true.Fx,
        Mx=faults["gain_Mx"] * true.Mx
        + faults["Mx0_Nm"]
        + faults["crosstalk_Fx_Mx_m"] * true.Fx
        + faults["crosstalk_Fy_Mx_m"] * true.Fy,
        My=faults["My0_Nm"] + faults["gain_My"] * true.My,
        Fx=faults["Fx0_N"] + faults["gain_Fx"] * true.Fx - np.sign(settings.Vx) * faults["drag_Fx_N"],
        Fz=settings.Fz,
    )


def _scaled(machine: Machine, settings: Settings) -> Any:
    """Coefficients of the tyre at the temperatures of the settings."""
    values: dict[str, Any] = dict(machine.tyre.values)
    for error, (name, formula) in SCALES.items():
        if machine.faults[error]:
            values[name] = values[name] * formula(machine.faults[error], settings, machine)
    for error, (name, formula) in ADDED.items():
        if machine.faults[error]:
            values[name] = values[name] + formula(machine.faults[error], settings, machine)
    return SimpleNamespace(**values)


def _effects(formulae: dict[str, Formula], s: Settings, m: Machine) -> Iterator[np.ndarray | float]:
    return (formula(m.faults[name], s, m) for name, formula in formulae.items())


def loaded_radius(p: Mapping[str, Any], at: Any, gamma: Any, omega: Any, pressure: Any) -> Any:
    """Distance (n,) of the wheel's centre from the contact point [m], by bisection for the load; SI, inputs (n,).

    ``at`` has the forces Fx, Fy and Fz.
    """
    R0, Fz0 = p["UNLOADED_RADIUS"], p["FNOMIN"]
    rim_speed = np.abs(omega) * R0 / p["LONGVL"]
    free = R0 * (p["Q_RE0"] + p["Q_V1"] * rim_speed**2)
    linear = np.sqrt((p["VERTICAL_STIFFNESS"] * R0 / Fz0) ** 2 - 4.0 * p["Q_FZ2"])
    leaning = np.abs(gamma) * (1.0 if p["Q_CAM1"] or p["Q_CAM2"] else 0.0)
    edge = (1.075 - 0.5 * p["ASPECT_RATIO"]) * p["WIDTH"] / 8.0 * np.tan(leaning)
    growth = p["Q_CAM2"] / p["Q_CAM1"] if p["Q_CAM1"] else np.inf
    steepness = 2.0 if np.isinf(growth) else 1.0
    lower, upper = 0.0 * free, free + edge
    for _ in range(40):  # to a picometre
        radius = 0.5 * (lower + upper)
        ratio = (radius / free) ** steepness
        if np.isfinite(growth):
            ratio = ratio * (1.0 + growth * radius) / (1.0 + growth * free)
        squeezed = free - radius
        relative = np.maximum(squeezed + ratio**2 * edge - p["Q_CAM3"] * squeezed * np.abs(gamma), 1e-12) / R0
        leaned = p["Q_FYS1"] + p["Q_FYS2"] * radius / free + p["Q_FYS3"] * (radius / free) ** 2
        sideways = relative ** p["Q_FCY2"] * p["Q_FCY"] * (at.Fy - leaned * gamma) / Fz0
        carried = Fz0 * (linear * relative + p["Q_FZ2"] * relative**2)
        carried = carried * (1.0 + p["PFZ1"] * (pressure / p["NOMPRES"] - 1.0))
        carried = carried * (1.0 + p["Q_V2"] * rim_speed - (p["Q_FCX"] * at.Fx / Fz0) ** 2 - sideways**2)
        lower, upper = np.where(carried > at.Fz, radius, lower), np.where(carried > at.Fz, upper, radius)
    return 0.5 * (lower + upper)
