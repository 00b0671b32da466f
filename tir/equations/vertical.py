"""Vertical load over loaded radius: MF-Tyre/MF-Swift 6.2, equation manual of July 2013, which extends 4.E68 by camber.

Q_CAM is the stiffness over camber of older versions; the equations of 6.2 have Q_CAM1-3 instead.
"""

from typing import Any, NamedTuple

from tir.equations.elementary import TINY, absolute, real, select, sqrt, tan

STEPS = 5
"""Number of Newton steps to a loaded radius, from that of the upright wheel without other forces."""


class Rolling(NamedTuple):
    """State of a rolling wheel without load and radius."""

    Fx: Any  #: [N], ISO-W
    Fy: Any  #: [N]
    gamma: Any  #: camber [rad]
    rim_speed: Any  #: speed of rotation times R0 over LONGVL [-]
    dpi: Any  #: pressure above the nominal one, over it [-]


def load(p, RL, rolling: Rolling):
    """Vertical load [N] of a wheel at the loaded radius RL [m], and its derivative [N/m] by the radius."""
    Fx, Fy, gamma, rim_speed, dpi = rolling
    free, lean, R0 = free_radius(p, rim_speed), absolute(gamma), p.UNLOADED_RADIUS
    tread = (1.075 - 0.5 * p.ASPECT_RATIO) * p.WIDTH  # reference width
    whole = p.Q_CAM1 * free + p.Q_CAM2 * free**2
    flat = absolute(real(whole)) <= 0.0  # exported code has no equality
    share = select(flat, 0.0, (p.Q_CAM1 * RL + p.Q_CAM2 * RL**2) / select(flat, 1.0, whole))
    by_radius = select(flat, 0.0, (p.Q_CAM1 + 2.0 * p.Q_CAM2 * RL) / select(flat, 1.0, whole))
    edge = tread / 8.0 * tan(lean)
    x = ((1.0 - p.Q_CAM3 * lean) * (free - RL) + edge * share**2) / R0
    x = select(real(x) > TINY, x, TINY)
    x_slope = (2.0 * edge * share * by_radius - (1.0 - p.Q_CAM3 * lean)) / R0

    side = Fy - (p.Q_FYS1 + p.Q_FYS2 * RL / free + p.Q_FYS3 * (RL / free) ** 2) * gamma
    side_slope = -(p.Q_FYS2 + 2.0 * p.Q_FYS3 * RL / free) * gamma / free
    yielding = (x**p.Q_FCY2 * p.Q_FCY / p.FNOMIN) ** 2 * side
    stiffer = 1.0 + p.Q_V2 * rim_speed - (p.Q_FCX * Fx / p.FNOMIN) ** 2 - yielding * side
    stiffer_slope = -2.0 * yielding * (side_slope + p.Q_FCY2 * side * x_slope / x)

    size, linear = p.FNOMIN * (1.0 + p.PFZ1 * dpi), linear_term(p)
    over = size * (linear * x + p.Q_FZ2 * x**2)
    over_slope = size * (linear + 2.0 * p.Q_FZ2 * x) * x_slope
    return stiffer * over, stiffer * over_slope + stiffer_slope * over


def loaded_radius(p, Fz, rolling: Rolling):
    """Loaded radius [m] of a wheel under the load Fz [N]: the inverse of :func:`load`."""
    rim_speed = rolling.rim_speed
    RL = free_radius(p, rim_speed) - deflection(p, Fz / (1.0 + p.Q_V2 * rim_speed), rolling.dpi)
    for _ in range(STEPS):
        carried, slope = load(p, RL, rolling)
        RL = RL - (carried - Fz) / slope
    return RL


def free_radius(p, rim_speed):
    """Radius [m] of the free wheel, which grows with speed."""
    return p.UNLOADED_RADIUS * (p.Q_RE0 + p.Q_V1 * rim_speed**2)


def linear_term(p):
    """Q_FZ1 [-]: load over nominal load per relative deflection, at zero load.

    It follows from VERTICAL_STIFFNESS, which is the slope of load over deflection at the nominal load and pressure.
    """
    return sqrt((p.VERTICAL_STIFFNESS * p.UNLOADED_RADIUS / p.FNOMIN) ** 2 - 4.0 * p.Q_FZ2)


def deflection(p, Fz, dpi):
    """Deflection [m] of the upright wheel at a load [N] without other forces; the growth with speed left out."""
    share = Fz / (p.FNOMIN * (1.0 + p.PFZ1 * dpi))
    linear = linear_term(p)
    return p.UNLOADED_RADIUS * 2.0 * share / (linear + sqrt(linear**2 + 4.0 * p.Q_FZ2 * share))
