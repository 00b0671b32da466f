"""The two radii of the direct method from tape measure and inclinometer, (18) and (19).

The formulae accept plain numbers and numbers with an uncertainty.
"""

import math
from typing import Any


def path_radius(shaft_diameter: Any, L_B: Any, L_C: Any, L_D: Any) -> Any:
    """Radius of the contact point's path, R = Phi_A/2 + L_B + (L_C + L_D)/2, (19); all [m].

    Parameters
    ----------
    shaft_diameter : diameter of the disc's shaft Phi_A [m]
    L_B : from the shaft to the inner edge of the abrasive path [m]
    L_C, L_D : from that edge to the tyre's inner and outer sidewall [m]

    Examples
    --------
    >>> round(path_radius(0.080, 1.140, 0.083, 0.203), 6)
    1.323
    """
    return shaft_diameter / 2 + L_B + (L_C + L_D) / 2


def wheel_turn(row: Any) -> float:
    """Angle [rad] by which the wheel turned during one disc revolution: whole turns plus the remaining angle."""
    turns: float = row.revolutions
    return 2.0 * math.pi * turns + math.radians(row.angle_end_deg - row.angle_start_deg)


def effective_radius(row: Any, R: Any) -> Any:
    """Free-rolling radius r_e = 2 pi R / turn of the wheel [m], (18); infinite if the wheel did not turn.

    ``row`` is a measured ``[rolling_radius]`` table, R the path radius [m].
    """
    turn = wheel_turn(row)
    return 2.0 * math.pi * R / turn if turn > 0.0 else math.inf
