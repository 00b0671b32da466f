"""Date, program, version, source and method of a result, the same in pages and in JSON."""

import hashlib
import os
import platform
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from importlib.resources import files
from importlib.resources.abc import Traversable

import mffit

METHOD = 22
"""Number of the method: raised by every change of the program that moves a figure of a result, in that same change.

``python tests/mffit/method_figures.py --raise`` raises it and stores the new figures. ``tests/mffit/test_method.py`` compares
the figures of fixed projects with those stored, which under one number never change.
"""

COMPUTING = ("numpy", "scipy")
"""Libraries on which the last digits of a figure depend."""
PACKAGES = ("mffit", "tir")
SOURCES = (".py", ".csv", ".toml", ".j2", ".js", ".css")
"""Endings of the files that the program consists of: code, tables, templates."""
BESIDE = ("samples", "__pycache__", "pyproject.toml")
"""What an installation has or lacks in addition, by the way in which it was made."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Made:
    """How and from what a result was made."""

    date: datetime  #: UTC
    program: str = "mffit"
    version: str
    source: str  #: of the program's own files, see :func:`source`
    method: int = METHOD
    libraries: Mapping[str, str] = field(default_factory=dict)
    """Version of Python and of what computes figures."""
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
        date=now(),
        version=mffit.__version__,
        source=source(),
        libraries=libraries(COMPUTING),
        inputs=dict(inputs or {}),
    )


@cache
def source() -> str:
    """SHA-256 over the names and contents of mffit's and tir's own files, in 64 hexadecimal digits.

    The same files give the same digest from a wheel, a checkout or a zip archive.
    """
    whole = hashlib.sha256()
    for package in PACKAGES:
        for name, content in sorted(_sources(files(package), package)):
            whole.update(f"{name} {hashlib.sha256(content).hexdigest()}\n".encode())
    return whole.hexdigest()


def _sources(folder: Traversable, name: str) -> Iterator[tuple[str, bytes]]:
    """Name and content of every file of the program in a folder and those within."""
    for entry in folder.iterdir():
        inner = f"{name}/{entry.name}"
        if entry.name in BESIDE:
            continue
        if entry.name.endswith(SOURCES):
            yield inner, entry.read_bytes()
        elif entry.is_dir():
            yield from _sources(entry, inner)


def libraries(names: Iterable[str]) -> dict[str, str]:
    """Version of Python and of some libraries by name."""
    return {"Python": platform.python_version(), **{name: version(name) for name in names}}
