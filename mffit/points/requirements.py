"""What the symmetric decomposition cannot do without on a rotating disc."""

from __future__ import annotations

import numpy as np

from mffit.config import Config
from mffit.errors import InputError
from mffit.points.points import Points

ZERO_ALPHA_DEG = 0.3
"""Sideslip angles as read within this of zero count as zero."""
ZERO_GAMMA_DEG = 0.5
"""Camber angles within this of zero count as zero."""


def at_zero(points: Points) -> np.ndarray:
    """Mask (n,) of the points at zero sideslip and camber."""
    upright = np.abs(np.degrees(points.gamma)) <= ZERO_GAMMA_DEG
    return upright & (np.abs(np.degrees(points.alpha)) <= ZERO_ALPHA_DEG)


def check_disc_programme(points: Points, config: Config) -> None:
    """Refuse a programme without mirrored angles or without a point at (0, 0).

    Raises
    ------
    InputError
        Names the column and what to run.
    """
    for column, values, zero in (
        ("alpha_deg", points.alpha, ZERO_ALPHA_DEG),
        ("gamma_deg", points.gamma, ZERO_GAMMA_DEG),
    ):
        degrees = np.degrees(values)
        if (degrees.max() > zero) != (degrees.min() < -zero):
            raise InputError(
                f"runs only from {degrees.min():.3g} to {degrees.max():.3g} deg in ISO signs, and on "
                "a disc both signs "
                "are needed to separate turn slip; add the mirrored points",
                file=config.path,
                column=column,
            )
    if not np.any(at_zero(points) & (points.direction > 0)):
        raise InputError(
            "no forward point has alpha_deg = 0 and gamma_deg = 0, where the turn-slip force is "
            "measured; add one per "
            "load",
            file=config.path,
            column="alpha_deg",
        )
