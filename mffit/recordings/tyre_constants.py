"""What recordings state about the tyre: constants of a TYDEX file, or columns of one value under their names."""

import math
from typing import NamedTuple

import numpy as np

from mffit.config.quantities import LOADS, TYRE_PRESSURES, WHEEL_RADII, Range
from mffit.sweeps.columns import numbers
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.units import UnknownUnitError, converted


class TyreConstant(NamedTuple):
    """A constant of recordings that states a key of [tyre]."""

    key: str
    name: str  #: in the recording
    unit: str  #: of the key
    factor: float  #: from the constant to the key
    accepted: Range  #: values that the key accepts; programs write others where nothing was measured


TYRE_CONSTANTS = (
    TyreConstant("unloaded_radius", "RFREE", "m", 1.0, WHEEL_RADII),
    TyreConstant("unloaded_radius", "OVALLDIA", "m", 0.5, WHEEL_RADII),
    TyreConstant("nominal_load", "FNOMIN", "N", 1.0, LOADS),
    TyreConstant("nominal_pressure", "NOMPRES", "kPa", 1.0, TYRE_PRESSURES),
)
"""Constants by TYDEX's names; of several for one key, the first counts."""


NAMES = frozenset(one.name for one in TYRE_CONSTANTS)


class StatedByFile(NamedTuple):
    """A value that a recording states."""

    value: float  #: in the unit of the key
    why: str  #: where it comes from
    heading: str  #: of its column


def stated_by(raw: RawTable) -> dict[str, StatedByFile]:
    """The keys of [tyre] that a recording states with their units."""
    found: dict[str, StatedByFile] = {}
    names = {heading.upper(): heading for heading in raw.headings}
    for one in TYRE_CONSTANTS:
        heading = names.get(one.name, "")
        value = _value(one, raw, heading)
        if one.key not in found and one.accepted.lower <= value <= one.accepted.upper:
            part = "half of " * (one.factor == 0.5)
            found[one.key] = StatedByFile(
                float(f"{value:.6g}"), f"{part}{one.name} of {raw.path.name}", heading
            )
    return found


def _value(one: TyreConstant, raw: RawTable, heading: str) -> float:
    """The value of the key; NaN without the constant, its unit, or one value in all rows."""
    if not heading or not (unit := raw.unit(heading)):
        return math.nan
    values = np.unique(numbers(raw.column(heading)))
    if len(values) != 1:
        return math.nan
    try:
        return one.factor * float(converted(values, unit, one.unit)[0])
    except UnknownUnitError:
        return math.nan
