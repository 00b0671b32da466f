"""Rules for single values: those that are impossible, or only possible in another unit. One record per rule."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass

from tir import constants
from tir.errors import Problem
from tir.parameters import BY_NAME, TABLE
from tir.record import TyreRecord


@dataclass(frozen=True, slots=True)
class PlausibleRule:
    """A condition under which the value of a key is wrong, independent of all other values."""

    keys: tuple[str, ...]
    broken: Callable[[float], bool]
    sentence: str  #: what the value looks like, or what to do
    level: str = "warning"
    amplitude: str = ""  #: the rule applies only if this key is not 0, because the value multiplies it


SINGLE = (
    PlausibleRule(
        ("NOMPRES", "INFLPRES"),
        lambda x: 0.0 < x < constants.PRESSURE_RANGE[0],
        "it looks like kPa or bar; write Pa",
    ),
    PlausibleRule(
        ("NOMPRES", "INFLPRES"),
        lambda x: x > constants.PRESSURE_RANGE[1],
        "no tyre holds that pressure; write Pa",
    ),
    PlausibleRule(
        ("ALPMIN", "ALPMAX", "CAMMIN", "CAMMAX"),
        lambda x: abs(x) > constants.LARGEST_ANGLE,
        "it looks like degrees; write radians",
    ),
    PlausibleRule(
        ("WIDTH", "RIM_WIDTH"),
        lambda x: x > constants.LENGTH_RANGE[1],
        "it looks like millimetres or inches; write metres",
    ),
    PlausibleRule(
        tuple(row.name for row in TABLE if row.unit in ("kg", "kg m2")),
        lambda x: x < 0.0,
        "it must not be negative",
        "error",
    ),
    PlausibleRule(
        ("LONGITUDINAL_STIFFNESS", "LATERAL_STIFFNESS"),
        lambda x: x <= 0.0,
        "the relaxation length is divided by it; give its value",
    ),
)
"""Dimensions, limits and masses."""
SHAPES = tuple(
    PlausibleRule((name,), lambda x: x <= 0.0, f"the {what} must be positive", "error", amplitude)
    for name, what, amplitude in (
        ("PCX1", "shape factor", "PDX1"),
        ("PCY1", "shape factor", ""),
        ("QCZ1", "shape factor", ""),
        ("QBZ1", "slope factor", "QDZ1"),
        ("LCX", "scale of a shape factor", "PDX1"),
        ("LCY", "scale of a shape factor", ""),
    )
)
"""Coefficients of the shape of the curves."""


def broken(tyre: TyreRecord, rules: Iterable[PlausibleRule]) -> Iterator[Problem]:
    """A problem for every key that breaks a rule."""
    for rule in rules:
        if rule.amplitude and tyre[rule.amplitude] == 0.0:
            continue
        for name in rule.keys:
            if rule.broken(tyre[name]):
                unit = BY_NAME[name].unit.replace("-", "")
                value = f"{tyre[name]:g} {unit}".strip()
                yield Problem(rule.level, f"{name} is {value}: {rule.sentence}", name)
