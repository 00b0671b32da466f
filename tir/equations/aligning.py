"""Aligning moment Mz: trail, residual torque and moment arm of Fx."""

from tir.equations.elementary import (
    absolute,
    arctan,
    at_most_one,
    away_from_zero,
    cos,
    magic_angle,
    pi,
    sign,
    sqrt,
    tan,
)
from tir.equations.lateral import SideForce
from tir.equations.normalise import Inputs
from tir.equations.turn_slip import Spin, SpinTorque


def equivalent_slip(alpha_shifted, K_xk, K_ya, kappa):
    """Sideslip that has the same effect as sideslip and longitudinal slip together [rad]; A54, A55."""
    ratio = K_xk / away_from_zero(K_ya)
    return arctan(sqrt(tan(alpha_shifted) ** 2 + ratio**2 * kappa**2)) * sign(alpha_shifted)


def trail(p, q: Inputs, spin: Spin, K_xk, K_ya):
    """Pneumatic trail t [m]; 4.E33 with the equivalent slip of A54."""
    S_H = p.QHZ1 + p.QHZ2 * q.dfz + (p.QHZ3 + p.QHZ4 * q.dfz) * q.gamma  # 4.E35
    alpha_t = q.alpha + S_H  # 4.E34
    B = slope_factor(p, q)
    C = p.QCZ1  # 4.E41
    D = q.Fz_moment * p.UNLOADED_RADIUS / q.Fz0 * trail_at_zero(p, q) * p.LTR * spin.zeta5  # A60
    E = curvature(p, q, B, alpha_t)
    slip = equivalent_slip(alpha_t, K_xk, K_ya, q.kappa)
    return p.LFZO * D * cos(magic_angle(B, C, at_most_one(E, q.limits), slip)) * q.cos_alpha  # 4.E33


def slope_factor(p, q: Inputs):
    """B_t [-] of the trail; A58."""
    load = p.QBZ1 + p.QBZ2 * q.dfz + p.QBZ3 * q.dfz**2
    return load * (1.0 + p.QBZ4 * q.gamma + p.QBZ5 * absolute(q.gamma)) * p.LKY / p.LMUY  # A58


def trail_at_zero(p, q: Inputs):
    """Peak trail over free radius at nominal load [-]: D_t of A60 without its proportionality to the load."""
    pressure, camber = 1.0 - p.PPZ1 * q.dpi, 1.0 + p.QDZ3 * q.gamma + p.QDZ4 * q.gamma**2
    return (p.QDZ1 + p.QDZ2 * q.dfz) * pressure * camber


def curvature(p, q: Inputs, B, alpha_t):
    """E_t [-] before limits, at the shifted sideslip alpha_t [rad]; 4.E44."""
    side = 2.0 / pi * arctan(B * p.QCZ1 * alpha_t)
    load = p.QEZ1 + p.QEZ2 * q.dfz + p.QEZ3 * q.dfz**2
    return load * (1.0 + (p.QEZ4 + p.QEZ5 * q.gamma) * side)  # 4.E44


def residual_torque(p, q: Inputs, spin: Spin, spin_torque: SpinTorque, side: SideForce, K_xk):
    """Residual torque Mzr [Nm]; 4.E36, with the turn-slip moment in the sign of z-up axes."""
    alpha_r = q.alpha + side.S_H + side.S_V / away_from_zero(side.K_ya)  # 4.E37, 4.E38
    B = (p.QBZ9 * p.LKY / p.LMUY + p.QBZ10 * side.B * side.C) * spin.zeta6  # 4.E45
    C = spin_torque.zeta7  # 4.E46
    constant = (p.QDZ6 + p.QDZ7 * q.dfz) * p.LRES * spin.zeta2
    slope = (p.QDZ8 + p.QDZ9 * q.dfz) * (1.0 + p.PPZ2 * q.dpi)
    slope = slope + (p.QDZ10 + p.QDZ11 * q.dfz) * absolute(q.gamma)
    size = q.Fz_moment * p.UNLOADED_RADIUS * p.LMUY * q.cos_alpha
    D = size * (constant + slope * q.gamma * p.LKZC * spin.zeta0) - (spin_torque.zeta8 - 1.0)  # 4.E47
    return D * cos(C * arctan(B * equivalent_slip(alpha_r, K_xk, side.K_ya, q.kappa)))  # 4.E36


def longitudinal_arm(p, q: Inputs, Fy):
    """Moment arm s of Fx [m]; A56."""
    return (
        p.UNLOADED_RADIUS * (p.SSZ1 + p.SSZ2 * Fy / p.FNOMIN + (p.SSZ3 + p.SSZ4 * q.dfz) * q.gamma) * p.LS
    )  # A56
