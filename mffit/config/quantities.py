"""Plausible ranges of the numbers of ``tyre.toml``, with a remedy for values outside them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, NamedTuple

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError
from scipy import constants


class OtherUnits(NamedTuple):
    """Units in which a number may have been written by mistake."""

    write: str  #: the right unit, in words
    units: Mapping[str, float]  #: factor to the right unit, by the words for the wrong one
    lower: float  #: usual range, in the right unit
    upper: float

    def hint(self, value: float) -> str:
        """The units in which the value would be usual, as a remedy; empty if there is none."""
        fitting = [
            words for words, factor in self.units.items() if self.lower <= value * factor <= self.upper
        ]
        return f"it looks like {' or '.join(fitting)}, write {self.write}" if fitting else ""


@dataclass(frozen=True, eq=False)
class Range:
    """Validator that refuses a number outside ``lower`` to ``upper``."""

    lower: float
    upper: float
    unit: str
    below: str = ""  #: remedy for a positive number below the range
    above: str = ""  #: remedy for a number above the range
    other: OtherUnits | None = None  #: finds a better remedy from the value

    def __call__(self, value: float) -> float:
        if self.lower <= value <= self.upper:
            return value
        hint = self.above if value > self.upper else self.below if value > 0.0 else ""
        if hint and self.other is not None:
            hint = self.other.hint(value) or hint
        unit = f" {self.unit}" if self.unit != "-" else ""
        sentence = f"{value:g}{unit} is outside {self.lower:g} to {self.upper:g}{unit}"
        raise wrong(f"{sentence}; {hint or 'correct it'}")


def wrong(sentence: str, key: str = "") -> PydanticCustomError:
    """An error whose sentence the user reads unchanged; ``key`` is the dotted key at fault if it is not the value checked."""
    return PydanticCustomError("sentence", "{sentence}", {"sentence": sentence, "key": key})


TOO_MANY_DIGITS = "has more digits than a number can have; correct it"
"""The sentence about a whole number that no float can hold."""
MILLIMETRES = "it looks like millimetres, write metres"

RADII = OtherUnits(
    write="metres",
    units={"inches": constants.inch, "centimetres": constants.centi, "millimetres": constants.milli},
    lower=0.1,
    upper=0.6,
)
PRESSURES = OtherUnits(
    write="kilopascals",
    units={"psi": constants.psi / constants.kilo, "bar": constants.bar / constants.kilo},
    lower=40.0,
    upper=1000.0,
)

WheelRadius = Annotated[float, AfterValidator(Range(0.03, 1.5, "m", above=MILLIMETRES, other=RADII))]
Width = Annotated[float, AfterValidator(Range(0.01, 1.0, "m", above=MILLIMETRES))]
PathRadius = Annotated[float, AfterValidator(Range(0.2, 100.0, "m", above=MILLIMETRES))]
Length = Annotated[float, AfterValidator(Range(1e-3, 100.0, "m", above=MILLIMETRES))]
Load = Annotated[
    float, AfterValidator(Range(20.0, 2e5, "N", below="it looks like kilonewtons, write newtons"))
]
Temperature = Annotated[float, AfterValidator(Range(-40.0, 200.0, "degC"))]
Pressure = Annotated[
    float,
    AfterValidator(
        Range(
            20.0,
            2000.0,
            "kPa",
            below="it looks like bar, write kilopascals",
            above="it looks like pascals, write kilopascals",
            other=PRESSURES,
        )
    ),
]
Speed = Annotated[float, AfterValidator(Range(0.01, 150.0, "m/s", above="write metres per second"))]
EstimateAngle = Annotated[
    float, AfterValidator(Range(1.0, 60.0, "deg", below="it looks like radians, write degrees"))
]
CamberLimit = Annotated[
    float, AfterValidator(Range(5.0, 70.0, "deg", below="it looks like radians, write degrees"))
]
Play = Annotated[float, AfterValidator(Range(0.0, 10.0, "deg", above="write the full play in degrees"))]
Revolutions = Annotated[float, AfterValidator(Range(0.0, 1e4, "revolutions"))]
Inclination = Annotated[float, AfterValidator(Range(-360.0, 720.0, "deg"))]
ULength = Annotated[float, AfterValidator(Range(0.0, 0.1, "m", above=MILLIMETRES))]
UForce = Annotated[float, AfterValidator(Range(0.0, 1e4, "N"))]
UMoment = Annotated[float, AfterValidator(Range(0.0, 1e3, "Nm"))]
UAngle = Annotated[float, AfterValidator(Range(0.0, 20.0, "deg"))]
Fraction = Annotated[float, AfterValidator(Range(0.0, 1.0, "of the value", above="write 0.05 for 5 %"))]
