"""All six outputs, composed in the order of the source."""

from typing import Any, Generic, NamedTuple, TypeVar

from tir.equations import aligning, lateral, longitudinal, overturning, rolling, stiffness, turn_slip
from tir.equations.elementary import absolute
from tir.equations.normalise import Inputs, camber_reduction, total_spin

Value = TypeVar("Value")
"""Of a result: a float, an array, a number of another kind."""


class Forces(NamedTuple, Generic[Value]):
    """Forces [N] and moments [Nm] on the wheel in the contact frame W; scalars or arrays of the inputs' shape."""

    Fx: Value
    Fy: Value
    Fz: Value
    Mx: Value
    My: Value
    Mz: Value


class State(NamedTuple, Generic[Value]):
    """All other results of the model at the operating condition."""

    K_xk: Value  #: longitudinal slip stiffness [N]
    K_ya: Value  #: cornering stiffness at this load, camber, pressure and spin [N/rad], negative for a normal tyre
    K_yg0: Value  #: camber stiffness at zero camber, normal mode [N/rad], negative for a normal tyre
    mu_x: Value  #: longitudinal friction coefficient [-]
    mu_y: Value  #: lateral friction coefficient [-]
    sigma_x: Value  #: longitudinal relaxation length [m]
    sigma_y: Value  #: lateral relaxation length [m]
    Re: Value  #: effective rolling radius [m]
    omega: Value  #: speed of rotation [rad/s]
    trail: Value  #: pneumatic trail [m]
    residual_torque: Value  #: Mzr [Nm]
    S_Hy: Value  #: horizontal shift of the side-force curve [rad]
    S_Vy: Value  #: vertical shift of the side-force curve [N]
    eps_gamma: Value  #: camber reduction factor [-]
    phi: Value  #: total spin [1/m]
    S_Hyphi: Value  #: shift of the side-force curve by spin [rad]
    zeta0: Value  #: to zeta8: factors by which spin changes the Magic Formula [-]; 1 without turn slip
    zeta1: Value
    zeta2: Value
    zeta3: Value
    zeta4: Value
    zeta5: Value
    zeta6: Value
    zeta7: Value
    zeta8: Value


class Wheel(NamedTuple):
    """Inputs that limits leave unchanged, or change in another way than those of the Magic Formula."""

    overturning: Any  #: load for Mx [N]
    rolling: Any  #: load for My [N]
    kappa: Any  #: longitudinal slip [-]
    Vx: Any  #: speed [m/s], > 0
    Re: Any  #: effective rolling radius [m]


def evaluate(p, q: Inputs, wheel: Wheel, with_turn_slip: bool) -> tuple[Forces[Any], State[Any]]:
    """Steady-state MF 6.2 of a wheel that rolls forwards.

    Parameters
    ----------
    p : object with the parameter names of the file as attributes
    q : normalised inputs, inside the limits
    wheel : what the moments of overturning and rolling resistance and the speed of rotation take
    with_turn_slip : whether spin acts through the zeta factors (units digit 5 of USE_MODE)
    """
    K_xk = stiffness.longitudinal_slip_stiffness(p, q)
    K_yg0 = stiffness.camber_stiffness(p, q)
    mu_x = stiffness.longitudinal_friction(p, q)
    mu_y = stiffness.lateral_friction(p, q, q.gamma)
    K_ya0 = stiffness.cornering_stiffness(p, q, 0.0)
    eps_gamma = camber_reduction(p, q.dfz)

    spin = turn_slip.NO_SPIN
    if with_turn_slip:
        spin = turn_slip.spin(p, q, total_spin(q, eps_gamma, wheel.Re), eps_gamma, K_ya0, K_yg0)
    K_ya = stiffness.cornering_stiffness(p, q, q.gamma, spin.zeta3)

    G_xa = longitudinal.combined_weight(p, q)
    G_yk = lateral.combined_weight(p, q)
    side = lateral.pure(p, q, q.gamma, spin, stiffness.SideGrip(K_ya, K_yg0, mu_y))
    Fx = G_xa * longitudinal.pure(p, q, spin, K_xk, mu_x)  # 4.E50
    Fy = G_yk * side.Fy + lateral.longitudinal_shift(p, q, mu_y, spin.zeta2)  # 4.E58

    spin_torque = turn_slip.NO_SPIN_TORQUE
    if with_turn_slip:
        spin_torque = turn_slip.torque(p, q, spin.phi, eps_gamma, mu_y, G_yk)
    trail = aligning.trail(p, q, spin, K_xk, K_ya)
    Mzr = aligning.residual_torque(p, q, spin, spin_torque, side, K_xk)
    grip = stiffness.SideGrip(K_ya0, K_yg0, stiffness.lateral_friction(p, q, 0.0))
    upright = lateral.pure(p, q, 0.0, turn_slip.NO_SPIN, grip)
    Mz = -trail * G_yk * upright.Fy + Mzr + aligning.longitudinal_arm(p, q, Fy) * Fx  # 4.E71, 4.E74
    Mx = overturning.moment(p, q, wheel.overturning, Fy)
    My = rolling.moment(p, q, wheel.rolling, Fx, wheel.kappa, wheel.Vx)

    zeta4 = 1.0 + spin.shift - side.S_V_gamma / K_ya if with_turn_slip else 1.0  # 4.E84
    state = State(
        K_xk=K_xk, K_ya=K_ya, K_yg0=K_yg0, mu_x=mu_x, mu_y=mu_y,
        sigma_x=absolute(K_xk / carcass_stiffness(p.LONGITUDINAL_STIFFNESS, p.PCFX1, p.PCFX2, p.PCFX3, q)),
        sigma_y=absolute(K_ya / carcass_stiffness(p.LATERAL_STIFFNESS, p.PCFY1, p.PCFY2, p.PCFY3, q)),
        Re=wheel.Re, omega=(1.0 + wheel.kappa) * wheel.Vx / wheel.Re, trail=trail, residual_torque=Mzr,
        S_Hy=side.S_H, S_Vy=side.S_V, eps_gamma=eps_gamma, phi=spin.phi, S_Hyphi=spin.shift, zeta0=spin.zeta0, zeta1=spin.zeta1,
        zeta2=spin.zeta2, zeta3=spin.zeta3, zeta4=zeta4, zeta5=spin.zeta5, zeta6=spin.zeta6,
        zeta7=spin_torque.zeta7, zeta8=spin_torque.zeta8,
    )  # fmt: skip
    return Forces(Fx, Fy, q.Fz, Mx, My, Mz), state


def carcass_stiffness(nominal, linear, quadratic, pressure, q: Inputs):
    """Carcass stiffness [N/m] at the load and pressure; A8, A9. Its ratio to a slip stiffness is a relaxation length."""
    return nominal * (1.0 + linear * q.dfz + quadratic * q.dfz**2) * (1.0 + pressure * q.dpi)
