"""Names of the sheets of Excel workbooks: ``book.xlsx#Sheet``, wherever the name of a recording is expected."""

import re
from pathlib import Path

WORKBOOKS = (".xlsx", ".xlsm")
MARK = "#"
ADDRESS = re.compile(rf"(.+(?:{'|'.join(map(re.escape, WORKBOOKS))})){MARK}(.+)", re.IGNORECASE)


def file_of(path: str | Path) -> Path:
    """The file to open: the workbook of a sheet, else the path itself."""
    found = ADDRESS.fullmatch(str(path))
    return Path(found[1]) if found else Path(path)


def sheet_of(path: str | Path) -> str:
    """The sheet that the path names; "" if it names a whole file."""
    found = ADDRESS.fullmatch(str(path))
    return found[2] if found else ""


def sheet_in(workbook: Path, sheet: str) -> Path:
    """The name of a sheet of a workbook."""
    return workbook.with_name(f"{workbook.name}{MARK}{sheet}")
