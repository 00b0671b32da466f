"""A sweep that leans to the other side than all the others: a camber of the wrong sign bends the model without a word."""

from __future__ import annotations

import numpy as np

from mffit.points.points import Points

LEANING = np.radians(0.5)
"""Camber [rad] from which on a wheel leans."""
FEWEST = 4
"""Sweeps with camber of which one may be the odd one."""


def lone_lean(points: Points) -> list[str]:
    """A sentence about the one sweep that leans the other way; none where sweeps hold both signs, as a disc's do."""
    sides: dict[int, float] = {}
    for k in np.unique(points.sweep).tolist():
        gamma = points.gamma[points.sweep == k]
        found = np.unique(np.sign(gamma[np.abs(gamma) > LEANING]))
        if len(found) > 1:
            return []
        if len(found):
            sides[k] = float(found[0])
    usual = np.sign(sum(sides.values()))
    odd = [k for k, side in sides.items() if side != usual]
    if len(sides) < FEWEST or len(odd) != 1:
        return []
    degrees = abs(np.degrees(np.median(points.gamma[points.sweep == odd[0]])))
    return [
        f"{points.sweep_names[odd[0]]} leans {degrees:.1f} deg to the other side than all {len(sides) - 1} other sweeps with "
        "camber: if that was not meant, correct the sign of its gamma_deg"
    ]
