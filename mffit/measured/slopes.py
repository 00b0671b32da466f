"""Stiffnesses at zero from odd curves: a saturating shape, cross-checked by a local cubic; the secant beside them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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


def _saturating(x, y, u) -> tuple[float, float]:
    """Fit D sin(C atan(x s / (C D))): an odd curve of slope s at zero that saturates at D."""
    import lmfit  # loads matplotlib, so only when a slope is wanted

    first = np.argsort(x)[:3]
    start = float(np.sum(x[first] * y[first]) / np.sum(x[first] ** 2))
    top = max(float(np.max(np.abs(y))), 1e-9) * np.sign(start or 1.0)

    shape = lmfit.Parameters()
    shape.add("slope", 1.05, min=0.2, max=5.0)  # over its first estimate
    shape.add("ceiling", 1.2, min=0.7, max=20.0)  # over the largest value
    shape.add("C", 1.2, min=0.3, max=1.9)

    def residual(shape):
        s, D, C = shape["slope"] * start, shape["ceiling"] * top, shape["C"].value
        curve = D * np.sin(C * np.arctan(s * x / (C * D)))
        return np.append((curve - y) / u, (C - 1.2) / 0.5)

    out = lmfit.minimize(residual, shape, method="least_squares", scale_covar=False, x_scale=[0.1, 0.3, 0.2])
    found = out.params["slope"]
    inflation = max(1.0, float(np.sqrt(out.chisqr / max(len(x) - 3, 1))))
    error = found.stderr if found.stderr is not None else abs(found.value)
    return float(found.value * start), float(error * abs(start) * inflation)


def _cubic(x, y, u) -> tuple[float, float]:
    A = np.column_stack([x, x**3]) / u[:, None]
    cov = np.linalg.inv(A.T @ A)
    a = cov @ (A.T @ (y / u))
    return float(a[0]), float(np.sqrt(cov[0, 0]))
