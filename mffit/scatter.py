"""Size and scatter of finite numbers, plain and robust against outliers."""

import math
from collections.abc import Iterable

import numpy as np
from scipy.special import ndtr, ndtri

from mffit.constants import FALSE_ALARM, PREDICTION_FALSE_ALARM

NORMAL = 1.482602218505602
"""Standard deviation of normal noise over the median of its absolute value."""

EFFICIENCY = 0.37
"""Relative efficiency of the median absolute value: a root mean square from this share of the readings is as uncertain."""


def beyond(chance: float) -> float:
    """Number of standard deviations beyond which a normal variable lies, to either side together, with probability ``chance``."""
    return float(-ndtri(chance / 2.0))


ALARM = beyond(FALSE_ALARM)
"""Number of standard deviations that a sound value exceeds with the probability of a false alarm."""


def clearly_below_zero(value: float, u: float) -> bool:
    """Whether a value of standard uncertainty ``u`` is below zero by more than chance explains."""
    return bool(value < ndtri(FALSE_ALARM) * u)


def significant(z: np.ndarray) -> np.ndarray:
    """Mask (n,) of the differences, in standard errors, that are not chance: 1 % of those found may be (Benjamini and Hochberg
    1995).
    """
    chance = 2.0 * ndtr(-np.abs(z))
    ordered = np.sort(chance)
    passing = ordered < PREDICTION_FALSE_ALARM * np.arange(1, len(z) + 1) / max(len(z), 1)
    return np.asarray(chance <= np.max(ordered[passing], initial=-1.0))


def rms(x: np.ndarray) -> float:
    """Root mean square of the finite values; NaN if there are none."""
    x = x[np.isfinite(x)]
    return float(np.sqrt(np.mean(x**2))) if len(x) else float("nan")


def finite_median(x: np.ndarray) -> float:
    """Median of the finite values; NaN if there are none."""
    x = x[np.isfinite(x)]
    return float(np.median(x)) if len(x) else float("nan")


def robust(x: np.ndarray) -> float:
    """Robust standard deviation of the finite values around zero, from the median; NaN if there are none."""
    return NORMAL * finite_median(np.abs(x))


def bends(values: np.ndarray, order: int) -> np.ndarray:
    """Differences (n - order,) of this order between successive values, of which a smooth curve leaves hardly any.

    Of white noise they have the standard deviation of the noise.
    """
    return np.asarray(np.diff(values, order) / math.sqrt(math.comb(2 * order, order)))


def usual_size(groups: Iterable[np.ndarray]) -> float:
    """Median of the groups' root mean squares; NaN if no group has a finite value."""
    return finite_median(np.array([rms(group) for group in groups]))
