"""Numbers of a stored result against those of a new run: which come out again, and which changed."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeGuard

from mffit.results.values import Json

MISSING = "missing"
"""In place of a number that one of the two results lacks."""
PASSING = ("made", "lab", "warnings", "fit.seconds")
"""Keys of ``result.json`` that no figure of the tyre is in: they differ from run to run, or are copied from the configuration."""
SAME_NUMBER = 1e-5
"""Relative change below which a number comes out again: processors and libraries round the last digits differently."""
SAME_IN_U = 1e-3
"""Change in standard uncertainties below which a number comes out again: no stated digit of it changes."""


@dataclass(frozen=True, slots=True)
class NumberAgain:
    """A number of a stored result and of the new one."""

    file: str  #: or project
    key: str  #: dotted, or the name of a coefficient
    old: Json
    new: Json
    size: float  #: of the change in units of the tolerance; infinite if one is missing or of another kind


def compared(file: str, old: Json, new: Json) -> list[NumberAgain]:
    """The numbers of a JSON document, true, false and null included, against those of a new one.

    Keys that only the new one has, and texts, are not compared.
    """
    return [NumberAgain(file, key, a, b, _size(a, b, u)) for key, a, b, u in _pairs(old, new)]


def _pairs(
    old: Json, new: Json, key: str = "", u: float = math.nan
) -> Iterator[tuple[str, Json, Json, float]]:
    """Key, old and new number, and the scale on which a change is judged as an uncertainty; NaN if none is stated."""
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
    """Standard uncertainty that a table states for one of its numbers; NaN without one."""
    keys = (f"u_{name}", *(("stderr", "u") if name == "value" else ()))
    return next((abs(u) for key in keys if isinstance(u := table.get(key), float)), math.nan)


def _spread(rows: list[Json]) -> list[float]:
    """Square roots of the diagonal of a covariance matrix, by which its elements are judged; empty for other lists."""
    square = [row for row in rows if isinstance(row, list) and len(row) == len(rows)]
    diagonal = [x for k, row in enumerate(square) if _is_number(x := row[k])]
    return [math.sqrt(abs(x)) for x in diagonal] if len(diagonal) == len(rows) else []


def _is_number(x: Json) -> TypeGuard[float]:
    return isinstance(x, int | float) and not isinstance(x, bool)


def _size(old: Json, new: Json, u: float) -> float:
    """Change of a number in units of the tolerance; infinite if one is missing or of another kind."""
    if old == new and isinstance(old, bool) == isinstance(new, bool):
        return 0.0
    if not _is_number(old) or not _is_number(new):
        return math.inf
    tolerance = SAME_NUMBER * max(abs(old), abs(new))
    return abs(new - old) / max(tolerance, SAME_IN_U * u if u > 0.0 else 0.0)
