"""The lag of the contact: slip that builds up over the file's relaxation lengths, down to standstill.

The contact point is joined to the wheel by two springs, the carcass; it is dragged over the road and slips as in steady
state. With its deflections against the wheel, u forwards and v to the right [m]::

    du/dt + |Vx| / sigma_x u = -Vsx        kappa' = sgn(Vx) u / sigma_x
    dv/dt + |Vx| / sigma_y v =  Vsy        tan(alpha') = sgn(Vx) v / sigma_y

(H. B. Pacejka, Tire and Vehicle Dynamics, 3rd ed., section 7.2.1, equations 7.7 and 7.9, in the signs of this package.)
sigma_x and sigma_y are the slip stiffness over the carcass stiffness (A8, A9). At standstill du/dt = -Vsx, and a spring of
the carcass stiffness remains. Each step solves the equations exactly for speeds that are constant within it, so steps of any
length are stable.
"""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from tir.calls import OF_CONTACT, lag_of, some_of
from tir.codegen.cpython import SCALARS
from tir.codegen.program import Switches
from tir.equations import contact as equations
from tir.equations.forces import Forces, State
from tir.errors import TirError
from tir.tyre import Tyre


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
) -> tuple[Contact, Forces]:
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
        oscillates on its carcass for ever
    turn_slip, limits : as in a call of the tyre

    Returns
    -------
    Contact, Forces
        ISO-W, SI. In steady state the forces are those of ``tyre(Fz, alpha, gamma, kappa, ...)``.

    Raises
    ------
    TirError
        If ``dt`` is negative or NaN.

    Notes
    -----
    Below VXLOW deflections do not grow beyond those at which the whole contact slides, ``3 mu Fz`` over the carcass stiffness:
    a wheel pushed sideways at standstill slides, and springs back when it is released. It does not stick to the road: under a
    constant push it creeps.
    """
    if not dt >= 0.0:
        raise TirError(f"the step dt is {dt:g} s, but time only runs forwards: give 0 or more")
    quick = _in_floats(tyre, contact, dt, (Fz, Vx, Vsx, Vsy, gamma, phi_t, p, damping), turn_slip, limits)
    if quick is not None:
        return quick
    state = _state(tyre, Fz, Vx, gamma, phi_t, p, turn_slip, limits)
    before = equations.Deflection(*map(np.asarray, contact))
    load, ahead, along, across = (np.asarray(x, dtype=float) for x in (Fz, Vx, Vsx, Vsy))
    with np.errstate(all="ignore"):
        moved = equations.after(tyre.p, state, before, dt, load, ahead, along, across)
    after = Contact(*map(_plain, moved))
    slip = _slip(tyre, state, after, Vx, Vsx, Vsy, damping)
    return after, _at(tyre, slip, Fz, Vx, gamma, phi_t, p, turn_slip, limits)


def _in_floats(
    tyre: Tyre, contact: Contact, dt: float, given: tuple[Any, ...], turn_slip: bool | None, limits: bool
) -> tuple[Contact, Forces] | None:
    """The step by straight-line code if every input is a single number and nothing is infinite; else None."""
    Fz, Vx, Vsx, Vsy, gamma, phi_t, p, damping = given
    on = tyre.turns(turn_slip, phi_t)
    phi_t = 0.0 if phi_t is None else phi_t
    p = tyre["INFLPRES"] if p is None else p
    inputs = (*contact, Fz, Vx, Vsx, Vsy, gamma, phi_t, p, damping)
    if not SCALARS.issuperset(map(type, inputs)):
        return None
    functions = lag_of(tyre, Switches(on, False, bool(limits)))
    if functions is None:
        return None
    try:
        after = Contact(*functions[0](*map(float, inputs), float(dt)))
        return after, Forces(*functions[1](*after, *map(float, inputs[2:]))[: len(Forces._fields)])
    except (ArithmeticError, ValueError):
        return None


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
) -> Forces:
    """The forces of a deflected contact; arguments as in :func:`step`."""
    state = _state(tyre, Fz, Vx, gamma, phi_t, p, turn_slip, limits)
    slip = _slip(tyre, state, contact, Vx, Vsx, Vsy, damping)
    return _at(tyre, slip, Fz, Vx, gamma, phi_t, p, turn_slip, limits)


def _state(
    tyre: Tyre, Fz: Any, Vx: Any, gamma: Any, phi_t: Any, p: Any, turn_slip: bool | None, limits: bool
) -> SimpleNamespace:
    """What the contact needs of the state without slip."""
    switches = Switches(tyre.turns(turn_slip, phi_t), False, bool(limits))
    inputs = (
        Fz, 0.0, gamma, 0.0, 0.0 if phi_t is None else phi_t, Vx, tyre["INFLPRES"] if p is None else p
    )  # fmt: skip
    return SimpleNamespace(**dict(zip(OF_CONTACT, some_of(tyre, inputs, switches, OF_CONTACT), strict=True)))


def _slip(
    tyre: Tyre, state: SimpleNamespace, contact: Contact, Vx: Any, Vsx: Any, Vsy: Any, damping: float
) -> tuple[Any, Any]:
    """kappa' and alpha' [rad] of a deflected contact, damping included."""
    deflection = equations.Deflection(*map(np.asarray, contact))
    Vx, Vsx, Vsy = (np.asarray(x, dtype=float) for x in (Vx, Vsx, Vsy))
    with np.errstate(all="ignore"):
        kappa, alpha = equations.slips(tyre.p, state, deflection, Vx, Vsx, Vsy, damping)
    return _plain(kappa), _plain(alpha)


def _at(
    tyre: Tyre,
    slip: tuple[Any, Any],
    Fz: Any,
    Vx: Any,
    gamma: Any,
    phi_t: Any,
    p: Any,
    turn_slip: bool | None,
    limits: bool,
) -> Forces:
    kappa, alpha = slip
    return tyre(Fz, _plain(alpha), gamma, _plain(kappa), phi_t, Vx, p, turn_slip=turn_slip, limits=limits)


def slips(state: State, contact: Contact, Vx: Any) -> tuple[Any, Any]:
    """kappa' and alpha' [rad] of a deflected contact with the relaxation lengths of ``state``; 0 where those are 0."""
    deflection = equations.Deflection(*map(np.asarray, contact))
    kappa, alpha = equations.slips(
        SimpleNamespace(VXLOW=0.0), state, deflection, np.asarray(Vx, dtype=float), 0.0, 0.0, 0.0
    )
    return _plain(kappa), _plain(alpha)


def _plain(x: Any) -> Any:
    """Scalars as floats, arrays unchanged."""
    return x if np.ndim(x) else float(x)
