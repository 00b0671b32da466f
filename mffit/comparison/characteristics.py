"""Characteristic numbers for the comparison of tyres: stiffnesses, peaks, trail, radius."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import chain
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.constants import SLIP_BEYOND_THE_PEAK
from mffit.fit import Posterior
from mffit.fit.posterior import spread_through
from mffit.prediction import Predictor
from mffit.quantities import CHARACTERISTICS
from tir import Quantity, Tyre
from tir.derivatives import gradient, plain, traced
from tir.outputs import outputs_of

OUTPUTS = ("Fx", "Fy", "Mz", "Re")
STEP = 1e-3
"""Step of central differences for slopes at zero [rad, -, 1/m]."""
DECIDED_BY = {
    "C_alpha_N_per_rad": "Fy",
    "mu_y": "Fy",
    "K_xk_N": "Fx",
    "mu_x": "Fx",
    "C_gamma_N_per_rad": "Fy",
    "Mz_peak_Nm": "Mz",
    "C_Mz_alpha_Nm_per_rad": "Mz",
    "trail_m": "Mz",
}
"""By number, the channel whose readings determine it; the numbers that engineers ask for first come first."""


def slip_end(tyres: Sequence[Tyre]) -> float:
    """End of the range of slip, common to some files, that lies farther from zero: negative if it is the braked one.

    At most 0.3 to either side; the driven end if both are equally far.
    """
    braked = max(float(tyre["KPUMIN"]) for tyre in tyres)
    driven = min(float(tyre["KPUMAX"]) for tyre in tyres)
    ends = max(braked, -float(SLIP_BEYOND_THE_PEAK)), min(driven, float(SLIP_BEYOND_THE_PEAK))
    return ends[0] if -ends[0] > ends[1] else ends[1]


def characteristics(
    tyre: Tyre,
    load: float,
    *,
    turn_slip: bool,
    pressure: float | None = None,
    reach: float | None = None,
    slip_reach: float | None = None,
    known: Posterior | None = None,
    predictor: Predictor | None = None,
) -> dict[str, Quantity]:
    """The numbers of ``mffit.quantities.CHARACTERISTICS`` on a straight path; SI units, ISO signs.

    ``turn_slip``: whether the simulation computes spin; without it there is no turn-slip stiffness. The default of ``pressure``
    is the file's, that of ``reach``, the largest sideslip of the search for peaks, its ALPMAX, that of ``slip_reach``
    :func:`slip_end`. Without ``known``, or if a number depends on none of its coefficients, the number's uncertainty is 0.
    The covariance of ``predictor`` is used for the numbers of its channels, see :data:`DECIDED_BY`; it includes the exchange
    between coefficients and model error, which leaves the force unchanged.
    """
    every = {}
    if predictor is not None:
        every = {name: Posterior(predictor.names, one.covariance) for name, one in predictor.channels.items()}
    posteriors = [one for one in (known, *every.values()) if one is not None]
    names = [name for name in dict.fromkeys(chain(*(one.names for one in posteriors))) if name in tyre.values]
    found, slopes = with_slopes(
        tyre, load, names, turn_slip=turn_slip, pressure=pressure, reach=reach, slip_reach=slip_reach
    )
    of_name = dict(zip(names, slopes.T, strict=True))
    numbers = {}
    for i, (key, x) in enumerate(found.items()):
        one, u = every.get(DECIDED_BY.get(key, ""), known), 0.0
        if one is not None:
            slope = [of_name[name][i] if name in of_name else 0.0 for name in one.names]
            u = float(spread_through(np.array([slope]), one.covariance)[0])
        numbers[key] = Quantity(x, u, CHARACTERISTICS[key].unit)
    return numbers


def with_slopes(
    tyre: Tyre,
    load: float,
    names: Sequence[str],
    *,
    turn_slip: bool,
    pressure: float | None,
    reach: float | None,
    slip_reach: float | None,
) -> tuple[dict[str, float], np.ndarray]:
    """The numbers of :func:`characteristics` (m,) without uncertainty, and their derivatives (m, k) by some coefficients."""
    uncertain = traced({name: float(tyre[name]) for name in names})
    values: dict[str, Any] = {**vars(tyre.p), **uncertain}
    p = SimpleNamespace(**values)
    still = {"alpha": 0.0, "gamma": 0.0, "kappa": 0.0, "phi_t": 0.0}
    still |= {"Fz": load, "pressure": float(tyre["INFLPRES"]) if pressure is None else pressure}

    def at(over: str, x: Any) -> dict[str, Any]:
        return dict(
            zip(OUTPUTS, outputs_of(OUTPUTS, p, {**still, over: x}, turn_slip=turn_slip), strict=True)
        )

    def slopes(over: str) -> dict[str, Any]:
        below, above = at(over, -STEP), at(over, STEP)
        return {name: (above[name] - below[name]) / (2.0 * STEP) for name in OUTPUTS}

    def peak(over: str, name: str, end: float) -> Any:
        x = np.linspace(0.0, end, 101)
        highest = x[np.argmax(np.abs(plain(at(over, x)[name])))]
        value = at(over, float(highest))[name]
        return value if plain(value) >= 0.0 else -value

    by_slip = slopes("alpha")
    end = float(tyre["ALPMAX"]) if reach is None else reach
    slip = slip_end([tyre]) if slip_reach is None else slip_reach
    dfz = load / (float(tyre["FNOMIN"]) * float(tyre["LFZO"])) - 1.0
    found = {
        "epsilon_gamma": values["PECP1"] * (1.0 + values["PECP2"] * dfz),
        "C_alpha_N_per_rad": by_slip["Fy"],
        "C_gamma_N_per_rad": slopes("gamma")["Fy"],
        "C_Mz_alpha_Nm_per_rad": by_slip["Mz"],
        "K_xk_N": slopes("kappa")["Fx"],
        "mu_x": peak("kappa", "Fx", slip) / load,
        "mu_y": peak("alpha", "Fy", end) / load,
        "Mz_peak_Nm": peak("alpha", "Mz", end),
        "trail_m": -by_slip["Mz"] / by_slip["Fy"] if plain(by_slip["Fy"]) else math.nan,
        "r_e_m": at("alpha", 0.0)["Re"],
    }
    if turn_slip:
        found["C_phit_Nm"] = slopes("phi_t")["Fy"]
    jacobian = np.array([gradient(x, list(uncertain.values())) for x in found.values()], dtype=float)
    return {key: float(plain(x)) for key, x in found.items()}, jacobian.reshape(len(found), -1)
