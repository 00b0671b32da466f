"""A file as headings and cells, with the line of every row; knows no heading, no unit and no format."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, slots=True)
class RawTable:
    """What a reader makes of one file; ``lines`` and every column of ``cells`` are of equal length (n,)."""

    headings: tuple[str, ...]
    units: tuple[str, ...]  #: as the file states them, "" where it does not
    cells: tuple[Sequence[str | float], ...]  #: a column under each heading; text is stripped of blanks
    lines: Sequence[int]  #: line of each row in the file, counted from 1
    path: Path
    heading_line: int

    def __len__(self) -> int:
        return len(self.lines)
