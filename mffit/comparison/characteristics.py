"""The numbers by which engineers compare two tyres first: stiffnesses, peaks, trail, radius."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence

import numpy as np

from mffit.comparison import constants
from mffit.constants import SLIP_BEYOND_THE_PEAK
from tir import Tyre
from tir.parameters import BY_NAME


def characteristics(
    tyre: Tyre,
    load: float,
    *,
    turn_slip: bool,
    pressure: float | None = None,
    reach: float | None = None,
    slip_reach: float | None = None,
) -> dict[str, float]:
    """The numbers of ``mffit.quantities.CHARACTERISTICS`` on a straight path; SI units, ISO signs.

    Parameters
    ----------
    tyre : the file
    load : [N]
    turn_slip : whether the simulation computes spin; without it there is no turn-slip stiffness
    pressure : [Pa]; default the file's
    reach : sideslip up to which peaks are sought [rad]; default the file's ALPMAX
    slip_reach : longitudinal slip up to which the peak of Fx is sought; default the file's KPUMAX, at most 0.3
    """
    p = float(tyre["INFLPRES"]) if pressure is None else pressure
    slip = np.linspace(0.0, float(tyre["ALPMAX"]) if reach is None else reach, 101)
    angles = np.array([-1e-3, 1e-3])
    by_slip = tyre(load, alpha=angles, turn_slip=turn_slip, p=p)
    by_camber = tyre(load, gamma=angles, turn_slip=turn_slip, p=p)
    curve = tyre(load, alpha=slip, turn_slip=turn_slip, p=p)
    step = 2e-3
    end = min(float(tyre["KPUMAX"]), SLIP_BEYOND_THE_PEAK) if slip_reach is None else slip_reach
    driven = tyre(load, kappa=np.linspace(0.0, end, 101), turn_slip=turn_slip, p=p)
    C_alpha = float(np.diff(by_slip.Fy)[0] / step)
    C_moment = float(np.diff(by_slip.Mz)[0] / step)
    dfz = load / (float(tyre["FNOMIN"]) * float(tyre["LFZO"])) - 1.0
    out = {
        "epsilon_gamma": float(tyre["PECP1"]) * (1.0 + float(tyre["PECP2"]) * dfz),
        "C_alpha_N_per_rad": C_alpha,
        "C_gamma_N_per_rad": float(np.diff(by_camber.Fy)[0] / step),
        "C_Mz_alpha_Nm_per_rad": C_moment,
        "K_xk_N": float(np.diff(tyre(load, kappa=angles, turn_slip=turn_slip, p=p).Fx)[0] / step),
        "mu_x": float(np.max(np.abs(driven.Fx)) / load),
        "mu_y": float(np.max(np.abs(curve.Fy)) / load),
        "Mz_peak_Nm": float(np.max(np.abs(curve.Mz))),
        "trail_m": -C_moment / C_alpha if C_alpha else float("nan"),
        "r_e_m": float(tyre.state(load, p=p).Re),
    }
    if turn_slip:
        curved = tyre(load, phi_t=np.array([-1e-3, 1e-3]), turn_slip=True, p=p)
        out["C_phit_Nm"] = float(np.diff(curved.Fy)[0] / 2e-3)
    return out


def with_u(
    tyre: Tyre, names: Sequence[str], covariance: np.ndarray | None, of: Callable[[Tyre], Mapping[str, float]]
) -> tuple[Mapping[str, float], dict[str, float]]:
    """Numbers of a tyre and their standard uncertainties, to first order.

    Parameters
    ----------
    tyre : the file
    names : coefficients (k,) whose covariance is known
    covariance : (k, k); None if it is unknown
    of : function that computes the numbers of a tyre

    Returns
    -------
    numbers, uncertainties
        Uncertainties are empty without a covariance. Infinite ones are left out, and those of numbers that depend on none of the
        coefficients, whose uncertainty is unknown.
    """
    here = of(tyre)
    if covariance is None:
        return here, {}
    slopes = {key: np.zeros(len(names)) for key in here}
    for k, (name, u) in enumerate(zip(names, np.sqrt(np.maximum(np.diag(covariance), 0.0)), strict=True)):
        step = 0.05 * min(float(u), 0.1 * BY_NAME[name].width)
        if step > 0.0:
            there = of(tyre.replace(**{name: float(tyre[name]) + step}))
            for key, value in here.items():
                change = there[key] - value
                if not abs(change) <= constants.ROUNDING_OF_NUMBERS * abs(value):
                    slopes[key][k] = change / step
    found = {key: math.sqrt(max(float(g @ covariance @ g), 0.0)) for key, g in slopes.items()}
    return here, {key: u for key, u in found.items() if math.isfinite(u) and u > 0.0}
