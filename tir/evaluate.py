"""The public evaluation: shapes, limits and direction of rolling around the equations."""

from numbers import Real
from types import SimpleNamespace
from typing import Any

import numpy as np

from tir.constants import PRESSURE_RANGE, SMALLEST_LOAD
from tir.equations import forces, normalise, vertical
from tir.equations.elementary import select
from tir.equations.forces import Forces, State, Wheel
from tir.equations.normalise import OperatingCondition, Switches
from tir.errors import TirError
from tir.parameters import TABLE

CONICITY = tuple(row.name for row in TABLE if row.conicity)
DIVISORS = tuple(row.name for row in TABLE if row.divisor)
NEARLY_UNLOADED, NEARLY_FLAT = float(SMALLEST_LOAD), PRESSURE_RANGE[0]


def evaluate(
    p: Any, *inputs: Any, turn_slip: bool = False, star: bool = False, limits: bool = False, **more: Any
) -> tuple[Forces[Any], State[Any]]:
    """Evaluate MF 6.2 in steady state (ISO-W, SI, radians).

    Parameters
    ----------
    p : any object with the file's parameter names as attributes, e.g. ``tyre.p``
    inputs, more : those of an :class:`OperatingCondition`, in its order or by name; pressures below PRESSURE_RANGE count as its
        lower end in My, where QSY8 < 0 leads to infinity
    turn_slip, star, limits : see :class:`Switches`

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
    at = OperatingCondition(*inputs, **more)
    Vx, pressure = (
        default if x is None else x for x, default in ((at.Vx, p.LONGVL), (at.pressure, p.INFLPRES))
    )
    return unchecked(p, at._replace(Vx=Vx, pressure=pressure), Switches(turn_slip, star, limits))


def unchecked(p: Any, at: OperatingCondition, switches: Switches) -> tuple[Forces[Any], State[Any]]:
    """As :func:`evaluate`, all given, unchecked: a divisor that is 0 gives infinity, NaN or an ArithmeticError."""
    if isinstance(at.pressure, float | int):  # Python's own numbers raise at 0 ** -0.4, numpy's do not
        at = at._replace(pressure=np.float64(at.pressure))
    backwards = np.real(at.Vx) < 0.0
    return either_way(p, backwards, at, switches) if np.any(backwards) else forwards(p, at, switches)


def forwards(p: Any, at: OperatingCondition, switches: Switches) -> tuple[Forces[Any], State[Any]]:
    """The model of a wheel that rolls forwards, ``Vx`` >= 0."""
    unloaded = np.real(at.Fz) <= 0.0
    given = held = at._replace(Fz=select(unloaded, NEARLY_UNLOADED, at.Fz))
    Fz_moment = overturning = rolling = given.Fz
    if switches.limits:
        held = _held(p, given)
        Fz_moment, overturning, rolling = _loads_below_range(p, held.Fz, given.Fz)
    q = normalise.inputs(p, held, switches, Fz_moment)
    q = q._replace(pressure=select(np.real(held.pressure) < NEARLY_FLAT, NEARLY_FLAT, held.pressure))
    Re = normalise.effective_radius(p, given.Fz, given.kappa, given.Vx, q.dpi)
    wheel = Wheel(overturning, rolling, given.kappa, given.Vx, Re)
    out, state = forces.evaluate(p, q, wheel, switches.turn_slip)
    return Forces(*(select(unloaded, 0.0, f) for f in out)), state


def either_way(
    p: Any, backwards: Any, at: OperatingCondition, switches: Switches
) -> tuple[Forces[Any], State[Any]]:
    """The model for either direction: where ``backwards`` holds, in a frame turned by half a revolution about z.

    In that frame the wheel rolls forwards and is turned on its rim.
    """
    turned = select(backwards, -1.0, 1.0)
    ahead = at._replace(gamma=turned * at.gamma, phi_t=turned * at.phi_t, Vx=np.abs(at.Vx))
    out, state = forwards(turned_on_rim(p, turned), ahead, switches)
    out = out._replace(Fx=turned * out.Fx, Fy=turned * out.Fy, Mx=turned * out.Mx, My=turned * out.My)
    return out, state._replace(omega=turned * state.omega, phi=turned * state.phi)


def loaded_radius(p: Any, at: OperatingCondition, out: Forces[Any], state: State[Any]) -> Any:
    """Loaded radius [m] of a wheel with these forces and this state at an operating condition."""
    rim_speed = np.abs(state.omega) * p.UNLOADED_RADIUS / p.LONGVL
    dpi = at.pressure / p.NOMPRES - 1.0
    return vertical.loaded_radius(p, at.Fz, vertical.Rolling(out.Fx, out.Fy, at.gamma, rim_speed, dpi))


def turned_on_rim(p: Any, turned: Any) -> SimpleNamespace:
    """The parameters of the tyre as mounted: conicity terms times ``turned``, +1 as measured and -1 turned on its rim."""
    mirrored = SimpleNamespace(**vars(p))
    for name in CONICITY:
        setattr(mirrored, name, getattr(p, name) * turned)
    return mirrored


def zero_divisors(p: Any) -> list[str]:
    """Parameters by which some equation divides and that are 0."""
    return [name for name in DIVISORS if isinstance(value := getattr(p, name), Real) and value == 0.0]


def _held(p: Any, at: OperatingCondition) -> OperatingCondition:
    """The condition within the ranges of the file; a load below its range is not."""
    return at._replace(
        Fz=_clip(at.Fz, None, p.FZMAX),
        kappa=_clip(at.kappa, p.KPUMIN, p.KPUMAX),
        alpha=_clip(at.alpha, p.ALPMIN, p.ALPMAX),
        gamma=_clip(at.gamma, p.CAMMIN, p.CAMMAX),
        pressure=_clip(at.pressure, p.PRESMIN, p.PRESMAX),
    )


def _clip(x: Any, lower: Any, upper: Any) -> Any:
    if lower is not None:
        x = select(np.real(x) < lower, lower, x)
    return select(np.real(x) > upper, upper, x)


def _loads_below_range(p: Any, Fz: Any, Fz_given: Any) -> tuple[Any, Any, Any]:
    """Loads for Mz, Mx and My: below FZMIN these fall faster than the load, so that an unloaded wheel has no moment."""
    below = np.real(Fz) < p.FZMIN
    floor = select(p.FZMIN > 0.0, p.FZMIN, 1.0)
    Fz_moment = select(below, p.FZMIN, Fz)
    overturning = select(below, Fz * (Fz / floor) ** 2, Fz)
    rolling = select(below, Fz_given**2 / floor, Fz_given)
    return Fz_moment, overturning, rolling
