"""Comparison of a stored result with a new run: the numbers that agree, and those that changed."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import TypeGuard

from mffit.brief import Brief
from mffit.results import constants
from mffit.results.values import Json
from tir.errors import counted

MISSING = "missing"
"""Stands for a number that the new result lacks."""
PASSING = ("made", "lab", "warnings", "fit.seconds")
"""Keys of ``result.json`` that are not compared: they differ from run to run, or are copied from the configuration."""


@dataclass(frozen=True, slots=True)
class NumberAgain:
    """A number of a stored result, and the same number of the new result."""

    file: str  #: "result.json" or a property file
    key: str  #: dotted key, or the name of a coefficient
    old: Json
    new: Json
    size: float  #: change over tolerance; infinite if the new number is missing or has another type


@dataclass(frozen=True, slots=True, repr=False)
class Verification(Brief):
    """Comparison of a stored result with a new run from the stored inputs."""

    folder: str
    compared: tuple[NumberAgain, ...]
    method: tuple[int, int]  #: stored, and of this program
    version: tuple[str, str]  #: stored, and of this program
    source: tuple[str, str]  #: stored, and of this program
    libraries: tuple[Mapping[str, str], Mapping[str, str]]  #: versions by name, stored and of this program

    @property
    def numbers(self) -> int:
        """How many numbers were compared."""
        return len(self.compared)

    @property
    def exact(self) -> int:
        """How many numbers are the same to the last digit."""
        return sum(row.old == row.new for row in self.compared)

    @property
    def changes(self) -> tuple[NumberAgain, ...]:
        """The numbers whose change exceeds the tolerance, the largest change first."""
        return tuple(sorted((row for row in self.compared if row.size > 1.0), key=lambda row: -row.size))

    @property
    def same(self) -> bool:
        """Whether every number agrees within the tolerance."""
        return not self.changes

    @property
    def headline(self) -> str:
        """The result in one sentence."""
        if self.same:
            rest = "" if self.exact == self.numbers else f", {self.exact} of them to the last digit"
            return f"every number comes out again ({self.numbers}{rest})"
        return f"{len(self.changes)} of {counted(self.numbers, 'number')} do not come out again"

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences about differences of method, source or libraries."""
        return tuple(self._notes())

    def _notes(self) -> Iterator[str]:
        (was, now), (old, new) = self.method, self.version
        if was != now:
            yield (
                f"the result was made by method {was} (mffit {old}), and this is method {now} (mffit {new}): numbers may differ "
                "for this reason alone"
            )
        elif self.source[0] != self.source[1]:
            yield f"the result was made by other files of mffit ({old}) than these ({new}); both use method {now}"
        before, here = self.libraries
        others = [
            f"{name} {before[name]} (here {here.get(name)})"
            for name in before
            if before[name] != here.get(name)
        ]
        if others:
            yield f"the result was made with {', '.join(others)}: last digits may differ"


def compared(file: str, old: Json, new: Json) -> list[NumberAgain]:
    """The numbers of two JSON documents, compared; true, false and null count as numbers.

    Texts, and keys that only the new document has, are not compared.
    """
    return [NumberAgain(file, key, a, b, _size(a, b, u)) for key, a, b, u in _pairs(old, new)]


def _pairs(
    old: Json, new: Json, key: str = "", u: float = math.nan
) -> Iterator[tuple[str, Json, Json, float]]:
    """Key, old and new number, and the uncertainty that scales the tolerance; NaN if none is stated."""
    if key in PASSING or isinstance(old, str):
        return
    if isinstance(old, dict):
        others = new if isinstance(new, dict) else {}
        for name, value in old.items():
            inner = f"{key}.{name}".lstrip(".")
            yield from _pairs(value, others.get(name, MISSING), inner, _uncertainty(old, name))
    elif isinstance(old, list):
        if not isinstance(new, list) or len(new) != len(old):
            yield f"{key}, length", len(old), len(new) if isinstance(new, list) else MISSING, math.nan
            return
        spread = _spread(old)
        for k, (value, other) in enumerate(zip(old, new, strict=True)):
            if spread and isinstance(value, list) and isinstance(other, list):
                for j, (a, b) in enumerate(zip(value, other, strict=False)):
                    yield f"{key}[{k}][{j}]", a, b, spread[k] * spread[j]
            else:
                yield from _pairs(value, other, f"{key}[{k}]")
    else:
        yield key, old, new, u


def _uncertainty(table: dict[str, Json], name: str) -> float:
    """Standard uncertainty of a number, from another key of the same table; NaN without one."""
    keys = (f"u_{name}", *(("stderr", "u") if name == "value" else ()))
    return next((abs(u) for key in keys if isinstance(u := table.get(key), float)), math.nan)


def _spread(rows: list[Json]) -> list[float]:
    """Square roots of the diagonal of a square matrix, or of its lower triangle; empty for other rows."""
    square = [row for k, row in enumerate(rows) if isinstance(row, list) and len(row) in (len(rows), k + 1)]
    diagonal = [x for k, row in enumerate(square) if _is_number(x := row[min(k, len(row) - 1)])]
    return [math.sqrt(abs(x)) for x in diagonal] if len(diagonal) == len(rows) else []


def _is_number(x: Json) -> TypeGuard[float]:
    return isinstance(x, int | float) and not isinstance(x, bool)


def _size(old: Json, new: Json, u: float) -> float:
    """Change of a number over its tolerance; infinite if the types differ or a number is missing."""
    if old == new and isinstance(old, bool) == isinstance(new, bool):
        return 0.0
    if not _is_number(old) or not _is_number(new):
        return math.inf
    tolerance = constants.SAME_NUMBER * max(abs(old), abs(new))
    return abs(new - old) / max(tolerance, constants.SAME_IN_U * u if u > 0.0 else 0.0)
