"""Cornering and camber stiffness at one load, from its sweeps in both directions.

The slope at zero comes from a fitted saturating curve and is cross-checked by a local polynomial; the secant is that of the
published procedure.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import CAMBER_OF_SLOPES, STRAIGHT, UPRIGHT, USUAL_U_FORCE
from mffit.least_squares import FreeNumber, of_model, solve
from mffit.measured import constants, wording
from mffit.measured.axis import slope_at, usual_stiffness
from mffit.measured.evidence import DirectEvidence, rest_of_play
from mffit.measured.uncertain import named, polynomial
from mffit.measured.zeros import LoadGroup, force_at_zero, u_of
from mffit.parts.constants import SAME_CAMBER
from mffit.points import Points, levels, main_path


class SlopeAtZero(NamedTuple):
    """Slope of an odd curve at zero, in the unit of y per radian."""

    value: float
    u_noise: float  #: standard uncertainty from the scatter of the points
    u_shape: float  #: from the difference of the two fitted shapes beyond noise; common to curves of one tyre
    dof: float  #: degrees of freedom of ``u_noise``


class Secant(NamedTuple):
    """Secant of an odd curve at one angle, (20)."""

    value: float
    u: float


class OddCurve(NamedTuple):
    """Odd part of a force or moment over an angle."""

    x: np.ndarray  #: (n,) angles > 0 [rad]
    y: np.ndarray  #: (n,) odd part there
    u: np.ndarray  #: (n,) its standard uncertainty

    def slope(self, *, local: float, curvature: float = 0.0, sideslip: bool = False) -> SlopeAtZero | None:
        """Slope at zero; None if there are fewer than three set-points.

        A second shape describes the curve up to the angle ``local`` [rad]: a cubic, or over ``sideslip`` a parabola of |x|, since
        a contact patch slides from its rear end on. ``curvature`` is the prior standard deviation of the first shape's curvature
        E; 0 holds it at 0.
        """
        x, y, u = self
        if _set_points(x) < 3:
            return None
        shape, u_noise, scatter = self._saturating(curvature)
        if not curvature:
            # Misfit of the stiff shape at large angles must not count as scatter.
            scatter = min(scatter, self._saturating(float(constants.CURVATURE_SPREAD))[2])
        near = x <= local * 1.01
        difference = constants.SLOPE_WITHOUT_CUBIC * abs(shape)
        if _set_points(x[near]) >= 3:
            other, u_other = polynomial(x[near], y[near], u[near], (1, 2) if sideslip else (1, 3))
            difference = math.sqrt(max((shape - other[0]) ** 2 - u_other[0] ** 2, 0.0))
        u_noise *= max(1.0, scatter)
        # JCGM 100, F.2.4.5: smooth shapes err one way over sideslip; anywhere between is as likely, and that is not corrected.
        u_shape = difference / (math.sqrt(3.0) if sideslip else 2.0)
        return SlopeAtZero(shape, u_noise, float(u_shape), max(1.0, len(x) - 3.0))

    def secant(self, angle: float) -> Secant | None:
        """Secant y/x at an angle [rad], interpolated between neighbours; None outside the sweep."""
        x, y, u = self
        reach = SAME_CAMBER.rad
        if not len(x) or not x.min() - reach < angle < x.max() + reach:
            return None
        nearest = x[np.argmin(np.abs(x - angle))]
        if abs(nearest - angle) < reach:
            same = np.abs(x - nearest) < 1e-3
            u_mean = float(np.linalg.norm(u[same])) / same.sum()
            return Secant(float(np.mean(y[same] / x[same])), float(u_mean / nearest))
        order = np.argsort(x)
        value, u_value = (float(np.interp(angle, x[order], one[order]) / angle) for one in (y, u))
        return Secant(value, u_value)

    def _saturating(self, curvature: float) -> tuple[float, float, float]:
        return _saturating(*(np.asarray(one, dtype=float).tobytes() for one in self), curvature)


def _set_points(angle: np.ndarray) -> int:
    """Number of set-points among angles (n,) [rad]: a held angle that wanders is one."""
    return len(np.unique(levels.nearest_labels(angle, levels.LevelKind("set-point", SAME_CAMBER.rad))))


@lru_cache(maxsize=256)
def _saturating(x: bytes, y: bytes, u: bytes, curvature: float) -> tuple[float, float, float]:
    """Slope at zero, its standard error from ``u``, and the scatter of the points over ``u``, from a saturating curve.

    The curve is D sin(C atan(b - E (b - atan b))) with b = x s / (C D): odd, with slope s at zero and ceiling D. A curve is given
    as the bytes of its numbers: the published procedure and the measurement behind the fit ask for most curves again.
    """
    angle, force, error = (np.frombuffer(one) for one in (x, y, u))
    first = np.argsort(angle)[:3]
    start = float(np.sum(angle[first] * force[first]) / np.sum(angle[first] ** 2))
    top = max(float(np.max(np.abs(force))), 1e-9)
    expected, spread = constants.SHAPE_OF_A_CURVE
    numbers = [
        FreeNumber("slope", 1.05, 0.2, 5.0),  # relative to its first estimate
        FreeNumber("ceiling", 1.2, 0.7, 20.0),  # relative to the largest value
        FreeNumber("C", expected, 0.3, 1.9, expected=expected, spread=spread),
    ]
    if curvature:
        numbers.append(FreeNumber("E", 0.0, -6.0, 1.0, expected=0.0, spread=curvature))

    def curve(at: Mapping[str, Any]) -> Any:
        D, C = at["ceiling"] * top, at["C"]
        b = at["slope"] * start * angle / (C * D)
        bent = at["E"] * (b - np.arctan(b)) if curvature else 0.0
        return D * np.sin(C * np.arctan(b - bent))

    found = solve(of_model(curve, [number.name for number in numbers], force, error), numbers, tolerance=1e-9)
    scatter = math.sqrt(found.cost / max(len(angle) - 3, 1))
    u_slope = math.sqrt(found.covariance[0, 0])
    return found.values["slope"] * start, u_slope * abs(start), scatter


CAMBER, BACKWARD_CAMBER = "camber stiffness", "camber stiffness backwards"


class Estimates(NamedTuple):
    """The two estimates of a stiffness at one load, and the largest angle of its sweep [rad]."""

    slope: SlopeAtZero | None
    secant: Secant | None
    largest: float


@dataclass(frozen=True, slots=True)
class LoadSlopes:
    """The stiffnesses at one load, not yet corrected for rig errors."""

    C_alpha: UFloat | None  #: cornering stiffness at zero reading [N/rad]
    bend: UFloat | None  #: change of the slope with sideslip at zero reading [N/rad^2]
    C_gamma: UFloat | None  #: camber stiffness of the forward sweep by the configured method [N/rad]
    C_gamma_backward: UFloat | None  #: camber stiffness of a backward sweep [N/rad]
    slope: UFloat | None  #: slope at zero of the forward camber sweep [N/rad]
    secant: UFloat | None  #: secant of the forward camber sweep [N/rad]

    def of_camber(self, better: Callable[[UFloat], UFloat]) -> LoadSlopes:
        """The record with ``better`` applied to all camber stiffnesses of the forward sweep."""
        C_gamma, slope, secant = (
            None if C is None else better(C) for C in (self.C_gamma, self.slope, self.secant)
        )
        return replace(self, C_gamma=C_gamma, slope=slope, secant=secant)

    def calibrated(self, of_sideslip: UFloat, of_camber: UFloat) -> LoadSlopes:
        """The record with cornering and camber stiffness multiplied by their calibration factors."""
        own = self.of_camber(lambda C_gamma: C_gamma * of_camber)
        return own if self.C_alpha is None else replace(own, C_alpha=self.C_alpha * of_sideslip)

    @property
    def exists(self) -> bool:
        """Whether anything could be estimated."""
        return not (self.C_alpha is None and self.slope is None and self.secant is None)


def load_slopes(evidence: DirectEvidence, group: LoadGroup) -> tuple[LoadSlopes, list[str]]:
    """The stiffnesses at one load, and warnings; from odd parts on a disc, from the readings themselves on a straight path."""
    C_alpha = cornering_stiffness(evidence, group)
    assumed = assumed_stiffness(evidence, group, C_alpha)
    camber, backward = (camber_estimates(evidence, group, assumed, direction) for direction in (1, -1))
    chosen, trouble = _chosen(evidence.config, camber, group.load)
    chosen_backward, _ = _chosen(evidence.config, backward, group.load)
    if evidence.rig is None:
        chosen_backward = None
    # Both directions have the same shape of curve, so its error cancels in their difference.
    curved = [x for x in (camber.slope, chosen, chosen_backward) if isinstance(x, SlopeAtZero)]
    shape = _shape_error(curved, CAMBER)
    slope, secant = _number(camber.slope, CAMBER, shape), _number(camber.secant, CAMBER)
    guessed = False
    if C_alpha is None and assumed is not None:
        without, share = camber_estimates(evidence, group, None, 1), assumed / assumed.nominal_value - 1.0
        slope = _with_play(slope, camber.slope, without.slope, share)
        secant = _with_play(secant, camber.secant, without.secant, share)
        guessed = slope is not None and evidence.rig is not None
    found = LoadSlopes(
        C_alpha=C_alpha,
        bend=_bend(evidence, group),
        C_gamma=slope if chosen is camber.slope else secant,
        C_gamma_backward=_number(chosen_backward, BACKWARD_CAMBER, shape),
        slope=slope,
        secant=secant,
    )
    troubles = [trouble, wording.GUESSED_STIFFNESS.format(load=group.load) if guessed else None]
    return found, [one for one in troubles if one]


def cornering_stiffness(evidence: DirectEvidence, group: LoadGroup) -> UFloat | None:
    """Slope of the side force over sideslip at zero [N/rad]; the secant if there are too few angles; None without either."""
    config, local = evidence.config, constants.CUBIC_SIDESLIP.rad
    curve = _curve(evidence, group, "alpha")
    slope = curve.slope(local=local, curvature=float(constants.CURVATURE_SPREAD), sideslip=True)
    C_alpha = _number(slope or curve.secant(local), "cornering stiffness")
    if C_alpha is None or not config.rig.backlash_deg:
        return C_alpha
    return C_alpha * (1.0 + rest_of_play(config) / local)


def assumed_stiffness(evidence: DirectEvidence, group: LoadGroup, C_alpha: UFloat | None) -> UFloat | None:
    """The cornering stiffness, or else the usual one [N/rad]; None in the published procedure, which does without."""
    return C_alpha if C_alpha is not None or evidence.published else usual_stiffness(group.load)


def _with_play(
    number: UFloat | None,
    corrected: SlopeAtZero | Secant | None,
    without: SlopeAtZero | Secant | None,
    share: UFloat,
) -> UFloat | None:
    """The number with the relative uncertainty of the stiffness, ``share``, by which it was corrected for play."""
    if number is None or corrected is None or without is None:
        return number
    return number + (corrected.value - without.value) * share


def _bend(evidence: DirectEvidence, group: LoadGroup) -> UFloat | None:
    """Second derivative of the side force over sideslip at zero, upright and forwards; None with too few angles."""
    points, reach = evidence.points, constants.CUBIC_SIDESLIP.rad
    i = on_usual_radius(points, group, evidence.config)
    i = i[
        (points.direction[i] == 1)
        & (np.abs(points.gamma[i]) < UPRIGHT.rad)
        & (np.abs(points.alpha[i]) <= 1.1 * reach)
        & np.isfinite(points.Fy[i])
        & (points.phi_t[i] == main_path(points))
    ]
    x = points.alpha[i]
    if len(np.unique(np.round(x, 3))) < constants.POINTS_FOR_PARABOLA or not x.min() < 0.0 < x.max():
        return None
    found, errors = polynomial(x / reach, points.Fy[i], u_of(points, "Fy")[i], range(4))
    scale = 2.0 / reach**2
    return named(scale * found[2], scale * errors[2], "bend of the sideslip curve", "N/rad^2", kind="A")


def camber_estimates(
    evidence: DirectEvidence, group: LoadGroup, C_alpha: UFloat | None, direction: int
) -> Estimates:
    """Slope and secant of the camber sweep in one direction, less the force of the sideslip that backlash causes in it."""
    slope = 0.0 if C_alpha is None else float(C_alpha.nominal_value)
    curve = _curve(evidence, group, "gamma", direction, direction * slope)
    secant = curve.secant(math.radians(evidence.config.camber_stiffness.angle_deg))
    return Estimates(curve.slope(local=CAMBER_OF_SLOPES.rad), secant, float(curve.x.max(initial=0.0)))


def _curve(
    evidence: DirectEvidence, group: LoadGroup, angle: str, direction: int = 1, slope: float = 0.0
) -> OddCurve:
    """The odd side force over sideslip ("alpha") or camber ("gamma"), less ``slope`` [N/rad] times the sideslip.

    On a straight path both branches are read, less the force at zero: ply-steer and conicity push alike on both.
    """
    points, slip, config = evidence.points, evidence.odd_slip, evidence.config
    odd, x = evidence.odd_Fy - slope * slip, slip if angle == "alpha" else points.gamma
    rows, u = sweep(points, odd, group, angle, config, direction), evidence.parts.u_Fy_odd
    u = np.where(np.isfinite(u), u, USUAL_U_FORCE / math.sqrt(2.0))
    if evidence.rig is not None:
        return OddCurve(x[rows], odd[rows], u[rows])
    mirrored = points.replace(alpha=-points.alpha, gamma=-points.gamma)
    rows = np.concatenate([rows, sweep(mirrored, odd, group, angle, config, direction)])
    zero = force_at_zero(points, group, direction, direction * slope or slope_at(None, group.load))
    if zero is None:
        rows, zero = rows[:0], named(0.0, 0.0, "no zero", "N")
    shared = math.sqrt(len(rows)) * zero.std_dev  # an error of the zero is no smaller with more rows
    y = np.sign(x[rows]) * (odd[rows] - zero.nominal_value)
    return OddCurve(np.abs(x[rows]), y, np.hypot(u[rows], shared))


def _chosen(config: Config, found: Estimates, load: float) -> tuple[SlopeAtZero | Secant | None, str | None]:
    """C_gamma by the configured method, or by the other one with a warning if the sweep is too short."""
    wanted, angle = config.camber_stiffness.method, config.camber_stiffness.angle_deg
    slope_possible = found.slope is not None and 2.0 * found.largest >= CAMBER_OF_SLOPES.rad
    if wanted == "slope" and not slope_possible and found.secant is not None:
        return found.secant, wording.SLOPE_NOT_POSSIBLE.format(load=load, angle=angle)
    if wanted == "secant" and found.secant is None and found.slope is not None:
        return found.slope, wording.SECANT_NOT_POSSIBLE.format(load=load, angle=angle)
    return (found.slope if wanted == "slope" else found.secant), None


def on_usual_radius(points: Points, group: LoadGroup, config: Config) -> np.ndarray:
    """Indices of the group's points at the usual radius, on either side of the disc; all if there are none."""
    if config.rig.radius is None:
        return group.index
    usual = np.isclose(np.abs(points.phi_t[group.index]), 1.0 / config.rig.radius, rtol=1e-6)
    return group.index[usual] if np.any(usual) else group.index


def sweep(
    points: Points, odd: np.ndarray, group: LoadGroup, angle: str, config: Config, direction: int = 1
) -> np.ndarray:
    """Indices of the group's points on the positive branch of a pure camber or sideslip sweep at the usual radius.

    ``direction`` is 1 for points rolled forwards, -1 backwards.
    """
    i = on_usual_radius(points, group, config)
    i = i[(points.direction[i] == direction) & np.isfinite(odd[i])]
    alpha, gamma = points.alpha[i], points.gamma[i]
    if angle == "gamma":
        return np.asarray(i[(np.abs(alpha) < STRAIGHT.rad) & (gamma > UPRIGHT.rad)])
    return np.asarray(i[(np.abs(gamma) < UPRIGHT.rad) & (alpha > STRAIGHT.rad)])


def _number(estimate: SlopeAtZero | Secant | None, source: str, shape: UFloat | None = None) -> UFloat | None:
    """An estimate as a number with uncertainty [N/rad] of this ``source`` in the budget.

    ``shape`` is the relative error of the slope due to the shape of the curve, if several slopes share it.
    """
    if estimate is None:
        return None
    if isinstance(estimate, Secant):
        return named(estimate.value, estimate.u, source, "N/rad", kind="A")
    noise = named(estimate.value, estimate.u_noise, source, "N/rad", kind="A", dof=estimate.dof)
    own = named(0.0, constants.SLOPE_SHAPE * abs(estimate.value), f"{source}, shape of the curve", "N/rad")
    return noise + own + abs(estimate.value) * (shape or _shape_error([estimate], source))


def _shape_error(estimates: Sequence[SlopeAtZero], source: str) -> UFloat:
    """Relative error of slopes at zero due to the shape of the curve, common to curves of one shape."""
    u = max((found.u_shape / abs(found.value) for found in estimates if found.value), default=0.0)
    return named(0.0, u, f"{source}, difference of shapes", "-")
