"""Loaded radius of the virtual tyre: load over deflection as MF 6.2 writes it, solved for the deflection.

``Fz = (1 + Q_V2 |omega| R0 / V0 - (Q_FCX Fx / Fz0)^2 - (Q_FCY Fy / Fz0)^2) (1 + PFZ1 dpi) Fz0 (q1 d + Q_FZ2 d^2)`` with
the deflection ``d`` in unloaded radii and ``q1^2 = (VERTICAL_STIFFNESS R0 / Fz0)^2 - 4 Q_FZ2``. Camber has no influence here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np


def loaded_radius(p: Mapping[str, Any], Fz: Any, Fx: Any, Fy: Any, omega: Any, pressure: Any) -> Any:
    """Distance (n,) of the wheel's centre from the contact point [m].

    Parameters
    ----------
    p : values of the property file
    Fz, Fx, Fy : forces (n,) [N]
    omega : speed of rotation (n,) [rad/s]
    pressure : inflation pressure (n,) [Pa]
    """
    R0, Fz0 = p["UNLOADED_RADIUS"], p["FNOMIN"]
    rim_speed = np.abs(omega) * R0 / p["LONGVL"]
    free = R0 * (p["Q_RE0"] + p["Q_V1"] * rim_speed**2)
    stiffer = 1.0 + p["Q_V2"] * rim_speed - (p["Q_FCX"] * Fx / Fz0) ** 2 - (p["Q_FCY"] * Fy / Fz0) ** 2
    stiffer = stiffer * (1.0 + p["PFZ1"] * (pressure / p["NOMPRES"] - 1.0))
    linear = np.sqrt((p["VERTICAL_STIFFNESS"] * R0 / Fz0) ** 2 - 4.0 * p["Q_FZ2"])
    load = Fz / Fz0 / stiffer
    # Root of q2 d^2 + q1 d = load that stays finite where q2 is zero.
    deflection = 2.0 * load / (linear + np.sqrt(linear**2 + 4.0 * p["Q_FZ2"] * load))
    return free - R0 * deflection
