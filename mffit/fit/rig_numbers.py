"""The rig's own errors as numbers of the fit, each with the uncertainty that the configuration declares."""

from __future__ import annotations

import math
from typing import Any

from mffit.least_squares import Number
from mffit.measured.alignment import FIRST_GUESS
from mffit.rig import RigFaults

FARTHEST = 8.0
"""Standard deviations that a rig error may move; beyond that the declaration is wrong, not the reading."""


def known_faults(config: Any, measured: Any) -> RigFaults:
    """What is known before the fit: declared play, and the misalignment where it exceeds what the rig's alignment leaves."""
    alpha_0 = (
        math.degrees(measured.alpha_M.value) if measured.misaligned and measured.alpha_M is not None else 0.0
    )
    return RigFaults(alpha_0_deg=alpha_0, backlash_deg=config.rig.backlash_deg)


def rig_numbers(config: Any, measured: Any) -> tuple[Number, ...]:
    """Load-cell offset, both axis zeros, path radius and play with their priors; none on a flat track.

    On a straight path ply-steer and conicity are free and take up what the zeros leave.
    """
    rig = config.rig
    if not rig.on_disc or measured.epsilon_gamma is None:
        return ()
    stiffness = abs(measured.C_alpha.value) if measured.C_alpha else FIRST_GUESS * measured.F_phit_load
    u_alpha = math.degrees(rig.u_slip_alignment_N / max(stiffness, 1.0))
    if measured.misaligned and measured.alpha_M is not None:
        # A zero that lies beyond what was declared shows that the declaration was too tight.
        u_alpha = max(u_alpha, math.degrees(abs(measured.alpha_M.value)))
    rows = [
        ("F0_N", 0.0, rig.u_loadcell_offset_N),
        ("gamma_0_deg", 0.0, rig.u_camber_alignment_deg),
        ("alpha_0_deg", 0.0, u_alpha),
        ("path_radius_m", rig.radius, measured.R.u if measured.R else 0.0),
        ("backlash_deg", rig.backlash_deg, rig.u_backlash_deg),
    ]
    return tuple(_number(name, value, u) for name, value, u in rows if u > 0.0)


def _number(name: str, value: float, u: float) -> Number:
    lower = max(value - FARTHEST * u, 0.0) if name == "backlash_deg" else value - FARTHEST * u
    return Number(name, value, lower, value + FARTHEST * u, expected=value, spread=u)
