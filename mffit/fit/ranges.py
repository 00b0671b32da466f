"""The ranges that the written file claims: what the data cover."""

from __future__ import annotations

import numpy as np

from mffit.fit.constraints import Envelope
from mffit.points import Points


def covered_ranges(points: Points) -> dict[str, float]:
    """FZ, ALP, CAM and PRES limits [N, rad, Pa] from the set-points; a pressure run alone gets 10 % either way."""
    alpha, gamma = float(np.max(np.abs(points.alpha))), float(np.max(np.abs(points.gamma)))
    low, high = float(np.min(points.p)), float(np.max(points.p))
    if high - low < 0.05 * high:
        low, high = 0.9 * low, 1.1 * high
    return {
        "PRESMIN": low,
        "PRESMAX": high,
        "FZMIN": float(np.min(points.Fz)),
        "FZMAX": float(np.max(points.Fz)),
        "ALPMIN": -alpha,
        "ALPMAX": alpha,
        "CAMMIN": -gamma,
        "CAMMAX": gamma,
    }


def envelope(ranges: dict[str, float]) -> Envelope:
    """The same ranges for the physical limits of the fit."""
    return Envelope(
        Fz=(ranges["FZMIN"], ranges["FZMAX"]),
        gamma=ranges["CAMMAX"],
        alpha=ranges["ALPMAX"],
        pressure=(ranges["PRESMIN"], ranges["PRESMAX"]),
    )
