"""Files that arrive in a folder: which of them are still being written."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from mffit.recordings import constants
from mffit.sweeps import formats

BINARY = (".gz", ".mat", ".xlsx", ".xlsm", ".parquet")
"""Endings of files whose reader refuses a part of one."""
Signature = tuple[int, int]
"""Size and time [ns] of a file, which change when it is written."""


class ArrivingFiles:
    """What is seen of files at every look."""

    def __init__(self) -> None:
        self._now: dict[Path, tuple[Signature, int]] = {}  #: and for how many looks it has been so
        self._grown: set[Path] = set()  #: that changed after they had been taken
        self._taken: set[Path] = set()

    def look(self, paths: Iterable[Path]) -> None:
        """Look at files; one that is gone is forgotten."""
        before, self._now = self._now, {}
        for path in paths:
            try:
                stat = path.stat()
            except OSError:
                continue
            signature = stat.st_size, stat.st_mtime_ns
            old, looks = before.get(path, (None, 0))
            self._now[path] = (signature, looks + 1 if signature == old else 0)
            if path in self._taken and signature != old:
                self._grown.add(path)

    def signature(self, path: Path) -> Signature | None:
        """Size and time of a file; None if it is not there."""
        return self._now[path][0] if path in self._now else None

    def rests(self, path: Path) -> bool:
        """Whether a file is there and has not changed since the look before; one that has grown before, for longer."""
        return path in self._now and (
            (self._now[path][1] > 0 and path not in self._grown) or self.is_final(path)
        )

    def is_final(self, path: Path) -> bool:
        """Whether a file is as it was for so long that nobody writes it."""
        return path in self._now and self._now[path][1] >= constants.LOOKS_OF_PATIENCE

    def take(self, path: Path) -> None:
        """Say that a file was read."""
        self._taken.add(path)


def ends_within_line(path: Path) -> bool:
    """Whether a text file lacks the end of its last line, as one does that is being written."""
    if path.name.lower().endswith(BINARY):
        return False
    with path.open("rb") as file:
        if not file.seek(0, 2):
            return True
        file.seek(-1, 2)
        return file.read(1) not in b"\r\n"


def same_headings(path: Path, other: Path) -> bool:
    """Whether two readable files have the same headings and units."""
    one, two = formats.read(path), formats.read(other)
    return (one.headings, one.units) == (two.headings, two.units)
