"""A declared uncertainty and measurements of the same number, combined."""

from __future__ import annotations

from collections.abc import Sequence

from uncertainties import UFloat

from mffit.measured import constants
from mffit.measured.paths import least_uncertain_mean


def agreed(declared: UFloat, measurements: Sequence[UFloat]) -> UFloat:
    """The mean of least uncertainty; without the declaration if the measurements contradict it.

    Parameters
    ----------
    declared : the expected value with its declared standard uncertainty
    measurements : of the same number, at least one
    """
    found = least_uncertain_mean(measurements)
    difference = found - declared
    if abs(difference.nominal_value) > constants.CONTRADICTED * difference.std_dev:
        return found
    return least_uncertain_mean([declared, *measurements])
