"""How much each point counts: the measurement uncertainty, the misfit of the model itself, outliers."""

from __future__ import annotations

import numpy as np

OUTLIER = 4.0
"""Residuals beyond this many robust standard deviations lose weight (Huber)."""


def stated_or_nominal(u: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Uncertainty (n,) per point: as stated, else 1 % of the channel's spread; inf where the channel is missing."""
    measured = np.isfinite(values)
    nominal = 0.01 * np.ptp(values[measured]) if np.any(measured) else 1.0
    u = np.where(np.isfinite(u) & (u > 0), u, max(nominal, 1e-9))
    return np.where(measured, u, np.inf)


def robust_scale(residual: np.ndarray) -> float:
    """Standard deviation of the residuals' core, from the median absolute value."""
    residual = residual[residual != 0.0]
    return float(1.4826 * np.median(np.abs(residual))) if len(residual) else 1.0


def huber(residual: np.ndarray, scale: float) -> np.ndarray:
    """Factor (n,) >= 1 by which the uncertainty of outlying points is enlarged."""
    size = np.abs(residual) / (OUTLIER * scale)
    return np.sqrt(np.maximum(size, 1.0))
