"""Weights of the points: from their stated uncertainty and the misfit of the model.

Residuals beyond the Huber threshold get a reduced weight, because a model may miss a stretch of a sweep by more than the noise.
"""

import numpy as np

from mffit.fit import constants
from mffit.scatter import robust


def stated_or_nominal(u: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Standard uncertainty (n,) of each point: as stated, else a share of the channel's range; inf without a reading."""
    measured = np.isfinite(values)
    nominal = constants.NOMINAL_NOISE_SHARE * np.ptp(values[measured]) if np.any(measured) else 1.0
    u = np.where(np.isfinite(u) & (u > 0), u, max(nominal, 1e-9))
    return np.where(measured, u, np.inf)


def robust_scale(residual: np.ndarray) -> float:
    """Standard deviation of the core of the residuals, from the median absolute value; zeros are ignored."""
    residual = residual[residual != 0.0]
    return robust(residual) if len(residual) else 1.0


def huber(residual: np.ndarray, scale: float) -> np.ndarray:
    """Factor (n,) >= 1 that enlarges the uncertainty of points beyond the Huber threshold."""
    size = np.abs(residual) / (constants.HUBER_THRESHOLD * scale)
    return np.asarray(np.sqrt(np.maximum(size, 1.0)))


def enlarged(residual: np.ndarray) -> np.ndarray:
    """Factor (n,) on the uncertainty of each point; residuals are in units of the uncertainty, 0 where a point is not used."""
    scale = max(robust_scale(residual), 1.0)
    return scale * huber(residual, scale)
