"""The reader of text tables: CSV of any dialect, tab-separated ``.dat`` with title and unit lines, blanks between columns.

Separator, decimal comma and encoding are found from the first lines. A small file is read cell by cell, so that an
error can name the cell; a large one by pandas, which is fifty times as fast, and cell by cell where pandas gives up.
"""

from __future__ import annotations

import csv
import gzip
import io
import re
import zlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import IO, NamedTuple

import numpy as np
import pandas as pd

from mffit.errors import InputError
from mffit.sweeps.grid import Head, head_of, table_of
from mffit.sweeps.raw_table import Cells, RawTable

UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
SEPARATORS = ("\t", ";", "|", ",")
"""In the order in which they are believed: a comma may also be a decimal comma."""
BLANKS = " "
LARGE = 2_000_000  # bytes
HEAD = 65_536  # bytes from which the dialect is found
DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+(?:[eE][-+]?\d+)?")
DECIMAL_POINT = re.compile(r"[-+]?\d*\.\d*(?:[eE][-+]?\d+)?")


class Dialect(NamedTuple):
    """How a text file writes its cells."""

    separator: str
    comma: bool  #: decimals follow a comma
    encoding: str


def read_csv(path: Path) -> RawTable:
    """Read a text table, also ``.gz``; blank lines and ``#`` lines are passed over.

    Raises
    ------
    InputError
        The file is missing, empty, not text, ragged, without data, or a heading is empty or appears twice.
    """
    dialect = _dialect(path)
    if _size(path) > LARGE:
        found = _fast(path, dialect)
        if found is not None:
            return found
    rows, lines = [], []
    try:
        for line, cells in _rows(_text(path, dialect), dialect):
            rows.append(cells)
            lines.append(line)
    except csv.Error as error:
        line = lines[-1] + 1 if lines else 1
        raise InputError(f"is not valid CSV ({error}); correct it", file=path, line=line) from None
    return table_of(rows, lines, path)


def _dialect(path: Path) -> Dialect:
    head = _bytes(path, HEAD)
    encoding = _encoding(head)
    if encoding is None:
        raise InputError("is binary, not plain text; save it as CSV in UTF-8", file=path)
    text = head.decode(encoding, errors="replace")
    if len(head) == HEAD:
        text = text[: text.rfind("\n")] if "\n" in text else text
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")][:200]
    separator = next((mark for mark in SEPARATORS if _fits(lines, mark)), None)
    if separator is None:
        counts = Counter(len(line.split()) for line in lines)
        separator = BLANKS if counts and counts.most_common(1)[0][0] > 1 else ","
        if separator == BLANKS and any("," in line for line in lines[:1]):
            separator = ","
    cells = [cell.strip() for line in lines[1:] for cell in _split(line, separator)]
    commas = sum(bool(DECIMAL_COMMA.fullmatch(cell)) for cell in cells)
    points = sum(bool(DECIMAL_POINT.fullmatch(cell)) for cell in cells)
    return Dialect(separator, separator != "," and commas > 0 and points == 0, encoding)


def _fits(lines: list[str], separator: str) -> bool:
    """Whether most lines have the same number of cells, two or more."""
    if not lines:
        return False
    counts = Counter(len(_split(line, separator)) for line in lines)
    usual, number = counts.most_common(1)[0]
    return usual > 1 and number >= 0.5 * len(lines)


def _split(line: str, separator: str) -> list[str]:
    if separator == BLANKS:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator), [])
    except csv.Error:
        return line.split(separator)


def _encoding(head: bytes) -> str | None:
    if head.startswith(UTF16_MARKS):
        return "utf-16"
    if b"\0" in head[:4096]:
        return None
    try:
        # The end of the excerpt may cut a letter in two.
        head[: max(len(head) - 4, 0) if len(head) == HEAD else len(head)].decode("utf-8-sig")
    except UnicodeDecodeError:
        return "latin-1"
    return "utf-8-sig"


def _rows(text: str, dialect: Dialect) -> Iterator[tuple[int, tuple[str, ...]]]:
    """Line and stripped cells of every row that is neither blank nor a comment."""
    if dialect.separator == BLANKS:
        for number, words in enumerate(text.splitlines(), start=1):
            if words.strip() and not words.lstrip().startswith("#"):
                yield number, tuple(_point(cell, dialect) for cell in words.split())
        return
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=dialect.separator)
    before = 0
    for cells in reader:
        # A quoted cell may span lines: the row begins behind where the one before it ended.
        line, before = before + 1, reader.line_num
        row = tuple(_point(cell.strip(), dialect) for cell in cells)
        if any(row) and not row[0].startswith("#"):
            yield line, row


def _point(cell: str, dialect: Dialect) -> str:
    return cell.replace(",", ".") if dialect.comma and DECIMAL_COMMA.fullmatch(cell) else cell


def _fast(path: Path, dialect: Dialect) -> RawTable | None:
    """The table by pandas; None where it is not sure of every row."""
    head, line = _head(path, dialect)
    separator = r"\s+" if dialect.separator == BLANKS else dialect.separator
    try:
        table = pd.read_csv(
            path,
            sep=separator,
            decimal="," if dialect.comma else ".",
            header=None,
            names=list(head.headings),
            index_col=False,
            skiprows=line,
            comment="#",
            skipinitialspace=True,
            encoding=dialect.encoding,
            encoding_errors="replace",
            engine="c",
            on_bad_lines="error",
            compression="gzip" if path.name.endswith(".gz") else None,
        )
        lines = _lines(path, line, len(table))
    except (ValueError, OSError, EOFError, zlib.error, MemoryError):
        return None
    if lines is None or not len(table):
        return None
    return RawTable(
        headings=head.headings,
        units=head.units,
        cells=tuple(_column(table.pop(name)) for name in head.headings),
        lines=lines,
        path=path,
        heading_line=line - (head.rows - head.at) + 1,
        about={"title": head.title} if head.title else {},
    )


def _head(path: Path, dialect: Dialect) -> tuple[Head, int]:
    """The head of a large file and the number of its last line."""
    text = _bytes(path, HEAD).decode(dialect.encoding, errors="replace")
    found = list(_rows(text[: text.rfind("\n")], dialect))
    head = head_of([row for _, row in found], [line for line, _ in found], path)
    return head, found[head.rows - 1][0]


def _column(column: pd.Series) -> Cells:
    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        return column.to_numpy(dtype=float)
    return column.fillna("").astype(str).str.strip().tolist()


def _lines(path: Path, head: int, rows: int) -> range | np.ndarray | None:
    """Line of every row behind the head; None if the lines are not the rows."""
    count, last = 0, b"\n"
    with _opened(path) as file:
        while chunk := file.read(1 << 20):
            count += chunk.count(b"\n")
            last = chunk[-1:]
    count += last != b"\n"
    if count - head == rows:
        return range(head + 1, head + 1 + rows)
    passed_over = []
    with _opened(path) as file:
        for number, line in enumerate(file, start=1):
            if number > head and (not line.strip() or line.lstrip().startswith(b"#")):
                passed_over.append(number)
    if count - head - len(passed_over) != rows:
        return None
    every = np.arange(head + 1, count + 1)
    return every[~np.isin(every, passed_over)]


def _text(path: Path, dialect: Dialect) -> str:
    raw = _bytes(path)
    try:
        return raw.decode(dialect.encoding)
    except UnicodeDecodeError:
        return raw.decode("utf-16" if dialect.encoding == "utf-16" else "latin-1", errors="replace")


def _size(path: Path) -> int:
    return path.stat().st_size * (4 if path.name.endswith(".gz") else 1)


def _opened(path: Path) -> IO[bytes]:
    return gzip.open(path, "rb") if path.name.endswith(".gz") else path.open("rb")  # type: ignore[return-value]


def _bytes(path: Path, most: int = -1) -> bytes:
    """The file's first bytes, unpacked; all of them by default."""
    try:
        with _opened(path) as file:
            return file.read(most)
    except FileNotFoundError:
        raise InputError("there is no such file; correct its name", file=path) from None
    except IsADirectoryError:
        raise InputError("is a folder; name the files in it", file=path) from None
    except (gzip.BadGzipFile, EOFError, zlib.error):
        raise InputError("is not a complete gzip file; compress it again", file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); check its permissions", file=path) from None
