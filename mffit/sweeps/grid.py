"""From rows of cells to a table: title lines, headings, a row of units, data. Shared by text files and spreadsheets."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from mffit.errors import InputError
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.units import is_unit

Row = Sequence[str | float]

WITH_UNIT = re.compile(r"^(.*\S)\s*[\[(]\s*([^\[\]()]*)\s*[\])]$")
"""A heading with its unit behind it: ``FY [N]``, ``Fz (kN)``."""


class Head(NamedTuple):
    """What stands above the data."""

    headings: tuple[str, ...]
    units: tuple[str, ...]
    at: int  #: number of the row of headings, from 0
    rows: int  #: rows up to and including headings and units
    title: str  #: whatever stands above the headings


def table_of(rows: Sequence[Row], lines: Sequence[int], path: Path) -> RawTable:
    """A table of rows, blank and comment rows left out already or empty.

    Parameters
    ----------
    rows : cells stripped of blanks, "" where there is nothing
    lines : line of each row in the file, from 1
    path : of the file, for errors

    Raises
    ------
    InputError
        No headings, no data, a heading that is empty or stands twice, or a row of another length.
    """
    filled = [(row, line) for row, line in zip(rows, lines, strict=True) if any(cell != "" for cell in row)]
    head = head_of([row for row, _ in filled], [line for _, line in filled], path)
    heading_line = filled[head.at][1]
    data = filled[head.rows :]
    width = len(head.headings)
    if not data:
        raise InputError(
            "has headings but no data; add one row per point or remove its [[sweep]]",
            file=path,
            line=heading_line,
        )
    for row, line in data:
        if len(row) != width and (len(row) < width or any(cell != "" for cell in row[width:])):
            sentence = f"has {len(row)} cells under {width} headings; complete or remove this row"
            raise InputError(sentence, file=path, line=line)
    return RawTable(
        headings=head.headings,
        units=head.units,
        cells=tuple(zip(*(row[:width] for row, _ in data), strict=True)),
        lines=tuple(line for _, line in data),
        path=path,
        heading_line=heading_line,
        about={"title": head.title} if head.title else {},
    )


def head_of(rows: Sequence[Row], lines: Sequence[int], path: Path) -> Head:
    """Headings and units of the first rows of a table, none of them empty; see :func:`table_of`."""
    if not rows:
        raise InputError("is empty; it needs one line of headings and one row per point", file=path)
    widths = Counter(_width(row) for row in rows)
    usual = max(widths, key=lambda width: (widths[width], width))
    at = next((k for k, row in enumerate(rows) if 2 * sum(c != "" for c in row) > usual), 0)
    found = _trimmed(rows[at])
    headings = tuple(str(cell) for cell in found)
    if all(is_number(cell) for cell in found):
        sentence = "there are numbers where the headings should be; add a first line of headings"
        raise InputError(sentence, file=path, line=lines[at])
    units, used = _units(rows, at, len(headings))
    split = [
        WITH_UNIT.match(heading) if not unit else None for heading, unit in zip(headings, units, strict=True)
    ]
    split = [found if found and is_unit(found[2]) else None for found in split]
    headings = tuple(found[1] if found else heading for heading, found in zip(headings, split, strict=True))
    units = tuple(found[2].strip() if found else unit for unit, found in zip(units, split, strict=True))
    _check_headings(path, lines[at], headings)
    title = " ".join(str(cell) for row in rows[:at] for cell in row if cell != "")
    return Head(headings, units, at, used, title)


def _units(rows: Sequence[Row], at: int, width: int) -> tuple[tuple[str, ...], int]:
    """The row of units below the headings, if there is one, and how many rows stand above the data."""
    nothing = ("",) * width, at + 1
    if at + 1 >= len(rows):
        return nothing
    row = _trimmed(rows[at + 1])
    texts = [str(cell).strip("[]() ") for cell in row]
    said = [text for text in texts if text]
    if any(is_number(cell) for cell in row) or len(row) > width or not all(is_unit(text) for text in said):
        return nothing
    return (*texts, *("",) * (width - len(texts))), at + 2


def _check_headings(path: Path, line: int, headings: tuple[str, ...]) -> None:
    if "" in headings:
        number = headings.index("") + 1
        raise InputError(f"heading {number} is empty; name or remove that column", file=path, line=line)
    twice = [heading for number, heading in enumerate(headings) if heading in headings[:number]]
    if twice:
        raise InputError("stands twice; rename or remove one", file=path, line=line, column=twice[0])


def _trimmed(row: Row) -> Row:
    return row[: _width(row)]


def _width(row: Row) -> int:
    """Number of cells up to the last that holds something."""
    return max((k + 1 for k, cell in enumerate(row) if cell != ""), default=0)


def is_number(cell: str | float) -> bool:
    """Whether a cell is a number, also with a decimal comma."""
    if not isinstance(cell, str):
        return True
    try:
        float(cell.replace(",", ".", 1))
    except ValueError:
        return False
    return True
