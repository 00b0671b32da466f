"""Slip stiffnesses and friction coefficients: the quantities that several forces share."""

from typing import Any, NamedTuple

from tir.equations.elementary import absolute, arctan, exp, sin
from tir.equations.normalise import Inputs


class SideGrip(NamedTuple):
    """What the side force is built of, at the camber and spin of interest."""

    K_ya: Any  #: cornering stiffness [N/rad]
    K_yg0: Any  #: camber stiffness at zero camber [N/rad]
    mu_y: Any  #: friction coefficient [-]


def longitudinal_slip_stiffness(p, q: Inputs):
    """K_xk [N]; 4.E15."""
    load = (p.PKX1 + p.PKX2 * q.dfz) * exp(p.PKX3 * q.dfz)
    return q.Fz * load * (1.0 + p.PPX1 * q.dpi + p.PPX2 * q.dpi**2) * p.LKX  # 4.E15


def cornering_stiffness(p, q: Inputs, gamma, zeta3=1.0):
    """K_ya [N/rad], negative for a normal tyre, at the camber given; 4.E25."""
    magnitude = p.PKY1 * q.Fz0 * (1.0 + p.PPY1 * q.dpi) * (1.0 - p.PKY3 * absolute(gamma))
    return magnitude * sin(p.PKY4 * arctan(q.Fz / q.Fz0 / peak_load(p, q, gamma))) * zeta3 * p.LKY  # 4.E25


def peak_load(p, q: Inputs, gamma):
    """Load over the nominal one whose arctangent scales the cornering stiffness, at the camber given; 4.E25."""
    return (p.PKY2 + p.PKY5 * gamma**2) * (1.0 + p.PPY2 * q.dpi)  # 4.E25


def camber_stiffness(p, q: Inputs):
    """K_yg0 [N/rad], negative for a normal tyre; 4.E30."""
    return q.Fz * (p.PKY6 + p.PKY7 * q.dfz) * (1.0 + p.PPY5 * q.dpi) * p.LKYC  # 4.E30


def residual_torque_stiffness(p, q: Inputs):
    """K_z [Nm/rad]: slope of the residual torque with camber that turn slip has to reproduce."""
    slope = p.QDZ8 + p.QDZ9 * q.dfz + (p.QDZ10 + p.QDZ11 * q.dfz) * absolute(q.gamma)
    return q.Fz_moment * p.UNLOADED_RADIUS * slope * p.LKZC


def longitudinal_friction(p, q: Inputs):
    """mu_x [-]; 4.E13."""
    pressure = 1.0 + p.PPX3 * q.dpi + p.PPX4 * q.dpi**2
    return (p.PDX1 + p.PDX2 * q.dfz) * pressure * (1.0 - p.PDX3 * q.gamma**2) * p.LMUX  # 4.E13


def lateral_friction(p, q: Inputs, gamma):
    """mu_y [-] at the camber given; 4.E23."""
    pressure = 1.0 + p.PPY3 * q.dpi + p.PPY4 * q.dpi**2
    return (p.PDY1 + p.PDY2 * q.dfz) * pressure * (1.0 - p.PDY3 * gamma**2) * p.LMUY  # 4.E23
