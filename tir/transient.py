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
from tir.equations.forces import Forces
from tir.errors import TirError
from tir.tyre import Tyre

if TYPE_CHECKING:
    from tir.codegen.lag import ContactLag


class Contact(NamedTuple):
    """Deflection of the contact point; floats or arrays (n,). ``Contact()`` is at rest."""

    u: Any = 0.0  #: forwards [m]
    v: Any = 0.0  #: to the right [m]


class ContactInputs(NamedTuple):
    """Motion, load and pressure of the wheel, ISO-W; floats or arrays (n,)."""

    Fz: Any  #: load [N]; without load the contact is lost and springs back
    Vx: Any  #: speed of the contact along the wheel [m/s], < 0 rolls backwards
    Vsx: Any = 0.0  #: longitudinal slip speed Vx - Re omega [m/s]; kappa = -Vsx/Vx in steady state
    Vsy: Any = 0.0  #: lateral slip speed [m/s]; alpha = atan(Vsy/Vx) in steady state
    gamma: Any = 0.0  #: camber [rad]
    phi_t: Any = None  #: turn slip [1/m], without lag
    p: Any = None  #: inflation pressure [Pa], default INFLPRES
    damping: Any = 0.0
    """Of the contact at standstill [Ns/m], fading out towards VXLOW; without it a car that has stopped keeps oscillating on its
    carcass."""


def step(
    tyre: Tyre,
    contact: Contact,
    dt: float,
    *inputs: Any,
    turn_slip: bool | None = None,
    limits: bool = False,
    **more: Any,
) -> tuple[Contact, Forces[Any]]:
    """The contact after ``dt``, and the forces there.

    Parameters
    ----------
    tyre : with the file's relaxation (LONGITUDINAL_STIFFNESS, LATERAL_STIFFNESS, PCFX1-3, PCFY1-3)
    contact : before the step
    dt : length of the step [s]; infinite gives the steady state
    inputs, more : Fz, Vx, Vsx, Vsy, gamma, phi_t, p, damping, in this order or by name, see :class:`ContactInputs`
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
    lag, known = _lag(tyre, ContactInputs(*inputs, **more), turn_slip, limits)
    after = Contact(*lag.after(*contact, *known, dt))
    return after, _forces(lag, known, after)


def forces(
    tyre: Tyre,
    contact: Contact,
    *inputs: Any,
    turn_slip: bool | None = None,
    limits: bool = False,
    **more: Any,
) -> Forces[Any]:
    """The forces [N] and moments [Nm] of a deflected contact; arguments as in :func:`step`."""
    return _forces(*_lag(tyre, ContactInputs(*inputs, **more), turn_slip, limits), contact)


def _lag(
    tyre: Tyre, given: ContactInputs, turn_slip: bool | None, limits: bool
) -> tuple[ContactLag, ContactInputs]:
    """The functions of the tyre's lag, and their inputs without the deflection."""
    switches = tyre.switches(given.phi_t, turn_slip=turn_slip, limits=limits)
    if turn_slip is None:
        switches = switches._replace(turn_slip=switches.turn_slip and tyre.may_turn)
    if given.phi_t is None:
        given = given._replace(phi_t=0.0)
    if given.p is None:
        given = given._replace(p=tyre["INFLPRES"])
    return lag_of(tyre, switches), given


def _forces(lag: ContactLag, inputs: ContactInputs, contact: Contact) -> Forces[Any]:
    return Forces(*lag.deflected(*contact, *inputs)[: len(Forces._fields)])
