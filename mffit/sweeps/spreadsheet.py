"""The reader of Excel workbooks: the only visible sheet with data, or the one that is named (``book.xlsx#Sheet``)."""

import zipfile
from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

from mffit.errors import InputError
from mffit.sheets import file_of, sheet_in, sheet_of
from mffit.sweeps.csv_text import table_of
from mffit.sweeps.extras import BYTES_OF_A_NUMBER, check_size, needed, undamaged
from mffit.sweeps.grid import is_number
from mffit.sweeps.raw_table import THOUSANDS_WITH_COMMA, RawTable, has_decimal_comma, with_decimal_point
from tir.errors import some

KIND = "Excel workbook"
Row = tuple[str | float, ...]


def read_xlsx(path: Path) -> RawTable:
    """Read a sheet: headings, optionally a row of units, then numbers; a formula counts as its last value.

    Raises InputError if the file is not a workbook, the sheet is missing or has no table, several visible sheets have data and
    none is named, or openpyxl is not installed.
    """
    with _opened(path) as book:
        data = _with_data(book, path)
        sheet = _named(book, sheet_of(path), path) if sheet_of(path) else _only(book, data, path)
        table = table_of(_with_points(list(_rows(sheet, path))), path)
    return replace(table, others=tuple(one.title for one in data if one.title != sheet.title))


def sheets_with_data(path: Path) -> list[Path]:
    """The visible sheets with data, by name; the path itself if it names a sheet, or if there are not several of them."""
    if sheet_of(path):
        return [path]
    with _opened(path) as book:
        shown = [sheet.title for sheet in _with_data(book, path) if _is_visible(sheet)]
    return [sheet_in(path, title) for title in shown] if len(shown) > 1 else [path]


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """The workbook that a path or the name of a sheet names."""
    file = file_of(path)
    openpyxl = needed("openpyxl", "Excel workbooks", file)
    with undamaged(file, KIND), zipfile.ZipFile(file) as members:
        check_size(sum(member.file_size for member in members.infolist()), file)
    with (
        undamaged(file, KIND),
        file.open("rb") as packed,  # openpyxl leaves a file of its own open where reading ends early
        closing(openpyxl.load_workbook(packed, read_only=True, data_only=True, keep_links=False)) as book,
    ):
        yield book


def _rows(sheet: Any, path: Path) -> Iterator[Row]:
    """The rows of a sheet, which may claim to have more of them than it holds."""
    cells = 0
    for row in sheet.iter_rows(values_only=True):
        yield tuple(_cell(value) for value in row)
        cells += len(row)
        check_size(BYTES_OF_A_NUMBER * cells, file_of(path))


def _with_data(book: Any, path: Path) -> list[Any]:
    """The sheets in which several rows have several numbers; a cover sheet may list the loads of a test in one row."""

    def has_data(sheet: Any) -> bool:
        of_numbers = (row for row in _rows(sheet, path) if sum(c != "" and is_number(c) for c in row) > 1)
        return len(list(islice(of_numbers, 2))) > 1

    return [sheet for sheet in book.worksheets if has_data(sheet)]


def _named(book: Any, title: str, path: Path) -> Any:
    titles = {sheet.title.lower(): sheet for sheet in book.worksheets}
    if title.lower() not in titles:
        there = ", ".join(f'"{sheet.title}"' for sheet in book.worksheets)
        raise InputError(f'has no sheet "{title}"; its sheets are {there}', file=file_of(path))
    return titles[title.lower()]


def _only(book: Any, data: Sequence[Any], path: Path) -> Any:
    """The visible sheet with data, else the first with a table, whose fault the reader then names."""

    def is_table(sheet: Any) -> bool:
        return any(sum(cell != "" for cell in row) > 1 for row in _rows(sheet, path))

    shown = [*filter(_is_visible, data)]
    if len(shown) > 1:
        quoted = some([f'"{sheet.title}"' for sheet in shown])
        raise InputError(
            f"has data in the sheets {quoted}: name the one to read, {sheet_in(path, shown[0].title).name}; a tyre.toml has a "
            "[[sweep]] for every sheet, as `mffit init --from` writes them",
            file=path,
        )
    found = next(iter(shown), None) or next(filter(is_table, book.worksheets), None)
    if found is None:
        raise InputError("has no sheet with a table; put headings above the columns", file=path)
    return found


def _is_visible(sheet: Any) -> bool:
    return bool(sheet.sheet_state == "visible")


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
