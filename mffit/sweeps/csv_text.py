"""The reader of text tables: CSV of any dialect, tab-separated ``.dat`` with title and unit lines, columns between blanks.

Separator, decimal comma and encoding are found from the first lines. A small file is read cell by cell, so that an
error can name the cell. A large file is read by pandas, which is fifty times as fast, and cell by cell if pandas fails.
"""

from __future__ import annotations

import csv
import io
import re
import zlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.errors import InputError
from mffit.sweeps import constants
from mffit.sweeps.extras import first_bytes, is_packed, opened
from mffit.sweeps.grid import Head, head_of, is_summary, table_of
from mffit.sweeps.raw_table import (
    SPREADSHEET_ERRORS,
    THOUSANDS_WITH_POINT,
    Cells,
    RawTable,
    has_decimal_comma,
    is_spreadsheet_error,
    without_commas,
)

UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
SEPARATORS = ("\t", ";", "|", ",")
"""Sorted by priority: a comma is last, because it may also be a decimal comma."""
BLANKS = " "
HEAD = 65_536
"""Bytes at the start of a file that show separator, decimal comma and encoding."""
COMMENT = re.compile(
    rb"^[ \t]*#(?!(?:%s)[\t;|, ])[^\n]*"
    % "|".join(re.escape(error[1:]) for error in sorted(SPREADSHEET_ERRORS)).encode(),
    re.MULTILINE | re.IGNORECASE,
)
NUMBER_WITH_POINT = re.compile(r"[-+]?\d*\.\d*(?:[eE][-+]?\d+)?")


class Dialect(NamedTuple):
    """How a text file writes its cells."""

    separator: str
    has_comma: bool  #: decimal comma instead of point
    encoding: str


def read_csv(path: Path) -> RawTable:
    """Read a text table, also ``.gz``; blank lines and lines that begin with ``#`` are skipped.

    Raises
    ------
    InputError
        The file is missing, empty, not text, ragged, without data, or a heading is empty or appears twice.
    """
    dialect = _dialect(path)
    if _size(path) > constants.LARGE_TEXT_FILE:
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
    head = first_bytes(path, HEAD)
    encoding = _encoding(head)
    if encoding is None:
        raise InputError("is binary, not plain text; save it as CSV in UTF-8", file=path)
    text = head.decode(encoding, errors="replace")
    if len(head) == HEAD:
        text = text[: text.rfind("\n")] if "\n" in text else text
    lines = [line for line in text.splitlines() if line.strip() and not line.lstrip().startswith("#")]
    lines = lines[:200]
    separator = _separator(lines)
    cells = [cell.strip() for line in lines[1:] for cell in _split(line, separator)]
    has_comma = separator != "," and any(map(has_decimal_comma, cells))
    with_point = [cell for cell in cells if NUMBER_WITH_POINT.fullmatch(cell)]
    if any("." in cell for cell in cells if has_decimal_comma(cell)):
        with_point = [cell for cell in with_point if not THOUSANDS_WITH_POINT.fullmatch(cell)]
    return Dialect(separator, has_comma and not with_point, encoding)


def _separator(lines: list[str]) -> str:
    """The first separator that makes rows of equal length, else blanks, else a comma."""
    for mark in SEPARATORS:
        if _fits(lines, mark):
            return mark
    counts = Counter(len(line.split()) for line in lines)
    has_columns = bool(counts) and counts.most_common(1)[0][0] > 1
    return BLANKS if has_columns and "," not in lines[0] else ","


def _fits(lines: list[str], separator: str) -> bool:
    """Whether most lines have the same number of cells, two or more."""
    if not lines:
        return False
    counts = Counter(len(_split(line, separator)) for line in lines)
    usual, number = counts.most_common(1)[0]
    return usual > 1 and 2 * number >= len(lines)


def _split(line: str, separator: str) -> list[str]:
    if separator == BLANKS:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator), [])
    except csv.Error:
        return line.split(separator)


def _encoding(head: bytes) -> str | None:
    """Encoding of a text; None for binary data."""
    if head.startswith(UTF16_MARKS):
        return "utf-16"
    if b"\0" in head[:4096]:
        return None
    try:
        # The excerpt may end within a character.
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
        # A quoted cell may span lines, so a row begins one line after the end of the row before it.
        line, before = before + 1, reader.line_num
        row = tuple(_point(cell.strip(), dialect) for cell in cells)
        if any(row) and (not row[0].startswith("#") or is_spreadsheet_error(row[0])):
            yield line, row


def _point(cell: str, dialect: Dialect) -> str:
    return without_commas(cell) if dialect.has_comma else cell


def _fast(path: Path, dialect: Dialect) -> RawTable | None:
    """The table as read by pandas; None if pandas fails or the line of each row is not certain."""
    head, line = _head(path, dialect)
    separator = r"\s+" if dialect.separator == BLANKS else dialect.separator
    try:
        source, count = _source(path)
        table = pd.read_csv(
            source,
            sep=separator,
            decimal="," if dialect.has_comma else ".",
            header=None,
            names=list(head.headings),
            index_col=False,
            skiprows=line,
            skip_blank_lines=False,
            skipinitialspace=True,
            encoding=dialect.encoding,
            encoding_errors="replace",
            engine="c",
            on_bad_lines="error",
            compression="gzip" if source is path and is_packed(path) else None,
        )
        filled = table.iloc[:, 0].notna().to_numpy()
        if not filled.all():
            filled = np.asarray(table.notna().to_numpy().any(axis=1))
        if not filled.any() or line + len(filled) != count:
            return None
    except (ValueError, OSError, EOFError, zlib.error, MemoryError):
        return None
    table = table if filled.all() else table.loc[filled]
    columns = tuple(_column(table.pop(name), dialect) for name in head.headings)
    if any(not isinstance(cells, np.ndarray) and any(map(is_summary, set(cells))) for cells in columns):
        return None
    return RawTable(
        headings=head.headings,
        units=head.units,
        cells=columns,
        lines=np.flatnonzero(filled) + line + 1,
        path=path,
        heading_line=line - (head.rows - head.at) + 1,
        about={"title": head.title} if head.title else {},
    )


def _head(path: Path, dialect: Dialect) -> tuple[Head, int]:
    """The head of a large file and the number of its last line."""
    text = first_bytes(path, HEAD).decode(dialect.encoding, errors="replace")
    found = list(_rows(text[: text.rfind("\n")], dialect))
    head = head_of([row for _, row in found], [line for line, _ in found], path)
    return head, found[head.rows - 1][0]


def _column(column: pd.Series, dialect: Dialect) -> Cells:
    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        return column.to_numpy(dtype=float)
    return [_point(cell, dialect) for cell in column.fillna("").astype(str).str.strip()]


def _source(path: Path) -> tuple[Path | io.BytesIO, int]:
    """What pandas reads, with a blank line in place of every comment, and the number of its lines."""
    count, last, has_marks = 0, b"\n", False
    with opened(path) as file:
        while chunk := file.read(1 << 20):
            count, last = count + chunk.count(b"\n"), chunk[-1:]
            has_marks |= b"#" in chunk
    if not has_marks:
        return path, count + (last != b"\n")
    text = COMMENT.sub(b"", first_bytes(path))
    return io.BytesIO(text), text.count(b"\n") + (text[-1:] != b"\n")


def _text(path: Path, dialect: Dialect) -> str:
    raw = first_bytes(path)
    try:
        return raw.decode(dialect.encoding)
    except UnicodeDecodeError:
        return raw.decode("utf-16" if dialect.encoding == "utf-16" else "latin-1", errors="replace")


def _size(path: Path) -> float:
    """Size of the unpacked file in bytes; of a packed one, estimated as four times its size."""
    return path.stat().st_size * (4.0 if is_packed(path) else 1.0)
