"""Numbers of judgement: constants with their unit, the reason for their value and the study that set it.

Each folder keeps its own in a module ``constants.py``, and ``docs/constants.md`` lists them all.

>>> from tir.constant import Real
>>> NARROW = Real(0.5, "deg", "Width of a bin.")
>>> NARROW * 2, NARROW.unit
(1.0, 'deg')
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any, Self


class _Judged:
    """Unit, reason and study of a constant."""

    unit: str  #: "-" for a ratio, a count or a probability
    why: str  #: one or two sentences
    study: str  #: study, data set or publication that set the value; empty where none did

    def _describe(self, unit: str, why: str, study: str) -> Self:
        self.unit, self.why, self.study = unit, why, study
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        return type(self), (self._plain(), self.unit, self.why, self.study)

    def _plain(self) -> Any:
        raise NotImplementedError


class Real(_Judged, float):
    """A real constant; computes like any float."""

    def __new__(cls, value: float, unit: str, why: str, study: str = "") -> Self:
        return super().__new__(cls, value)._describe(unit, why, study)

    def _plain(self) -> float:
        return float(self)

    @property
    def rad(self) -> float:
        """The value in radians of a constant in degrees.

        Raises
        ------
        ValueError
            The unit is not "deg".
        """
        if self.unit != "deg":
            raise ValueError(f"{self!r} is in {self.unit}, not in degrees")
        return math.radians(self)


class Count(_Judged, int):
    """A whole constant; computes like any int."""

    def __new__(cls, value: int, unit: str, why: str, study: str = "") -> Self:
        return super().__new__(cls, value)._describe(unit, why, study)

    def _plain(self) -> int:
        return int(self)


class Series(_Judged, tuple[float, ...]):
    """Several constants of one unit that belong together; a tuple of numbers."""

    def __new__(cls, values: Iterable[float], unit: str, why: str, study: str = "") -> Self:
        return super().__new__(cls, tuple(values))._describe(unit, why, study)

    def _plain(self) -> tuple[float, ...]:
        return tuple(self)
