"""Title, headings and units from the rows above the data of a text table or spreadsheet."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from mffit.errors import InputError
from mffit.sweeps.raw_table import with_decimal_point
from mffit.sweeps.units import is_unit

Row = Sequence[str | float]

WITH_UNIT = re.compile(r"^(.*\S)\s*[\[(]\s*([^\[\]()]*)\s*[\])]$")
"""A heading followed by its unit: ``FY [N]``, ``Fz (kN)``."""


class Head(NamedTuple):
    """The rows above the data."""

    headings: tuple[str, ...]
    units: tuple[str, ...]
    at: int  #: index of the row of headings
    rows: int  #: number of rows up to and including headings and units
    title: str  #: text above the headings


def without_data(path: Path, line: int) -> InputError:
    """The error about a table without rows."""
    return InputError("has headings but no data; add one row per point", file=path, line=line)


def ragged(count: int, width: int, path: Path, line: int) -> InputError:
    """The error about a row whose number of cells differs from that of the headings."""
    remedy = "complete or remove this row"
    if count > width:
        remedy = "remove the cells too many, or the row, or write decimal points if decimal commas split the numbers"
    return InputError(f"has {count} cells under {width} headings; {remedy}", file=path, line=line)


def head_of(rows: Sequence[Row], lines: Sequence[int], path: Path) -> Head:
    """Headings and units in the first rows of a table, none of them empty, whose cells are stripped of blanks."""
    if not rows:
        raise InputError("is empty; write one line of headings and one row per point", file=path)
    widths = Counter(_width(row) for row in rows)
    usual = max(widths, key=lambda width: (widths[width], width))
    # The headings are the first row with most cells filled, because a title fills few.
    at = next((k for k, row in enumerate(rows) if 2 * sum(c != "" for c in row) > usual), 0)
    found = _trimmed(rows[at])
    headings = tuple(str(cell) for cell in found)
    if all(is_number(cell) for cell in found):
        above = [_width(row) for row in rows[:at] if not any(is_number(cell) for cell in row if cell != "")]
        if above and max(above) > 1:  # headings, and rows with more cells than headings
            raise ragged(len(found), max(above), path, lines[at])
        sentence = "has numbers instead of headings; add a first line of headings"
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
    """Units from the row below the headings, all "" without a row of units; and the number of rows above the data."""
    nothing = ("",) * width, at + 1
    if at + 1 >= len(rows):
        return nothing
    row = _trimmed(rows[at + 1])
    texts = [str(cell).strip("[]() ") for cell in row]
    stated = [text for text in texts if text]
    if any(is_number(cell) for cell in row) or len(row) > width or not all(is_unit(text) for text in stated):
        return nothing
    return (*texts, *("",) * (width - len(texts))), at + 2


def _check_headings(path: Path, line: int, headings: tuple[str, ...]) -> None:
    if "" in headings:
        number = headings.index("") + 1
        raise InputError(f"heading {number} is empty; name or remove that column", file=path, line=line)
    twice = [heading for number, heading in enumerate(headings) if heading in headings[:number]]
    if twice:
        raise InputError("appears twice; rename or remove one", file=path, line=line, column=twice[0])


def _trimmed(row: Row) -> Row:
    return row[: _width(row)]


def _width(row: Row) -> int:
    """Number of cells up to the last filled one."""
    return max((k + 1 for k, cell in enumerate(row) if cell != ""), default=0)


def is_number(cell: str | float) -> bool:
    """Whether a cell is a number, with a decimal point or comma."""
    if not isinstance(cell, str):
        return True
    try:
        float(with_decimal_point(cell))
    except ValueError:
        return False
    return True
