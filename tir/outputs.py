"""Some outputs of the equations, plain or with exact derivatives, without computing the others."""

from collections.abc import Iterable, Mapping
from typing import Any

from tir.codegen.program import INPUTS, Switches, refuse_zero_divisors
from tir.codegen.replay import replay
from tir.derivatives import Traced, plain
from tir.equations.forces import Forces, State
from tir.errors import TirError


def outputs_of(
    names: tuple[str, ...], p: Any, inputs: Mapping[str, Any], *, turn_slip: bool = False, star: bool = False
) -> list[Any]:
    """Forces or states by name, equal to those of :func:`tir.evaluate.evaluate`; not for complex numbers.

    ``p`` has the file's parameter names as attributes: floats, arrays (n,) or :class:`~tir.derivatives.Traced`. ``inputs`` are
    some of :data:`~tir.codegen.program.INPUTS`, SI and radians, scalar or (n,), real or traced; missing slips and angles are 0,
    Vx is LONGVL and pressure INFLPRES. Each result has the broadcast shape, or is Traced if it depends on a traced number.

    Raises TirError if a value by which the equations divide is 0, a name is unknown, or the load is missing.
    """
    _known(names, Forces._fields + State._fields, "output")
    _known(inputs, INPUTS, "input")
    if "Fz" not in inputs:
        raise TirError("the load Fz is missing among the inputs; give it")
    switches = Switches(turn_slip, star)
    refuse_zero_divisors(p, switches, names)
    given = {"Vx": p.LONGVL, "pressure": p.INFLPRES, **inputs}
    still = tuple(name for name in INPUTS if name not in given)
    every = {**vars(p), **given}
    leaves = {name: x for name, x in every.items() if type(x) is Traced}
    run = replay(switches, names, tuple(leaves), still)
    found = run({name: x if type(x := every[name]) is float else _real(plain(x)) for name in run.symbols})
    if not leaves:
        return found
    tape, k = next(iter(leaves.values())).tape, len(leaves)
    slopes = [found[i : i + k] for i in range(len(names), len(found), k)]
    return [
        Traced(value, tape, tuple(zip(leaves.values(), row, strict=True)))
        for value, row in zip(found[: len(names)], slopes, strict=True)
    ]


def _known(names: Iterable[str], among: tuple[str, ...], what: str) -> None:
    if isinstance(names, str):
        raise TirError(f"{names!r} is a text where a tuple of {what} names was expected; write ({names!r},)")
    for name in names:
        if name not in among:
            raise TirError(f"{name} is not an {what}; use {', '.join(among)}", name=name)


def _real(x: Any) -> Any:
    """The number, integers as floats because numpy has no negative powers of integers."""
    return float(x) if isinstance(x, int) else x
