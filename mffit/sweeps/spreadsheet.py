"""The reader of Excel workbooks: the first sheet that has a table."""

from __future__ import annotations

import zipfile
from contextlib import closing
from pathlib import Path

from mffit.errors import InputError
from mffit.sweeps.csv_text import table_of
from mffit.sweeps.extras import BYTES_OF_A_NUMBER, check_size, needed, undamaged
from mffit.sweeps.raw_table import THOUSANDS_WITH_COMMA, RawTable, has_decimal_comma, with_decimal_point


def read_xlsx(path: Path) -> RawTable:
    """Read an ``.xlsx`` file: headings, optionally a row of units, then numbers; a formula counts as its last value.

    Raises InputError if the file is not a workbook, no sheet has a table, or openpyxl is not installed.
    """
    openpyxl = needed("openpyxl", "Excel workbooks", path)
    with undamaged(path, "Excel workbook"), zipfile.ZipFile(path) as members:
        check_size(sum(member.file_size for member in members.infolist()), path)
    with (
        undamaged(path, "Excel workbook"),
        path.open("rb") as packed,  # openpyxl leaves a file of its own open where reading ends early
        closing(openpyxl.load_workbook(packed, read_only=True, data_only=True, keep_links=False)) as book,
    ):
        for sheet in book.worksheets:
            rows, cells = [], 0
            for row in sheet.iter_rows(values_only=True):
                rows.append(tuple(_cell(value) for value in row))
                cells += len(row)  # also those that a workbook only claims to have
                check_size(BYTES_OF_A_NUMBER * cells, path)
            if any(sum(cell != "" for cell in row) > 1 for row in rows):
                return table_of(_with_points(rows), path)
    raise InputError("has no sheet with a table; put headings above the columns", file=path)


def _with_points(rows: list[tuple[str | float, ...]]) -> list[tuple[str | float, ...]]:
    """The rows with decimal points in place of decimal commas; unchanged if all commas may separate thousands."""
    texts = {cell for row in rows for cell in row if isinstance(cell, str)}
    with_comma = {cell for cell in texts if has_decimal_comma(cell)}
    if all(map(THOUSANDS_WITH_COMMA.fullmatch, with_comma)):
        return rows
    return [tuple(with_decimal_point(cell) if cell in with_comma else cell for cell in row) for row in rows]


def _cell(value: object) -> str | float:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value)
    return float(value) if isinstance(value, int | float) else str(value).strip()
