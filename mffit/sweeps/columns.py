"""From the cells of a file to the contract's columns, in the contract's units and the rig's own axes."""

from __future__ import annotations

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from mffit.config.models import Column
from mffit.errors import InputError
from mffit.sweeps.channels import BY_NAME, CHANNELS, Channel, nearest_channel, nearest_heading
from mffit.sweeps.raw_table import Cells, RawTable
from mffit.sweeps.units import UnknownUnitError, converted

DIRECTIONS = {"forward": 1, "backward": -1, "1": 1, "+1": 1, "-1": -1}
UNCERTAINTIES = ("u_Fy_N", "u_Mz_Nm")
MAY_BE_BLANK = frozenset({"iteration", "point", *UNCERTAINTIES})
LONGEST_QUOTE = 40
NUMBER_WITH_UNIT = re.compile(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?\s*([^\d\s.,+-].*)")
NO_READING = ("", "nan", "inf", "infinity", "na", "n/a", "null", "notavail")
FEW = 0.01
"""Share of a recording's samples up to which readings outside the plausible range are spikes, not another unit."""
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+")


@dataclass(frozen=True, slots=True)
class Columns:
    """A file's columns as reported, row-aligned with ``lines``."""

    raw: RawTable
    table: pd.DataFrame  #: contract columns in contract units, then whatever else the file holds, as text
    direction: np.ndarray | None  #: +1 or -1 (n,), None without such a column
    warnings: tuple[str, ...]

    def line(self, row: int) -> int:
        """Line of a row in the file."""
        return int(self.raw.lines[row])


def _mapped(mapping: Mapping[str, Column], name: str) -> str | None:
    """The heading that a mapping gives a contract column; None if it does not name the column."""
    return (mapping[name].column or name) if name in mapping else None


def read_columns(raw: RawTable, mapping: Mapping[str, Column], shared: Collection[str] = ()) -> Columns:
    """Find, convert and check the contract's columns.

    Parameters
    ----------
    raw : the file's cells
    mapping : ``[sweep.columns]``: contract column -> heading, unit and scale; its keys are contract columns
    shared : those of its keys that come from ``[columns]``, which serves all files: headings that this file lacks
        are passed over unless the column is required

    Notes
    -----
    A recording (``time_s``) may have gaps: cells without a number, and rare samples outside the plausible range, which
    become NaN. In a table of points each of them is refused.

    Raises
    ------
    InputError
        A column is missing, a cell is no finite number, or a value is outside its plausible range.
    """
    sources = {name: column.column or name for name, column in mapping.items()}
    for name in set(shared) & set(sources):
        if sources[name] not in raw.headings and (name in raw.headings or not BY_NAME[name].required):
            del sources[name]
    for channel in CHANNELS:
        if channel.name not in sources and channel.name in raw.headings:
            sources[channel.name] = channel.name
    _check_sources(raw, sources)
    cells = dict(zip(raw.headings, raw.cells, strict=True))
    found: dict[str, np.ndarray] = {}
    warnings: list[str] = []
    for channel in CHANNELS:
        if channel.name in sources:
            heading = sources[channel.name]
            gaps = "time_s" in sources and channel.name != "time_s"
            own = mapping.get(channel.name) if heading == _mapped(mapping, channel.name) else None
            values = _channel(raw, channel, heading, cells, own, gaps=gaps, say=warnings)
            if values is not None:
                found[channel.name] = values
    for name in UNCERTAINTIES:
        if name in found:
            found[name], said = _stated(raw, sources[name], found[name])
            warnings += said
    taken = set(sources.values()) | set(sources)
    extras = {heading: column for heading, column in cells.items() if heading not in taken}
    direction = found.get("direction")
    if direction is not None:
        found["direction"] = np.where(direction > 0, "forward", "backward")
    order = sorted(found, key=lambda name: raw.headings.index(sources[name]))
    table = pd.DataFrame({**{name: found[name] for name in order}, **extras}, copy=False)
    return Columns(raw, table, direction, (*warnings, *_misspelt(raw, extras, found)))


def _check_sources(raw: RawTable, sources: Mapping[str, str]) -> None:
    """Every mapped heading is there, and every required column has one."""
    for name, heading in sources.items():
        if heading not in raw.headings:
            near = nearest_heading(BY_NAME[name], raw.headings)
            hint = f'; the nearest heading is "{near}"' if near else f"; there are {', '.join(raw.headings)}"
            sentence = f'there is no heading "{heading}", which [sweep.columns] {name} names{hint}'
            raise InputError(sentence, file=raw.path, line=raw.heading_line)
    for channel in CHANNELS:
        if channel.required and channel.name not in sources:
            raise _missing(raw, channel)


def _missing(raw: RawTable, channel: Channel) -> InputError:
    near = nearest_heading(channel, raw.headings)
    unit = channel.unit
    remedy = (
        f'if "{near}" is it, put {channel.name} = {{ column = "{near}", unit = "{unit}" }}, with its true '
        "unit, under [sweep.columns]"
        if near
        else f"add it, or name its heading under [sweep.columns] ({', '.join(raw.headings)} are there)"
    )
    sentence = f"is missing ({channel.description}); {remedy}"
    return InputError(sentence, file=raw.path, line=raw.heading_line, column=channel.name)


def _channel(
    raw: RawTable,
    channel: Channel,
    heading: str,
    cells: Mapping[str, Cells],
    column: Column | None,
    *,
    gaps: bool,
    say: list[str],
) -> np.ndarray | None:
    """One column (n,) in the contract's unit; None if all its cells are blank."""
    given = cells[heading]
    if bool(np.all(np.isnan(given))) if isinstance(given, np.ndarray) else all(map(_is_blank, given)):
        if channel.required:
            raise InputError(
                "has no values; complete it", file=raw.path, line=int(raw.lines[0]), column=heading
            )
        return None
    if channel.kind == "label":
        different, where = np.unique(np.asarray(given), return_inverse=True)
        return np.array([_text(cell) for cell in different.tolist()], dtype=object)[where]
    if channel.kind == "direction":
        return _directions(raw, heading, given)
    values = _numbers(raw, channel, heading, given, gaps=gaps)
    values = _in_contract_unit(values, raw, channel, heading, column)
    return _in_range(raw, channel, heading, values, gaps=gaps, say=say)


def _directions(raw: RawTable, heading: str, given: Cells) -> np.ndarray:
    different, where = np.unique(np.asarray(given), return_inverse=True)
    words = [_text(cell).lower() for cell in different.tolist()]
    wrong = np.array([word not in DIRECTIONS for word in words])[where]
    if np.any(wrong):
        row = int(wrong.argmax())
        sentence = f'"{_cut(_text(given[row]))}" is no direction; write forward or backward'
        raise InputError(sentence, file=raw.path, line=int(raw.lines[row]), column=heading)
    return np.array([DIRECTIONS.get(word, 0) for word in words])[where]


def _numbers(raw: RawTable, channel: Channel, heading: str, given: Cells, *, gaps: bool) -> np.ndarray:
    if isinstance(given, np.ndarray):
        values = given
    else:
        values = pd.to_numeric(pd.Series(given, dtype=object), errors="coerce").to_numpy(dtype=float)
    bad = ~np.isfinite(values)
    if not np.any(bad):
        return values
    if gaps:
        bad &= np.array([not _is_gap(cell) for cell in np.asarray(given, dtype=object)])
        values = np.where(np.isinf(values), np.nan, values)
    elif channel.name in MAY_BE_BLANK:
        bad &= np.array([not _is_blank(cell) for cell in given])
    if np.any(bad):
        row = int(bad.argmax())
        sentence = _bad_cell(_text(given[row]), channel)
        raise InputError(sentence, file=raw.path, line=int(raw.lines[row]), column=heading)
    return values


def _bad_cell(cell: str, channel: Channel) -> str:
    """Why a cell is no finite number and what to do."""
    cell = _cut(cell)
    if cell == "":
        return "this cell is empty; complete it or remove the row"
    if cell.lower().lstrip("+-") in NO_READING:
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


def _is_blank(cell: str | float) -> bool:
    """Whether a cell holds nothing: no text, or the NaN that stands for it in a format of numbers."""
    return not cell if isinstance(cell, str) else bool(np.isnan(cell))


def _is_gap(cell: str | float) -> bool:
    """Whether a recorder writes this where it has no reading."""
    return not isinstance(cell, str) or cell.lower().lstrip("+-") in NO_READING


def _text(cell: str | float) -> str:
    return cell if isinstance(cell, str) else f"{cell:g}"


def _cut(cell: str) -> str:
    """A cell short enough to be quoted; a quote that is never closed swallows half a file."""
    return cell if len(cell) <= LONGEST_QUOTE else f"{cell[:LONGEST_QUOTE]}..."


def _in_contract_unit(
    values: np.ndarray, raw: RawTable, channel: Channel, heading: str, column: Column | None
) -> np.ndarray:
    """Values in the contract's unit, from the unit that ``tyre.toml`` names, else from the file's own."""
    scale = 1.0 if column is None else column.scale
    named = None if column is None else column.unit
    unit = named or raw.units[raw.headings.index(heading)]
    if not unit:
        return scale * values

    def refuse(sentence: str) -> InputError:
        if named:
            return InputError(sentence, key=f"columns.{channel.name}.unit")
        return InputError(sentence, file=raw.path, line=raw.heading_line, column=heading)

    if not channel.unit and named and channel.kind != "number":
        raise refuse("has no unit; remove it")
    try:
        return scale * converted(values, unit, channel.unit)
    except UnknownUnitError as error:
        raise refuse(f"{error}; name the unit of the file's column") from None


def _in_range(
    raw: RawTable, channel: Channel, heading: str, values: np.ndarray, *, gaps: bool, say: list[str]
) -> np.ndarray:
    """The values (n,), all in their plausible range or, few of a recording, NaN."""
    outside = (values < channel.lower) | (values > channel.upper)
    if not np.any(outside):
        return values
    row, number = int(outside.argmax()), int(outside.sum())
    unit = f" {channel.unit}" if channel.unit else ""
    said = f"{values[row]:g}{unit} is outside {channel.lower:g} to {channel.upper:g}{unit}"
    line = int(raw.lines[row])
    if gaps and number <= FEW * len(values):
        more = f", as {number - 1} more" if number > 1 else ""
        say.append(f"{raw.path}:{line}: column {heading}: {said}{more}; taken for no reading")
        return np.where(outside, np.nan, values)
    hint = channel.below if values[row] < channel.lower else channel.above
    sentence = (
        f"{said}; {hint or 'correct it'}"
        f"{', convert it or name its unit under [sweep.columns]' if hint else ''}"
    )
    raise InputError(sentence, file=raw.path, line=line, column=heading)


def _stated(raw: RawTable, heading: str, values: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Uncertainties (n,), NaN where none is stated, and what to say: a point of no uncertainty would count for all."""
    none = values <= 0.0
    if not np.any(none):
        return values, []
    row, number = int(none.argmax()), int(none.sum())
    if not np.any(values > 0.0):
        raise InputError(
            "is not above zero in any row, and a standard uncertainty is; complete or remove the column",
            file=raw.path,
            line=int(raw.lines[row]),
            column=heading,
        )
    more = f", as in {number - 1} more rows" if number > 1 else ""
    sentence = (
        f"{raw.path}:{raw.lines[row]}: column {heading}: {values[row]:g} is no uncertainty and counts as not "
        f"stated{more}"
    )
    return np.where(none, np.nan, values), [sentence]


def _is_constant(cells: Cells) -> bool:
    """Whether an unused column says nothing about its rows; of text it is not asked."""
    return isinstance(cells, np.ndarray) and bool(np.all(cells == cells[0]))


def _misspelt(raw: RawTable, extras: Mapping[str, Cells], found: Mapping[str, object]) -> list[str]:
    """Warnings for headings that look like a channel that would otherwise be missing."""
    sentences = []
    for heading, cells in extras.items():
        near = nearest_channel(heading)
        if near and near not in found and not _is_constant(cells):
            sentences.append(f'{raw.path}: column "{heading}" is not used; if it is {near}, rename it')
    return sentences
