"""A file as headings and cells, with the line of every row; knows no heading, no unit and no format."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

Cells = Sequence[str | float] | np.ndarray
"""One column (n,): an array of floats where the reader is sure of all of them, else cells as they stand."""


@dataclass(frozen=True, slots=True)
class RawTable:
    """What a reader makes of one file; ``lines`` and every column of ``cells`` are of equal length (n,)."""

    headings: tuple[str, ...]
    units: tuple[str, ...]  #: as the file states them, "" where it does not
    cells: tuple[Cells, ...]  #: a column under each heading; text is stripped of blanks
    lines: (
        Sequence[int] | np.ndarray
    )  #: line of each row in the file, counted from 1; in binary formats its number
    path: Path
    heading_line: int | None  #: None where the format has no lines
    about: Mapping[str, str] = field(
        default_factory=dict
    )  #: what the file says of itself: tyre, test, source

    def __len__(self) -> int:
        return len(self.lines)
