"""The reader of text tables: CSV of any dialect, tab-separated ``.dat`` with title and unit lines, columns between blanks.

The first lines show separator, decimal comma and headings; pandas reads the rows below them.
"""

import csv
import io
import re
import warnings
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.errors import InputError
from mffit.sweeps.about import WORDS
from mffit.sweeps.channels import SWEEP_CHANNELS
from mffit.sweeps.extras import content_of
from mffit.sweeps.grid import head_of, ragged, without_data
from mffit.sweeps.raw_table import (
    THOUSANDS_WITH_COMMA,
    THOUSANDS_WITH_POINT,
    Cells,
    RawTable,
    has_decimal_comma,
    without_commas,
)

UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
SEPARATORS = ("\t", ";", "|", ",")
"""Separators by priority; the comma is last, because it may also be a decimal comma."""
BLANKS = " "
HEAD = 65_536
"""Bytes at the start of a file that show separator, decimal comma and headings."""
COMMENT = re.compile(
    rb"^[ \t]*#(?!(?:%s)[\t;|, ])[^\n]*"
    % "|".join(re.escape(error[1:]) for error in sorted(WORDS["spreadsheet_error"])).encode(),
    re.MULTILINE | re.IGNORECASE,
)
NUMBER_WITH_POINT = re.compile(r"[-+]?\d*\.\d*(?:[eE][-+]?\d+)?")
LABELS = frozenset(channel.name for channel in SWEEP_CHANNELS if channel.kind == "label")
"""Columns that are texts even if they look like numbers."""


class Dialect(NamedTuple):
    """Separator and decimal mark of a text file."""

    separator: str
    has_comma: bool  #: decimal comma instead of point


class Body(NamedTuple):
    """The lines of a text below its headings."""

    text: bytes
    dialect: Dialect
    path: Path
    above: int  #: number of lines above them


def read_csv(path: Path) -> RawTable:
    """Read a text table, also ``.gz``; blank lines and lines that begin with ``#`` are skipped.

    A column without a heading is left out if it is empty, else named by its number.

    Raises InputError if the file is missing, empty, not text, ragged, without data, or a heading appears twice.
    """
    return _table_of_text(_utf8(path), path)


def table_of(rows: Iterable[Sequence[str | float]], path: Path) -> RawTable:
    """The table in a spreadsheet's rows of cells; the line of a row is its number in the sheet."""
    text = io.StringIO()
    lines = csv.writer(text, delimiter="\t", lineterminator="\n")
    lines.writerows([" ".join(c.split()) if isinstance(c, str) else c for c in row] for row in rows)
    return _table_of_text(text.getvalue().encode(errors="replace"), path)


def _table_of_text(content: bytes, path: Path) -> RawTable:
    """The table that a text in UTF-8 holds."""
    if b"#" in content:
        content = COMMENT.sub(b"", content)
    end = len(content) if len(content) <= HEAD else content.rfind(b"\n", 0, HEAD)
    text = content[:end].decode(errors="replace")
    dialect = _dialect(text)
    first = list(_rows(text, dialect))
    head = head_of([row for _, row in first], [line for line, _ in first], path)
    heading_line = first[head.at][0]
    if len(first) == head.rows:
        raise without_data(path, heading_line)
    above = first[head.rows][0] - 1
    body = Body(content.split(b"\n", above)[above], dialect, path, above)
    widest = max(len(head.headings), *(len(row) for _, row in first[head.rows :]))
    names = [heading or f"column {k}" for k, heading in enumerate(head.headings, 1)]
    table = _table(body, (*names, *range(widest - len(names))))
    filled = np.flatnonzero(table.notna().any(axis=1).to_numpy())
    _check_widths(body, table, filled, len(head.headings))
    table = table.iloc[filled] if len(filled) < len(table) else table
    columns = dict(table.items())
    kept = [k for k, name in enumerate(names) if head.headings[k] or columns[name].notna().any()]
    return RawTable(
        headings=tuple(names[k] for k in kept),
        units=tuple(head.units[k] for k in kept),
        cells=tuple(_cells(columns[names[k]], dialect) for k in kept),
        lines=filled + above + 1,
        path=path,
        heading_line=heading_line,
        about={"title": head.title} if head.title else {},
    )


def _utf8(path: Path) -> bytes:
    """The text in UTF-8, with ``\\n`` at the end of its lines."""
    content = content_of(path)
    if content.startswith(UTF16_MARKS):
        content = content.decode("utf-16", errors="replace").encode()
    if b"\0" in content:
        raise InputError("is binary, not plain text; save it as CSV in UTF-8", file=path)
    content = content.removeprefix(b"\xef\xbb\xbf")
    try:
        content.decode()
    except UnicodeDecodeError:
        content = content.decode("latin-1").encode()
    return content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")


def _dialect(text: str) -> Dialect:
    lines = [line for line in text.split("\n") if line.strip()][:200]
    separator = _separator(lines)
    cells = [cell.strip() for line in lines[1:] for cell in _split(line, separator)]
    # Where a comma separates cells, those with a decimal comma are in quotation marks.
    with_comma = [cell for cell in cells if has_decimal_comma(cell)]
    if separator == "," and all(map(THOUSANDS_WITH_COMMA.fullmatch, with_comma)):
        with_comma = []
    with_point = [cell for cell in cells if NUMBER_WITH_POINT.fullmatch(cell)]
    if any("." in cell for cell in with_comma):
        with_point = [cell for cell in with_point if not THOUSANDS_WITH_POINT.fullmatch(cell)]
    return Dialect(separator, bool(with_comma) and not with_point)


def _separator(lines: list[str]) -> str:
    """The first separator that makes rows of equal length, else blanks, else a comma."""
    for mark in (*SEPARATORS, BLANKS):
        counts = Counter(len(_split(line, mark)) for line in lines)
        usual, number = counts.most_common(1)[0] if counts else (0, 0)
        if usual > 1 and (2 * number >= len(lines) if mark != BLANKS else "," not in lines[0]):
            return mark
    return ","


def _split(line: str, separator: str) -> list[str]:
    if separator == BLANKS:
        return line.split()
    try:
        return next(csv.reader([line], delimiter=separator), [])
    except csv.Error:
        return line.split(separator)


def _rows(text: str, dialect: Dialect) -> Iterator[tuple[int, list[str]]]:
    """First line and stripped cells of every row that is not blank; a quoted heading may span lines."""
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=dialect.separator)
    before = 0
    for found in reader:
        line, before = before + 1, reader.line_num
        cells = " ".join(found).split() if dialect.separator == BLANKS else found
        row = [_point(cell.strip(), dialect) for cell in cells]
        if any(row):
            yield line, row


def _point(cell: str, dialect: Dialect) -> str:
    return without_commas(cell) if dialect.has_comma else cell


def _table(body: Body, names: Sequence[str | int]) -> pd.DataFrame:
    """The rows below the headings, a row per line."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", pd.errors.ParserWarning)  # it would lose cells
            table = pd.read_csv(
                io.BytesIO(body.text),
                sep=r"\s+" if body.dialect.separator == BLANKS else body.dialect.separator,
                decimal="," if body.dialect.has_comma and body.dialect.separator != "," else ".",
                header=None,
                names=list(names),
                dtype=dict.fromkeys(LABELS.intersection(names), str),
                index_col=False,
                skip_blank_lines=False,
                skipinitialspace=True,
                keep_default_na=False,
                na_values=[""],
                encoding_errors="replace",
                low_memory=False,
            )
    except (ValueError, pd.errors.ParserWarning) as error:
        found = re.search(r"in line (\d+), saw (\d+)", str(error))
        if found:
            width = sum(isinstance(name, str) for name in names)
            raise ragged(int(found[2]), width, body.path, body.above + int(found[1])) from None
        raise _open_quote(body) from None
    if len(table) != body.text.count(b"\n") + (not body.text.endswith(b"\n")):
        raise _open_quote(body)
    return table


def _open_quote(body: Body) -> InputError:
    """The error about a row that spans several lines, at the first line with an odd number of quotation marks."""
    lines = body.text.split(b"\n")
    line = body.above + 1 + next((k for k, one in enumerate(lines) if one.count(b'"') % 2), 0)
    sentence = "a quotation mark is not closed in its line; remove it, or the line break within the cell"
    return InputError(sentence, file=body.path, line=line)


def _check_widths(body: Body, table: pd.DataFrame, filled: np.ndarray, width: int) -> None:
    """Refuse a row with fewer or more cells than headings; empty cells at its end do not count as more."""
    missing = table.iloc[filled, width - 1].isna().to_numpy()
    more = table.iloc[filled, width:].notna().any(axis=1).to_numpy()
    if not np.any(missing | more):
        return
    lines = body.text.split(b"\n")
    for row in filled[missing | more].tolist():
        cells = _split(lines[row].decode(errors="replace"), body.dialect.separator)
        if len(cells) < width or any(cell.strip() for cell in cells[width:]):
            raise ragged(len(cells), width, body.path, body.above + row + 1)


def _cells(column: pd.Series, dialect: Dialect) -> Cells:
    if pd.api.types.is_numeric_dtype(column) and not pd.api.types.is_bool_dtype(column):
        return column.to_numpy(dtype=float)
    return [_point(cell, dialect) for cell in column.fillna("").astype(str).str.strip()]
