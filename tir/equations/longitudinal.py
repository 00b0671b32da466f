"""Longitudinal force Fx."""

from tir.equations.elementary import at_most_one, away_from_zero, cos, cos_arctan, magic_angle, sign, sin
from tir.equations.normalise import Inputs, WeightFactors
from tir.equations.turn_slip import Spin


def pure(p, q: Inputs, spin: Spin, K_xk, mu_x):
    """Fx at zero sideslip [N]; 4.E9."""
    C = p.PCX1 * p.LCX  # 4.E11
    D = mu_x * q.Fz * spin.zeta1  # 4.E12
    S_H = (p.PHX1 + p.PHX2 * q.dfz) * p.LHX  # 4.E17
    S_V = q.Fz * (p.PVX1 + p.PVX2 * q.dfz) * p.LVX * p.LMUX * spin.zeta1  # 4.E18
    kappa_x = q.kappa + S_H  # 4.E10
    E = curvature(p, q, sign(kappa_x))
    B = K_xk / away_from_zero(C * D)  # 4.E16
    return D * sin(magic_angle(B, C, at_most_one(E, q.limits), kappa_x)) + S_V  # 4.E9


def curvature(p, q: Inputs, side):
    """E_x [-] before limits, driven (``side`` +1) or braked (-1); 4.E14."""
    return (p.PEX1 + p.PEX2 * q.dfz + p.PEX3 * q.dfz**2) * (1.0 - p.PEX4 * side) * p.LEX  # 4.E14


def weight_factors(p, q: Inputs) -> WeightFactors:
    """Factors of G_xa, the weight of sideslip."""
    return WeightFactors(
        B=(p.RBX1 + p.RBX3 * q.gamma**2) * cos_arctan(p.RBX2 * q.kappa) * p.LXAL,  # 4.E54
        C=p.RCX1,  # 4.E55
        E=p.REX1 + p.REX2 * q.dfz,  # 4.E56
        S_H=p.RHX1,  # 4.E57
    )


def combined_weight(p, q: Inputs):
    """G_xa [-]: how sideslip reduces Fx; 4.E51."""
    B, C, E, S_H = weight_factors(p, q)
    E = at_most_one(E, q.limits)
    at_zero = cos(magic_angle(B, C, E, S_H))  # 4.E52
    return cos(magic_angle(B, C, E, q.alpha + S_H)) / at_zero  # 4.E51, 4.E53
