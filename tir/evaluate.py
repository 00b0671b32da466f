"""The public evaluation: shapes, limits and direction of rolling around the equations."""

from __future__ import annotations

from numbers import Real
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from tir.constants import PRESSURE_RANGE, SMALLEST_LOAD
from tir.equations import forces, normalise, vertical
from tir.equations.elementary import select
from tir.equations.forces import Forces, Loads, State
from tir.errors import TirError
from tir.parameters import TABLE

CONICITY = tuple(row.name for row in TABLE if row.conicity)
DIVISORS = tuple(row.name for row in TABLE if row.divisor)
NEARLY_UNLOADED, NEARLY_FLAT = float(SMALLEST_LOAD), PRESSURE_RANGE[0]


class OperatingCondition(NamedTuple):
    """The inputs of the model, SI and radians, as :func:`evaluate` explains them; scalars or arrays that broadcast."""

    Fz: Any
    alpha: Any
    gamma: Any
    kappa: Any
    phi_t: Any
    Vx: Any
    pressure: Any


class Switches(NamedTuple):
    """Options of the model; each combination has a program of its own."""

    turn_slip: bool = False
    star: bool = False
    limits: bool = False


def evaluate(
    p: Any,
    Fz: Any,
    alpha: Any = 0.0,
    gamma: Any = 0.0,
    kappa: Any = 0.0,
    phi_t: Any = 0.0,
    Vx: Any = None,
    pressure: Any = None,
    *,
    turn_slip: bool = False,
    star: bool = False,
    limits: bool = False,
) -> tuple[Forces, State]:
    """Evaluate MF 6.2 in steady state (ISO-W, SI, radians).

    Parameters
    ----------
    p : any object with the file's parameter names as attributes, e.g. ``tyre.p``
    Fz : vertical load [N], scalar or (n,); loads <= 0 give zero forces, NaN gives NaN
    alpha : sideslip angle atan(Vsy/Vx) [rad]; rolling backwards it stays the reading of the rig's axis
    gamma : camber [rad], > 0 with the top of the wheel to -y
    kappa : longitudinal slip -Vsx/Vx [-], -1 for a locked wheel in either direction
    phi_t : turn slip -psi_dot/Vc of the path rolled forwards [1/m]; -1/R with the centre to the left
    Vx : speed of the contact [m/s]; default LONGVL; < 0 rolls backwards, forces stay fixed to the rig
    pressure : inflation pressure [Pa]; default INFLPRES; in My not below PRESSURE_RANGE, where QSY8 < 0 leads to infinity
    turn_slip : let spin act (zeta factors); otherwise phi_t is ignored
    star : tan(alpha) and sin(gamma) as inputs instead of the angles
    limits : hold the inputs to the file's ranges and the curvature factors to <= 1

    Returns
    -------
    Forces, State
        Fields of the broadcast shape (forces) or of any shape that broadcasts to it (state).

    Raises
    ------
    TirError
        If a value by which the equations divide is 0.
    """
    for name in zero_divisors(p):
        raise TirError(f"{name} is 0, but the equations divide by it: give its value", name=name)
    Vx = p.LONGVL if Vx is None else Vx
    pressure = p.INFLPRES if pressure is None else pressure
    at = OperatingCondition(Fz, alpha, gamma, kappa, phi_t, Vx, pressure)
    return unchecked(p, at, Switches(turn_slip, star, limits))


def unchecked(p: Any, at: OperatingCondition, switches: Switches) -> tuple[Forces, State]:
    """As :func:`evaluate`, all given; what divides by a parameter that is 0 is infinite, NaN or an ArithmeticError."""
    if isinstance(at.pressure, float | int):  # Python's own numbers raise at 0 ** -0.4, numpy's do not
        at = at._replace(pressure=np.float64(at.pressure))
    backwards = np.real(at.Vx) < 0.0
    return either_way(p, backwards, at, switches) if np.any(backwards) else forwards(p, at, switches)


def forwards(p: Any, at: OperatingCondition, switches: Switches) -> tuple[Forces, State]:
    """The model of a wheel that rolls forwards, ``Vx`` >= 0."""
    Fz, alpha, gamma, kappa, phi_t, Vx, pressure = at
    turn_slip, star, limits = switches
    unloaded = np.real(Fz) <= 0.0
    Fz_given, kappa_given = select(unloaded, NEARLY_UNLOADED, Fz), kappa
    Fz, Fz_moment, loads = Fz_given, Fz_given, Loads(Fz_given, Fz_given)
    if limits:
        Fz = _clip(Fz_given, None, p.FZMAX)
        kappa = _clip(kappa, p.KPUMIN, p.KPUMAX)
        alpha = _clip(alpha, p.ALPMIN, p.ALPMAX)
        gamma = _clip(gamma, p.CAMMIN, p.CAMMAX)
        pressure = _clip(pressure, p.PRESMIN, p.PRESMAX)
        Fz_moment, loads = _loads_below_range(p, Fz, Fz_given)
    q = normalise.inputs(p, Fz, Fz_moment, kappa, alpha, gamma, phi_t, pressure, star, limits)
    q = q._replace(pressure=select(np.real(pressure) < NEARLY_FLAT, NEARLY_FLAT, pressure))
    Re = normalise.effective_radius(p, Fz_given, kappa_given, Vx, q.dpi)
    out, state = forces.evaluate(p, q, loads, kappa_given, Vx, Re, turn_slip)
    return Forces(*(select(unloaded, 0.0, f) for f in out)), state


def either_way(p: Any, backwards: Any, at: OperatingCondition, switches: Switches) -> tuple[Forces, State]:
    """The model for either direction: where ``backwards`` holds, in a frame turned by half a revolution about z.

    In that frame the wheel rolls forwards and is turned on its rim.
    """
    turned = select(backwards, -1.0, 1.0)
    ahead = at._replace(gamma=turned * at.gamma, phi_t=turned * at.phi_t, Vx=np.abs(at.Vx))
    out, state = forwards(turned_on_rim(p, turned), ahead, switches)
    out = out._replace(Fx=turned * out.Fx, Fy=turned * out.Fy, Mx=turned * out.Mx, My=turned * out.My)
    return out, state._replace(omega=turned * state.omega, phi=turned * state.phi)


def loaded_radius(p: Any, at: OperatingCondition, out: Forces, state: State) -> Any:
    """Loaded radius [m] of a wheel with these forces and this state at an operating condition."""
    rim_speed = np.abs(state.omega) * p.UNLOADED_RADIUS / p.LONGVL
    dpi = at.pressure / p.NOMPRES - 1.0
    return vertical.loaded_radius(p, at.Fz, out.Fx, out.Fy, at.gamma, rim_speed, dpi)


def turned_on_rim(p: Any, turned: Any) -> SimpleNamespace:
    """The parameters of the tyre as mounted: conicity terms times ``turned``, +1 as measured and -1 turned on its rim."""
    mirrored = SimpleNamespace(**vars(p))
    for name in CONICITY:
        setattr(mirrored, name, getattr(p, name) * turned)
    return mirrored


def zero_divisors(p: Any) -> list[str]:
    """Parameters by which some equation divides and that are 0."""
    return [name for name in DIVISORS if isinstance(value := getattr(p, name), Real) and value == 0.0]


def _clip(x: Any, lower: Any, upper: Any) -> Any:
    if lower is not None:
        x = select(np.real(x) < lower, lower, x)
    return select(np.real(x) > upper, upper, x)


def _loads_below_range(p: Any, Fz: Any, Fz_given: Any) -> tuple[Any, Loads]:
    """Loads for the moments: below FZMIN these fall faster than the load, so that an unloaded wheel has no moment."""
    below = np.real(Fz) < p.FZMIN
    floor = select(p.FZMIN > 0.0, p.FZMIN, 1.0)
    Fz_moment = select(below, p.FZMIN, Fz)
    overturning = select(below, Fz * (Fz / floor) ** 2, Fz)
    rolling = select(below, Fz_given**2 / floor, Fz_given)
    return Fz_moment, Loads(overturning, rolling)
