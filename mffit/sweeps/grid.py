"""Title, headings and units from the rows above the data of a text table or spreadsheet."""

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
    """Headings and units in the first rows of a table. Rows are not empty, and their cells are stripped of blanks.

    Headings may be in two rows, where cells were merged: an upper cell names a column by itself, or the group of those below.
    A column without a heading has an empty one here.
    """
    if not rows:
        raise InputError("is empty; write one line of headings and one row per point", file=path)
    widths = Counter(_width(row) for row in rows)
    usual = max(widths, key=lambda width: (widths[width], width))
    at = _row_of_headings(rows, usual)
    _check_texts(rows, at, lines, path)
    upper, lower, used = _rows_of_headings(rows, at)
    headings, units = _headings_of(upper, lower)
    stated, used = _units(rows, used, len(headings))
    twice = [heading for number, heading in enumerate(headings) if heading and heading in headings[:number]]
    if twice:
        raise InputError("appears twice; rename or remove one", file=path, line=lines[at], column=twice[0])
    units = tuple(below or own for below, own in zip(stated, units, strict=True))
    title = " ".join(str(cell) for row in rows[:at] for cell in row if cell != "")
    return Head(headings, units, at, used, title)


def _row_of_headings(rows: Sequence[Row], usual: int) -> int:
    """Index of the first of the rows of text directly above the data; ``usual`` is the number of cells in most rows.

    A title fills only a few cells. A block of keys and values, as loggers write above the headings, contains some numbers.
    """
    full = [k for k, row in enumerate(rows) if 2 * sum(c != "" for c in row) > usual]
    data = next((k for k in full if 2 * sum(c != "" and is_number(c) for c in rows[k]) > usual), 0)
    at = next((k for k in reversed(full) if k < data and _without_numbers(rows[k])), full[0] if full else 0)
    while at - 1 in full and _without_numbers(rows[at - 1]):
        at -= 1
    return at


def _check_texts(rows: Sequence[Row], at: int, lines: Sequence[int], path: Path) -> None:
    """Refuse numbers in place of headings."""
    found = _trimmed(rows[at])
    if all(is_number(cell) for cell in found):
        above = [_width(row) for row in rows[:at] if _without_numbers(row)]
        if above and max(above) > 1:  # headings, and rows with more cells than headings
            raise ragged(len(found), max(above), path, lines[at])
        sentence = "has numbers instead of headings; add a first line of headings"
        raise InputError(sentence, file=path, line=lines[at])
    if len(found) > 2 and not is_number(found[0]) and all(is_number(cell) for cell in found[1:]):
        below = [row[0] for row in rows[at + 1 :] if row and row[0] != ""]
        sentence = f'has numbers beside "{found[0]}" where headings are expected: ' + (
            "if rows and columns are settings, write one row per point, with a column for each setting and for the reading"
            if below and all(map(is_number, below))
            else "if every row is a channel, transpose the table, so that every column is one; else write a heading above every "
            "column"
        )
        raise InputError(sentence, file=path, line=lines[at])


def _without_numbers(row: Row) -> bool:
    return not any(is_number(cell) for cell in row if cell != "")


def _rows_of_headings(rows: Sequence[Row], at: int) -> tuple[Row, Row, int]:
    """The row of groups (empty if there is none) and that of headings, one of which is row ``at``; and the row after them."""
    below = rows[at + 1] if at + 1 < len(rows) else ()
    if _without_numbers(below) and not _is_of_units(below) and _fills_gaps(below, rows[at]):
        return rows[at], below, at + 2
    above = rows[at - 1] if at else ()
    return above if _fills_gaps(above, rows[at]) else (), rows[at], at + 1


def _fills_gaps(row: Row, other: Row) -> bool:
    """Whether a row has texts where the other one has none."""
    return any(cell != "" and (k >= len(other) or other[k] == "") for k, cell in enumerate(row))


def _headings_of(groups: Row, row: Row) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Headings and units: those of the row, or of its groups where it has none; groups distinguish equal headings."""
    width = max(_width(groups), _width(row))
    group, of_group = ("", ""), sum(cell != "" for cell in groups) > 1  # a title is not a group
    found = []
    for above, own in zip(_with_units(groups, width), _with_units(row, width), strict=True):
        group = above if above[0] else group
        name, unit = own if own[0] else above
        found.append((name, unit or group[1] if of_group else unit, group[0]))
    names = [name for name, _, _ in found]
    alike = {group for name, _, group in found if name and names.count(name) > 1} - {""}
    headings = tuple(
        f"{group} {name}" if name and group in alike - {name} else name for name, _, group in found
    )
    return headings, tuple(unit for _, unit, _ in found)


def _with_units(row: Row, width: int) -> list[tuple[str, str]]:
    """The cells of a row with the unit that some have in brackets, such as ``FY [N]``."""
    cells = [str(cell) for cell in row[:width]] + [""] * (width - len(row))
    split = [(cell, WITH_UNIT.match(cell)) for cell in cells]
    return [(m[1], m[2].strip()) if m and is_unit(m[2]) else (cell, "") for cell, m in split]


def _units(rows: Sequence[Row], at: int, width: int) -> tuple[tuple[str, ...], int]:
    """Units from the first row below the headings, or from the next if that one describes the columns, and the row of the data.

    Most cells of a row of units are units; all are "" without such a row.
    """
    for k in range(at, min(at + 2, len(rows))):
        row = _trimmed(rows[k])
        if not _without_numbers(row) or len(row) > width:
            break
        if _is_of_units(row):
            return (*map(_unit, row), *("",) * (width - len(row))), k + 1
    return ("",) * width, at


def _is_of_units(row: Row) -> bool:
    """Whether most texts of a row are units."""
    stated = [text for text in map(_unit, row) if text]
    return 2 * sum(map(is_unit, stated)) > len(stated)


def _unit(cell: str | float) -> str:
    """A unit without the brackets around it."""
    text = str(cell)
    return text.strip("[]() ") if text[:1] in ("[", "(") else text


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
