"""The reader of TYDEX files, release 1.3 as text: fixed or free columns, constants, factors and offsets.

Columns of a row: name 10 letters, description 30, unit 10, then 10 each. A channel's row goes on with a factor, an
offset of the measured and an offset of the physical value: physical = factor (measured + offset 1) + offset 2.
"""

from __future__ import annotations

import gzip
import math
import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mffit.errors import InputError
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.units import is_unit

NAME, UNIT, VALUES = 10, 40, 50
"""Where the name ends, the unit begins and the numbers begin."""
WIDTH = 10
MISSING = "NOTAVAIL"


class Entry(NamedTuple):
    """One row of the channels or constants."""

    name: str
    unit: str
    words: tuple[str, ...]  #: what stands behind the unit


def read_tydex(path: Path) -> RawTable:
    """Read a ``.tdx`` file; constants that no channel gives become columns of one value.

    Raises
    ------
    InputError
        The file is binary (National Instruments writes another ``.tdx``), has no ``**HEADER``, channels or data, or a
        row of data has not one number for each channel.
    """
    sections = _sections(path)
    channels = [_entry(line) for _, line in sections.get("MEASURCHANNELS", [])]
    if not channels:
        raise InputError("has no channels; it needs **MEASURCHANNELS with a row for each", file=path)
    twice = [c.name for k, c in enumerate(channels) if c.name in [other.name for other in channels[:k]]]
    if twice:
        raise InputError("stands twice in **MEASURCHANNELS; rename one", file=path, column=twice[0])
    lines, data = [], []
    for number, line in sections.get("MEASURDATA", []):
        data.append(_numbers(line, len(channels), path, number))
        lines.append(number)
    if not data:
        raise InputError("has no data; it needs **MEASURDATA with a row for each sample", file=path)
    values = np.array(data, dtype=float)
    columns = {c.name: _physical(c, values[:, k]) for k, c in enumerate(channels)}
    units = {c.name: c.unit for c in channels}
    for _, line in sections.get("CONSTANTS", []):
        constant = _entry(line)
        value = _float(constant.words[0]) if constant.words else math.nan
        if constant.name not in columns and math.isfinite(value):
            columns[constant.name], units[constant.name] = np.full(len(lines), value), constant.unit
    about = {e.name: " ".join(e.words) for _, line in sections.get("HEADER", []) if (e := _entry(line)).name}
    return RawTable(
        headings=tuple(columns),
        units=tuple(units[name] for name in columns),
        cells=tuple(columns.values()),
        lines=lines,
        path=path,
        heading_line=None,
        about=about,
    )


def _sections(path: Path) -> dict[str, list[tuple[int, str]]]:
    """Numbered lines of every section, without blank lines and ``!`` comments."""
    found: dict[str, list[tuple[int, str]]] = {}
    section = ""
    for number, line in enumerate(_text(path).splitlines(), start=1):
        line = line.expandtabs(WIDTH).rstrip()
        if line.startswith("**"):
            section = (line[2:].split() or [""])[0].upper()  # **MEASURDATA may go on with the number of rows
            found.setdefault(section, [])
        elif section and line.strip() and not line.lstrip().startswith("!"):
            found[section].append((number, line))
    return found


def _text(path: Path) -> str:
    try:
        raw = path.read_bytes()
        raw = gzip.decompress(raw) if path.name.lower().endswith(".gz") else raw
    except (gzip.BadGzipFile, EOFError, zlib.error):
        raise InputError("is not a complete gzip file; compress it again", file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); check its permissions", file=path) from None
    text = raw.decode("latin-1")
    if "**HEADER" in text.upper() and "\0" not in text:
        return text
    if "\0" in text:
        raise InputError(
            "is binary: a National Instruments .tdx goes with a .tdm file and is no TYDEX; export it as CSV",
            file=path,
        )
    raise InputError("is no TYDEX file, as **HEADER is not in it; export it as TYDEX 1.3 or CSV", file=path)


def _entry(line: str) -> Entry:
    """A row of fixed columns, or of free ones where the fixed ones do not make sense."""
    name, unit, words = line[:NAME].strip(), line[UNIT:VALUES].strip(), line[VALUES:].split()
    if " " not in name and is_unit(unit) and line[NAME:UNIT].strip() != line[NAME:].strip():
        return Entry(name, unit, tuple(words))
    tokens = line.split()
    behind = len(tokens)
    while behind > 1 and (math.isfinite(_float(tokens[behind - 1])) or tokens[behind - 1] == MISSING):
        behind -= 1
    has_unit = behind > 1 and is_unit(tokens[behind - 1])
    return Entry(tokens[0], tokens[behind - 1] if has_unit else "", tuple(tokens[behind:]))


def _physical(channel: Entry, values: np.ndarray) -> np.ndarray:
    factor, before, behind = ([_float(word) for word in channel.words] + [math.nan] * 3)[:3]
    factor = factor if math.isfinite(factor) else 1.0
    before = before if math.isfinite(before) else 0.0
    behind = behind if math.isfinite(behind) else 0.0
    return factor * (values + before) + behind


def _numbers(line: str, count: int, path: Path, number: int) -> list[float]:
    words = line.split()
    if len(words) != count:  # full columns leave no blank between them
        words = [line[k : k + WIDTH].strip() for k in range(0, len(line), WIDTH)]
    if len(words) != count or any(" " in word for word in words):
        sentence = f"has {len(line.split())} values for {count} channels; complete or remove this row"
        raise InputError(sentence, file=path, line=number)
    found = [_float(word) for word in words]
    for word, value in zip(words, found, strict=True):
        if not math.isfinite(value) and word.upper() not in (MISSING, "NAN", ""):
            raise InputError(f'"{word[:40]}" is no number; correct it', file=path, line=number)
    return found


def _float(word: str) -> float:
    try:
        return float(word)
    except ValueError:
        return math.nan
