"""Stiffnesses at zero from odd curves: a saturating shape, cross-checked by a local cubic; and the secant."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mffit.measured import constants
from mffit.parts.constants import SAME_CAMBER


class SlopeAtZero(NamedTuple):
    """Slope of an odd curve at zero, in the unit of y per radian."""

    value: float
    u_noise: float  #: standard uncertainty from the scatter of the points
    u_shape: float  #: half the difference of two shapes, beyond noise; common to curves of one tyre
    dof: float  #: degrees of freedom of ``u_noise``


class Secant(NamedTuple):
    """Secant of an odd curve at one angle, the paper's (20)."""

    value: float
    u: float


def polynomial(
    x: np.ndarray, y: np.ndarray, u: np.ndarray, powers: Sequence[int]
) -> tuple[np.ndarray, np.ndarray]:
    """Coefficients (k,) of these powers through readings (n,), and their standard uncertainties."""
    A = x[:, None] ** np.array(powers) / u[:, None]
    errors = np.linalg.inv(A.T @ A)
    return errors @ A.T @ (y / u), np.sqrt(np.diag(errors))


def slope_at_zero(
    x: np.ndarray, y: np.ndarray, u: np.ndarray, *, local: float, curvature: float = 0.0
) -> SlopeAtZero | None:
    """Slope at zero of an odd curve.

    Parameters
    ----------
    x : (n,) angles > 0 [rad]
    y : (n,) odd part there
    u : (n,) standard uncertainties of y
    local : up to where a cubic may describe the curve [rad]
    curvature : prior standard deviation of the curvature E of the shape; 0 holds it at 0

    Returns
    -------
    Slope, or None if there are fewer than three angles.
    """
    if len(np.unique(np.round(x, 4))) < 3:
        return None
    shape, u_noise, scatter = _saturating(x, y, u, curvature)
    if not curvature:
        # A misfit of the shape at large angles is no scatter.
        scatter = min(scatter, _saturating(x, y, u, float(constants.CURVATURE_SPREAD))[2])
    scatter = max(1.0, scatter)
    u_noise *= scatter
    near = x <= local * 1.01
    difference = constants.SLOPE_WITHOUT_CUBIC * abs(shape)
    if len(np.unique(np.round(x[near], 4))) >= 3:
        cubic, u_cubic = polynomial(x[near], y[near], u[near], (1, 3))
        difference = math.sqrt(max((shape - cubic[0]) ** 2 - u_cubic[0] ** 2, 0.0))
    return SlopeAtZero(shape, u_noise, float(difference / 2.0), max(1.0, len(x) - 3.0))


def secant_at(x: np.ndarray, y: np.ndarray, u: np.ndarray, angle: float) -> Secant | None:
    """Secant y/x at the angle [rad], interpolated between the neighbours; None beyond the sweep."""
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


def _saturating(x: np.ndarray, y: np.ndarray, u: np.ndarray, curvature: float) -> tuple[float, float, float]:
    """Fit D sin(C atan(b - E (b - atan b))), b = x s / (C D): an odd curve of slope s at zero that saturates at D.

    Slope, its standard error from ``u``, and the scatter of the points over ``u``.
    """
    import lmfit  # loads matplotlib, so only when a slope is wanted

    first = np.argsort(x)[:3]
    start = float(np.sum(x[first] * y[first]) / np.sum(x[first] ** 2))
    top = max(float(np.max(np.abs(y))), 1e-9) * np.sign(start or 1.0)

    shape = lmfit.Parameters()
    shape.add("slope", 1.05, min=0.2, max=5.0)  # over its first estimate
    shape.add("ceiling", 1.2, min=0.7, max=20.0)  # over the largest value
    shape.add("C", 1.2, min=0.3, max=1.9)
    if curvature:
        shape.add("E", 0.0, min=-6.0, max=1.0)

    def residual(shape: lmfit.Parameters) -> np.ndarray:
        s, D, C = shape["slope"] * start, shape["ceiling"] * top, shape["C"].value
        b = s * x / (C * D)
        bent = shape["E"].value * (b - np.arctan(b)) if curvature else 0.0
        priors = [(C - 1.2) / 0.5, *([shape["E"].value / curvature] if curvature else [])]
        return np.append((D * np.sin(C * np.arctan(b - bent)) - y) / u, priors)

    scales = [0.1, 0.3, 0.2, *([0.5] if curvature else [])]
    out = lmfit.minimize(residual, shape, method="least_squares", scale_covar=False, x_scale=scales)
    found = out.params["slope"]
    scatter = float(np.sqrt(out.chisqr / max(len(x) - 3, 1)))
    error = found.stderr if found.stderr is not None else abs(found.value)
    return float(found.value * start), float(error * abs(start)), scatter
