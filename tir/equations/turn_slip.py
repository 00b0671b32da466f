"""Turn slip: the factors zeta0..zeta8 by which spin changes the Magic Formula.

The signs are those of z-up axes: the camber part of the spin, the shift of the side-force curve and the turn-slip moment
go together, so that camber alone gives the side force of the model without turn slip, times R0/Re.
"""

from typing import Any, NamedTuple

from tir.equations.elementary import (
    absolute,
    arccos,
    arctan,
    away_from_zero,
    cos_arctan,
    magic_angle,
    pi,
    real,
    select,
    sin,
    sqrt,
)
from tir.equations.normalise import Inputs
from tir.equations.stiffness import residual_torque_stiffness


class Spin(NamedTuple):
    """Spin and what it does to the forces; without turn slip phi is 0 and every factor 1."""

    phi: Any  #: total spin [1/m]
    zeta0: Any  #: switches the camber terms of the normal mode off
    zeta1: Any  #: peak longitudinal force
    zeta2: Any  #: peak side force
    zeta3: Any  #: cornering stiffness
    shift: Any  #: S_Hyphi, shift of the side-force curve [rad]
    zeta5: Any  #: pneumatic trail
    zeta6: Any  #: residual torque, decay with slip


class SpinTorque(NamedTuple):
    """What spin does to the residual torque."""

    zeta7: Any  #: shape
    zeta8: Any  #: 1 + turn-slip moment [Nm]


NO_SPIN = Spin(phi=0.0, zeta0=1.0, zeta1=1.0, zeta2=1.0, zeta3=1.0, shift=0.0, zeta5=1.0, zeta6=1.0)
NO_SPIN_TORQUE = SpinTorque(zeta7=1.0, zeta8=1.0)


def spin(p, q: Inputs, phi, eps_gamma, K_ya0, K_yg0) -> Spin:
    """Weighting factors that do not depend on the combined-slip forces."""
    R0_phi = p.UNLOADED_RADIUS * phi
    Bx = p.PDXP1 * (1.0 + p.PDXP2 * q.dfz) * cos_arctan(p.PDXP3 * q.kappa)  # 4.E106
    By = p.PDYP1 * (1.0 + p.PDYP2 * q.dfz) * cos_arctan(p.PDYP3 * q.tan_alpha)  # 4.E78
    size = absolute(R0_phi)
    return Spin(
        phi=phi,
        zeta0=0.0,  # 4.E83
        zeta1=cos_arctan(Bx * R0_phi),  # 4.E105
        zeta2=cos_arctan(By * (size + p.PDYP4 * sqrt(size))),  # 4.E77
        zeta3=cos_arctan(p.PKYP1 * R0_phi**2),  # 4.E79
        shift=side_force_shift(p, q, R0_phi, eps_gamma, K_ya0, K_yg0),
        zeta5=cos_arctan(p.QDTP1 * R0_phi),  # 4.E91
        zeta6=cos_arctan(p.QBRP1 * R0_phi),  # 4.E101
    )


def side_force_shift(p, q: Inputs, R0_phi, eps_gamma, K_ya0, K_yg0):
    """S_Hyphi [rad]: shift of the side-force curve by spin; 4.E80 with the sign of z-up axes."""
    C = p.PHYP1  # 4.E85
    D = away_from_zero(p.PHYP2 + p.PHYP3 * q.dfz)  # 4.E86
    E = p.PHYP4  # 4.E87
    B = -K_yg0 / (1.0 - eps_gamma) / away_from_zero(C * D * K_ya0)  # 4.E88
    return D * sin(magic_angle(B, C, E, R0_phi))  # 4.E80


def torque(p, q: Inputs, phi, eps_gamma, mu_y, Gyk) -> SpinTorque:
    """Turn-slip moment and its decay with sideslip; 4.E92-4.E103."""
    R0, K_z = p.UNLOADED_RADIUS, residual_torque_stiffness(p, q)
    M_inf = p.QCRP1 * absolute(mu_y) * R0 * q.Fz_moment * sqrt(q.Fz_moment / q.Fz0) * p.LMP  # 4.E95
    M_90 = M_inf * 2.0 / pi * arctan(p.QCRP2 * R0 * absolute(q.phi_t)) * Gyk  # 4.E103
    C = p.QDRP1  # 4.E96
    D = away_from_zero(M_inf / away_from_zero(sin(0.5 * pi * C)))  # 4.E94
    B = K_z / away_from_zero(C * D * (1.0 - eps_gamma))  # 4.E99
    D_rphi = D * sin(magic_angle(B, C, p.QDRP2, R0 * phi))  # 4.E98
    ratio = absolute(M_90) / (absolute(D_rphi) + 1e-30)
    return SpinTorque(
        zeta7=2.0 / pi * arccos(select(real(ratio) > 1.0, 1.0, ratio)),  # 4.E102
        zeta8=1.0 + D_rphi,  # 4.E97
    )
