"""Size and scatter of the finite ones of some numbers, with and without regard to outliers."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from scipy.special import ndtri

from mffit.constants import FALSE_ALARM

NORMAL = 1.482602218505602
"""Standard deviation of normal noise over the median of its absolute value."""

EFFICIENCY = 0.37
"""Readings from which a root mean square is as uncertain as this median is from one."""


def beyond(chance: float) -> float:
    """Standard deviations from the mean, to either side, beyond which a normal number lies with a probability."""
    return float(-ndtri(chance / 2.0))


ALARM = beyond(FALSE_ALARM)
"""Standard deviations beyond which a sound number lies with the probability of a false alarm."""


def rms(x: np.ndarray) -> float:
    """Root mean square of the finite values; NaN if there are none."""
    x = x[np.isfinite(x)]
    return float(np.sqrt(np.mean(x**2))) if len(x) else float("nan")


def finite_median(x: np.ndarray) -> float:
    """Median of the finite values; NaN if there are none."""
    x = x[np.isfinite(x)]
    return float(np.median(x)) if len(x) else float("nan")


def robust(x: np.ndarray, centre: float = 0.0) -> float:
    """Standard deviation of the core of finite values around a centre; NaN if there are none."""
    x = x[np.isfinite(x)]
    return NORMAL * float(np.median(np.abs(x - centre))) if len(x) else float("nan")


def usual_size(groups: Iterable[np.ndarray]) -> float:
    """Median of the groups' root mean squares; NaN if no group has a finite value."""
    return finite_median(np.array([rms(group) for group in groups]))
