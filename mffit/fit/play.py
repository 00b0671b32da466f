"""Where the moment is so small that nobody knows on which side the play of the steering axis lies."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from mffit.points import Points
from mffit.rig import Readings, Simulation

SMALL = 4.0
"""Uncertainties of the moment within which its sign is open."""


def undecided_play(simulation: Simulation, points: Points, sigma_Mz: np.ndarray) -> Readings:
    """How far Fy [N] and Mz [Nm] (n,) may be off because the play may lie on either side; 0 where it is decided.

    Parameters
    ----------
    simulation : with the play of the rig
    points : (n,)
    sigma_Mz : uncertainty of the moment (n,) [Nm]; inf where it was not measured
    """
    play = simulation.faults.backlash_deg
    if not play:
        return Readings(np.zeros(len(points)), np.zeros(len(points)))
    firm = replace(simulation, faults=replace(simulation.faults, backlash_deg=0.0))
    half = 0.5 * np.radians(play)
    left, right = (firm.readings(points.replace(alpha=points.alpha + side * half)) for side in (1.0, -1.0))
    across = np.abs(left.Mz - right.Mz)
    known = np.where(np.isfinite(sigma_Mz), sigma_Mz, 0.0)
    open_ = np.abs(left.Mz + right.Mz) / 2.0 < SMALL * known + across / 2.0
    return Readings(np.where(open_, np.abs(left.Fy - right.Fy), 0.0), np.where(open_, across, 0.0))
