"""Readings of one revolution of the disc, for the effective rolling radius (18)."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from mffit.virtual_rig.plan import RollingRadiusPlan


def written_down(
    row: RollingRadiusPlan, r_e: float, R: float, generator: np.random.Generator
) -> dict[str, Any]:
    """The table ``[[rolling_radius]]`` of tyre.toml for one load.

    Parameters
    ----------
    row : load, and uncertainties of the readings
    r_e : true effective rolling radius [m]
    R : true radius of the path [m]; infinite on a flat track
    generator : errors of the readings, normally distributed with the declared uncertainties

    Notes
    -----
    Angles are read to 0.1 deg. The notches of the disc are aligned by eye at the start and at the end, so the wheel travels
    ``2 pi R`` and two small arcs.
    """
    chance = generator.standard_normal(4)
    if row.u_effective_radius is not None:
        known = round(float(r_e + row.u_effective_radius * chance[0]), 5)
        return {"load_N": row.load_N, "effective_radius": known, "u_effective_radius": row.u_effective_radius}
    travelled = 2.0 * math.pi * R + row.u_arc_m * (chance[0] + chance[1])
    start = 10.0
    turned = start + math.degrees(travelled / r_e) + row.u_angle_deg * (chance[2] + chance[3])
    revolutions, end = divmod(float(turned), 360.0)
    return {
        "load_N": row.load_N,
        "revolutions": int(revolutions),
        "angle_start_deg": start,
        "angle_end_deg": round(end, 1),
        "u_angle_deg": row.u_angle_deg,
        "u_arc_m": row.u_arc_m,
    }
