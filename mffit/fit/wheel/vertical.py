"""Vertical stiffness and effective rolling radius, from the measured loaded radius and wheel speed of a freely rolling wheel."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from mffit.constants import COVERAGE_FACTOR_95, STRAIGHT
from mffit.fit import constants
from mffit.fit.agreement import Agreement, agreement
from mffit.fit.beside import BesideNumbers
from mffit.least_squares import FreeNumber, of_model, solve
from mffit.points import Points, levels
from mffit.rounding import ascii_only, to_uncertainty
from mffit.scatter import rms
from mffit.suspicion import parts_of_sweeps
from tir import Quantity
from tir.equations import vertical
from tir.outputs import outputs_of
from tir.parameters import BY_NAME

GROWTH = "growth"
"""Growth of the free radius with pressure, relative to dpi: MF has no term for it, and PFZ1 would take it up."""
LEAN = {"RL": "lean of RL", "omega": "lean of omega"}
"""By channel, change of the radius with the square of camber, relative to the free one: it depends on the contour, and is not
written."""
BOUNDS = {
    "Q_RE0": (0.9, 1.1),
    "PFZ1": (-0.5, 2.0),
    "DREFF": (-1.0, 2.0),
    "FREFF": (-1.0, 1.0),
    "BREFF": (0.2, 40.0),
    GROWTH: (-0.3, 0.3),
    **dict.fromkeys(LEAN.values(), (-10.0, 10.0)),
    "Q_V1": (-0.01, 0.02),
    "Q_V2": (-0.3, 0.5),
}
OVER_SPEED = dict(zip(("Q_V1", "Q_V2"), constants.SPREADS_OVER_SPEED, strict=True))
"""Coefficients of the radii that several speeds show, and the standard deviation of each among tyres."""


OF_WHEEL_SPEED = ("DREFF", "FREFF", "BREFF")
"""Coefficients of the rolling radius, in the order in which further loads determine them."""
OF_RADII = ("VERTICAL_STIFFNESS", "Q_FZ2", *(name for name in BOUNDS if name in BY_NAME))
"""Every coefficient that radii may determine."""


@dataclass(frozen=True, slots=True)
class Vertical:
    """What loaded radius and wheel speed determine."""

    numbers: Mapping[str, float] = field(default_factory=dict)
    """Coefficients (k,) with the growth of the free radius and the effects of camber, in the order of the covariance."""
    covariance: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  #: (k, k)
    rms: Mapping[str, float] = field(default_factory=dict)
    """By channel, RL and omega, rms misfit of the radius [m]."""
    rolling: RollingParts | None = None  #: the means that were fitted; None without any

    @property
    def found(self) -> dict[str, Quantity]:
        """The coefficients with their standard uncertainties."""
        return self.beside.quantities

    @property
    def beside(self) -> BesideNumbers:
        """The coefficients with their covariance; no force of the points depends on them."""
        rows = [i for i, name in enumerate(self.numbers) if name in BY_NAME]
        names = [name for name in self.numbers if name in BY_NAME]
        return BesideNumbers({n: self.numbers[n] for n in names}, self.covariance[np.ix_(rows, rows)])

    @property
    def growth(self) -> float:
        """Growth of the free radius, relative to dpi."""
        return self.numbers.get(GROWTH, 0.0)

    def agreement(self, values: Mapping[str, Any]) -> dict[str, Agreement]:
        """By channel, RL and omega, agreement of the radii [m] of these values with the means; as far as they were fitted."""
        if self.rolling is None:
            return {}
        return {
            name: agreement(radius(values, self.rolling, name), self.rolling.radius(name))
            for name in self.rms
        }


@dataclass(frozen=True, slots=True)
class RollingParts:
    """Means over the freely rolling parts of sweeps with little camber (n,)."""

    Fz: np.ndarray  #: [N]
    gamma: np.ndarray  #: [rad]
    p: np.ndarray  #: [Pa]
    V: np.ndarray  #: [m/s]
    loaded: np.ndarray  #: [m]; NaN where it was not measured
    effective: np.ndarray  #: [m]; the same

    def radius(self, channel: str) -> np.ndarray:
        """The measured radius (n,) [m] of RL, or of omega."""
        return self.loaded if channel == "RL" else self.effective

    def select(self, which: np.ndarray) -> RollingParts:
        """Those of a boolean mask (n,)."""
        return RollingParts(*(getattr(self, part.name)[which] for part in fields(self)))

    def rim_speed(self, free_radius: float) -> np.ndarray:
        """Speed of rotation times a radius (n,) [m/s]; that of travel where the wheel speed was not measured."""
        rolled = np.where(np.isfinite(self.effective), self.effective, free_radius)
        found: np.ndarray = self.V * free_radius / rolled
        return found


def radius(values: Mapping[str, Any], at: RollingParts, channel: str) -> Any:
    """Loaded radius, or effective rolling radius for omega, of the upright wheel [m]; plain or traced as the values are."""
    p = SimpleNamespace(**values)
    if channel == "RL":
        rim_speed = at.rim_speed(float(values["UNLOADED_RADIUS"])) / float(values["LONGVL"])
        free = p.UNLOADED_RADIUS * (p.Q_RE0 + p.Q_V1 * rim_speed**2)
        return free - vertical.deflection(
            p, at.Fz / (1.0 + p.Q_V2 * rim_speed), at.p / float(values["NOMPRES"]) - 1.0
        )
    return outputs_of(("Re",), p, {"Fz": at.Fz, "Vx": at.V, "pressure": at.p})[0]


def vertical_coefficients(values: Mapping[str, Any], points: Points, held: Collection[str] = ()) -> Vertical:
    """Vertical stiffness, free radius and rolling radius of the file that fit the readings, with standard uncertainties.

    The stiffness comes first, from the loaded radius: DREFF, BREFF and FREFF appear only over it, and a zero of one reading does
    not distort what the other shows. The errors of the first fit are carried into the second. Coefficients ``held``, by hand
    or because they were measured, stay, and so does what too few loads, pressures or speeds show. What speed does and a single
    speed does not show is part of the uncertainties.
    """
    rolling = _rolling(points)
    if rolling is None:
        return Vertical()
    best = _best(values, rolling, held)
    covariance = best.covariance
    for name, spread in OVER_SPEED.items():
        if name in best.numbers or name in held:
            continue
        known = float(values[name])
        change = float(constants.SIMILAR_TYRES_SPREAD) * abs(known) or float(spread)
        other = _best({**values, name: known + change}, rolling, {*held, *OVER_SPEED})
        moved = [other.numbers.get(n, x) - x for n, x in best.numbers.items()]
        covariance = covariance + np.outer(moved, moved)
    return replace(best, covariance=covariance)


def _best(values: Mapping[str, Any], rolling: RollingParts, held: Collection[str]) -> Vertical:
    """The numbers that fit the readings; coefficients over speed that are not found are exact here."""
    nominal = float(values["NOMPRES"])
    loads = levels.count(rolling.Fz, levels.LOAD)
    pressures = levels.count(rolling.p, levels.PRESSURE)
    speeds = levels.count(rolling.V, levels.SPEED)
    dpi = rolling.p / nominal - 1.0
    known: dict[str, Any] = {**values, GROWTH: 0.0, **dict.fromkeys(LEAN.values(), 0.0)}
    fits: dict[str, _OfRadius] = {}
    growth = [GROWTH] if pressures > 1 else []
    leant = levels.count(np.abs(rolling.gamma), levels.CAMBER) > 1
    if np.any(np.isfinite(rolling.loaded)) and loads > 1:
        names = ["VERTICAL_STIFFNESS", "Q_RE0"] + (["Q_FZ2"] if loads > 2 else [])
        names += (["PFZ1"] if pressures > 1 else []) + (list(OVER_SPEED) if speeds > 1 else [])
        names = [name for name in names if name not in held]
        known |= {name: 0.0 for name in ("Q_FZ2", "PFZ1") if name in names}
        known["VERTICAL_STIFFNESS"] = _stiffness(rolling)
        names += [*growth, *([LEAN["RL"]] if leant else [])]
        fits["RL"] = _fitted(names, (), known, rolling, "RL", dpi)
        known |= fits["RL"].values
        growth = []
    if np.any(np.isfinite(rolling.effective)) and loads > 1:
        names = [] if fits else ["Q_RE0", *(["Q_V1"] if speeds > 1 else [])]
        names += OF_WHEEL_SPEED[: loads - 1]
        names = [name for name in names if name not in held]
        names += [*growth, *([LEAN["omega"]] if leant else [])]
        before = [name for fit in fits.values() for name in fit.values]
        fits["omega"] = _fitted(names, before, known, rolling, "omega", dpi)
        known |= fits["omega"].values
    covariance = np.zeros((0, 0))
    for fit in fits.values():  # an error of what was fitted before moves the rest
        across = fit.moved @ covariance
        own = fit.covariance + across @ fit.moved.T
        covariance = np.block([[covariance, across.T], [across, own]])
    numbers = {name: x for fit in fits.values() for name, x in fit.values.items()}
    return Vertical(numbers, covariance, {c: fit.rms for c, fit in fits.items()}, rolling)


def _rolling(points: Points) -> RollingParts | None:
    """The parts of sweeps at which the wheel rolls freely straight on; None without radius or wheel speed."""
    used = points.free_rolling & (points.direction > 0) & (points.phi_t == 0.0)
    used &= np.abs(points.alpha) < STRAIGHT.rad
    used &= np.abs(points.gamma) < constants.LARGEST_CAMBER_OF_RADII.rad
    turning = np.isfinite(points.omega) & (points.omega > 0.0)
    used &= np.isfinite(points.RL) | turning
    if not np.any(used):
        return None
    part = points.select(used)
    effective = np.where(turning[used], part.rolling_radius, np.nan)
    # Radii grow with the square of speed, so that a mean over speeds belongs to none of them.
    speed = levels.nearest_labels(part.V, levels.SPEED)
    group = parts_of_sweeps(part) * (int(np.max(speed)) + 2) + speed + 1

    def mean(x: np.ndarray) -> np.ndarray:
        return np.array([float(np.mean(x[group == k])) for k in np.unique(group)])

    return RollingParts(*map(mean, (part.Fz, part.gamma, part.p, part.V, part.RL, effective)))


def _stiffness(rolling: RollingParts) -> float:
    """Load over loaded radius [N/m], the slope of a line."""
    known = np.isfinite(rolling.loaded)
    slope = float(np.polyfit(rolling.Fz[known], rolling.loaded[known], 1)[0])
    return 1.0 / max(-slope, 1e-7)


class _OfRadius(NamedTuple):
    """The fit of one radius."""

    values: dict[str, float]  #: (k,)
    covariance: np.ndarray  #: (k, k) from the misfit; what was fitted before counts as exact
    moved: np.ndarray  #: (k, b) derivatives of the numbers by those that were fitted before
    rms: float  #: [m]


def _fitted(
    names: Sequence[str],
    before: Sequence[str],
    values: Mapping[str, Any],
    rolling: RollingParts,
    channel: str,
    dpi: np.ndarray,
) -> _OfRadius:
    """The best values of the named numbers, beside those that were fitted ``before``."""
    known = np.isfinite(rolling.radius(channel))
    rolling, dpi = rolling.select(known), dpi[known]
    measured = rolling.radius(channel)
    unit = float(np.ptp(measured)) or 1e-3
    stiffness, free_radius = float(values["VERTICAL_STIFFNESS"]), float(values["UNLOADED_RADIUS"])
    relative = (stiffness * free_radius / float(values["FNOMIN"])) ** 2
    bounds = {
        **BOUNDS,
        "VERTICAL_STIFFNESS": (0.2 * stiffness, 5.0 * stiffness),
        "Q_FZ2": (-relative, 0.2 * relative),
    }
    numbers = [FreeNumber(name, float(values[name]), *bounds[name]) for name in names]

    def radius_of(free: Mapping[str, Any]) -> Any:
        every = {**values, **free}
        with np.errstate(invalid="ignore"):
            found = radius(every, rolling, channel)
        return found + free_radius * (every[GROWTH] * dpi + every[LEAN[channel]] * rolling.gamma**2)

    end = solve(of_model(radius_of, names, measured, unit), numbers, tolerance=1e-9)
    scale = _scatter(float(end.data @ end.data), len(measured) - len(names), unit) ** 2
    values = {**values, **end.values}
    at = np.array([float(values[name]) for name in before])
    slope = of_model(radius_of, before, measured, unit).linear(at).slope
    return _OfRadius(
        values=dict(end.values),
        covariance=end.covariance * scale,
        moved=-end.covariance @ end.jacobian.T @ slope,
        rms=unit * rms(end.data),
    )


def _scatter(squares: float, freedom: int, unit: float) -> float:
    """Scatter of the means in units, so that 1.96 of it hold 95 % although it is estimated from few of them."""
    if freedom < 1:
        return float(constants.USUAL_MISFIT_OF_RADIUS) / unit
    return math.sqrt(squares / freedom) * float(stdtrit(freedom, 0.975)) / COVERAGE_FACTOR_95


def vertical_sentence(found: Vertical) -> str:
    """What was fitted to loaded radius and wheel speed, with the misfit; empty if nothing was."""
    if not found.found:
        return ""
    sources = {"RL": "loaded radius", "omega": "wheel speed"}
    misfit = " and ".join(f"{1e3 * x:.1f} mm ({sources[name]})" for name, x in found.rms.items())
    numbers = ", ".join(f"{name} {to_uncertainty(q.value, q.u)}" for name, q in found.found.items())
    grown = (
        f" The free radius changes by {1e2 * found.growth:+.2f} % per nominal pressure, for which MF has no coefficient."
        if found.growth
        else ""
    )
    return ascii_only(f"Fitted to radii of the freely rolling wheel, rms {misfit}: {numbers}.{grown}")
