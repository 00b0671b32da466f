"""Vertical stiffness and effective rolling radius, from the measured loaded radius and wheel speed of a freely rolling wheel."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
from scipy.special import stdtrit

from mffit.constants import COVERAGE_FACTOR_95, MOST, STRAIGHT, UPRIGHT
from mffit.fit import constants
from mffit.fit.agreement import Agreement, agreement
from mffit.fit.beside import BesideNumbers
from mffit.fit.coverage import design
from mffit.least_squares import FreeNumber, Solution, inverse, of_model, solve
from mffit.left_out import moved_without
from mffit.points import Points, levels
from mffit.scatter import rms
from mffit.suspicion import parts_of_sweeps
from tir import Quantity
from tir.derivatives import plain
from tir.equations import vertical
from tir.frozen import ReadOnlyArrays
from tir.outputs import outputs_of
from tir.parameters import BY_NAME, TABLE

GROWTH = "growth"
"""Growth of the free radius with pressure, relative to dpi. MF has no term for it, and without it PFZ1 would absorb it. Q_RE0
holds at the mean pressure of the readings."""
BOUNDS = {
    "Q_RE0": (0.9, 1.1),
    "PFZ1": (-0.5, 2.0),
    "DREFF": (-1.0, 2.0),
    "FREFF": (-1.0, 1.0),
    "BREFF": (0.2, 40.0),
    GROWTH: (-0.3, 0.3),
    "Q_V1": (-0.01, 0.02),
    "Q_V2": (-0.3, 0.5),
    "Q_FCX": (0.0, 1.0),
    "Q_FCY": (0.0, 1.0),
    "Q_CAM3": (-8.0, 8.0),
}
OF_ROLLING_RADIUS = ("Q_RE0", "DREFF", "FREFF", "BREFF")
"""Coefficients of the rolling radius."""
SPREADS = {
    row.name: row.tyres_spread for row in TABLE if row.section == "VERTICAL" and row.tyres_spread is not None
}
"""Standard deviation among tyres of coefficients that few test plans determine: published files have Q_V1 of 0.0005 to 0.0008,
Q_V2 of 0.02 to 0.05, Q_FCX of -0.13 to 0.11, Q_FCY of 0.12 to 0.23, and Q_CAM3 of 0 to 0.5; Q_RE0 of 0.9935 to 1.002, DREFF of
0.24 to 0.36, FREFF of 0.05 to 0.1 and BREFF of 7 to 9. A rolling radius that falls by a third of the deflection has DREFF 0 and
FREFF 1/3. A few radii under load do not separate the free radius from these slopes."""
OVER_SPEED = ("Q_V1", "Q_V2")
"""Coefficients that several speeds determine; with a single speed they are held and add to the uncertainties."""
EVEN = ("Q_FCX", "Q_FCY")
"""Coefficients that act only through their squares: the search starts at a usual size, because the gradient vanishes at 0."""
USUAL = 0.1

CONTOUR = {"Q_CAM1": 1.0}
"""Switches on the deflection of a flat tread by camber: only the ratio of Q_CAM1 to Q_CAM2 acts, so its size is arbitrary."""
ROUNDING = 1e-9
"""Lower bound of the misfit of a radius, over the usual misfit."""
SHOWN = {
    "RL": ("VERTICAL_STIFFNESS", "Q_RE0", "Q_FZ2", "PFZ1", *OVER_SPEED, *EVEN, "Q_CAM3", GROWTH),
    "omega": (*OF_ROLLING_RADIUS, "Q_V1", GROWTH),
}
"""By channel, the numbers that it determines; numbers found from RL are kept for omega."""
NEEDED = {
    "Q_FZ2": ("loads", 3),
    **dict.fromkeys(("PFZ1", GROWTH), ("pressures", 2)),
    **dict.fromkeys(OVER_SPEED, ("speeds", 2)),
    **{"Q_FCX": ("kappa", 1), "Q_FCY": ("sideslips", 3), "Q_CAM3": ("camber", 1)},
}
"""By coefficient, the setting that must vary, and its number of levels; all coefficients need two loads."""


@dataclass(frozen=True, slots=True)
class Vertical(ReadOnlyArrays):
    """Coefficients from loaded radius and wheel speed."""

    numbers: Mapping[str, float] = field(default_factory=dict)
    """Coefficients and the growth of the free radius (k,), in the order of the covariance."""
    covariance: np.ndarray = field(default_factory=lambda: np.zeros((0, 0)))  #: (k, k)
    rms: Mapping[str, float] = field(default_factory=dict)
    """By channel, RL and omega, rms misfit of the radius [m]."""
    regularised: frozenset[str] = frozenset()  #: numbers with much weight of the prior
    switched: Mapping[str, float] = field(default_factory=dict)
    """Coefficients set to ``CONTOUR``, if that fits the readings better."""
    rolling: RadiusReadings | None = None  #: means of the upright wheel that rolls freely; None without any
    loaded: RadiusReadings | None = None  #: all readings of the loaded radius; None without any

    @property
    def found(self) -> dict[str, Quantity]:
        """The coefficients with their standard uncertainties."""
        return self.beside.quantities

    @property
    def beside(self) -> BesideNumbers:
        """The coefficients with their covariance; it is independent of the main fit."""
        rows = [i for i, name in enumerate(self.numbers) if name in BY_NAME]
        names = [name for name in self.numbers if name in BY_NAME]
        return BesideNumbers({n: self.numbers[n] for n in names}, self.covariance[np.ix_(rows, rows)])

    @property
    def growth(self) -> float:
        """Growth of the free radius, relative to dpi."""
        return self.numbers.get(GROWTH, 0.0)

    def agreement(self, values: Mapping[str, Any]) -> dict[str, Agreement]:
        """By fitted channel, agreement of the radii [m] from these values with the readings.

        RL is compared with all readings, omega with the means of the freely rolling upright wheel.
        """
        read = {"RL": self.loaded, "omega": self.rolling}
        return {
            name: agreement(radius(values, at, name), at.radius(name))
            for name in self.rms
            if (at := read[name]) is not None
        }


@dataclass(frozen=True, slots=True)
class RadiusReadings(ReadOnlyArrays):
    """Radii of a wheel (n,) and the conditions on which they depend, in ISO-W axes."""

    Fz: np.ndarray  #: [N]
    p: np.ndarray  #: [Pa]
    V: np.ndarray  #: [m/s]
    gamma: np.ndarray  #: [rad]
    Fx: np.ndarray  #: [N]
    Fy: np.ndarray  #: [N]
    omega: np.ndarray  #: speed of rotation [rad/s]; NaN where it was not measured
    loaded: np.ndarray  #: loaded radius [m]; NaN where it was not measured
    effective: np.ndarray  #: effective rolling radius [m]; NaN where it was not measured
    part: np.ndarray  #: index of the part of a sweep to which a reading belongs

    def radius(self, channel: str) -> np.ndarray:
        """The measured radius (n,) [m] of RL, or of omega."""
        return self.loaded if channel == "RL" else self.effective

    def select(self, which: np.ndarray) -> RadiusReadings:
        """The readings selected by a boolean mask (n,)."""
        return RadiusReadings(*(getattr(self, part.name)[which] for part in fields(self)))

    @property
    def means(self) -> RadiusReadings:
        """The means (m,) over each part."""
        groups = [self.part == k for k in np.unique(self.part)]
        every = (getattr(self, part.name) for part in fields(self))
        return RadiusReadings(*(np.array([float(np.mean(x[rows])) for rows in groups]) for x in every))

    def rim_speed(self, free_radius: float) -> np.ndarray:
        """Speed of rotation times ``free_radius`` (n,) [m/s]; the speed of travel where the wheel speed was not measured."""
        return np.where(np.isfinite(self.omega), np.abs(self.omega) * free_radius, self.V)


def radius(values: Mapping[str, Any], at: RadiusReadings, channel: str) -> Any:
    """Loaded radius for "RL", effective rolling radius of the upright wheel for "omega" [m]; plain or traced as the values."""
    p = SimpleNamespace(**values)
    if channel == "RL":
        rim_speed = at.rim_speed(float(values["UNLOADED_RADIUS"])) / float(values["LONGVL"])
        dpi = at.p / float(values["NOMPRES"]) - 1.0
        rolling = vertical.Rolling(at.Fx, at.Fy, at.gamma, rim_speed, dpi)
        known = SimpleNamespace(**{name: plain(value) for name, value in values.items()})
        found = vertical.loaded_radius(known, at.Fz, rolling)
        # One Newton step at the given load gives the radius its derivatives by the traced values.
        load, slope = vertical.load(p, found, rolling)
        return found - (load - at.Fz) / plain(slope)
    return outputs_of(("Re",), p, {"Fz": at.Fz, "Vx": at.V, "pressure": at.p})[0]


def vertical_coefficients(values: Mapping[str, Any], points: Points, held: Collection[str] = ()) -> Vertical:
    """Coefficients of vertical stiffness, free radius and rolling radius, fitted to the readings, with their covariance.

    The loaded radius is fitted first, to every reading under Fx, Fy and camber, because DREFF, BREFF and FREFF act only relative
    to the stiffness. Then the rolling radius follows, so that an offset of one channel does not distort the other. Coefficients
    that are ``held`` or that need more levels of a setting keep their values. The uncertainties include unknown effects of speed
    (if a single speed was run) and the errors of the first fit; those of the rolling radius hold for the vertical stiffness of
    the file. Errors within a part of a sweep are correlated, so only different parts are treated as independent.
    """
    loaded, rolling = _loaded(points), _rolling(points)
    turning = None if rolling is None else rolling.select(np.isfinite(rolling.effective))
    read = {"RL": loaded, "omega": turning if turning is not None and len(turning.V) else None}
    run = {name: _run(points, at) for name, at in read.items() if at is not None}
    names = {
        channel: [n for n in SHOWN[channel] if n not in held and _is_shown(n, seen)]
        for channel, seen in run.items()
        if seen["loads"] > 1
    }
    found = {
        name: float(values[name])
        for name in OVER_SPEED
        if name not in held and not any(name in own for own in names.values())
    }
    u = [constants.SIMILAR_TYRES_SPREAD * abs(x) or SPREADS[name] for name, x in found.items()]
    covariance, unseen, misfit = np.diag(np.square(u)), len(found), dict[str, float]()
    known = {**values, GROWTH: 0.0, **{n: 0.0 for n in ("Q_FZ2", "PFZ1") if n in names.get("RL", ())}}
    if loaded is not None and "VERTICAL_STIFFNESS" in names.get("RL", ()):
        known["VERTICAL_STIFFNESS"] = _stiffness(loaded)
    switched: dict[str, float] = {}
    regularised: set[str] = set()
    for channel, every in names.items():
        free, at = [name for name in every if name not in found], read[channel]
        assert at is not None
        fit = _fitted(free, list(found), {**known, **found}, at, channel)
        if "Q_CAM3" in free and not (known["Q_CAM1"] or known["Q_CAM2"] or {"Q_CAM1", "Q_CAM2"} & {*held}):
            leaning = _fitted(free, list(found), {**known, **found, **CONTOUR}, at, channel)
            if leaning.rms < fit.rms:
                fit, switched = leaning, CONTOUR
                known |= CONTOUR
        found |= fit.values
        misfit[channel] = fit.rms
        regularised |= fit.regularised
        across = fit.moved @ covariance
        own = fit.covariance + across @ fit.moved.T
        covariance = np.block([[covariance, across.T], [across, own]])
    numbers = dict(list(found.items())[unseen:])
    return Vertical(
        numbers=numbers,
        covariance=covariance[unseen:, unseen:],
        rms=misfit,
        regularised=frozenset(regularised),
        switched=switched,
        rolling=rolling,
        loaded=loaded,
    )


def _is_shown(name: str, run: Mapping[str, int]) -> bool:
    what, count = NEEDED.get(name, ("loads", 2))
    return run[what] >= count


def _run(points: Points, at: RadiusReadings) -> dict[str, int]:
    """By need of the coefficients, the number of levels that the readings have."""
    return {
        **design(points, "").run,
        "loads": levels.count(at.Fz, levels.LOAD),
        "pressures": levels.count(at.p, levels.PRESSURE),
        "speeds": levels.count(at.V, levels.SPEED),
    }


def _loaded(points: Points) -> RadiusReadings | None:
    """Every reading of the loaded radius of a wheel that rolls forwards on a straight path; None without any."""
    used = (points.direction > 0) & (points.phi_t == 0.0) & np.isfinite(points.RL) & np.isfinite(points.Fy)
    used &= np.isfinite(points.Fx) | points.free_rolling
    return _readings(points, used)


def _rolling(points: Points) -> RadiusReadings | None:
    """Means of the upright wheel that rolls freely straight on; None without loaded radius or wheel speed."""
    used = points.free_rolling & (points.direction > 0) & (points.phi_t == 0.0)
    used &= np.abs(points.alpha) < STRAIGHT.rad
    used &= np.abs(points.gamma) < UPRIGHT.rad
    used &= np.isfinite(points.RL) | (points.omega > 0.0)
    found = _readings(points, used)
    return None if found is None else found.means


def _readings(points: Points, used: np.ndarray) -> RadiusReadings | None:
    if not np.any(used):
        return None
    part = points.select(used)
    # Radii grow with the square of speed, so means are taken at each speed separately.
    speed = levels.nearest_labels(part.V, levels.SPEED)
    return RadiusReadings(
        Fz=part.Fz, p=part.p, V=part.V, gamma=part.gamma, Fx=np.nan_to_num(part.Fx), Fy=np.nan_to_num(part.Fy),
        omega=np.where(part.omega > 0.0, part.omega, np.nan), loaded=part.RL, effective=part.rolling_radius,
        part=parts_of_sweeps(part) * (int(np.max(speed)) + 2) + speed + 1,
    )  # fmt: skip


def _stiffness(at: RadiusReadings) -> float:
    """Vertical stiffness [N/m] from the slope of the loaded radius over load."""
    slope = float(np.polyfit(at.Fz, at.loaded, 1)[0])
    return 1.0 / max(-slope, 1e-7)


class _OfRadius(NamedTuple):
    """The fit of one radius."""

    values: dict[str, float]  #: (k,)
    covariance: np.ndarray  #: (k, k) from the misfit, with the previously found numbers exact
    moved: np.ndarray  #: (k, b) derivatives of the numbers by the previously found ones
    rms: float  #: [m]
    regularised: frozenset[str]  #: numbers that depend on their priors as much as on the readings


def _fitted(
    names: Sequence[str], before: Sequence[str], values: Mapping[str, Any], at: RadiusReadings, channel: str
) -> _OfRadius:
    """The fit of the named numbers to one radius; numbers ``before`` have been found already."""
    dpi = at.p / float(values["NOMPRES"]) - 1.0
    measured = at.radius(channel)
    free_radius = float(values["UNLOADED_RADIUS"])

    def radius_of(free: Mapping[str, Any]) -> Any:
        every = {**values, **free}
        with np.errstate(all="ignore"):
            found = radius(every, at, channel)
        return found + free_radius * every[GROWTH] * (dpi - np.mean(dpi))

    def fitted(u: float, start: Mapping[str, Any]) -> Solution:
        stiffness = float(start["VERTICAL_STIFFNESS"])
        relative = (stiffness * free_radius / float(values["FNOMIN"])) ** 2
        bounds = {
            **BOUNDS,
            "VERTICAL_STIFFNESS": (0.2 * stiffness, 5.0 * stiffness),
            "Q_FZ2": (-relative, 0.2 * relative),
        }
        numbers = [_number(name, float(values[name]), float(start[name]), bounds[name]) for name in names]
        return solve(of_model(radius_of, names, measured, u), numbers, tolerance=1e-9)

    parts = [np.flatnonzero(at.part == k) for k in np.unique(at.part)]
    end = fitted(u := float(constants.USUAL_MISFIT_OF_RADIUS), values)
    covariance = end.covariance
    if len(parts) > len(names):
        # Refit until the uncertainty, which sets the weight of the priors, is the misfit.
        for _ in range(constants.REFIT_STEPS):
            wider = _alike(end, parts)
            end = fitted(u := u * wider, {**values, **end.values})
            if abs(wider - 1.0) < constants.STAGE_TOLERANCE:
                break
        covariance = _of_units(end, parts)
    values = {**values, **end.values}
    x = np.array([float(values[name]) for name in before])
    slope = of_model(radius_of, before, measured, u).linear(x).slope
    stderr = dict(zip(end.names, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    return _OfRadius(
        values=dict(end.values),
        covariance=covariance,
        moved=-end.covariance @ end.jacobian.T @ slope,
        rms=u * rms(end.data),
        regularised=frozenset(n.name for n in end.objective.numbers if stderr[n.name] > MOST * n.spread),
    )


def _number(name: str, known: float, start: float, bounds: tuple[float, float]) -> FreeNumber:
    if name in EVEN:
        known, start = abs(known), max(abs(start), USUAL)
    return FreeNumber(name, start, *bounds, expected=known, spread=SPREADS.get(name, math.inf))


def _of_units(end: Solution, parts: Sequence[np.ndarray]) -> np.ndarray:
    """Covariance (k, k) from the jackknife over parts of sweeps, plus that from the priors.

    The jackknife includes any correlation of errors within a part. A factor from Student's t makes 1.96 standard errors hold 95 %
    even with few parts.
    """
    free = np.array([name not in end.at_bound for name in end.names])
    n, slopes, prior = len(parts), end.jacobian[:, free], end.prior[free]
    wider = float(stdtrit(max(n - _determined(end), 1.0), 0.975)) / COVERAGE_FACTOR_95
    if len(end.data) == n:
        return inverse(end.jacobian.T @ end.jacobian / wider**2 + np.diag(end.prior))
    information = slopes.T @ slopes + np.diag(prior)
    gradient = slopes.T @ end.data + prior * (end.x - end.objective.expected)[free]
    moves = np.array([moved_without(slopes[k], end.data[k], information, gradient) for k in parts])
    of_priors = inverse(information) * np.sqrt(prior)
    covariance = np.diag(np.diag(end.covariance))
    covariance[np.ix_(free, free)] = wider**2 * (n - 1) / n * moves.T @ moves + of_priors @ of_priors.T
    return covariance


def _determined(end: Solution) -> float:
    """Number of free numbers that the readings determine; one that mostly its prior holds counts little."""
    free = np.array([name not in end.at_bound for name in end.names])
    return float(np.sum((1.0 - end.prior * np.diag(end.covariance))[free]))


def _alike(end: Solution, parts: Sequence[np.ndarray]) -> float:
    """Factor on the uncertainty of every reading that accounts for misfit and for correlated errors within a part.

    The effective number of readings is their number over the variance inflation of the parts' sums, at least 1.
    """
    squares = float(end.data @ end.data)
    sums = sum(float(np.sum(end.data[rows])) ** 2 for rows in parts)
    together = max(sums / squares, 1.0) if squares else 1.0
    freedom = max(len(end.data) / together - _determined(end), 1.0)
    return max(math.sqrt(squares / freedom), ROUNDING)


def vertical_sentence(found: Vertical) -> str:
    """A sentence on the growth of the free radius with pressure, for which MF has no coefficient; empty if unknown."""
    if not found.growth:
        return ""
    return f"The free radius changes by {1e2 * found.growth:+.2f} % per nominal pressure, for which MF has no coefficient."
