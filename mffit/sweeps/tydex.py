"""The reader of TYDEX files: fixed or free columns, constants, factors and offsets; see :mod:`mffit.sweeps.tydex_format`."""

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mffit.errors import InputError, shortened
from mffit.sweeps import tydex_format
from mffit.sweeps.extras import content_of
from mffit.sweeps.raw_table import RawTable, with_decimal_point
from mffit.sweeps.tydex_format import (
    CHANNEL_SECTION,
    CONSTANTS,
    DATA,
    HEADER,
    MARK,
    MISSING,
    REMARK,
    FixedRow,
)
from mffit.sweeps.units import is_unit, spelt

Numbered = list[tuple[int, str]]
"""Lines with their numbers, from 1."""


class Entry(NamedTuple):
    """One row of the channels or constants."""

    name: str
    unit: str
    words: tuple[str, ...]  #: what follows the unit


def read_tydex(path: Path) -> RawTable:
    """Read a ``.tdx`` file; a constant becomes a column of equal values, unless a channel has its name.

    Raises InputError if the file is binary (National Instruments writes another ``.tdx``), has no ``**HEADER``, channels or
    data, or a row of data does not have one number for each channel.
    """
    sections = _sections(path)
    channels = _channels(sections.get(CHANNEL_SECTION, []), path)
    lines, values = _data(sections.get(DATA, []), len(channels), path)
    columns = {channel.name: _physical(channel, values[:, k]) for k, channel in enumerate(channels)}
    units = {channel.name: channel.unit for channel in channels}
    header = [_entry(line) for _, line in sections.get(HEADER, [])]
    in_header = [
        entry for entry in header if entry.unit and spelt(entry.unit)
    ]  # some programs put constants there
    for constant in (*(_entry(line) for _, line in sections.get(CONSTANTS, [])), *in_header):
        value = _float(constant.words[0]) if constant.words else math.nan
        if constant.name not in columns and math.isfinite(value):
            columns[constant.name], units[constant.name] = np.full(len(lines), value), constant.unit
    return RawTable(
        headings=tuple(columns),
        units=tuple(units[name] for name in columns),
        cells=tuple(columns.values()),
        lines=lines,
        path=path,
        heading_line=None,
        about={entry.name: " ".join(entry.words) for entry in header if entry.name},
    )


def _sections(path: Path) -> dict[str, Numbered]:
    """Numbered lines of every section, without blank lines and remarks."""
    found: dict[str, Numbered] = {}
    section = ""
    for number, line in enumerate(_text(path).splitlines(), start=1):
        line = line.expandtabs(tydex_format.VALUE).rstrip()
        if line.startswith(MARK):
            section = (line[2:].split() or [""])[0].upper()  # the number of rows may follow **MEASURDATA
            found.setdefault(section, [])
        elif section and line.strip() and not line.lstrip().startswith(REMARK):
            found[section].append((number, line))
    return found


def _text(path: Path) -> str:
    text = content_of(path).decode("latin-1")
    if "\0" in text:
        raise InputError(
            "is binary: a National Instruments .tdx, which belongs to a .tdm file, and not TYDEX; export it as CSV",
            file=path,
        )
    if f"{MARK}{HEADER}" not in text.upper():
        raise InputError(
            f"is not a TYDEX file: it has no {MARK}{HEADER}; export it as TYDEX {tydex_format.RELEASE} or CSV",
            file=path,
        )
    return text


def _channels(lines: Numbered, path: Path) -> list[Entry]:
    channels = [_entry(line) for _, line in lines]
    if not channels:
        raise InputError(f"has no channels; add {MARK}{CHANNEL_SECTION} with a row for each", file=path)
    names = [channel.name for channel in channels]
    twice = [name for k, name in enumerate(names) if name in names[:k]]
    if twice:
        raise InputError(
            f"is listed twice in {MARK}{CHANNEL_SECTION}; rename one", file=path, column=twice[0]
        )
    return channels


def _data(lines: Numbered, count: int, path: Path) -> tuple[list[int], np.ndarray]:
    """Line numbers of the rows, and their values (n, count)."""
    if not lines:
        raise InputError(f"has no data; add {MARK}{DATA} with a row for each sample", file=path)
    values = [_numbers(line, count, path, number) for number, line in lines]
    return [number for number, _ in lines], np.array(values, dtype=float)


def _entry(line: str) -> Entry:
    """A row read by its fixed columns, or by its words if the fixed columns hold no unit."""
    row = FixedRow.of(line)
    if " " not in row.name and is_unit(row.unit) and (row.unit or row.values):
        return Entry(row.name, row.unit, tuple(row.values.split()))
    tokens = line.split()
    end = len(tokens)
    while end > 1 and (math.isfinite(_float(tokens[end - 1])) or tokens[end - 1] == MISSING):
        end -= 1
    has_unit = end > 1 and is_unit(tokens[end - 1])
    return Entry(tokens[0], tokens[end - 1] if has_unit else "", tuple(tokens[end:]))


def _physical(channel: Entry, values: np.ndarray) -> np.ndarray:
    stated = (*map(_float, channel.words[:3]), *3 * (math.nan,))
    factor, before, after = (
        value if math.isfinite(value) else default
        for value, default in zip(stated, (1.0, 0.0, 0.0), strict=False)
    )
    return factor * (values + before) + after


def _numbers(line: str, count: int, path: Path, number: int) -> list[float]:
    words = line.split()
    if len(words) != count:  # full columns leave no blank between them
        width = tydex_format.VALUE
        words = [line[k : k + width].strip() for k in range(0, len(line), width)]
    if len(words) != count or any(" " in word for word in words):
        sentence = f"has {len(line.split())} values for {count} channels; complete or remove this row"
        raise InputError(sentence, file=path, line=number)
    found = [_float(word) for word in words]
    for word, value in zip(words, found, strict=True):
        if not math.isfinite(value) and word.upper() not in (MISSING, "NAN", ""):
            raise InputError(f'"{shortened(word)}" is not a number; correct it', file=path, line=number)
    return found


def _float(word: str) -> float:
    try:
        return float(with_decimal_point(word))
    except ValueError:
        return math.nan
