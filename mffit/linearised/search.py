"""The search for the most probable parameters of a linear Gaussian model, by its evidence and their priors.

A parameter is searched on a scale without ends: the logarithm of a size, or the log odds of a share.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
import scipy  # its parts are loaded on first use

from mffit.least_squares import UNDAMPED, Quadratic, next_damping
from mffit.linearised import constants

DAMPING = 0.1
"""Damping of the first step of a search, and the least after a step that is taken back."""
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

    def most_probable(self, near: Mapping[str, float] | None = None) -> tuple[np.ndarray, float]:
        """The parameters (k,) of the largest density, and the log probability of the model by Laplace's approximation there.

        The search begins at the parameters of ``near``, else at their usual starts.
        """
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
        found = scipy.optimize.minimize(
            loss, start, jac=True, method="L-BFGS-B", bounds=bounds, options=options
        )
        x, step = np.asarray(found.x), float(constants.EVIDENCE_STEP)
        curvature = np.array([loss(x + one)[1] - found.jac for one in step * np.eye(len(x))]) / step
        axes = np.linalg.eigvalsh(0.5 * (curvature + curvature.T))
        width = np.log(2.0 * math.pi / np.maximum(axes, constants.LEAST_CURVATURE))
        return x, 0.5 * float(np.sum(width)) - float(found.fun)


class Scored(NamedTuple):
    """A log density, up to a constant, at some parameters (k,)."""

    value: float
    slope: np.ndarray  #: (k,) its derivatives
    information: np.ndarray  #: (k, k) how fast the slope is expected to fall


class Scoring(NamedTuple):
    """The posterior of parameters (k,) whose readings tell how much they inform (Fisher's method of scoring)."""

    parameters: Sequence[SearchedParameter]
    evidence: Callable[[np.ndarray], Scored]  #: log evidence at the parameters

    def density(self, x: np.ndarray) -> Scored:
        """Log posterior density."""
        value, slope, information = self.evidence(x)
        h = float(constants.EVIDENCE_STEP)
        for i, (one, at) in enumerate(zip(self.parameters, x.tolist(), strict=True)):
            log, by = one.prior(at)
            value, slope[i] = value + log, slope[i] + by
            falls = (one.prior(at - h)[1] - one.prior(at + h)[1]) / (2.0 * h)
            information[i, i] += max(falls, float(constants.LEAST_CURVATURE))
        return Scored(value, slope, information)

    def most_probable(self, near: Sequence[float]) -> np.ndarray:
        """The parameters (k,) of the largest density, searched from those ``near``.

        The search ends with an undamped step, whose gain is too small to be worth another look.
        """
        lower, upper = (np.array([one[i] for one in self.parameters]) for i in (1, 2))
        x, damping, none = np.clip(near, lower, upper), DAMPING, np.zeros((0, len(near)))
        here = self.density(x)
        for _ in range(int(constants.SEARCH_STEPS)):
            form = Quadratic(-here.slope, here.information, none[:, 0], none, lower - x, upper - x)
            step, last = form.move(damping), form.move(UNDAMPED)
            assert step is not None
            assert last is not None
            if 0.5 * form.gain(last) < constants.SEARCH_TOLERANCE:
                return np.asarray(np.clip(x + last, lower, upper))
            there = self.density(trial := np.clip(x + step, lower, upper))
            rise, promised = there.value - here.value, 0.5 * form.gain(step)
            damping = next_damping(damping, rise, promised) if rise > 0.0 else max(6.0 * damping, DAMPING)
            if rise > 0.0:
                x, here = trial, there
        return x
