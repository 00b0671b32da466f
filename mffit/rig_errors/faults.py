"""Values of all rig errors for one rig."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping

from mffit.as_json import Estimates
from mffit.rig_errors.catalog import BY_NAME, RIG_ERRORS
from mffit.rig_errors.record import RigError

OF_RUN = "@"
"""Separates the name of an error from its run or set-up, as in ``F0_N@zeros.csv`` or ``F0_N@A``."""


def number_of(name: str, part: str) -> str:
    """Name of the number of an error in one run or set-up; the plain name if ``part`` is empty."""
    return f"{name}{OF_RUN}{part}" if part else name


def unit_of(name: str) -> str:
    """Unit of a rig number, for the whole test or one part."""
    return BY_NAME[name.partition(OF_RUN)[0]].unit


def rig_estimates(numbers: Estimates) -> dict[str, object]:
    """JSON of rig numbers with their standard errors and units."""
    return {n: {"value": value, "stderr": u, "unit": unit_of(n)} for n, (value, u) in numbers.items()}


def meaning_of(name: str) -> str:
    """Formula, in words, of a rig number, for the whole test or one part."""
    return BY_NAME[name.partition(OF_RUN)[0]].meaning


def words_of(name: str) -> str:
    """Words for a rig number, followed by its run or set-up; empty without words."""
    error, part = error_of(name), name.partition(OF_RUN)[2]
    return ", ".join(filter(None, (error.words, part))) if error is not None and error.words else ""


def shown(name: str, value: float, u: float) -> tuple[float, float, str]:
    """A rig number and its uncertainty in the unit for display, and that unit; empty if it is dimensionless."""
    error = error_of(name)
    unit, size = error.shown_in if error is not None and error.shown_in else (unit_of(name), 1.0)
    return value * size, u * size, "" if unit == "-" else unit


def error_of(name: str) -> RigError | None:
    """The rig error of a number, for the whole test or one part; None for other numbers."""
    return BY_NAME.get(name.partition(OF_RUN)[0])


class Faults(Mapping[str, float]):
    """Values of all rig errors by name, in ISO-W axes and the unit of the name; immutable.

    Parameters
    ----------
    values : values that differ from a perfect rig

    Raises
    ------
    KeyError
        There is no rig error of such a name.

    Examples
    --------
    >>> faults = Faults(F0_N=8.0)
    >>> faults["F0_N"], faults["gain"]
    (8.0, 1.0)
    """

    __slots__ = ("_values",)

    def __init__(self, **values: float) -> None:
        unknown = sorted(set(values) - set(BY_NAME))
        if unknown:
            raise KeyError(f"{unknown[0]} is no rig error")
        self._values = {error.name: float(values.get(error.name, error.undisturbed)) for error in RIG_ERRORS}

    def __getitem__(self, name: str) -> float:
        return self._values[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Faults) and self.disturbed == other.disturbed

    def __hash__(self) -> int:
        return hash(frozenset(self.disturbed.items()))

    def __repr__(self) -> str:
        return f"Faults({', '.join(f'{name}={value!r}' for name, value in self.disturbed.items())})"

    def replace(self, **values: float) -> Faults:
        """The record with some values replaced."""
        return Faults(**{**self._values, **values})

    @property
    def disturbed(self) -> dict[str, float]:
        """The values that differ from a perfect rig."""
        return {
            name: value
            for name, value in self._values.items()
            if not math.isnan(value) and value != BY_NAME[name].undisturbed
        }


NO_FAULTS = Faults()
