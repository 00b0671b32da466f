"""The variables of a functional mock-up unit: names, references, units, start values."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

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


def inputs(tyre: tir.Tyre, *, transient: bool = False) -> tuple[Variable, ...]:
    """The operating condition; it starts as the nominal one of the file, rolling straight. ``transient``: with slip speeds."""
    starts = {"Fz": tyre["FNOMIN"], "Vx": tyre["LONGVL"], "pressure": tyre["INFLPRES"]}
    texts = {**INPUT_TEXTS, **LAG_TEXTS}
    out = []
    for reference, field in enumerate(LAG_INPUTS if transient else ORDER, start=1):
        description, unit = _described(texts[field])
        start = repr(float(starts.get(field, 0.0)))
        out.append(
            Variable(
                name=called(field),
                field=field,
                reference=reference,
                description=description,
                unit=unit,
                start=start,
            )
        )
    return tuple(out)


def outputs(*, transient: bool = False) -> tuple[Variable, ...]:
    """Forces and moments on the wheel in the contact frame, and further results for simulations.

    ``transient``: the lagging slips and the deflections of the contact too.
    """
    fields = [("forces", name) for name in Forces._fields] + [("state", name) for name in STATES]
    if transient:
        fields = [("deflected", name) for _, name in fields] + [
            ("deflected", name) for name in ("kappa", "alpha")
        ]
        fields += [("(*s)", name) for name in LAGGING]
    texts = {**OUTPUT_TEXTS, **LAG_TEXTS}
    out = []
    for reference, (record, field) in enumerate(fields, start=1 + len(LAG_INPUTS if transient else INPUTS)):
        description, unit = _described(texts[field])
        out.append(
            Variable(
                name=NAMES.get(field, field),
                field=f"{record}.{field}",
                reference=reference,
                description=description,
                unit=unit,
            )
        )
    return tuple(out)


def parameters(tyre: tir.Tyre, *, transient: bool = False) -> tuple[Variable, ...]:
    """What can be turned: scaling factors, and the temperature if the file has terms for it; they start as in the file."""
    first = 1 + len(LAG_INPUTS if transient else INPUTS) + len(outputs(transient=transient))
    out = []
    for reference, one in enumerate(tunables(tyre), start=first):
        description, unit = _described(one.description)
        out.append(Variable(one.name, one.name, reference, description, unit, repr(one.start)))
    return tuple(out)


def units_of(variables: Iterable[Variable]) -> tuple[Unit, ...]:
    """The units of the variables, and that of time."""
    used = {"s", *(x.unit for x in variables)}
    return tuple(unit for unit in UNITS.values() if unit.name in used)


def arguments(variables: tuple[Variable, ...]) -> str:
    """The inputs as arguments of the C functions, from the array of values ``v``."""
    references = {x.field: x.reference for x in variables}
    order = INPUTS if set(INPUTS) <= set(references) else LAG_INPUTS
    return ", ".join(f"v[{references[name]}]" for name in order)


def _described(text: str) -> tuple[str, str]:
    """Words and unit of a text with a unit in brackets: 'sideslip angle [rad]'."""
    found = re.fullmatch(r"(.*?)\s*\[(.*?)\](.*)", text)
    assert found, f"{text!r} has no unit in brackets"
    return found[1] + found[3], "" if found[2] == "-" else found[2]
