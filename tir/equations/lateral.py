"""Side force Fy."""

from typing import Any, NamedTuple

from tir.equations.elementary import (
    arctan,
    at_most_one,
    away_from_zero,
    cos,
    cos_arctan,
    magic_angle,
    sign,
    sin,
)
from tir.equations.normalise import Inputs, WeightFactors
from tir.equations.stiffness import SideGrip
from tir.equations.turn_slip import Spin


class SideForce(NamedTuple):
    """Pure side force and the factors that the moments use again."""

    Fy: Any  #: [N]
    K_ya: Any  #: cornering stiffness [N/rad]
    S_H: Any  #: horizontal shift [rad]
    S_V: Any  #: vertical shift [N]
    S_V_gamma: Any  #: its camber part [N]
    B: Any
    C: Any


def pure(p, q: Inputs, gamma, spin: Spin, grip: SideGrip) -> SideForce:
    """Fy at zero longitudinal slip [N], at the camber and spin given; 4.E19."""
    K_ya, K_yg0, mu_y = grip
    S_V_gamma = camber_force(p, q, gamma, spin.zeta2)
    from_camber = (K_yg0 * gamma * spin.zeta0 - S_V_gamma) / away_from_zero(K_ya)
    S_H = (p.PHY1 + p.PHY2 * q.dfz) * p.LHY + from_camber + spin.shift  # 4.E27 with zeta4 of 4.E84
    S_V = vertical_shift(p, q, gamma, spin.zeta2)
    alpha_y = q.alpha + S_H  # 4.E20
    C = p.PCY1 * p.LCY  # 4.E21
    D = mu_y * q.Fz * spin.zeta2  # 4.E22
    E = curvature(p, q, gamma, sign(alpha_y))
    B = K_ya / away_from_zero(C * D)  # 4.E26
    Fy = D * sin(magic_angle(B, C, at_most_one(E, q.limits), alpha_y)) + S_V  # 4.E19
    return SideForce(Fy, K_ya, S_H, S_V, S_V_gamma, B, C)


def camber_force(p, q: Inputs, gamma, zeta2=1.0):
    """S_Vygamma [N]: the part of the vertical shift that camber causes; 4.E28."""
    return q.Fz * (p.PVY3 + p.PVY4 * q.dfz) * gamma * p.LKYC * p.LMUY * zeta2  # 4.E28


def vertical_shift(p, q: Inputs, gamma, zeta2=1.0):
    """S_Vy [N]: vertical shift of the side-force curve, conicity and camber; 4.E29."""
    conicity = q.Fz * (p.PVY1 + p.PVY2 * q.dfz) * p.LVY * p.LMUY * zeta2
    return conicity + camber_force(p, q, gamma, zeta2)  # 4.E29


def curvature(p, q: Inputs, gamma, side):
    """E_y [-] before limits, on the side of the curve given by ``side``: -1 or +1; 4.E24."""
    asymmetry = 1.0 + p.PEY5 * gamma**2 - (p.PEY3 + p.PEY4 * gamma) * side
    return (p.PEY1 + p.PEY2 * q.dfz) * asymmetry * p.LEY  # 4.E24


def weight_factors(p, q: Inputs) -> WeightFactors:
    """Factors of G_yk, the weight of longitudinal slip."""
    return WeightFactors(
        B=(p.RBY1 + p.RBY4 * q.gamma**2) * cos_arctan(p.RBY2 * (q.alpha - p.RBY3)) * p.LYKA,  # 4.E62
        C=p.RCY1,  # 4.E63
        E=p.REY1 + p.REY2 * q.dfz,  # 4.E64
        S_H=p.RHY1 + p.RHY2 * q.dfz,  # 4.E65
    )


def combined_weight(p, q: Inputs):
    """G_yk [-]: how longitudinal slip reduces Fy; 4.E59."""
    B, C, E, S_H = weight_factors(p, q)
    E = at_most_one(E, q.limits)
    at_zero = cos(magic_angle(B, C, E, S_H))  # 4.E60
    return cos(magic_angle(B, C, E, q.kappa + S_H)) / at_zero  # 4.E59, 4.E61


def longitudinal_shift(p, q: Inputs, mu_y, zeta2):
    """S_Vyk [N]: side force induced by longitudinal slip (ply-steer under braking); 4.E66."""
    D = (
        mu_y * q.Fz * (p.RVY1 + p.RVY2 * q.dfz + p.RVY3 * q.gamma) * cos_arctan(p.RVY4 * q.alpha) * zeta2
    )  # 4.E67
    return D * sin(p.RVY5 * arctan(p.RVY6 * q.kappa)) * p.LVYKA  # 4.E66
