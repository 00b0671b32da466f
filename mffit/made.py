"""Date, program, version and method of a result, the same in pages and in JSON."""

from __future__ import annotations

import os
import platform
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from importlib.metadata import version

import mffit

METHOD = 3
"""Number of the method: raised whenever a change of the program can change a figure of a result.

``tests/mffit/test_method.py`` compares the figures of fixed projects with stored ones and asks for a new number if they differ.
"""


COMPUTING = ("numpy", "scipy")
"""Libraries on which the last digits of a figure depend."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """How and from what a result was made."""

    date: datetime  #: UTC
    program: str = "mffit"
    version: str
    method: int = METHOD
    libraries: Mapping[str, str] = field(
        default_factory=dict
    )  #: version of Python and of what computes figures
    inputs: Mapping[str, str] = field(default_factory=dict)
    """SHA-256 of every file read, in 64 hexadecimal digits, by the name that the configuration gives."""

    @property
    def day(self) -> str:
        """Date and time as pages show them."""
        return self.date.strftime("%Y-%m-%d %H:%M UTC")


def now() -> datetime:
    """The present time in UTC, to the second; the time of ``SOURCE_DATE_EPOCH`` [s since 1970] if that is set.

    With a fixed date the same data give the same bytes.
    """
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "")
    when = datetime.fromtimestamp(int(epoch), UTC) if epoch.isdigit() else datetime.now(UTC)
    return when.replace(microsecond=0)


def made(inputs: Mapping[str, str] | None = None) -> Made:
    """The record of a result that is made now from inputs with the given hashes."""
    return Made(
        date=now(), version=mffit.__version__, libraries=libraries(COMPUTING), inputs=dict(inputs or {})
    )


def libraries(names: Iterable[str]) -> dict[str, str]:
    """Version of Python and of some libraries by name."""
    return {"Python": platform.python_version(), **{name: version(name) for name in names}}
