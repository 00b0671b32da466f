"""Backlash of the sideslip axis: the moment takes up the play, so the reading is not the angle."""

from __future__ import annotations

import math

import numpy as np
from scipy.special import ndtr
from uncertainties import UFloat

from mffit.config import Config
from mffit.constants import USUAL_CORNERING_STIFFNESS, USUAL_U_MOMENT
from mffit.measured import constants
from mffit.measured.uncertain import named
from mffit.parts import Parts
from mffit.points import Points


def backlash_shift(Mz: np.ndarray, u_Mz: np.ndarray, play: float) -> tuple[np.ndarray, np.ndarray]:
    """Sideslip that the play adds to the reading, ISO-W: -(play/2) sign(Mz), and its standard uncertainty [rad].

    If the moment is within its noise, its sign is uncertain: the shift is then the expectation over both signs.
    """
    noise = np.where(np.isfinite(u_Mz) & (u_Mz > 0), u_Mz, USUAL_U_MOMENT)
    positive = ndtr(Mz / noise)
    return -0.5 * play * (2.0 * positive - 1.0), play * np.sqrt(positive * (1.0 - positive))


def backlash_corrected(points: Points, config: Config) -> Points:
    """The points with true sideslip angles; u_Fy includes the uncertainty of the side of the play.

    Points without Mz take the sign of the moment that the path curvature causes at zero slip.
    """
    play = np.radians(config.rig.backlash_deg)
    if play == 0.0:
        return points
    assumed = 1e3 * np.sign(points.phi_t) * points.direction  # [Nm]; only its sign matters
    shift, u = backlash_shift(np.where(np.isfinite(points.Mz), points.Mz, assumed), points.u_Mz, play)
    return points.replace(
        alpha=points.alpha + shift, u_Fy=np.hypot(points.u_Fy, USUAL_CORNERING_STIFFNESS * points.Fz * u)
    )


def rest_of_play(config: Config) -> UFloat:
    """What the correction leaves of sideslip zeros, as the wheel floats where the moment changes sign [rad]."""
    half = 0.5 * math.radians(config.rig.backlash_deg)
    return named(0.0, constants.REST_OF_PLAY * half, "play near zero moment", "rad")


def odd_alpha(points: Points, parts: Parts, config: Config) -> np.ndarray:
    """Sideslip (n,) to which the odd part of every point belongs: half the difference of the true angles of the pair.

    Parameters
    ----------
    points : with the angles as read
    parts : their decomposition, by reading
    """
    play = np.radians(config.rig.backlash_deg)
    if play == 0.0:
        return points.alpha
    own, _ = backlash_shift(points.Mz, points.u_Mz, play)
    mirror, _ = backlash_shift(points.Mz - 2.0 * parts.Mz_odd, points.u_Mz, play)
    return np.asarray(points.alpha + np.nan_to_num(own - mirror) / 2.0)
