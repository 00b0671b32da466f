"""The effective rolling radius, and the coefficients of rolling resistance from the measured moment My."""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.config import Declaration
from mffit.constants import MOST, STRAIGHT
from mffit.fit import constants
from mffit.fit.beside import BesideNumbers
from mffit.fit.coverage import why_held
from mffit.fit.weights import stated_or_nominal
from mffit.least_squares import EXACT, FreeNumber, inverse, of_model, solve
from mffit.points import Points
from mffit.rig_errors import number_of
from mffit.scatter import rms
from tir import Quantity
from tir.outputs import outputs_of
from tir.parameters import TABLE


def effective_radius(values: Mapping[str, Any], loads: np.ndarray, speed: float) -> Any:
    """Effective rolling radius [m] at loads (n,) [N] and a speed [m/s], plain or traced as the values are."""
    return outputs_of(("Re",), SimpleNamespace(**values), {"Fz": loads, "Vx": speed})[0]


ROLLING = tuple(row.name for row in TABLE if row.channel == "My")
"""Coefficients of rolling resistance."""
SPREADS = {
    row.name: row.tyres_spread for row in TABLE if row.name in ROLLING and row.tyres_spread is not None
}
"""Standard deviation among tyres of each coefficient of rolling resistance, which is 0.007 to 0.02 over the load; public files
have QSY3 of 0.0004 and more, QSY7 of 0.85 to 1 and QSY8 of -0.4 to 0."""
BOUNDS = {"QSY7": (0.0, 3.0), "QSY8": (-2.0, 1.0)}
MY_ZERO, FX_ZERO = "My0_Nm", "Fx0_N"


@dataclass(frozen=True, slots=True)
class Resistance:
    """Coefficients and zeros from the moment My of the freely rolling wheel."""

    beside: BesideNumbers = field(default_factory=BesideNumbers)  #: coefficients
    regularised: frozenset[str] = frozenset()  #: coefficients with much weight of the prior
    zeros: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Zeros of My [Nm] by rig number, with standard errors; only those that the loads separate from the tyre."""

    @property
    def found(self) -> dict[str, Quantity]:
        """The coefficients with their standard uncertainties."""
        return self.beside.quantities


def coasting(points: Points, values: Mapping[str, Any]) -> Points:
    """The points (m,) of sweeps with a freely rolling wheel on a straight path without sideslip, with My computed from Fx.

    No torque drives such a wheel, so the moments about its axis balance: My = Fx times the loaded radius.
    """
    straight = points.free_rolling & (np.abs(points.alpha) < STRAIGHT.rad) & (points.phi_t == 0.0)
    driven = np.unique(points.sweep[~straight])
    used = np.isfinite(points.Fx) & ~np.isin(points.sweep, driven)
    rolling = points.select(used)
    deflected = float(values["UNLOADED_RADIUS"]) - rolling.Fz / float(values["VERTICAL_STIFFNESS"])
    radius = np.where(np.isfinite(rolling.RL), rolling.RL, deflected)
    return rolling.replace(My=rolling.Fx * radius, u_My=rolling.u_Fx * radius)


def rolling_resistance(
    values: Mapping[str, Any],
    points: Points,
    zero: Declaration,
    held: Collection[str] = (),
    side: str = "left",
    u_gain: float = 0.0,
) -> Resistance:
    """Coefficients of rolling resistance and the zeros of the rig, with standard uncertainties; empty if My was not measured.

    ``zero`` is the prior of the zero of My; each set-up has its own zero. Coefficients that are ``held`` or that the loads,
    pressures, speeds and cambers do not determine keep their values. ``u_gain`` is the relative uncertainty of the calibration
    of My over load. Points with longitudinal slip are not used: their My depends on the arm of Fx.
    """
    rolling = np.isfinite(points.My) & (points.direction > 0) & points.free_rolling
    if not np.any(rolling):
        return Resistance()
    chosen = points.select(np.flatnonzero(rolling))
    names = [n for n in ROLLING if n not in held and not why_held(n, chosen, side)]
    numbers = [_with_prior(name, float(values[name])) for name in names]
    setups = chosen.used_setups
    own = {setup: number_of(MY_ZERO, setup if len(setups) > 1 else "") for setup in setups}
    numbers += [FreeNumber(n, zero.value, expected=zero.value, spread=zero.u or EXACT) for n in own.values()]
    in_setup = np.array([[chosen.setups[k] == setup for setup in setups] for k in chosen.setup], float)
    sigma = stated_or_nominal(chosen.u_My, chosen.My)
    inputs = {
        "Fz": chosen.Fz, "alpha": chosen.alpha, "gamma": chosen.gamma, "phi_t": chosen.phi_t, "Vx": chosen.V,
        "pressure": chosen.p,
    }  # fmt: skip

    def moment(free: Mapping[str, Any]) -> Any:
        (My,) = outputs_of(("My",), SimpleNamespace(**{**values, **free}), inputs, turn_slip=True)
        for setup, number in enumerate(own.values()):
            My = My + in_setup[:, setup] * free[number]
        return My

    every = [number.name for number in numbers]
    end = solve(of_model(moment, every, chosen.My, sigma), numbers, tolerance=1e-8)
    scale = max(rms(end.data), 1.0)  # where the formula misses the points by more than their noise
    information = end.jacobian.T @ end.jacobian / scale**2 + np.diag(end.prior)
    covariance = inverse(information)
    stderr = dict(zip(end.names, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    scaled = np.array([0.0 if n in BOUNDS else end.values[n] for n in names])  # exponents are not factors
    of_gain = u_gain**2 * np.outer(scaled, scaled)
    of_prior = {n.name for n in numbers if stderr[n.name] > MOST * n.spread}
    return Resistance(
        beside=BesideNumbers(
            {name: end.values[name] for name in names}, covariance[: len(names), : len(names)] + of_gain
        ),
        regularised=frozenset(of_prior.intersection(names)),
        zeros={n: (end.values[n], stderr[n]) for n in own.values() if n not in of_prior and zero.u > 0.0},
    )


def _with_prior(name: str, known: float) -> FreeNumber:
    """A coefficient with a prior around its known value, as wide as the scatter of similar tyres."""
    lower, upper = BOUNDS.get(name, (-math.inf, math.inf))
    spread = max(SPREADS[name], constants.SIMILAR_TYRES_SPREAD * abs(known))
    return FreeNumber(name, known, lower, upper, expected=known, spread=spread)
