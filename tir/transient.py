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

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from tir.equations.forces import Forces, State
from tir.errors import TirError

if TYPE_CHECKING:
    from tir.tyre import Tyre

FULL_SLIDING = 3.0
"""Slip at which the whole contact slides, in units of friction times load over slip stiffness: a brush of parabolic pressure
(Pacejka, section 3.2.1)."""


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
    state = tyre.state(Fz, 0.0, gamma, 0.0, phi_t, Vx, p, turn_slip=turn_slip, limits=limits)
    lifted = np.asarray(Fz) <= 0.0
    slow = np.abs(Vx) < tyre["VXLOW"]
    with np.errstate(divide="ignore", invalid="ignore"):
        u = _dragged(contact.u, -np.asarray(Vsx), np.abs(Vx), state.sigma_x, dt)
        v = _dragged(contact.v, np.asarray(Vsy), np.abs(Vx), state.sigma_y, dt)
        u = np.where(slow, _no_growth(u, contact.u, _sliding(state.sigma_x, state.mu_x, Fz, state.K_xk)), u)
        v = np.where(slow, _no_growth(v, contact.v, _sliding(state.sigma_y, state.mu_y, Fz, state.K_ya)), v)
    after = Contact(_plain(np.where(lifted, 0.0, u)), _plain(np.where(lifted, 0.0, v)))
    slip = _slip(tyre, state, after, Vx, Vsx, Vsy, damping)
    return after, _at(tyre, slip, Fz, Vx, gamma, phi_t, p, turn_slip, limits)


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
    state = tyre.state(Fz, 0.0, gamma, 0.0, phi_t, Vx, p, turn_slip=turn_slip, limits=limits)
    slip = _slip(tyre, state, contact, Vx, Vsx, Vsy, damping)
    return _at(tyre, slip, Fz, Vx, gamma, phi_t, p, turn_slip, limits)


def _slip(
    tyre: Tyre, state: State, contact: Contact, Vx: Any, Vsx: Any, Vsy: Any, damping: float
) -> tuple[Any, Any]:
    """kappa' and alpha' [rad] of a deflected contact, damping included."""
    kappa, alpha = slips(state, contact, Vx)
    if damping:
        share = _way(Vx) * damping * _fading(Vx, tyre["VXLOW"])
        kappa = kappa - _ratio(share * np.asarray(Vsx), state.K_xk)
        alpha = np.arctan(np.tan(alpha) + _ratio(share * np.asarray(Vsy), np.abs(state.K_ya)))
    return kappa, alpha


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
    kappa, tan_alpha = _ratio(contact.u, state.sigma_x), _ratio(contact.v, state.sigma_y)
    return _plain(_way(Vx) * kappa), _plain(_way(Vx) * np.arctan(tan_alpha))


def _way(Vx: Any) -> Any:
    """-1 if the wheel rolls backwards, where slips are relative to the backward speed, else 1."""
    return np.where(np.asarray(Vx) < 0.0, -1.0, 1.0)


def _dragged(x: Any, speed: Any, rolling: Any, sigma: Any, dt: float) -> Any:
    """Exact solution of dx/dt + rolling/sigma x = speed after dt; x + speed dt where nothing rolls."""
    z = np.where(rolling > 0.0, rolling * dt / sigma, 0.0)
    mean = np.where(z > 0.0, -np.expm1(-z) / np.where(z > 0.0, z, 1.0), 1.0)
    time = sigma / rolling if np.isinf(dt) else dt * mean  # effective time for which the slip speed acts
    gone = np.where(speed == 0.0, 0.0, speed * time)
    # a contact without slip stiffness has no grip on the road, so no deflection
    return np.where(sigma == 0.0, 0.0, np.asarray(x) * np.exp(-z) + gone)


def _sliding(sigma: Any, mu: Any, Fz: Any, stiffness: Any) -> Any:
    stiffness = np.asarray(stiffness)
    return np.where(stiffness == 0.0, 0.0, np.abs(FULL_SLIDING * mu * np.asarray(Fz) * sigma / stiffness))


def _no_growth(x: Any, before: Any, limit: Any) -> Any:
    most = np.maximum(np.abs(before), limit)
    return np.clip(x, -most, most)


def _fading(Vx: Any, low: float) -> Any:
    """1 at standstill, 0 from ``low`` on, smooth between (Pacejka, chapter 7)."""
    return (
        np.where(np.abs(Vx) < low, 0.5 * (1.0 + np.cos(np.pi * np.asarray(Vx) / low)), 0.0)
        if low > 0.0
        else 0.0
    )


def _ratio(x: Any, sigma: Any) -> Any:
    sigma = np.asarray(sigma)
    return np.where(sigma > 0.0, np.asarray(x) / np.where(sigma > 0.0, sigma, 1.0), 0.0)


def _plain(x: Any) -> Any:
    """Scalars as floats, arrays unchanged."""
    return x if np.ndim(x) else float(x)
