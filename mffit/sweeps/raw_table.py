"""Headings and cells of a file, before headings and units are interpreted."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from mffit.errors import InputError
from mffit.sweeps.about import WORDS
from tir.errors import counted
from tir.frozen import ReadOnlyArrays

Cells = Sequence[str | float] | np.ndarray
"""One column (n,): an array of floats if the file holds only numbers in it, else the cells as written."""


@dataclass(frozen=True, slots=True)
class RawTable(ReadOnlyArrays):
    """The content of one file; ``lines`` and every column of ``cells`` have the same length (n,).

    Raises
    ------
    InputError
        There are no rows, a heading is empty or appears twice, or a column's length differs from the number of rows.
    """

    headings: tuple[str, ...]
    units: tuple[str, ...]  #: as the file states them, "" if it does not
    cells: tuple[Cells, ...]  #: one column per heading; text is stripped of blanks
    lines: Sequence[int] | np.ndarray  #: line of each row, from 1; in binary formats the row's number
    path: Path
    heading_line: int | None  #: None in formats without lines
    about: Mapping[str, str] = field(default_factory=dict)  #: the file's own texts: tyre, test, source, title
    others: tuple[str, ...] = ()  #: other sheets of the workbook that have data

    def __post_init__(self) -> None:
        ReadOnlyArrays.__post_init__(self)
        if not self.headings or not len(self.lines):
            raise InputError("has no rows; write one per point or sample", file=self.path)
        if "" in self.headings or len(set(self.headings)) < len(self.headings):
            sentence = "has a heading that is empty or appears twice; rename that column"
            raise InputError(sentence, file=self.path, line=self.heading_line)
        for heading, cells in zip(self.headings, self.cells, strict=True):
            if len(cells) != len(self):
                sentence = (
                    f"has {counted(len(cells), 'value')} for {counted(len(self), 'row')}; write one per row"
                )
                raise InputError(sentence, file=self.path, column=heading)

    def __len__(self) -> int:
        return len(self.lines)

    def column(self, heading: str) -> Cells:
        """The cells under a heading."""
        return self.cells[self.headings.index(heading)]

    def unit(self, heading: str) -> str:
        """The unit that the file states for a heading; "" if it states none."""
        return self.units[self.headings.index(heading)]

    def of_rows(self, mask: np.ndarray) -> RawTable:
        """The table of some rows, (n,) of bool."""
        rows = np.flatnonzero(mask)

        def some(cells: Cells) -> Cells:
            return cells[rows] if isinstance(cells, np.ndarray) else [cells[row] for row in rows.tolist()]

        return replace(self, cells=tuple(map(some, self.cells)), lines=np.asarray(self.lines)[rows])


def with_values(raw: RawTable, values: Mapping[str, float]) -> RawTable:
    """The table with columns of one value each, without a unit, in place of those with these headings."""
    kept = [k for k, heading in enumerate(raw.headings) if heading not in values]
    return replace(
        raw,
        headings=(*(raw.headings[k] for k in kept), *values),
        units=(*(raw.units[k] for k in kept), *("" for _ in values)),
        cells=(
            *(raw.cells[k] for k in kept),
            *(np.full(len(raw), float(value)) for value in values.values()),
        ),
    )


NUMBER_WITH_COMMA = re.compile(r"[-+]?(?:\d*|\d{1,3}(?:\.\d{3})+),\d+(?:[eE][-+]?\d+)?")
"""A number with a decimal comma, with or without points between thousands: ``-8,0``, ``1.500,0``."""
THOUSANDS_WITH_POINT = re.compile(r"[-+]?[1-9]\d{0,2}(?:\.\d{3})+")
THOUSANDS_WITH_COMMA = re.compile(r"[-+]?[1-9]\d{0,2}(?:,\d{3})+")


def has_decimal_comma(cell: str) -> bool:
    """Whether a cell is a number with a decimal comma."""
    return NUMBER_WITH_COMMA.fullmatch(cell) is not None


def with_decimal_point(cell: str) -> str:
    """The number with a decimal point; any other text unchanged."""
    return cell.replace(".", "").replace(",", ".") if has_decimal_comma(cell) else cell


def is_spreadsheet_error(cell: str) -> bool:
    """Whether a cell is a spreadsheet's error code, such as ``#NV``."""
    return cell.lower() in WORDS["spreadsheet_error"]


def is_summary(cell: str) -> bool:
    """Whether a cell marks its row as statistics of the other rows."""
    return cell.lower().rstrip(".: ") in WORDS["statistics"]


def without_commas(cell: str) -> str:
    """A number from a file with decimal commas, rewritten with a decimal point and without separators of thousands."""
    return cell.replace(".", "") if THOUSANDS_WITH_POINT.fullmatch(cell) else with_decimal_point(cell)
