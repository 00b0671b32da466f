"""The file formats that sweeps come in; a new one is a reader and one record here."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

from mffit.sweeps.csv_text import read_csv
from mffit.sweeps.matlab import read_mat
from mffit.sweeps.parquet import read_parquet
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.spreadsheet import read_xlsx
from mffit.sweeps.tydex import read_tydex


class Format(NamedTuple):
    """One file format."""

    name: str  #: as people call it
    endings: tuple[str, ...]  #: of file names
    read: Callable[[Path], RawTable]  #: raises InputError with file and line


FORMATS = (
    Format("CSV", (".csv", ".csv.gz", ".txt", ".txt.gz", ".tsv", ".tsv.gz", ".dat", ".dat.gz"), read_csv),
    Format("MATLAB", (".mat",), read_mat),
    Format("Excel", (".xlsx", ".xlsm"), read_xlsx),
    Format("Parquet", (".parquet",), read_parquet),
    Format("TYDEX", (".tdx", ".tdx.gz"), read_tydex),
)
LARGEST_KEPT = 5_000_000
"""Cells of a file that is kept."""
_KEPT: ContextVar[dict[Path, RawTable] | None] = ContextVar("kept", default=None)
ENDINGS = tuple(ending for kind in FORMATS for ending in kind.endings)


def read(path: Path) -> RawTable:
    """Read a file by the ending of its name; a name with another ending is read as CSV."""
    kept, place = _KEPT.get(), path.absolute()
    if kept is not None and place in kept:
        return replace(kept[place], path=path)
    found = next((kind for kind in FORMATS if reads(kind, path)), FORMATS[0]).read(path)
    if kept is not None and len(found) * len(found.headings) < LARGEST_KEPT:
        kept[place] = found
    return found


@contextmanager
def reading_once() -> Iterator[None]:
    """Within it every file is read once, however often it is looked at; large ones are not kept in memory."""
    if _KEPT.get() is not None:
        yield
        return
    token = _KEPT.set({})
    try:
        yield
    finally:
        _KEPT.reset(token)


def reads(kind: Format, path: Path) -> bool:
    """Whether files of this name are of this format."""
    return path.name.lower().endswith(kind.endings)


def stem(path: str) -> str:
    """The file's name without folder and ending."""
    name = Path(path).name
    ending = max((ending for ending in ENDINGS if name.lower().endswith(ending)), key=len, default="")
    return name[: len(name) - len(ending)]
