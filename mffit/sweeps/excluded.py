"""Rows that ``[fit] exclude`` leaves out, apart from all others before anything is checked or computed.

They are taken out of the file's cells, so that a damaged row can be excluded without editing the file.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from mffit.config.exclusion import ExcludeTable
from mffit.config.lines import inside, ranges_text
from mffit.sweeps.raw_table import RawTable


class Apart(NamedTuple):
    """A file without its excluded rows, and these by entry."""

    kept: RawTable | None  #: None if no row is left
    excluded: tuple[RawTable, ...]


class ExclusionError(ValueError):
    """Why an entry of ``exclude`` does not fit its file, and which."""

    def __init__(self, sentence: str, entry: ExcludeTable) -> None:
        super().__init__(sentence)
        self.entry = entry


def take_apart(raw: RawTable, entries: Sequence[ExcludeTable]) -> Apart:
    """The rows of a file that are kept, and those of each entry.

    Raises
    ------
    ExclusionError
        A range begins or ends at a line that holds no reading.
    """
    lines = np.asarray(raw.lines)
    out = np.zeros(len(lines), dtype=bool)
    excluded = []
    for entry in entries:
        # The first end of a range that is not the line of a row.
        wrong = next((end for pair in entry.ranges for end in pair if not np.any(lines == end)), None)
        if wrong is not None:
            raise ExclusionError(_sentence(raw, wrong), entry)
        mask = inside(lines, entry.ranges)
        out |= mask
        excluded.append(raw.of_rows(mask))
    kept = None if np.all(out) else raw.of_rows(~out) if np.any(out) else raw
    return Apart(kept, tuple(excluded))


def _sentence(raw: RawTable, wrong: int) -> str:
    first, last = int(np.min(raw.lines)), int(np.max(raw.lines))
    place = f"the readings of {raw.path.name} are in lines {ranges_text([(first, last)])}"
    if wrong > last:
        return f"line {wrong} is beyond the end of the file; {place}"
    reason = "is above the first reading" if wrong < first else "holds no reading"
    return f"line {wrong} {reason}; {place}"
