"""Records whose arrays are read-only."""

from dataclasses import fields
from operator import is_
from typing import Any

import numpy as np


class ReadOnlyArrays:
    """Base of frozen dataclasses: the arrays of the fields, in tuples and mappings too, are read-only.

    An array that the caller can still write is not copied: the record has a read-only view of it.
    """

    __slots__ = ()

    def __post_init__(self) -> None:
        for field in fields(self):  # type: ignore[arg-type]  # every subclass is a dataclass
            given = getattr(self, field.name)
            kept = read_only(given)
            if kept is not given:
                object.__setattr__(self, field.name, kept)


def read_only(value: Any) -> Any:
    """An array, or a tuple or dict with arrays, such that no array can be written; any other value unchanged."""
    if isinstance(value, np.ndarray):
        if value.flags.writeable:
            value = value.view()
            value.flags.writeable = False
        return value
    if type(value) is tuple:
        kept = tuple(map(read_only, value))
        return value if all(map(is_, kept, value)) else kept
    if type(value) is dict:
        found = {key: read_only(item) for key, item in value.items()}
        return value if all(map(is_, found.values(), value.values())) else found
    return value
