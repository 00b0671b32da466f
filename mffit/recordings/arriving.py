"""Files that arrive in a folder: which of them are still being written."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from mffit.recordings.constants import LOOKS_OF_PATIENCE
from mffit.sheets import file_of

BINARY = (".gz", ".mat", ".xlsx", ".xlsm", ".parquet")
"""Endings of files whose reader refuses a part of one."""


class Seen(NamedTuple):
    """A file at a look."""

    signature: tuple[int, int]  #: size and time [ns], which change when it is written
    looks: int = 0  #: looks before at which it was the same

    @property
    def is_final(self) -> bool:
        """Whether it has been the same for so long that nobody writes it."""
        return self.looks >= LOOKS_OF_PATIENCE


def look_at(paths: Iterable[Path], before: Mapping[Path, Seen]) -> dict[Path, Seen]:
    """The files that are there, after those of the look before."""
    found = {}
    for path in paths:
        with suppress(OSError):
            stat = file_of(path).stat()
            now, old = (stat.st_size, stat.st_mtime_ns), before.get(path)
            found[path] = Seen(now, old.looks + 1 if old and old.signature == now else 0)
    return found


def is_cut_off(path: Path) -> bool:
    """Whether a text file lacks the end of its last line, as one does that is being written."""
    if path.name.lower().endswith(BINARY):
        return False
    with path.open("rb") as file:
        if not file.seek(0, 2):
            return True
        file.seek(-1, 2)
        return file.read(1) not in b"\r\n"
