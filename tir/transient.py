"""The lag of the contact: slip that builds up over the file's relaxation lengths, down to standstill.

The contact point is joined to the wheel by two springs, the carcass; it is dragged over the road and slips as in steady
state. With its deflections against the wheel, u forwards and v to the right [m]::

    du/dt + |Vx| / sigma_x u = -Vsx        kappa' = sgn(Vx) u / sigma_x
    dv/dt + |Vx| / sigma_y v =  Vsy        tan(alpha') = sgn(Vx) v / sigma_y

(H. B. Pacejka, Tire and Vehicle Dynamics, 3rd ed., section 7.2.1, equations 7.7 and 7.9, in the signs of this package.)
sigma_x and sigma_y are the slip stiffness over the carcass stiffness (A8, A9). At standstill du/dt = -Vsx, and a spring of
the carcass stiffness remains. Each step solves the equations exactly for speeds that are constant within it, so steps of any
length are stable.

Below VXLOW deflections do not grow beyond those at which the whole contact slides, ``3 mu Fz`` over the carcass stiffness: a
wheel pushed sideways at standstill slides, and springs back when it is released. It does not stick to the road: under a constant
push it creeps.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from tir.calls import lag_of
from tir.codegen.program import Switches
from tir.equations.forces import Forces
from tir.errors import TirError
from tir.tyre import Tyre

if TYPE_CHECKING:
    from tir.codegen.lag import ContactLag


class Contact(NamedTuple):
    """Deflection of the contact point; floats or arrays (n,). ``Contact()`` is at rest."""

    u: Any = 0.0  #: forwards [m]
    v: Any = 0.0  #: to the right [m]


def step(
    tyre: Tyre,
    contact: Contact,
    dt: float,
    Fz: Any,
    Vx: Any,
    Vsx: Any = 0.0,
    Vsy: Any = 0.0,
    gamma: Any = 0.0,
    phi_t: Any = None,
    p: Any = None,
    *,
    damping: float = 0.0,
    turn_slip: bool | None = None,
    limits: bool = False,
) -> tuple[Contact, Forces[Any]]:
    """The contact after ``dt``, and the forces there.

    Parameters
    ----------
    tyre : with the file's relaxation (LONGITUDINAL_STIFFNESS, LATERAL_STIFFNESS, PCFX1-3, PCFY1-3)
    contact : before the step
    dt : length of the step [s]; infinite gives the steady state
    Fz : load [N], float or (n,) as every input; without load the contact is lost and springs back
    Vx : speed of the contact along the wheel [m/s], < 0 rolls backwards
    Vsx : longitudinal slip speed Vx - Re omega [m/s]; kappa = -Vsx/Vx in steady state
    Vsy : lateral slip speed [m/s]; alpha = atan(Vsy/Vx) in steady state
    gamma : camber [rad]
    phi_t : turn slip [1/m], without lag
    p : inflation pressure [Pa], default INFLPRES
    damping : of the contact at standstill [Ns/m], which fades out towards VXLOW; without it a car that has stopped
        keeps oscillating on its carcass
    turn_slip, limits : as in a call of the tyre

    Returns
    -------
    Contact, Forces
        ISO-W, SI. In steady state the forces are those of ``tyre(Fz, alpha, gamma, kappa, ...)``.

    Raises
    ------
    TirError
        If ``dt`` is negative or NaN, or a parameter is not a real number.
    """
    if not dt >= 0.0:
        raise TirError(f"the step dt is {dt:g} s, but time only runs forwards: give 0 or more")
    lag, inputs = _lag(tyre, (Fz, Vx, Vsx, Vsy, gamma, phi_t, p, damping), turn_slip, limits)
    after = Contact(*lag.after(*contact, *inputs, dt))
    return after, _forces(lag, after, inputs)


def forces(
    tyre: Tyre,
    contact: Contact,
    Fz: Any,
    Vx: Any,
    Vsx: Any = 0.0,
    Vsy: Any = 0.0,
    gamma: Any = 0.0,
    phi_t: Any = None,
    p: Any = None,
    *,
    damping: float = 0.0,
    turn_slip: bool | None = None,
    limits: bool = False,
) -> Forces[Any]:
    """The forces [N] and moments [Nm] of a deflected contact; arguments as in :func:`step`."""
    lag, inputs = _lag(tyre, (Fz, Vx, Vsx, Vsy, gamma, phi_t, p, damping), turn_slip, limits)
    return _forces(lag, contact, inputs)


def _lag(
    tyre: Tyre, given: tuple[Any, ...], turn_slip: bool | None, limits: bool
) -> tuple[ContactLag, tuple[Any, ...]]:
    """The functions of the tyre's lag, and their inputs without the deflection."""
    *moving, phi_t, p, damping = given
    lag = lag_of(tyre, Switches(tyre.turns(turn_slip, phi_t), False, bool(limits)))
    return lag, (*moving, 0.0 if phi_t is None else phi_t, tyre["INFLPRES"] if p is None else p, damping)


def _forces(lag: ContactLag, contact: Contact, inputs: tuple[Any, ...]) -> Forces[Any]:
    return Forces(*lag.deflected(*contact, *inputs)[: len(Forces._fields)])
