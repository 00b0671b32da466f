"""From ISO-W to the axes and the frame in which the rig reports."""

from __future__ import annotations

import numpy as np

from mffit.virtual_rig.machine import Channels


def in_wheel_carrier(forces: Channels, gamma: np.ndarray) -> Channels:
    """Contact frame W to wheel-carrier frame C: turned about x by the camber ``gamma`` (n,) [rad].

    The moments stay those about the contact point: a lever to the wheel's centre would not change Mz.
    """
    c, s = np.cos(gamma), np.sin(gamma)
    return forces._replace(
        Fy=c * forces.Fy + s * forces.Fz,
        Fz=c * forces.Fz - s * forces.Fy,
        My=c * forces.My + s * forces.Mz,
        Mz=c * forces.Mz - s * forces.My,
    )
