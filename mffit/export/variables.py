"""The variables of a functional mock-up unit: names, references, units, start values."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import NamedTuple

import tir
from tir.codegen.lag import LAG_INPUTS, LAG_TEXTS, LAGGING
from tir.codegen.program import INPUTS, ORDER, called
from tir.equations.forces import Forces
from tir.exporting import INPUT_TEXTS, OUTPUT_TEXTS, STATES, tunables

NAMES = {"Fz": "Fz_out"}
"""Outputs with another name than in C: the load is input and output."""


@dataclass(frozen=True, slots=True)
class Unit:
    """A unit as powers of SI units."""

    name: str
    powers: Mapping[str, int]
    shown: str = ""  #: unit for display
    factor: float = 1.0  #: number in the unit for display over the number in this unit
    offset: float = 0.0  #: SI value of zero in this unit


UNITS = {
    unit.name: unit
    for unit in (
        Unit("s", {"s": 1}),
        Unit("m", {"m": 1}),
        Unit("1/m", {"m": -1}),
        Unit("m/s", {"m": 1, "s": -1}),
        Unit("N", {"kg": 1, "m": 1, "s": -2}),
        Unit("Nm", {"kg": 1, "m": 2, "s": -2}),
        Unit("N/rad", {"kg": 1, "m": 1, "s": -2, "rad": -1}),
        Unit("Pa", {"kg": 1, "m": -1, "s": -2}, "kPa", 1e-3),
        Unit("rad", {"rad": 1}, "deg", math.degrees(1.0)),
        Unit("rad/s", {"rad": 1, "s": -1}),
        Unit("Ns/m", {"kg": 1, "s": -1}),
        Unit("degC", {"K": 1}, offset=273.15),
    )
}


@dataclass(frozen=True, slots=True)
class Variable:
    """An input, output or parameter."""

    name: str
    field: str  #: its name in C
    reference: int  #: value reference; 0 is time
    description: str
    unit: str  #: "" without one
    start: str = ""  #: as text for C and XML; not for outputs


class Interface(NamedTuple):
    """The variables of a tyre by their part, with references in this order."""

    inputs: tuple[Variable, ...]
    outputs: tuple[Variable, ...]
    parameters: tuple[Variable, ...]

    @classmethod
    def of(cls, tyre: tir.Tyre, *, transient: bool) -> Interface:
        """Inputs start as the nominal condition of the file, rolling straight, and parameters as in the file.

        ``transient``: slip speeds are inputs; the lagging slips and the deflections of the contact are outputs too.
        """
        starts = {"Fz": tyre["FNOMIN"], "Vx": tyre["LONGVL"], "pressure": tyre["INFLPRES"]}
        texts = {**INPUT_TEXTS, **OUTPUT_TEXTS, **LAG_TEXTS}
        given = LAG_INPUTS if transient else ORDER
        inputs = [(called(x), x, INPUT_TEXTS.get(x) or texts[x], starts.get(x, 0.0)) for x in given]
        found = [(NAMES.get(x, x), field, texts[x], None) for x, field in _outputs(transient).items()]
        turned = [(one.name, one.name, one.description, one.start) for one in tunables(tyre)]
        every = [_variable(k, *row) for k, row in enumerate([*inputs, *found, *turned], start=1)]
        first, last = len(inputs), len(inputs) + len(found)
        return cls(tuple(every[:first]), tuple(every[first:last]), tuple(every[last:]))


def _outputs(transient: bool) -> dict[str, str]:
    """By output its name in C: forces and moments on the wheel in the contact frame, and what simulations need besides."""
    if not transient:
        return {x: f"forces.{x}" for x in Forces._fields} | {x: f"state.{x}" for x in STATES}
    fields = {x: f"deflected.{x}" for x in (*Forces._fields, *STATES, "kappa", "alpha")}
    return fields | {x: f"(*s).{x}" for x in LAGGING}


def _variable(reference: int, name: str, field: str, text: str, start: float | None) -> Variable:
    """A variable from a text with its unit in brackets: 'sideslip angle [rad]'."""
    found = re.fullmatch(r"(.*?)\s*\[(.*?)\](.*)", text)
    assert found, f"{text!r} has no unit in brackets"
    unit = "" if found[2] == "-" else found[2]
    return Variable(
        name, field, reference, found[1] + found[3], unit, "" if start is None else repr(float(start))
    )


def units_of(variables: Iterable[Variable]) -> tuple[Unit, ...]:
    """The units of the variables, and that of time."""
    used = {"s", *(x.unit for x in variables)}
    return tuple(unit for unit in UNITS.values() if unit.name in used)


def arguments(variables: tuple[Variable, ...]) -> str:
    """The inputs as arguments of the C functions, from the array of values ``v``."""
    references = {x.field: x.reference for x in variables}
    order = INPUTS if set(INPUTS) <= set(references) else LAG_INPUTS
    return ", ".join(f"v[{references[name]}]" for name in order)
