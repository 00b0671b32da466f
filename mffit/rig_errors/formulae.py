"""Formulae of the rig errors, and what the direct method subtracts for them.

A formula takes the number of the error, the quantity before it and the state ``at`` of the chain (``mffit.rig.chain.Chain``), and
returns the quantity after it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from mffit.rig_errors.record import RADIANS, AtLoad, AtZero, Formula, Slopes


def scaled(k: Any, quantity: Any, at: Any) -> Any:
    """A reading, or a set-point, times its calibration factor."""
    return k * quantity


def added(zero: Any, quantity: Any, at: Any) -> Any:
    """A reading plus its zero."""
    return quantity + zero


def turned(zero: Any, angle: Any, at: Any) -> Any:
    """An angle [rad] plus a zero [deg]."""
    return angle + zero * RADIANS


def over(reference: str) -> Formula:
    """A force or a scaling factor times 1 + k (x - x_ref), x the condition of the ``reference``."""
    return lambda k, value, at: value * (1.0 + k * at.above(reference))


def bent(k2: Any, value: Any, at: Any) -> Any:
    """A scaling factor with the linear term of temperature, with the quadratic one too."""
    warmer = at.above("T_ref_degC")
    return value * (1.0 + k2 * warmer**2 / (1.0 + at.numbers["k_T_grip_per_K"] * warmer))


def changed(share: Any, value: Any, at: Any) -> Any:
    """A scaling factor times 1 plus the number of a run."""
    return value * (1.0 + share)


FORMULAE: dict[str, Formula] = {
    "gain_gamma": scaled,
    "gamma_0_deg": turned,
    "gamma_0_deg_per_kN": lambda k, gamma, at: (
        gamma + k * (RADIANS * 1e-3) * (at.points.Fz - at.nominal_load)
    ),
    "disc_tilt_deg_per_kN": lambda k, gamma, at: (
        gamma + k * (RADIANS * 1e-3) * np.sign(at.points.phi_t) * at.points.Fz
    ),
    "gain_Fz": scaled,
    "load_camber": lambda share, Fz, at: Fz * (1.0 + share * np.sin(at.gamma) ** 2),
    "load_camber_odd": lambda share, Fz, at: Fz * (1.0 + share * np.sin(at.gamma)),
    # All paths share the error of the usual path's radius, because the distances between paths are known.
    "path_radius_m": lambda radius, phi_t, at: np.sign(phi_t) / (radius + at.beyond_usual_path),
    "crown_m": lambda crown, phi_t, at: phi_t / (1.0 - crown * phi_t * np.sin(at.gamma)),
    "kappa_0": added,
    "k_T_grip_per_K2": bent,
    "k_p_arm_per_kPa": lambda k, QSX3, at: QSX3 + k * at.above("p_ref_kPa"),
    "run_grip": changed,
    "run_stiffness": changed,
    "sweep_heating": lambda change, value, at: value * (1.0 + change * at.along_sweep),
    "gain_alpha": scaled,
    "relaxation_m": lambda sigma, alpha, at: at.lagged(alpha, sigma),
    "alpha_0_deg": turned,
    "camber_skew_deg": lambda skew, alpha, at: alpha + skew * RADIANS * np.sin(at.gamma),
    "hysteresis_deg": lambda width, alpha, at: alpha - width * (RADIANS * at.sense),
    "compliance_deg_per_Nm": lambda give, alpha, at: at.turned_by_moment(alpha, give * RADIANS),
    "backlash_deg": lambda play, alpha, at: at.held_in_play(alpha, 0.5 * RADIANS * play),
    "k_t_per_s": lambda k, force, at: force * (1.0 + k * at.time),
    "wear_per_km": lambda wear, force, at: force * (1.0 + wear * at.distance_km),
    "warm_up": lambda share, force, at: force * (1.0 - share * np.exp(-at.distance_km)),
    "gain": scaled,
    "gain_Mx": scaled,
    "gain_My": scaled,
    "gain_Mz": scaled,
    "nonlinearity_per_kN": lambda growth, Fy, at: Fy * (1.0 + 1e-3 * growth * abs(Fy)),
    "crosstalk": lambda share, Fy, at: Fy + share * at.Fz,
    "crosstalk_camber": lambda share, Fy, at: Fy + share * np.sin(at.gamma) * at.Fz,
    "F0_direction_N": lambda zero, Fy, at: Fy + zero * at.points.direction,
    "F0_N": added,
    "M0_Nm": added,
    "gain_Fx": scaled,
    "crosstalk_Fx_Mz_m": lambda arm, Mz, at: Mz + arm * at.true["Fx"],
    "crosstalk_Fx_Mx_m": lambda arm, Mx, at: Mx + arm * at.true["Fx"],
    "crosstalk_Fy_Mx_m": lambda arm, Mx, at: Mx + arm * at.true["Fy"],
    "drag_Fx_N": lambda drag, Fx, at: Fx - drag * at.points.direction,
    "Fx0_N": added,
    "Mx0_Nm": added,
    "My0_Nm": added,
}
"""By name of the error; references such as ``T_ref_degC`` have none, others that count from one have :func:`over` it."""
FORCE_AT_ZERO: dict[str, Callable[[Any, AtZero], Any]] = {
    "alpha_0_deg": lambda force, at: force,
    "backlash_deg": lambda play, at: 0.5 * RADIANS * at.C_alpha * at.side_of_play * play,
    "gamma_0_deg": lambda zero, at: RADIANS * at.C_gamma * zero,
    "disc_tilt_deg_per_kN": lambda tilt, at: RADIANS * 1e-3 * at.C_gamma * at.load * tilt,
    "F0_N": lambda zero, at: zero,
}
"""Contributions to the raw force at zero angles [N], of errors in the unit of their declaration."""
CAMBER_STIFFNESS: dict[str, Callable[[Any, AtZero], Any]] = {
    "camber_skew_deg": lambda skew, at: RADIANS * at.C_alpha * skew
}
"""Contributions to the slope over camber, rolling forwards [N/rad]."""
CALIBRATES: dict[str, Callable[[AtLoad], Slopes]] = {
    "gain_gamma": lambda at: Slopes(C_gamma=1.0),
    "gain_Fz": lambda at: at.over_load,
    "crown_m": lambda at: Slopes(C_gamma=at.spin_of_camber),
    "gain_alpha": lambda at: Slopes(C_alpha=1.0),
    "compliance_deg_per_Nm": lambda at: Slopes(*(RADIANS * share for share in at.by_moment)),
    "gain": lambda at: Slopes(1.0, 1.0, 1.0),
    "crosstalk_camber": lambda at: Slopes(C_gamma=at.load_of_camber),
    **{f"gain_{channel}": lambda at: Slopes() for channel in ("Mx", "My", "Mz", "Fx")},
}
"""Relative changes of stiffnesses and force per unit of the errors that are multiplicative."""
