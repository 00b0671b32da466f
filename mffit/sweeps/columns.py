"""From the cells of a file to the contract's columns, in the contract's units and the rig's own axes."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from mffit.config.models import Column
from mffit.errors import InputError
from mffit.sweeps.channels import BY_NAME, CHANNELS, Channel, nearest_channel, nearest_heading
from mffit.sweeps.csv_text import CsvText
from mffit.sweeps.units import UnknownUnitError, converted

DIRECTIONS = {"forward": 1, "backward": -1, "1": 1, "+1": 1, "-1": -1}
MAY_BE_BLANK = frozenset({"iteration", "point"})
LONGEST_QUOTE = 40
NUMBER_WITH_UNIT = re.compile(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?\s*([^\d\s.,+-].*)")
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+")


@dataclass(frozen=True, slots=True)
class Columns:
    """A file's columns as reported, row-aligned with ``lines``."""

    text: CsvText
    table: pd.DataFrame  #: contract columns in contract units, then whatever else the file holds, as text
    direction: np.ndarray | None  #: +1 or -1 (n,), None without such a column
    warnings: tuple[str, ...]

    def line(self, row: int) -> int:
        """Line of a row in the file."""
        return self.text.lines[row]


def read_columns(text: CsvText, mapping: Mapping[str, Column]) -> Columns:
    """Find, convert and check the contract's columns.

    Parameters
    ----------
    text : the file's cells
    mapping : ``[sweep.columns]``: contract column -> heading, unit and scale; its keys are contract columns

    Raises
    ------
    InputError
        A column is missing, a cell is no finite number, or a value is outside its plausible range.
    """
    sources = {name: column.column or name for name, column in mapping.items()}
    for channel in CHANNELS:
        if channel.name not in sources and channel.name in text.headings:
            sources[channel.name] = channel.name
    _check_sources(text, sources)
    cells = dict(zip(text.headings, zip(*text.rows, strict=True), strict=True))
    found: dict[str, np.ndarray] = {}
    for channel in CHANNELS:
        if channel.name in sources:
            values = _channel(text, channel, sources[channel.name], cells, mapping.get(channel.name))
            if values is not None:
                found[channel.name] = values
    taken = set(sources.values()) | set(sources)
    extras = {heading: column for heading, column in cells.items() if heading not in taken}
    direction = found.get("direction")
    if direction is not None:
        found["direction"] = np.where(direction > 0, "forward", "backward")
    order = sorted(found, key=lambda name: text.headings.index(sources[name]))
    table = pd.DataFrame({**{name: found[name] for name in order}, **extras})
    return Columns(text, table, direction, tuple(_misspelt(text, extras, found)))


def _check_sources(text: CsvText, sources: Mapping[str, str]) -> None:
    """Every mapped heading is there, and every required column has one."""
    for name, heading in sources.items():
        if heading not in text.headings:
            near = nearest_heading(BY_NAME[name], text.headings)
            hint = f'; the nearest heading is "{near}"' if near else f"; there are {', '.join(text.headings)}"
            sentence = f'there is no heading "{heading}", which [sweep.columns] {name} names{hint}'
            raise InputError(sentence, file=text.path, line=text.heading_line)
    for channel in CHANNELS:
        if channel.required and channel.name not in sources:
            raise _missing(text, channel)


def _missing(text: CsvText, channel: Channel) -> InputError:
    near = nearest_heading(channel, text.headings)
    unit = channel.unit
    remedy = (
        f'if "{near}" is it, put {channel.name} = {{ column = "{near}", unit = "{unit}" }}, with its true '
        "unit, under [sweep.columns]"
        if near
        else f"add it, or name its heading under [sweep.columns] ({', '.join(text.headings)} are there)"
    )
    sentence = f"is missing ({channel.description}); {remedy}"
    return InputError(sentence, file=text.path, line=text.heading_line, column=channel.name)


def _channel(
    text: CsvText, channel: Channel, heading: str, cells: Mapping[str, tuple[str, ...]], column: Column | None
) -> np.ndarray | None:
    """One column (n,) in the contract's unit; None if all its cells are blank."""
    given = cells[heading]
    if not any(given):
        if channel.required:
            raise InputError("has no values; complete it", file=text.path, line=text.lines[0], column=heading)
        return None
    if channel.kind == "label":
        return np.array(given, dtype=object)
    if channel.kind == "direction":
        return _directions(text, heading, given)
    values = _numbers(text, channel, heading, given)
    if column is not None:
        values = column.scale * _in_contract_unit(values, channel, column)
    _check_range(text, channel, heading, values)
    return values


def _directions(text: CsvText, heading: str, given: tuple[str, ...]) -> np.ndarray:
    for row, cell in enumerate(given):
        if cell.lower() not in DIRECTIONS:
            sentence = f'"{_cut(cell)}" is no direction; write forward or backward'
            raise InputError(sentence, file=text.path, line=text.lines[row], column=heading)
    return np.array([DIRECTIONS[cell.lower()] for cell in given])


def _numbers(text: CsvText, channel: Channel, heading: str, given: tuple[str, ...]) -> np.ndarray:
    values = pd.to_numeric(pd.Series(given, dtype=object), errors="coerce").to_numpy(dtype=float)
    bad = ~np.isfinite(values)
    if channel.name in MAY_BE_BLANK:
        bad &= np.array([cell != "" for cell in given])
    if np.any(bad):
        row = int(bad.argmax())
        sentence = _bad_cell(given[row], channel)
        raise InputError(sentence, file=text.path, line=text.lines[row], column=heading)
    return values


def _bad_cell(cell: str, channel: Channel) -> str:
    """Why a cell is no finite number and what to do."""
    cell = _cut(cell)
    if cell == "":
        return "this cell is empty; complete it or remove the row"
    if cell.lower().lstrip("+-") in ("nan", "inf", "infinity", "na", "n/a", "null"):
        return f'"{cell}" is no measurement; complete it or remove the row'
    if DECIMAL_COMMA.fullmatch(cell):
        return f'"{cell}" has a decimal comma; write {cell.replace(",", ".")}'
    unit = NUMBER_WITH_UNIT.fullmatch(cell)
    if unit:
        return (
            f'"{cell}" has a unit in the cell; write the number alone, in {channel.unit}, or with '
            f'unit = "{unit[1].strip()}" for this column under [sweep.columns]'
        )
    return f'"{cell}" is a text where a number in {channel.unit or "plain digits"} should be; correct it'


def _cut(cell: str) -> str:
    """A cell short enough to be quoted; a quote that is never closed swallows half a file."""
    return cell if len(cell) <= LONGEST_QUOTE else f"{cell[:LONGEST_QUOTE]}..."


def _in_contract_unit(values: np.ndarray, channel: Channel, column: Column) -> np.ndarray:
    if column.unit is None:
        return values
    if not channel.unit:
        raise InputError("has no unit; remove it", key=f"columns.{channel.name}.unit")
    try:
        return converted(values, column.unit, channel.unit)
    except UnknownUnitError as error:
        sentence = f"{error}; name the unit of the file's column"
        raise InputError(sentence, key=f"columns.{channel.name}.unit") from None


def _check_range(text: CsvText, channel: Channel, heading: str, values: np.ndarray) -> None:
    outside = (values < channel.lower) | (values > channel.upper)
    if not np.any(outside):
        return
    row = int(outside.argmax())
    hint = channel.below if values[row] < channel.lower else channel.above
    unit = f" {channel.unit}" if channel.unit else ""
    sentence = (
        f"{values[row]:g}{unit} is outside {channel.lower:g} to {channel.upper:g}{unit}; "
        f"{hint or 'correct it'}{', convert it or name its unit under [sweep.columns]' if hint else ''}"
    )
    raise InputError(sentence, file=text.path, line=text.lines[row], column=heading)


def _misspelt(text: CsvText, extras: Mapping[str, object], found: Mapping[str, object]) -> list[str]:
    """Warnings for headings that look like a channel that would otherwise be missing."""
    sentences = []
    for heading in extras:
        near = nearest_channel(heading)
        if near and near not in found:
            sentences.append(f'{text.path}: column "{heading}" is not used; if it is {near}, rename it')
    return sentences
