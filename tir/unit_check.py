"""Units in a file's [UNITS] that its values contradict: a program wrote the word of one unit and the numbers of another."""

from collections.abc import Mapping
from dataclasses import replace
from types import MappingProxyType
from typing import TypeVar

from tir import constants
from tir.defaults import completed
from tir.errors import Problem, listed
from tir.parameters import BY_NAME
from tir.properties import units_of
from tir.record import TyreRecord
from tir.units import KINDS, SI, factor

AnyTyre = TypeVar("AnyTyre", bound=TyreRecord)
LENGTHS = ("meter", "cm", "mm", "inch")
ANGLE_LIMITS = ("ALPMIN", "ALPMAX", "CAMMIN", "CAMMAX")


def in_fitting_units(tyre: AnyTyre) -> tuple[AnyTyre, list[Problem]]:
    """The tyre as its numbers read in the units that fit them, and a problem for each unit of its file that they contradict.

    The tyre itself if none does: other problems of its values are then its own, and not those of a unit.
    """
    words = {} if tyre.document is None else units_of(tyre.document, [])
    stated = {kind: word for kind, word in words.items() if KINDS[kind][word] != 1.0}
    problems = []
    for kind, search in (("LENGTH", _length), ("ANGLE", _angle)):
        found = search(tyre, words) if kind in stated else None
        if found is not None:
            problems.append(found[0])
            words = words | {kind: found[1]}
            tyre = _reread(tyre, words | {kind: stated[kind]}, words)
    return tyre, problems


def _length(tyre: TyreRecord, words: Mapping[str, str]) -> tuple[Problem, str] | None:
    """The problem of a length in which the radius is that of no tyre, and the unit in which radius and pressures fit."""
    ranges = {"UNLOADED_RADIUS": constants.LENGTH_RANGE}
    if "PRESSURE" not in words:
        ranges |= dict.fromkeys(("NOMPRES", "INFLPRES"), constants.PRESSURE_RANGE)
    seen = {name: limits for name, limits in ranges.items() if name in tyre.present}
    smallest, largest = constants.LENGTH_RANGE
    if "UNLOADED_RADIUS" not in seen or smallest < tyre["UNLOADED_RADIUS"] < largest:
        return None
    for word in LENGTHS:
        other = _reread(tyre, words, {**words, "LENGTH": word})
        if all(low < other[name] < high for name, (low, high) in seen.items()):
            said = f"LENGTH = '{words['LENGTH']}' contradicts the values: by it {_values(tyre, seen)}"
            return Problem(
                "error", f"{said}; write '{word}', by which {_values(other, seen)}", "LENGTH"
            ), word
    return None


def _angle(tyre: TyreRecord, words: Mapping[str, str]) -> tuple[Problem, str] | None:
    """The problem of limits in degrees that all are usual numbers of radians."""
    seen = [name for name in ANGLE_LIMITS if name in tyre.present and tyre[name]]
    other = _reread(tyre, words, {**words, "ANGLE": SI["ANGLE"]})
    if not seen or any(abs(other[name]) > constants.LARGEST_ANGLE for name in seen):
        return None
    numbers = listed([f"{name} {other[name]:g} deg" for name in seen])
    said = f"ANGLE = '{words['ANGLE']}' contradicts the ranges, which would end at {numbers}"
    return Problem("warning", f"{said}: they look like radians; write '{SI['ANGLE']}'", "ANGLE"), SI["ANGLE"]


def _values(tyre: TyreRecord, names: Mapping[str, object]) -> str:
    return listed([f"{name} is {tyre[name]:.4g} {BY_NAME[name].unit}" for name in names])


def _reread(tyre: AnyTyre, words: Mapping[str, str], other: Mapping[str, str]) -> AnyTyre:
    """The tyre with the numbers of its file in other units."""
    values = {name: tyre[name] for name in tyre.present}
    for name, value in values.items():
        unit = BY_NAME[name].unit
        if not isinstance(value, str):
            values[name] = value * factor(unit, other) / factor(unit, words)
    return replace(tyre, values=MappingProxyType(completed(values)))
