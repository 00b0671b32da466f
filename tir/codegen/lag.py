"""The tyre with the lag of its contact as programs: the deflection after a step, and the forces of a deflection."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache, partial
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from tir.codegen.cpython import SCALARS
from tir.codegen.graph import INPUT, Graph
from tir.codegen.program import INPUTS, Parameters, Program, Switches, program_of, symbols_of
from tir.codegen.replay import Replay, replayed
from tir.codegen.single import Run, compiled, constants, with_defaults
from tir.equations import contact
from tir.equations.normalise import OperatingCondition
from tir.evaluate import either_way
from tir.inputs import arrays_of

LAG_INPUTS = ("Fz", "Vx", "Vsx", "Vsy", "gamma", "phi_t", "pressure", "damping")
LAG_TEXTS = {
    "Vsx": "longitudinal slip speed Vx - Re omega [m/s]",
    "Vsy": "lateral slip speed [m/s]",
    "damping": "damping of the contact at standstill, fading out towards VXLOW [Ns/m]",
    "u": "deflection of the contact forwards [m]",
    "v": "deflection of the contact to the right [m]",
    "kappa": "lagging longitudinal slip [-]",
    "alpha": "lagging sideslip angle [rad]",
}
LAGGING = ("u", "v")


class ContactLag(NamedTuple):
    """The programs of :func:`lag_programs` for a tyre, as functions of (u, v, *LAG_INPUTS): single numbers, or arrays."""

    after: Callable[..., tuple[Any, ...]]  #: takes dt behind them
    deflected: Callable[..., tuple[Any, ...]]  #: gives forces and the lagging slips


def lag_functions(values: Mapping[str, float], switches: Switches) -> ContactLag:
    """The lag of a tyre with these parameters."""
    functions = []
    for names, prepare, run, in_numpy in _compiled(switches):
        quick = with_defaults(run, constants(prepare, values))
        functions.append(partial(_run, quick, partial(_in_numpy, in_numpy, values, names)))
    return ContactLag(*functions)


@cache
def _compiled(switches: Switches) -> list[tuple[tuple[str, ...], Any, Any, Replay]]:
    """Names of the inputs, straight-line code to prepare and to run, and the same for numpy, of both functions."""
    out = []
    for program, more in zip(lag_programs(symbols_of, switches), (("dt",), ()), strict=True):
        names = (*LAGGING, *LAG_INPUTS, *more)
        out.append((names, *compiled(program, names), replayed([*program.outputs.values()])))
    return out


def _run(quick: Run, otherwise: Run, *given: Any) -> tuple[Any, ...]:
    """In Python's floats if every input is a single number and nothing is infinite."""
    if SCALARS.issuperset(map(type, given)):
        try:
            return quick(*map(float, given))
        except (ArithmeticError, ValueError):
            pass
    return otherwise(*given)


def _in_numpy(run: Replay, values: Mapping[str, float], names: Sequence[str], *given: Any) -> tuple[Any, ...]:
    inputs = [np.asarray(x, dtype=float)[()] for x in arrays_of(given, names)]
    found = run({**values, **dict(zip(names, inputs, strict=True))})
    shape = np.broadcast_shapes(*map(np.shape, inputs))
    return tuple(np.broadcast_to(x, shape).copy() if shape else float(x) for x in found)


def lag_programs(
    parameters_on: Parameters, switches: Switches, states: Sequence[str] = ()
) -> tuple[Program, Program]:
    """The deflection after a step ``dt``; and forces, ``states`` and the lagging slips of a deflection.

    Inputs are LAG_INPUTS, the deflection u and v, and for the step ``dt`` [s].
    """
    graph = Graph()
    parameters = SimpleNamespace(**parameters_on(graph))
    given = {name: graph.symbol(name, INPUT) for name in (*LAG_INPUTS, *LAGGING, "dt")}
    motion = contact.Motion(*(given[name] for name in contact.Motion._fields))
    deflection = contact.Deflection(*(given[name] for name in LAGGING))
    backwards = motion.Vx < 0.0
    rolling = OperatingCondition(**{name: given[name] for name in INPUTS if name in given})
    _, state = either_way(parameters, backwards, rolling, switches)
    moved = contact.after(parameters, state, deflection, given["dt"], motion)
    kappa, alpha = contact.slips(parameters, state, deflection, motion, given["damping"])
    slipping = rolling._replace(alpha=alpha, kappa=kappa)
    forces, here = either_way(parameters, backwards, slipping, switches)
    outputs = {**forces._asdict(), **{name: getattr(here, name) for name in states}}
    return program_of(moved._asdict()), program_of({**outputs, "kappa": kappa, "alpha": alpha})
