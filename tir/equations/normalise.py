"""Inputs of the Magic Formula: normalised load and pressure, slips, effective rolling radius, spin."""

from typing import Any, NamedTuple

from tir.equations.elementary import arctan, away_from_zero, cos, finite, sin, tan


class OperatingCondition(NamedTuple):
    """The inputs of the model in ISO-W, SI and radians; scalars or arrays that broadcast."""

    Fz: Any  #: vertical load [N]; loads <= 0 give zero forces, NaN gives NaN
    alpha: Any = (
        0.0  #: sideslip angle atan(Vsy/Vx) [rad]; rolling backwards it stays the reading of the rig's axis
    )
    gamma: Any = 0.0  #: camber [rad], > 0 with the top of the wheel to -y
    kappa: Any = 0.0  #: longitudinal slip -Vsx/Vx [-], -1 for a locked wheel in either direction
    phi_t: Any = (
        0.0  #: turn slip -psi_dot/Vc of the path rolled forwards [1/m]; -1/R with the centre to the left
    )
    Vx: Any = (
        None  #: speed of the contact [m/s]; default LONGVL; < 0 rolls backwards, forces stay fixed to the rig
    )
    pressure: Any = None  #: inflation pressure [Pa]; default INFLPRES


class Switches(NamedTuple):
    """Options of the model; each combination has a program of its own."""

    turn_slip: bool = False  #: spin acts (zeta factors); otherwise phi_t is ignored
    star: bool = False  #: tan(alpha) and sin(gamma) as inputs instead of the angles
    limits: bool = False  #: inputs held to the file's ranges and curvature factors to <= 1


PLAIN = Switches()


class Inputs(NamedTuple):
    """One operating condition as the formulae use it; every field a scalar or an array, all broadcasting together."""

    Fz: Any  #: vertical load inside the limits, > 0 [N]
    Fz_moment: Any  #: load used by the trail and residual torque, at least FZMIN with limits [N]
    kappa: Any  #: longitudinal slip [-]
    alpha: Any  #: sideslip as the formulae use it: the angle, or its tangent with ``star`` [rad, -]
    gamma: Any  #: camber as the formulae use it: the angle, or its sine with ``star`` [rad, -]
    sin_gamma: Any  #: [-]
    cos_alpha: Any  #: Vx / Vc [-]
    tan_alpha: Any  #: [-]
    phi_t: Any  #: turn slip -psi_dot / Vc [1/m]
    pressure: Any  #: for the rolling resistance [Pa]
    dfz: Any  #: (Fz - Fz0') / Fz0', 4.E2a [-]
    dpi: Any  #: (p - p0) / p0, 4.E2b [-]
    Fz0: Any  #: Fz0' = LFZO FNOMIN, 4.E1 [N]
    limits: bool  #: curvature factors held at <= 1


class WeightFactors(NamedTuple):
    """Factors of a weight of combined slip, cos(C arctan(B x - E (B x - arctan(B x)))) with the slip x shifted by S_H."""

    B: Any
    C: Any
    E: Any  #: before limits
    S_H: Any


def nominal_load(p):
    """Fz0' [N]; 4.E1."""
    return p.LFZO * p.FNOMIN  # 4.E1


def relative_load(p, Fz):
    """dfz [-]: load above the nominal one, over it; 4.E2a."""
    Fz0 = nominal_load(p)
    return (Fz - Fz0) / Fz0  # 4.E2a


def inputs(p, at: OperatingCondition, switches: Switches = PLAIN, Fz_moment=None) -> Inputs:
    """The normalised inputs; ``Fz_moment`` is the load [N] of trail and residual torque, by default that of the condition."""
    Fz, alpha, gamma, _, _, _, pressure = at
    pressure = p.INFLPRES if pressure is None else pressure
    return Inputs(
        Fz=Fz,
        Fz_moment=Fz if Fz_moment is None else Fz_moment,
        kappa=at.kappa,
        alpha=tan(alpha) if switches.star else alpha,  # 4.E3
        gamma=sin(gamma) if switches.star else gamma,  # 4.E4
        sin_gamma=sin(gamma),
        cos_alpha=cos(alpha),  # 4.E6
        tan_alpha=tan(alpha),
        phi_t=finite(at.phi_t),  # a wheel that turns on the spot has an infinite one
        pressure=pressure,
        dfz=relative_load(p, Fz),
        dpi=(pressure - p.NOMPRES) / p.NOMPRES,  # 4.E2b
        Fz0=nominal_load(p),
        limits=switches.limits,
    )


def effective_radius(p, Fz, kappa, Vx, dpi):
    """Effective rolling radius Re [m] at load Fz [N] and forward speed Vx [m/s]; A7.

    Re depends on the wheel's speed of rotation, which depends on Re: ``Re = a + b / Re**2``, solved by Newton's method
    (four steps reach rounding while b < a^3 / 2; ``b`` is the small centrifugal growth).
    """
    stiffness = p.VERTICAL_STIFFNESS * (1.0 + p.PFZ1 * dpi)
    load = Fz / p.FNOMIN
    deflection = p.FNOMIN / stiffness * (p.DREFF * arctan(p.BREFF * load) + p.FREFF * load)
    a = p.UNLOADED_RADIUS * p.Q_RE0 - deflection
    b = p.UNLOADED_RADIUS * p.Q_V1 * ((1.0 + kappa) * Vx * p.UNLOADED_RADIUS / p.LONGVL) ** 2
    Re = a + b / (a * a)
    for _ in range(4):
        square = Re * Re
        Re = Re * (a * square + 3.0 * b) / (square * Re + 2.0 * b)
    return Re


def camber_reduction(p, dfz):
    """Camber reduction factor eps_gamma [-]; 4.E90. Kept off 1, where the turn-slip stiffness would be infinite."""
    return 1.0 - away_from_zero(1.0 - p.PECP1 * (1.0 + p.PECP2 * dfz))


def total_spin(q: Inputs, eps_gamma, Re):
    """Total spin phi [1/m] of a rolling wheel: turn slip plus the reduced camber spin; 4.E76 in z-up axes."""
    omega_over_Vc = (1.0 + q.kappa) * q.cos_alpha / Re
    return q.phi_t - (1.0 - eps_gamma) * omega_over_Vc * q.sin_gamma
