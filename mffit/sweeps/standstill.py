"""Samples of a recording before the wheel rolls, and after it."""

from __future__ import annotations

import numpy as np

from mffit.sweeps import constants


def standing(V: np.ndarray) -> np.ndarray:
    """Mask (n,) of the samples at which the road stands, from its speed in any unit and with any sign; NaN is not a standstill.

    The usual speed is that of the rolling wheel, so a recording may stand for most of its time.
    """
    speed = np.abs(V)
    largest = np.max(speed, where=np.isfinite(speed), initial=0.0)
    rolling = speed[speed > constants.STANDSTILL * largest]
    return (
        np.asarray(speed < constants.STANDSTILL * np.median(rolling))
        if len(rolling)
        else np.zeros(len(V), bool)
    )
