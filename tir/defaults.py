"""Values of keys that a file lacks: those of the table, on the scale of the file's own tyre."""

import math
from collections.abc import Collection, Mapping
from typing import Any

from tir.parameters import BY_NAME, TABLE, Parameter

SCALES: Mapping[str, Mapping[str, int]] = {
    "m": {"UNLOADED_RADIUS": 1},
    "N": {"FNOMIN": 1},
    "N/m": {"FNOMIN": 1, "UNLOADED_RADIUS": -1},
    "N s/m": {"FNOMIN": 1, "UNLOADED_RADIUS": -1},
    "N m/rad": {"FNOMIN": 1, "UNLOADED_RADIUS": 1},
    "Pa": {"NOMPRES": 1},
    "kg": {"FNOMIN": 1},
    "kg m2": {"FNOMIN": 1, "UNLOADED_RADIUS": 2},
}
"""By unit, the powers of the tyre's measures with which a default grows; other units do not depend on its size."""
OF_PROGRAMS = "MODEL"
"""Section of what programs and measurements set; its defaults hold for a tyre of any size."""
SAME = {"INFLPRES": "NOMPRES", "NOMPRES": "INFLPRES"}
"""Keys that are equal unless a file states both: without a stated pressure, a tyre has the one that it was measured at."""
MIRRORED = {
    low: high
    for pair in (("KPUMIN", "KPUMAX"), ("ALPMIN", "ALPMAX"), ("CAMMIN", "CAMMAX"))
    for low, high in (pair, pair[::-1])
}
"""Ends of ranges to both sides of zero, of which one is the negative of the other unless a file states both."""


def completed(given: Mapping[str, Any]) -> dict[str, Any]:
    """Every parameter of the table: the given values, and defaults for all others.

    A default with a unit is that of the table's tyre scaled to the given one: lengths by UNLOADED_RADIUS, forces by FNOMIN,
    stiffnesses by both, pressures by NOMPRES. A missing INFLPRES is NOMPRES and the reverse; a missing end of a range of slip or
    camber mirrors the other end.
    """
    values: dict[str, Any] = {row.name: row.default for row in TABLE} | dict(given)
    for name, other in SAME.items():
        if name not in given and other in given:
            values[name] = given[other]
    for row in TABLE:
        if row.name in given or row.name in SAME or not isinstance(row.default, float):
            continue
        if row.name in MIRRORED and MIRRORED[row.name] in given:
            values[row.name] = -given[MIRRORED[row.name]]
        else:
            values[row.name] = row.default * _growth(row, values)
    return values


DECIDING = frozenset({*SAME, *MIRRORED, *(name for powers in SCALES.values() for name in powers)})
"""Keys on which defaults of others depend."""


def followed(
    values: Mapping[str, Any], present: Collection[str], changes: Mapping[str, Any]
) -> dict[str, Any]:
    """The values with some changed; defaults of keys that are not ``present`` follow, as in a file with the new ones."""
    found = {**values, **changes}
    if not DECIDING.intersection(changes):
        return found
    given = {name: values[name] for name in present}
    before, after = completed(given), completed({**given, **changes})
    for name in after:
        absent = name not in present and name not in changes
        if absent and name in values and isinstance(values[name], float) and values[name] == before[name]:
            found[name] = after[name]
    return found


def _growth(row: Parameter, values: Mapping[str, Any]) -> float:
    """The tyre's measures over those of the table's tyre, for the unit of a parameter; 1 if unusable."""
    if row.section == OF_PROGRAMS:
        return 1.0
    growth = 1.0
    for name, power in SCALES.get(row.unit, {}).items():
        default, value = BY_NAME[name].default, values[name]
        if isinstance(value, int | float) and isinstance(default, float) and 0.0 < value < math.inf:
            growth *= (value / default) ** power
    return growth
