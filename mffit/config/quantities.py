"""Plausible ranges of the numbers of ``tyre.toml``, with a remedy for values outside them."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError

from tir.units import KINDS


@dataclass(frozen=True, eq=False)
class Range:
    """Validator that refuses a number outside ``lower`` to ``upper``, with the units in which it would be a usual one."""

    lower: float
    upper: float
    unit: str
    otherwise: str = ""  #: remedy for a number above the range that no unit explains
    write: str = ""  #: the right unit, in words
    units: Mapping[str, float] = field(default_factory=dict)
    """Factor to the right unit, by the words for one in which the number may have been written."""
    usual: tuple[float, float] | None = None  #: range of usual numbers; None: all that are accepted

    def __call__(self, value: float) -> float:
        if self.lower <= value <= self.upper:
            return value
        least, most = self.usual or (self.lower, self.upper)
        fitting = [words for words, factor in self.units.items() if least <= value * factor <= most]
        hint = self.otherwise if value > self.upper else ""
        if fitting:
            hint = f"it looks like {' or '.join(fitting)}, write {self.write}"
        unit = f" {self.unit}" if self.unit != "-" else ""
        sentence = f"{value:g}{unit} is outside {self.lower:g} to {self.upper:g}{unit}"
        raise wrong(f"{sentence}; {hint or 'correct it'}")


def wrong(sentence: str, key: str = "") -> PydanticCustomError:
    """An error with this sentence for the user; ``key`` is the dotted key that is wrong, if not that of the checked value."""
    return PydanticCustomError("sentence", "{sentence}", {"sentence": sentence, "key": key})


TOO_MANY_DIGITS = "has more digits than a number can have; correct it"
"""The sentence about a whole number that no float can hold."""
LENGTH, FORCE, PRESSURE = (KINDS[kind] for kind in ("LENGTH", "FORCE", "PRESSURE"))
LENGTHS = {"inches": LENGTH["inch"], "centimetres": LENGTH["cm"], "millimetres": LENGTH["mm"]}
PRESSURES = {
    word: PRESSURE[unit] / PRESSURE["kpa"]
    for word, unit in (("psi", "psi"), ("bar", "bar"), ("pascals", "pa"))
}


def length(lower: float, upper: float, usual: tuple[float, float] | None = None) -> Range:
    """The range of a length [m]."""
    return Range(lower, upper, "m", "write metres", "metres", LENGTHS, usual)


def _length(lower: float, upper: float, usual: tuple[float, float] | None = None) -> AfterValidator:
    return AfterValidator(length(lower, upper, usual))


def _angle(lower: float, upper: float) -> AfterValidator:
    return AfterValidator(Range(lower, upper, "deg", write="degrees", units={"radians": DEGREES}))


DEGREES = 180.0 / math.pi
WHEEL_RADII = length(0.03, 1.5, (0.1, 0.6))
LOADS = Range(20.0, 2e5, "N", write="newtons", units={"kilonewtons": FORCE["kn"]})
TYRE_PRESSURES = Range(20.0, 2000.0, "kPa", "", "kilopascals", PRESSURES, (20.0, 1000.0))
WheelRadius = Annotated[float, AfterValidator(WHEEL_RADII)]
Load = Annotated[float, AfterValidator(LOADS)]
Pressure = Annotated[float, AfterValidator(TYRE_PRESSURES)]
Width = Annotated[float, _length(0.01, 1.0)]
PATH_RADII = (0.2, 100.0)
"""Smallest and largest radius of a path [m]."""
PathRadius = Annotated[float, _length(*PATH_RADII)]
Length = Annotated[float, _length(1e-3, 100.0)]
Temperature = Annotated[float, AfterValidator(Range(-40.0, 200.0, "degC"))]
Speed = Annotated[float, AfterValidator(Range(0.01, 150.0, "m/s", "write metres per second"))]
EstimateAngle = Annotated[float, _angle(1.0, 60.0)]
CamberLimit = Annotated[float, _angle(5.0, 70.0)]
Play = Annotated[float, AfterValidator(Range(0.0, 10.0, "deg", "write the full play in degrees"))]
Revolutions = Annotated[float, AfterValidator(Range(0.0, 1e4, "revolutions"))]
Inclination = Annotated[float, AfterValidator(Range(-360.0, 720.0, "deg"))]
