"""Backlash of the sideslip axis: the moment takes up the play, so the reading is not the angle."""

from __future__ import annotations

import numpy as np

from mffit.config import Config
from mffit.points import Points


def backlash_corrected(points: Points, config: Config) -> Points:
    """The points with the sideslip angle that the wheel really had: reading - (play/2) sign(Mz), ISO-W.

    Points without Mz take the sign of the moment that the path curvature causes at zero slip.
    """
    play = np.radians(config.rig.backlash_deg)
    if play == 0.0:
        return points
    assumed = np.where(points.direction > 0, np.sign(points.phi_t), -np.sign(points.phi_t))
    moment = np.where(np.isfinite(points.Mz), np.sign(np.nan_to_num(points.Mz)), assumed)
    return points.replace(alpha=points.alpha - 0.5 * play * moment)
