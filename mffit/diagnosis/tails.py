"""Heavy tails of the scatter: Student's t distribution of the residuals, and the weights of the readings that follow."""

from __future__ import annotations

import math

import numpy as np

from mffit.diagnosis import constants
from mffit.scatter import rms, robust


def heavy_tails(z: np.ndarray) -> tuple[float, float]:
    """Degrees of freedom and width of Student's t that standardised residuals (m,) follow; infinite if they are normal."""
    width = rms(z)
    best = -len(z) * (math.log(width) + 0.5 * math.log(2.0 * math.pi) + 0.5) + constants.SURPRISING_LOG_ODDS
    found = (math.inf, width)
    core = robust(z) or 1.0
    for dof in constants.TAIL_DEGREES_OF_FREEDOM:
        width = core
        for _ in range(30):  # expectation maximisation, converged after about ten
            width = math.sqrt(float(np.mean((dof + 1.0) * z**2 / (dof + (z / width) ** 2))))
        shape = math.lgamma(0.5 * (dof + 1.0)) - math.lgamma(0.5 * dof) - 0.5 * math.log(math.pi * dof)
        fall = float(np.sum(np.log1p((z / width) ** 2 / dof)))
        value = len(z) * (shape - math.log(width)) - 0.5 * (dof + 1.0) * fall
        if value > best:
            best, found = value, (dof, width)
    return found


def weights(z: np.ndarray, tails: float, width: float) -> np.ndarray:
    """Weight (m,) of every reading with standardised residual ``z``."""
    return np.ones(len(z)) if math.isinf(tails) else (tails + 1.0) / (tails + (z / width) ** 2)


def beyond_weights(z: np.ndarray, tails: float) -> float:
    """Ratio of the standard error of an estimate from weighted readings to the one computed with weights taken as known.

    ``z`` (m,) are standardised residuals of width 1. The weights depend on the residuals, so readings carry less information than
    their weights suggest (Huber, Robust Statistics, 1981, section 7.6).
    """
    if math.isinf(tails):
        return 1.0
    weight = weights(z, tails, 1.0)
    slope = weight * (tails - z**2) / (tails + z**2)
    return max(1.0, rms(weight * z) * math.sqrt(float(np.mean(weight))) / float(np.mean(slope)))
