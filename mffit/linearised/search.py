"""The search for the most probable parameters of a linear Gaussian model, by its evidence and their priors.

A parameter is searched on a scale without ends: the logarithm of a size, or the log odds of a share.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize

from mffit.linearised import constants

LogPrior = Callable[[float], tuple[float, float]]
"""Log prior density of a parameter on the scale of the search, up to a constant, and its derivative."""


def flat(x: float) -> tuple[float, float]:
    """No knowledge of the parameter."""
    return 0.0, 0.0


def normal(mean: float, spread: float) -> LogPrior:
    """Normal distribution."""

    def prior(x: float) -> tuple[float, float]:
        far = (x - mean) / spread
        return -0.5 * far**2, -far / spread

    return prior


def half_cauchy(x: float) -> tuple[float, float]:
    """Half-Cauchy distribution of a size over its usual one, by its logarithm."""
    square = math.exp(2.0 * x)
    return math.log(2.0 / math.pi) + x - math.log1p(square), (1.0 - square) / (1.0 + square)


def arcsine(x: float) -> tuple[float, float]:
    """Jeffreys' prior of a correlation between 0 and 1, by its log odds; it allows values near 1."""
    share = share_of(x)
    log = math.log(2.0 / math.pi) + math.log(share) + 0.5 * (math.log1p(-share) - math.log1p(share))
    return log, 1.0 - share - 0.5 * share - 0.5 * share * (1.0 - share) / (1.0 + share)


def uniform(x: float) -> tuple[float, float]:
    """Uniform distribution of a share, by its log odds."""
    share = share_of(x)
    return math.log(share) + math.log1p(-share), 1.0 - 2.0 * share


def share_of(log_odds: float) -> float:
    """A share from its log odds."""
    return 1.0 / (1.0 + math.exp(-log_odds)) if log_odds > -math.inf else 0.0


class SearchedParameter(NamedTuple):
    """Start, bounds and prior of a parameter, on the scale of the search."""

    start: float
    lower: float
    upper: float
    prior: LogPrior = flat


class ParameterSearch(NamedTuple):
    """The posterior of parameters (k,)."""

    parameters: Mapping[str, SearchedParameter]
    evidence: Callable[[np.ndarray], tuple[float, np.ndarray]]
    """Log evidence at the parameters, and its derivatives (k,)."""
    readings: int  #: to which the log evidence is about proportional

    def density(self, x: np.ndarray) -> tuple[float, np.ndarray]:
        """Log posterior density up to a constant, and its derivatives (k,)."""
        value, slope = self.evidence(x)
        priors = [one.prior(at) for one, at in zip(self.parameters.values(), x.tolist(), strict=True)]
        return value + sum(log for log, _ in priors), slope + [by for _, by in priors]

    def most_probable(self, near: Mapping[str, float] | None = None) -> np.ndarray:
        """The parameters (k,) of the largest density; the search begins at those of ``near``, else at their usual starts."""
        begin = near or {}

        def loss(x: np.ndarray) -> tuple[float, np.ndarray]:
            value, slope = self.density(x)
            return -value, -slope

        start = [
            min(max(begin.get(name, one.start), one.lower), one.upper)
            for name, one in self.parameters.items()
        ]
        bounds = [(one.lower, one.upper) for one in self.parameters.values()]
        options = {
            "maxiter": int(constants.SEARCH_STEPS),
            "ftol": constants.SEARCH_TOLERANCE / max(self.readings, 1),
        }
        found = minimize(loss, start, jac=True, method="L-BFGS-B", bounds=bounds, options=options)
        return np.asarray(found.x)

    def log_probability(self, x: np.ndarray) -> float:
        """Log probability of the model, by Laplace's approximation around its most probable parameters (k,)."""
        value, slope = self.density(x)
        step = float(constants.EVIDENCE_STEP)
        moved = [self.density(x + one)[1] for one in step * np.eye(len(x))]
        curvature = (slope - np.array(moved)) / step
        axes = np.linalg.eigvalsh(0.5 * (curvature + curvature.T))
        return value + 0.5 * float(
            np.sum(np.log(2.0 * math.pi / np.maximum(axes, constants.LEAST_CURVATURE)))
        )
