"""Vertical stiffness and effective rolling radius, from the measured loaded radius and wheel speed of a freely rolling wheel."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from mffit.constants import COVERAGE_FACTOR_95, STRAIGHT, UPRIGHT
from mffit.fit import constants
from mffit.fit.agreement import Agreement, agreement
from mffit.fit.beside import BesideNumbers
from mffit.least_squares import FreeNumber, of_model, solve
from mffit.points import Points, levels
from mffit.scatter import rms
from mffit.suspicion import parts_of_sweeps
from tir import Quantity
from tir.equations import vertical
from tir.outputs import outputs_of
from tir.parameters import BY_NAME

GROWTH = "growth"
"""Growth of the free radius with pressure, relative to dpi: MF has no term for it, and PFZ1 would take it up."""
BOUNDS = {
    "Q_RE0": (0.9, 1.1),
    "PFZ1": (-0.5, 2.0),
    "DREFF": (-1.0, 2.0),
    "FREFF": (-1.0, 1.0),
    "BREFF": (0.2, 40.0),
    GROWTH: (-0.3, 0.3),
    "Q_V1": (-0.01, 0.02),
    "Q_V2": (-0.3, 0.5),
}
OVER_SPEED = dict(zip(("Q_V1", "Q_V2"), constants.SPREADS_OVER_SPEED, strict=True))
"""Coefficients of the radii that several speeds show, and the standard deviation of each among tyres."""


OF_WHEEL_SPEED = ("DREFF", "FREFF", "BREFF")
"""Coefficients of the rolling radius."""
SHOWN = {
    "RL": ("VERTICAL_STIFFNESS", "Q_RE0", "Q_FZ2", "PFZ1", *OVER_SPEED, GROWTH),
    "omega": ("Q_RE0", "Q_V1", *OF_WHEEL_SPEED, GROWTH),
}
"""By channel, the numbers that it shows; what the first one has shown stays."""
NEEDED = {
    **{"Q_FZ2": ("loads", 3), "FREFF": ("loads", 3), "BREFF": ("loads", 4)},
    **dict.fromkeys(("PFZ1", GROWTH), ("pressures", 2)),
    **dict.fromkeys(OVER_SPEED, ("speeds", 2)),
}
"""What must be varied for some of them, and how many levels of it; all need two loads."""


@dataclass(frozen=True, slots=True)
class Vertical:
    """What loaded radius and wheel speed determine."""

    numbers: Mapping[str, float] = field(default_factory=dict)
    """Coefficients (k,) with the growth of the free radius, in the order of the covariance."""
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
    """Means over the freely rolling parts of sweeps without camber (n,)."""

    Fz: np.ndarray  #: [N]
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

    The loaded radius comes first: DREFF, BREFF and FREFF appear only over the stiffness, and a zero of one reading does not
    distort what the other shows. Coefficients ``held``, by hand or because they were measured, stay, and so does what too few
    loads, pressures or speeds show. What speed does and a single speed does not show is part of the uncertainties, and so are
    the errors of what was found before.
    """
    rolling = _rolling(points)
    if rolling is None:
        return Vertical()
    run = {
        "loads": levels.count(rolling.Fz, levels.LOAD),
        "pressures": levels.count(rolling.p, levels.PRESSURE),
        "speeds": levels.count(rolling.V, levels.SPEED),
    }
    read = [c for c in SHOWN if np.any(np.isfinite(rolling.radius(c)))] if run["loads"] > 1 else []
    names = {channel: [n for n in SHOWN[channel] if n not in held and _is_shown(n, run)] for channel in read}
    found = {
        name: float(values[name])
        for name in OVER_SPEED
        if name not in held and not any(name in own for own in names.values())
    }
    u = [constants.SIMILAR_TYRES_SPREAD * abs(x) or float(OVER_SPEED[name]) for name, x in found.items()]
    covariance, unseen, misfit = np.diag(np.square(u)), len(found), dict[str, float]()
    known = {**values, GROWTH: 0.0, **{n: 0.0 for n in ("Q_FZ2", "PFZ1") if n in names.get("RL", ())}}
    if "VERTICAL_STIFFNESS" in names.get("RL", ()):
        known["VERTICAL_STIFFNESS"] = _stiffness(rolling)
    for channel, every in names.items():
        free = [name for name in every if name not in found]
        fit = _fitted(free, list(found), {**known, **found}, rolling, channel)
        found |= fit.values
        misfit[channel] = fit.rms
        across = fit.moved @ covariance
        own = fit.covariance + across @ fit.moved.T
        covariance = np.block([[covariance, across.T], [across, own]])
    numbers = dict(list(found.items())[unseen:])
    return Vertical(numbers, covariance[unseen:, unseen:], misfit, rolling)


def _is_shown(name: str, run: Mapping[str, int]) -> bool:
    what, count = NEEDED.get(name, ("loads", 2))
    return run[what] >= count


def _rolling(points: Points) -> RollingParts | None:
    """The parts of sweeps at which the wheel rolls freely straight on; None without radius or wheel speed."""
    used = points.free_rolling & (points.direction > 0) & (points.phi_t == 0.0)
    used &= np.abs(points.alpha) < STRAIGHT.rad
    used &= np.abs(points.gamma) < UPRIGHT.rad
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

    return RollingParts(*map(mean, (part.Fz, part.p, part.V, part.RL, effective)))


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
) -> _OfRadius:
    """The best values of the named numbers, beside those that were fitted ``before``."""
    rolling = rolling.select(np.isfinite(rolling.radius(channel)))
    dpi = rolling.p / float(values["NOMPRES"]) - 1.0
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
        return found + free_radius * every[GROWTH] * dpi

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
    """What pressure does to the free radius, which no coefficient says; empty if that is not known."""
    if not found.growth:
        return ""
    return f"The free radius changes by {1e2 * found.growth:+.2f} % per nominal pressure, for which MF has no coefficient."
