"""JSON of records, with the keys that users' scripts rely on.

The keys of a record are its fields, unless :func:`keys` states others next to its class: their order, attributes and units.
Standard JSON has no NaN and no infinity; both become null.
"""

import json
import math
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import fields, is_dataclass
from datetime import date
from enum import Enum
from importlib import import_module
from pathlib import Path
from typing import TypeVar, Union

import numpy as np
from pydantic import BaseModel

from mffit.rounding import AtLeast
from tir import Quantity

Json = Union[None, bool, int, float, str, list["Json"], dict[str, "Json"]]  # noqa: UP007  it names itself
Record = TypeVar("Record")

UNIT = re.compile(r"_(deg_per_s|deg|kPa|degC|N_per_rad|Nm|N|m|Hz)$")
"""The unit at the end of a key."""
FROM_SI: Mapping[str, Callable[[float], float]] = {
    "deg": math.degrees,
    "deg_per_s": math.degrees,
    "kPa": lambda pressure: pressure / 1e3,
}
"""Conversion from SI, by the unit of the key; values in other units need none."""

_KEYS: dict[type, tuple[str, Mapping[str, Callable[..., object] | str]]] = {}
Estimates = Mapping[str, tuple[float, float]]
"""Numbers with their standard errors, by name."""


def keys(record: type[Record], words: str, /, **computed: Callable[[Record], object] | str) -> None:
    """State the JSON keys of a class of records.

    Parameters
    ----------
    record : the class
    words : the keys in their order; a key takes the attribute of the same name, with or without the unit at its end.
        ``*`` takes all fields. ``key=path`` takes another attribute, such as ``best.effect`` or ``limits.0``. ``±key`` adds
        the standard uncertainty of a quantity. ``**key`` inserts the entries of a mapping or record. ``key?`` is null if
        the value is empty; ``[key]`` is left out if it is None.
    computed : functions that compute the values of keys from the record; where a function's module needs the record, as those
        with sentences do, its dotted name, which is imported on first use
    """
    _KEYS[record] = (words, computed)


def document(record: object) -> dict[str, Json]:
    """The JSON of a record or a mapping."""
    found = plain(record)
    assert isinstance(found, dict)
    return found


def _entries(record: object) -> Iterator[tuple[str, Json]]:
    words, computed = _KEYS.get(type(record), ("*", {}))
    for word in words.split():
        if word == "*":
            yield from ((name, plain(getattr(record, name))) for name in _fields(record))
            continue
        name, _, path = word.strip("±*?[]").partition("=")
        value = _computed(computed[name], record) if name in computed else _attribute(record, name, path)
        if word.startswith("±"):
            yield from with_u(name, value).items()
        elif word.startswith("**"):
            yield from document(value).items()
        elif value is not None or not word.startswith("["):
            yield name, plain(value or None) if word.endswith("?") else plain(value)


def _computed(function: Callable[..., object] | str, record: object) -> object:
    if isinstance(function, str):
        module, _, name = function.rpartition(".")
        function = getattr(import_module(module), name)
        assert callable(function)
    return function(record)


def _fields(record: object) -> list[str]:
    """Names of the fields of a dataclass or a named tuple."""
    if is_dataclass(record):
        return [field.name for field in fields(record)]
    return list(getattr(record, "_fields", ()))


def _attribute(record: object, key: str, path: str) -> object:
    """The value of an attribute, in the unit of the key."""
    unit = UNIT.search(key)
    if not path:
        path = key if hasattr(record, key) else UNIT.sub("", key)
    found = record
    for part in path.split("."):
        if isinstance(found, tuple) and part.isdigit():
            found = found[int(part)]
        elif found is not None:
            found = getattr(found, part)
    as_stated = unit is None or path.endswith(unit[0]) or unit[1] not in FROM_SI
    return found if unit is None or as_stated else _converted(found, FROM_SI[unit[1]])


def _converted(value: object, convert: Callable[[float], float]) -> object:
    """The value with its numbers converted; any other value, such as None, unchanged."""
    if isinstance(value, Quantity):
        return Quantity(convert(value.value), convert(value.u), "")
    if isinstance(value, tuple):
        return [_converted(item, convert) for item in value]
    return convert(value) if isinstance(value, float) else value


def with_u(name: str, number: object) -> dict[str, Json]:
    """A quantity as two entries, ``name`` and its standard uncertainty ``u_name``; both null for None."""
    value, u = number[:2] if isinstance(number, Quantity) else (None, None)
    return {name: plain(value), f"u_{name}": plain(u)}


def plain(value: object) -> Json:
    """The value in types of standard JSON."""
    if isinstance(value, np.generic | Enum):
        value = value.item() if isinstance(value, np.generic) else value.value
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, date):
        return value.isoformat()
    if isinstance(value, BaseModel):
        return plain(value.model_dump(mode="json", exclude_none=True))
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, Quantity):
        least = {"at_least": True} if isinstance(value, AtLeast) else {}
        return {"value": plain(value.value), "u": plain(value.u), **least}
    if is_dataclass(value) or hasattr(value, "_fields"):
        return dict(_entries(value))
    assert isinstance(value, list | tuple | np.ndarray), type(value)
    return [plain(item) for item in value]


def estimates(numbers: Estimates) -> dict[str, object]:
    """JSON of numbers with their standard errors."""
    return {name: {"value": value, "stderr": u} for name, (value, u) in numbers.items()}


def text(content: object) -> str:
    """JSON text of a record, or of a list or mapping of records."""
    return json.dumps(plain(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def write(path: Path, content: object) -> None:
    """Write the JSON text in UTF-8."""
    path.write_text(text(content), encoding="utf-8")
