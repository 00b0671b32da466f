"""Numbers of ``tyre.toml``: the range in which they make sense, and what a value outside it usually is."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Annotated, NamedTuple

from pydantic import AfterValidator
from pydantic_core import PydanticCustomError
from scipy import constants


class Other(NamedTuple):
    """Other units in which a number may have been written."""

    write: str  #: the right unit, in words
    units: Mapping[str, float]  #: by their words, in the right unit
    lower: float  #: what is usual, in the right unit
    upper: float

    def hint(self, value: float) -> str:
        """The units in which the value would be a usual one; empty if there is none."""
        fitting = [
            words for words, factor in self.units.items() if self.lower <= value * factor <= self.upper
        ]
        return f"it looks like {' or '.join(fitting)}, write {self.write}" if fitting else ""


class Range:
    """Refuses a number outside ``lower`` to ``upper``; ``below`` and ``above`` say what it usually is."""

    def __init__(
        self,
        lower: float,
        upper: float,
        unit: str,
        below: str = "",
        above: str = "",
        other: Other | None = None,
    ) -> None:
        self.lower, self.upper, self.unit = lower, upper, unit
        self.below, self.above, self.other = below, above, other

    def __call__(self, value: float) -> float:
        if value < self.lower and value > 0.0:
            raise self._refusal(value, self.below)
        if value < self.lower:
            raise self._refusal(value, "")
        if value > self.upper:
            raise self._refusal(value, self.above)
        return value

    def _refusal(self, value: float, hint: str) -> PydanticCustomError:
        if hint and self.other is not None:
            hint = self.other.hint(value) or hint
        sentence = f"{value:g} {self.unit} is outside {self.lower:g} to {self.upper:g} {self.unit}"
        return wrong(f"{sentence}; {hint}" if hint else f"{sentence}; correct it")


def wrong(sentence: str, key: str = "") -> PydanticCustomError:
    """A refusal in our own words; ``key`` is the dotted key at fault when the value itself does not tell."""
    return PydanticCustomError("sentence", "{sentence}", {"sentence": sentence, "key": key})


MILLIMETRES = "it looks like millimetres, write metres"

RADII = Other(
    "metres",
    {"inches": constants.inch, "centimetres": constants.centi, "millimetres": constants.milli},
    0.1,
    0.6,
)
PRESSURES = Other(
    "kilopascals",
    {"psi": constants.psi / constants.kilo, "bar": constants.bar / constants.kilo},
    40.0,
    1000.0,
)

WheelRadius = Annotated[float, AfterValidator(Range(0.03, 1.5, "m", above=MILLIMETRES, other=RADII))]
Width = Annotated[float, AfterValidator(Range(0.01, 1.0, "m", above=MILLIMETRES))]
PathRadius = Annotated[float, AfterValidator(Range(0.2, 100.0, "m", above=MILLIMETRES))]
Length = Annotated[float, AfterValidator(Range(1e-3, 100.0, "m", above=MILLIMETRES))]
Load = Annotated[
    float, AfterValidator(Range(20.0, 2e5, "N", below="it looks like kilonewtons, write newtons"))
]
Pressure = Annotated[
    float,
    AfterValidator(
        Range(
            20.0,
            2000.0,
            "kPa",
            below="it looks like bar, write kilopascals",
            above="it looks like pascals",
            other=PRESSURES,
        )
    ),
]
Speed = Annotated[float, AfterValidator(Range(0.01, 150.0, "m/s", above="write metres per second"))]
EstimateAngle = Annotated[
    float, AfterValidator(Range(1.0, 60.0, "deg", below="it looks like radians, write degrees"))
]
Play = Annotated[float, AfterValidator(Range(0.0, 10.0, "deg", above="write the full play in degrees"))]
Revolutions = Annotated[float, AfterValidator(Range(0.0, 1e4, "revolutions"))]
Inclination = Annotated[float, AfterValidator(Range(-360.0, 720.0, "deg"))]
ULength = Annotated[float, AfterValidator(Range(0.0, 0.1, "m", above=MILLIMETRES))]
UForce = Annotated[float, AfterValidator(Range(0.0, 1e4, "N"))]
UAngle = Annotated[float, AfterValidator(Range(0.0, 20.0, "deg"))]
Fraction = Annotated[float, AfterValidator(Range(0.0, 1.0, "of the value", above="write 0.05 for 5 %"))]
