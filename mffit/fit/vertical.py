"""Vertical stiffness and effective rolling radius, from the measured loaded radius and wheel speed of a freely rolling wheel."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from mffit.fit import constants
from mffit.fit.agreement import Agreement, agreement
from mffit.least_squares import FreeNumber, of_model, solve
from mffit.points import Points, levels
from mffit.rounding import ascii_only, to_uncertainty
from mffit.suspicion import parts_of_sweeps
from tir import Quantity
from tir.equations import vertical
from tir.outputs import outputs_of
from tir.parameters import BY_NAME

GROWTH = "growth"
"""Growth of the free radius with pressure, relative to dpi: MF has no term for it, and PFZ1 would take it up."""
LEAN = "lean"
"""Change of a radius with the square of camber, relative to the free one: it depends on the contour, and is not written."""
BOUNDS = {
    "Q_RE0": (0.9, 1.1),
    "PFZ1": (-0.5, 2.0),
    "DREFF": (-1.0, 2.0),
    "FREFF": (-1.0, 1.0),
    "BREFF": (0.2, 40.0),
    GROWTH: (-0.3, 0.3),
    LEAN: (-10.0, 10.0),
    "Q_V1": (-0.01, 0.02),
    "Q_V2": (-0.3, 0.5),
}
OVER_SPEED = {"Q_V1": constants.RADIUS_GROWTH_OVER_SPEED, "Q_V2": constants.STIFFENING_OVER_SPEED}
"""Coefficients of the radii that several speeds show, and the standard deviation of each among tyres."""


OF_RADII = ("VERTICAL_STIFFNESS", "Q_FZ2", *(name for name in BOUNDS if name not in (GROWTH, LEAN)))
"""Every coefficient that radii may determine."""


@dataclass(frozen=True, slots=True)
class Vertical:
    """What loaded radius and wheel speed determine."""

    found: Mapping[str, Quantity] = field(default_factory=dict)
    growth: float = 0.0  #: of the free radius, relative to dpi
    rms: Mapping[str, float] = field(default_factory=dict)
    """By channel, RL and omega, rms misfit of the radius [m]."""
    covariance: Mapping[str, tuple[tuple[str, ...], np.ndarray]] = field(default_factory=dict)
    """By channel, the fitted numbers (k,) with their covariance (k, k)."""
    rolling: RollingParts | None = None  #: the means that were fitted; None without any

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

    The stiffness comes first, from the loaded radius: DREFF, BREFF and FREFF appear only over it. Coefficients ``held``, by hand
    or because they were measured, stay, and so does what too few loads, pressures or speeds show. What speed does and a single
    speed does not show is part of the uncertainties.
    """
    rolling = _rolling(points)
    if rolling is None:
        return Vertical()
    best = _best(values, rolling, held)
    covariance = dict(best.covariance)
    for name, spread in OVER_SPEED.items():
        if name in best.found or name in held:
            continue
        known = float(values[name])
        change = float(constants.SIMILAR_TYRES_SPREAD) * abs(known) or float(spread)
        other = _best({**values, name: known + change}, rolling, {*held, *OVER_SPEED})
        for channel, (names, matrix) in covariance.items():
            moved = [other.found[n].value - best.found[n].value if n in best.found else 0.0 for n in names]
            covariance[channel] = names, matrix + np.outer(moved, moved)
    u = {name: u for of in covariance.values() for name, u in _standard(of).items()}
    return replace(
        best, found={name: q._replace(u=u[name]) for name, q in best.found.items()}, covariance=covariance
    )


def _best(values: Mapping[str, Any], rolling: RollingParts, held: Collection[str]) -> Vertical:
    """The coefficients that fit the readings; coefficients over speed that are not found are exact here."""
    nominal = float(values["NOMPRES"])
    loads = levels.count(rolling.Fz, levels.LOAD)
    pressures = levels.count(rolling.p, levels.PRESSURE)
    speeds = levels.count(rolling.V, levels.SPEED)
    dpi = rolling.p / nominal - 1.0
    known: dict[str, Any] = {**values, GROWTH: 0.0, LEAN: 0.0}
    found: dict[str, Quantity] = {}
    rms: dict[str, float] = {}
    covariance: dict[str, tuple[tuple[str, ...], np.ndarray]] = {}
    beside = [GROWTH] if pressures > 1 else []
    lean = [LEAN] if levels.count(np.abs(rolling.gamma), levels.CAMBER) > 1 else []
    if np.any(np.isfinite(rolling.loaded)) and loads > 1:
        names = ["VERTICAL_STIFFNESS", "Q_RE0"] + (["Q_FZ2"] if loads > 2 else [])
        names += (["PFZ1"] if pressures > 1 else []) + (list(OVER_SPEED) if speeds > 1 else [])
        names = [name for name in names if name not in held]
        known |= {name: 0.0 for name in ("Q_FZ2", "PFZ1") if name in names}
        known["VERTICAL_STIFFNESS"] = _stiffness(rolling)
        here, covariance["RL"], rms["RL"] = _fitted([*names, *beside, *lean], known, rolling, "RL", dpi)
        u = _standard(covariance["RL"])
        known |= {**here, LEAN: 0.0}
        found |= {name: Quantity(here[name], u[name], BY_NAME[name].unit) for name in names}
        beside = []
    if np.any(np.isfinite(rolling.effective)) and loads > 1:
        names = [] if found else ["Q_RE0", *(["Q_V1"] if speeds > 1 else [])]
        names += ["DREFF", "FREFF", "BREFF"][: loads - 1]
        names = [name for name in names if name not in held]
        here, covariance["omega"], rms["omega"] = _fitted(
            [*names, *beside, *lean], known, rolling, "omega", dpi
        )
        u = _standard(covariance["omega"])
        known |= here
        found |= {name: Quantity(here[name], u[name], BY_NAME[name].unit) for name in names}
    return Vertical(found, known[GROWTH], rms, covariance, rolling)


def _standard(covariance: tuple[tuple[str, ...], np.ndarray]) -> dict[str, float]:
    """Standard uncertainty by name."""
    names, matrix = covariance
    return dict(zip(names, np.sqrt(np.diag(matrix)).tolist(), strict=True))


def _rolling(points: Points) -> RollingParts | None:
    """The parts of sweeps at which the wheel rolls freely straight on; None without radius or wheel speed."""
    used = points.free_rolling & (points.direction > 0) & (points.phi_t == 0.0)
    used &= np.abs(points.alpha) < constants.COUPLED_ALPHA.rad
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


def _fitted(
    names: Sequence[str],
    values: Mapping[str, Any],
    rolling: RollingParts,
    channel: str,
    dpi: np.ndarray,
) -> tuple[dict[str, float], tuple[tuple[str, ...], np.ndarray], float]:
    """Best values, names and covariance from the misfit, and its rms [m]."""
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
    numbers = [FreeNumber(name, float(values.get(name, 0.0)), *bounds[name]) for name in names]

    def radius_of(free: Mapping[str, Any]) -> Any:
        every = {**values, **free}
        with np.errstate(invalid="ignore"):
            found = radius(every, rolling, channel)
        return found + free_radius * (every[GROWTH] * dpi + every[LEAN] * rolling.gamma**2)

    end = solve(of_model(radius_of, names, measured, unit), numbers, tolerance=1e-9)
    freedom = max(len(measured) - len(names), 1)
    scale = float(end.data @ end.data) / freedom
    covariance = end.covariance * scale if names else np.zeros((0, 0))
    return dict(end.values), (tuple(names), covariance), unit * math.sqrt(float(np.mean(end.data**2)))


def vertical_sentence(found: Vertical) -> str:
    """What was fitted to loaded radius and wheel speed, with the misfit; empty if nothing was."""
    if not found.found:
        return ""
    sources = {"RL": "loaded radius", "omega": "wheel speed"}
    misfit = " and ".join(f"{1e3 * rms:.1f} mm ({sources[name]})" for name, rms in found.rms.items())
    numbers = ", ".join(f"{name} {to_uncertainty(q.value, q.u)}" for name, q in found.found.items())
    grown = (
        f" The free radius changes by {1e2 * found.growth:+.2f} % per nominal pressure, for which MF has no coefficient."
        if found.growth
        else ""
    )
    return ascii_only(f"Fitted to radii of the freely rolling wheel, rms {misfit}: {numbers}.{grown}")
