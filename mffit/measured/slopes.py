"""Stiffnesses at zero from odd curves: a saturating shape, cross-checked by a local cubic; the secant beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from mffit.least_squares import FreeNumber, LeastSquaresProblem, Linear, solve
from mffit.measured import constants


@dataclass(frozen=True, slots=True)
class SlopeAtZero:
    """Slope of an odd curve at zero, in the unit of y per radian."""

    value: float
    u: float  #: standard uncertainty: noise, and the difference of the two shapes
    u_noise: float
    cubic: float  #: the cross-check; NaN if too few points
    points: int


@dataclass(frozen=True, slots=True)
class Secant:
    """Secant of an odd curve at one angle, the paper's (20)."""

    value: float
    u: float
    angle: float  #: of the point used [rad]


def slope_at_zero(x: np.ndarray, y: np.ndarray, u: np.ndarray, *, local: float) -> SlopeAtZero | None:
    """Slope at zero of an odd curve.

    Parameters
    ----------
    x : (n,) angles > 0 [rad]
    y : (n,) odd part there
    u : (n,) standard uncertainties of y
    local : up to where a cubic may describe the curve [rad]

    Returns
    -------
    Slope, or None if there are fewer than three angles.
    """
    if len(np.unique(np.round(x, 4))) < 3:
        return None
    shape, u_shape = _saturating(x, y, u)
    near = x <= local * 1.01
    cubic = np.nan
    if len(np.unique(np.round(x[near], 4))) >= 3:
        cubic, _ = _cubic(x[near], y[near], u[near])
    difference = abs(shape - cubic) if np.isfinite(cubic) else constants.SLOPE_WITHOUT_CUBIC * abs(shape)
    return SlopeAtZero(shape, float(np.hypot(u_shape, difference / 2.0)), u_shape, float(cubic), len(x))


def secant_at(x: np.ndarray, y: np.ndarray, u: np.ndarray, angle: float) -> Secant | None:
    """Secant y/x at the angle [rad], interpolated between the neighbours; None beyond the sweep."""
    order = np.argsort(x)
    x, y, u = x[order], y[order], u[order]
    if (
        not len(x)
        or angle > x[-1] * (1.0 + constants.SECANT_REACH)
        or angle < x[0] * (1.0 - constants.SECANT_REACH)
    ):
        return None
    nearest = int(np.argmin(np.abs(x - angle)))
    if abs(x[nearest] - angle) < constants.SECANT_REACH * angle:
        same = np.abs(x - x[nearest]) < 1e-3
        return Secant(
            float(np.mean(y[same] / x[same])),
            float(np.sqrt(np.sum(u[same] ** 2)) / same.sum() / x[nearest]),
            angle,
        )
    return Secant(float(np.interp(angle, x, y) / angle), float(np.interp(angle, x, u) / angle), angle)


def _saturating(x: np.ndarray, y: np.ndarray, u: np.ndarray) -> tuple[float, float]:
    """Slope at zero and its standard uncertainty by a fit of D sin(C atan(x s / (C D))), which saturates at D."""
    first = np.argsort(x)[:3]
    start = float(np.sum(x[first] * y[first]) / np.sum(x[first] ** 2))
    top = max(float(np.max(np.abs(y))), 1e-9) * np.sign(start or 1.0)
    none = np.zeros(0)

    def residual(numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return (_shape(x, numbers * (start, top, 1.0))[0] - y) / u, none

    def linear(numbers: np.ndarray) -> Linear:
        curve, derivatives = _shape(x, numbers * (start, top, 1.0))
        return Linear((curve - y) / u, derivatives * (start, top, 1.0) / u[:, None], none, np.zeros((0, 3)))

    numbers = (
        FreeNumber("slope", 1.05, 0.2, 5.0),  # over its first estimate
        FreeNumber("ceiling", 1.2, 0.7, 20.0),  # over the largest value
        FreeNumber("C", 1.2, 0.3, 1.9, expected=1.2, spread=0.5),
    )
    found = solve(LeastSquaresProblem(residual, linear), numbers, max_steps=200, tolerance=1e-12)
    inflation = max(1.0, float(np.sqrt(found.cost / max(len(x) - 3, 1))))
    error = float(np.sqrt(found.covariance[0, 0]))
    return found.values["slope"] * start, error * abs(start) * inflation


def _shape(x: np.ndarray, numbers: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The curve (n,) at s, D and C, and its derivatives by them (n, 3)."""
    s, D, C = numbers
    t = s * x / (C * D)
    angle, bend = C * np.arctan(t), 1.0 / (1.0 + t**2)
    sine, cosine = np.sin(angle), np.cos(angle)
    by_C = D * cosine * (np.arctan(t) - t * bend)
    return D * sine, np.column_stack([x * bend * cosine, sine - C * t * bend * cosine, by_C])


def _cubic(x, y, u) -> tuple[float, float]:
    A = np.column_stack([x, x**3]) / u[:, None]
    cov = np.linalg.inv(A.T @ A)
    a = cov @ (A.T @ (y / u))
    return float(a[0]), float(np.sqrt(cov[0, 0]))
