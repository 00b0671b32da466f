"""Standard uncertainties as ``tyre.toml`` states them: a number, or a table with its distribution and degrees of freedom."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import AfterValidator, PlainSerializer, ValidatorFunctionWrapHandler, WrapValidator

from mffit.config.quantities import Range, length, wrong

DIVISORS = {"normal": 1.0, "rectangular": math.sqrt(3.0), "triangular": math.sqrt(6.0)}
"""``value`` over the standard uncertainty; ``value`` is the half-width of a bounded distribution (JCGM 100, 4.3.7, 4.3.9)."""
KEYS = ("value", "dof", "distribution")


class StatedUncertainty(float):
    """A standard uncertainty with its degrees of freedom and distribution."""

    value: float  #: as stated, half the width of a distribution with ends
    dof: float
    distribution: str

    def __new__(cls, value: float, dof: float = math.inf, distribution: str = "normal") -> StatedUncertainty:
        own = super().__new__(cls, value / DIVISORS[distribution])
        own.value, own.dof, own.distribution = value, dof, distribution
        return own


def shape_of(u: float) -> dict[str, Any]:
    """Degrees of freedom ``dof`` and ``distribution`` of an uncertainty that a table states; empty for a number."""
    return {"dof": u.dof, "distribution": u.distribution} if isinstance(u, StatedUncertainty) else {}


def _read(given: object, number: ValidatorFunctionWrapHandler) -> float:
    """The uncertainty that a number or a table states."""
    if not isinstance(given, Mapping):
        return float(number(given)) if not isinstance(given, StatedUncertainty) else given
    if unknown := [key for key in given if key not in KEYS]:
        raise wrong(f'has the unknown key "{unknown[0]}"; known are {", ".join(KEYS)}')
    value, dof, shape = given.get("value"), given.get("dof", math.inf), given.get("distribution", "normal")
    if value is None:
        raise wrong("has no value; write it as a number, such as { value = 0.5, dof = 12 }")
    value, dof = number(value), dof if dof == math.inf else number(dof)
    if not dof >= 1.0:
        raise wrong("has a dof below 1; write the degrees of freedom, or leave them out")
    if shape not in DIVISORS:
        raise wrong(f"has no known distribution; known are {', '.join(DIVISORS)}")
    return StatedUncertainty(value, dof, shape)


def _written(u: float) -> object:
    """The uncertainty as ``tyre.toml`` writes it."""
    if not isinstance(u, StatedUncertainty):
        return u
    dof = {} if math.isinf(u.dof) else {"dof": u.dof}
    return {"value": u.value, **dof, "distribution": u.distribution}


_Stated = Annotated[float, WrapValidator(_read), PlainSerializer(_written)]
Length = Annotated[_Stated, AfterValidator(length(0.0, 0.1))]
Force = Annotated[_Stated, AfterValidator(Range(0.0, 1e4, "N"))]
Moment = Annotated[_Stated, AfterValidator(Range(0.0, 1e3, "Nm"))]
Angle = Annotated[_Stated, AfterValidator(Range(0.0, 20.0, "deg"))]
Tilt = Annotated[_Stated, AfterValidator(Range(0.0, 5.0, "deg/kN", "write degrees per kilonewton"))]
Compliance = Annotated[_Stated, AfterValidator(Range(0.0, 0.05, "deg/Nm", "write degrees per newton metre"))]
Share = Annotated[_Stated, AfterValidator(Range(0.0, 1.0, "of the value", "write 0.05 for 5 %"))]
