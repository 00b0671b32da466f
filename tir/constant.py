"""Numbers of judgement: constants with their unit, the reason for their value and the study that set it.

Each folder keeps its own in a module ``constants.py``, and the page ``constants`` of the documentation's site lists them all.

>>> from tir.constant import Real
>>> NARROW = Real(0.5, "deg", "Width of a bin.")
>>> NARROW * 2, NARROW.unit
(1.0, 'deg')
"""

import math
from collections.abc import Iterable
from typing import Any, Self


class _Judged:
    """Unit, reason and study of a constant."""

    unit: str  #: "-" for a ratio, a count or a probability
    why: str  #: one or two sentences
    study: str  #: study, data set or publication that set the value; empty where none did

    def __new__(cls, value: float | Iterable[float], unit: str, why: str, study: str = "") -> Self:
        found = super().__new__(cls, value)  # type: ignore[call-arg]
        found.unit, found.why, found.study = unit, why, study
        return found

    def __reduce__(self) -> tuple[Any, ...]:
        plain: type = type(self).__mro__[2]
        return type(self), (plain(self), self.unit, self.why, self.study)


class Real(_Judged, float):
    """A real constant; computes like any float."""

    @property
    def rad(self) -> float:
        """The value in radians of a constant in degrees. Raises ValueError if the unit is not "deg"."""
        if self.unit != "deg":
            raise ValueError(f"{self!r} is in {self.unit}, not in degrees")
        return math.radians(self)


class Count(_Judged, int):
    """A whole constant; computes like any int."""


class Series(_Judged, tuple[float, ...]):
    """Several constants of one unit that belong together; a tuple of numbers."""
