"""The file formats of sweeps; a new format needs a reader and one record in ``FORMATS``."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from mffit.errors import check_readable
from mffit.sheets import WORKBOOKS, file_of, sheet_of
from mffit.sweeps.clock_times import with_clock_times
from mffit.sweeps.csv_text import read_csv
from mffit.sweeps.matlab import read_mat
from mffit.sweeps.parquet import read_parquet
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.spreadsheet import read_xlsx, sheets_with_data
from mffit.sweeps.tydex import read_tydex
from mffit.sweeps.wide import with_load_of_names


class Format(NamedTuple):
    """One file format."""

    name: str  #: for messages
    endings: tuple[str, ...]  #: of file names, in lower case
    read: Callable[[Path], RawTable]  #: raises InputError with file and line
    axes: str = ""  #: axes that the format prescribes; "" if none


FORMATS = (
    Format("CSV", (".csv", ".csv.gz", ".txt", ".txt.gz", ".tsv", ".tsv.gz", ".dat", ".dat.gz"), read_csv),
    Format("MATLAB", (".mat",), read_mat),
    Format("Excel", WORKBOOKS, read_xlsx),
    Format("Parquet", (".parquet",), read_parquet),
    Format("TYDEX", (".tdx", ".tdx.gz", ".tda", ".tdb"), read_tydex, axes="iso"),
)
_KEPT: ContextVar[dict[Path, RawTable] | None] = ContextVar("kept", default=None)
LARGEST_TABLE_KEPT = 5_000_000
"""Maximum number of cells of a table that stays in memory while a command reads the same file repeatedly."""
ENDINGS = tuple(ending for kind in FORMATS for ending in kind.endings)


def read(path: Path) -> RawTable:
    """Read a file in the format that its ending names, CSV by default.

    Raises
    ------
    InputError
        The file cannot be read or is too large.
    """
    kept, place = _KEPT.get(), path.absolute()
    if kept is not None and place in kept:
        return replace(kept[place], path=path)
    check_readable(file_of(path))
    found = with_load_of_names(with_clock_times(format_of(path).read(path)))
    if kept is not None and len(found) * len(found.headings) < LARGEST_TABLE_KEPT:
        kept[place] = found
    return found


@contextmanager
def reading_once() -> Iterator[None]:
    """Within this block, every file is read only once; large files are not kept in memory."""
    if _KEPT.get() is not None:
        yield
        return
    token = _KEPT.set({})
    try:
        yield
    finally:
        _KEPT.reset(token)


def format_of(path: Path) -> Format:
    """The format that the file's ending names, CSV by default."""
    name = file_of(path).name.lower()
    return next((kind for kind in FORMATS if name.endswith(kind.endings)), FORMATS[0])


def tables_of(path: Path) -> list[Path]:
    """The tables of a file by name: the sheets with data of a workbook that has several, else the path itself.

    Raises InputError if the workbook cannot be read.
    """
    return sheets_with_data(path) if format_of(path).read is read_xlsx else [path]


def stem(path: str) -> str:
    """The name of a file without folder and without the ending of a known format; ``book:Sheet`` for a sheet."""
    name = file_of(path).name
    ending = max((ending for ending in ENDINGS if name.lower().endswith(ending)), key=len, default="")
    return ":".join(filter(None, (name[: len(name) - len(ending)], sheet_of(path))))
