"""The reader of Excel workbooks: the first sheet that has a table."""

from __future__ import annotations

from pathlib import Path

from mffit.errors import InputError
from mffit.sweeps.extras import needed
from mffit.sweeps.grid import table_of
from mffit.sweeps.raw_table import RawTable


def read_xlsx(path: Path) -> RawTable:
    """Read an ``.xlsx`` file: headings, if need be a row of units, then numbers; values, not formulae.

    Raises
    ------
    InputError
        The file is no workbook, no sheet holds a table, or openpyxl is not installed.
    """
    openpyxl = needed("openpyxl", "Excel workbooks", path)
    try:
        book = openpyxl.load_workbook(path, read_only=True, data_only=True, keep_links=False)
        try:
            for sheet in book.worksheets:
                rows = [tuple(_cell(value) for value in row) for row in sheet.iter_rows(values_only=True)]
                if any(sum(cell != "" for cell in row) > 1 for row in rows):
                    return table_of(rows, range(1, len(rows) + 1), path)
        finally:
            book.close()
    except InputError:
        raise
    except FileNotFoundError:
        raise InputError("there is no such file; correct its name", file=path) from None
    except Exception as error:  # a damaged workbook fails in whatever way its parts happen to lead to
        said = " ".join(str(error).split())[:80]
        raise InputError(
            f"is no Excel workbook that can be read ({said}); save it again", file=path
        ) from None
    raise InputError("has no sheet with a table; put headings above the columns", file=path)


def _cell(value: object) -> str | float:
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value)
    return float(value) if isinstance(value, int | float) else str(value).strip()
