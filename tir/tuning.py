"""What exported code has of a tyre: its switches, and what can be turned: scaling factors, temperature if its file has terms."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from tir.codegen.graph import PARAMETER, Graph
from tir.codegen.program import NUMBERS, Program, Switches, trace
from tir.errors import TirError
from tir.mode import warn_of_doubt
from tir.parameters import TABLE
from tir.record import TyreRecord
from tir.temperature import REFERENCE, factors_at, terms_of

TEMPERATURE = "T_degC"
FACTORS = {row.name: row.description for row in TABLE if row.scaling}


class Tunable(NamedTuple):
    """A number that the user of exported code may change."""

    name: str
    description: str  #: with the unit in brackets
    start: float  #: its value in the file


def exported(tyre: TyreRecord, turn_slip: bool | None, star: bool, limits: bool) -> Switches:
    """The switches of exported code; warns of doubtful coefficients of turn slip, and of a correction, which stays behind."""
    tyre.leave_correction("exported code")
    on = tyre.turn_slip if turn_slip is None else bool(turn_slip)
    if on:
        warn_of_doubt(tyre.values, tyre.present)
    return Switches(on, bool(star), bool(limits))


def tunables(tyre: TyreRecord) -> tuple[Tunable, ...]:
    """Everything that can be turned in the exported tyre, in the order of the file, the temperature last."""
    found = [Tunable(name, f"{text} [-]", float(tyre[name])) for name, text in FACTORS.items()]
    if terms_of(tyre):
        start = float(tyre.measured[REFERENCE].value)
        found.append(Tunable(TEMPERATURE, "temperature of the tread, by the terms of the file [degC]", start))
    return tuple(found)


def chosen(tyre: TyreRecord, names: Iterable[str]) -> tuple[Tunable, ...]:
    """The named ones. Raises TirError if a name cannot be turned."""
    known = {one.name: one for one in tunables(tyre)}
    for name in names:
        if name not in known:
            raise TirError(f"{name} cannot be turned in an exported tyre: use {', '.join(known)}", name=name)
    return tuple(known[name] for name in names)


def trace_tuned(
    tyre: TyreRecord, switches: Switches, outputs: tuple[str, ...], names: Iterable[str] | None = None
) -> Program:
    """The program of a tyre, in which the named tunables (default all) are symbols and every other value is a number."""
    free = {one.name for one in tunables(tyre)} if names is None else set(names)

    def warmed(p: dict[str, Any], graph: Graph) -> None:
        if TEMPERATURE in free:
            warm(tyre, p, graph)

    return trace(switches, outputs, {key: float(tyre[key]) for key in NUMBERS if key not in free}, warmed)


def warm(tyre: TyreRecord, p: dict[str, Any], graph: Graph) -> None:
    """Multiply scaling factors by the temperature terms of the tyre's file, with the temperature as a symbol."""
    terms = terms_of(tyre)
    if not terms:
        return
    warmer = graph.symbol(TEMPERATURE, PARAMETER) - tyre.measured[REFERENCE].value
    for name, factor in factors_at(terms, warmer).items():
        p[name] = p[name] * factor
