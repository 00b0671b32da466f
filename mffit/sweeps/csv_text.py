"""The reader of CSV files."""

from __future__ import annotations

import csv
import gzip
import io
import zlib
from pathlib import Path

from mffit.errors import InputError
from mffit.sweeps.raw_table import RawTable

UTF16_MARKS = (b"\xff\xfe", b"\xfe\xff")
SEPARATORS = {";": "semicolons", "\t": "tabs", "|": "bars"}


def read_csv(path: Path) -> RawTable:
    """Read a ``.csv`` or ``.csv.gz`` with one line of headings; blank lines and ``#`` lines are passed over.

    Raises
    ------
    InputError
        The file is missing, empty, not text, not separated by commas, ragged, without data, or a heading is
        empty or appears twice.
    """
    text = _decoded(path)
    reader = csv.reader(io.StringIO(text, newline=""))
    headings: tuple[str, ...] = ()
    heading_line, rows, lines = 0, [], []
    before = 0
    try:
        for cells in reader:
            # A quoted cell may span lines: the row begins behind where the one before it ended.
            line, before = before + 1, reader.line_num
            row = tuple(cell.strip() for cell in cells)
            if not any(row) or row[0].startswith("#"):
                continue
            if not headings:
                headings, heading_line = row, line
                _check_headings(path, line, headings, text)
                continue
            if len(row) != len(headings):
                sentence = f"has {len(row)} cells under {len(headings)} headings; complete or remove this row"
                raise InputError(sentence, file=path, line=line)
            rows.append(row)
            lines.append(line)
    except csv.Error as error:
        raise InputError(f"is not valid CSV ({error}); correct it", file=path, line=before + 1) from None
    if not headings:
        raise InputError("is empty; it needs one line of headings and one row per point", file=path)
    if not rows:
        raise InputError(
            "has headings but no data; add one row per point or remove its [[sweep]]",
            file=path,
            line=heading_line,
        )
    return RawTable(
        headings=headings,
        units=("",) * len(headings),
        cells=tuple(zip(*rows, strict=True)),
        lines=tuple(lines),
        path=path,
        heading_line=heading_line,
    )


def _decoded(path: Path) -> str:
    raw = _bytes(path)
    if raw.startswith(UTF16_MARKS) or b"\0" in raw[:4096]:
        raise InputError("is UTF-16 or binary, not plain text; save it as CSV in UTF-8", file=path)
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _bytes(path: Path) -> bytes:
    try:
        raw = path.read_bytes()
        return gzip.decompress(raw) if path.suffix == ".gz" else raw
    except FileNotFoundError:
        raise InputError("there is no such file; correct its name in [[sweep]] file", file=path) from None
    except IsADirectoryError:
        raise InputError("is a folder; name the CSV file in it", file=path) from None
    except (gzip.BadGzipFile, EOFError, zlib.error):
        raise InputError("is not a complete gzip file; compress it again", file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); check its permissions", file=path) from None


def _check_headings(path: Path, line: int, headings: tuple[str, ...], text: str) -> None:
    joined = ",".join(headings)
    for separator, word in SEPARATORS.items():
        if joined.count(separator) > joined.count(","):
            decimals = " and decimal points" if _has_decimal_commas(text, separator) else ""
            sentence = f"is separated by {word}; save it with commas between the cells{decimals}"
            raise InputError(sentence, file=path, line=line)
    if all(_is_number(heading) for heading in headings):
        sentence = "there are numbers where the headings should be; add a first line of headings"
        raise InputError(sentence, file=path, line=line)
    if "" in headings:
        number = headings.index("") + 1
        raise InputError(f"heading {number} is empty; name or remove that column", file=path, line=line)
    twice = [heading for number, heading in enumerate(headings) if heading in headings[:number]]
    if twice:
        raise InputError("stands twice; rename or remove one", file=path, line=line, column=twice[0])


def _has_decimal_commas(text: str, separator: str) -> bool:
    cells = text.replace("\n", separator).split(separator)
    return any(_is_number(cell.replace(",", ".")) for cell in cells if "," in cell)


def _is_number(cell: str) -> bool:
    try:
        float(cell)
    except ValueError:
        return False
    return True
