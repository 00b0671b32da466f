"""Conversion of a file's cells to the contract's columns, in the contract's units and the rig's own axes."""

import re
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.config.lines import line_text
from mffit.config.models import Column
from mffit.errors import InputError, shortened
from mffit.quantities import CHANNELS, column, u_column
from mffit.sweeps import constants
from mffit.sweeps.about import WORDS
from mffit.sweeps.channels import BY_NAME, SWEEP_CHANNELS, Channel, nearest_channel, nearest_heading
from mffit.sweeps.raw_table import (
    Cells,
    RawTable,
    has_decimal_comma,
    is_spreadsheet_error,
    is_summary,
    with_decimal_point,
    with_values,
)
from mffit.sweeps.units import UnknownUnitError, converted, has_dimension, is_unit, spelt
from tir.frozen import ReadOnlyArrays

DIRECTIONS = {"forward": 1, "backward": -1, "1": 1, "+1": 1, "-1": -1}
UNCERTAINTIES = {u_column(name): column(name) for name in CHANNELS}
"""Column of the readings, by column of their standard uncertainties."""
MAY_BE_BLANK = frozenset({"iteration", "point", "time_s", *UNCERTAINTIES})
NUMBER_WITH_UNIT = re.compile(r"[-+]?[\d.]+(?:[eE][-+]?\d+)?\s*([^\d\s.,+-].*)")


@dataclass(frozen=True, slots=True)
class Columns(ReadOnlyArrays):
    """A file's columns as reported; rows as in ``raw``."""

    raw: RawTable
    table: pd.DataFrame  #: contract columns in contract units, then all other columns of the file as text
    direction: np.ndarray | None  #: +1 or -1 (n,), None without such a column
    warnings: tuple[str, ...]
    headings: Mapping[str, str] = field(default_factory=dict)  #: headings of the file, by contract column
    standing: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=int))
    """Lines of samples at standstill, which are removed before any check."""

    def line(self, row: int) -> int:
        """Line of a row in the file."""
        return int(self.raw.lines[row])


class _Source(NamedTuple):
    """The column of a file that holds a channel."""

    raw: RawTable
    channel: Channel
    heading: str
    mapped: Column | None  #: unit and scale that ``tyre.toml`` gives; None if it does not name this heading
    may_have_gaps: bool
    warnings: list[str]  #: sentences about this and the columns before it

    @property
    def cells(self) -> Cells:
        return self.raw.column(self.heading)

    @property
    def unit(self) -> str:
        """The unit by ``tyre.toml``, or else by the file; "" if neither states one."""
        named = None if self.mapped is None else self.mapped.unit
        return named or self.raw.unit(self.heading)

    def refusal(self, sentence: str, row: int) -> InputError:
        """The error about a cell of this column."""
        line = int(self.raw.lines[row])
        return InputError(sentence, file=self.raw.path, line=line, column=self.heading)


def read_columns(raw: RawTable, mapping: Mapping[str, Column], shared: Collection[str] = ()) -> Columns:
    """The contract's columns of a file, converted and checked, by ``[sweep.columns]``: contract column -> heading, unit and
    scale.

    Keys that are ``shared`` come from ``[columns]``, which applies to all files; if a file lacks the heading, such a key is
    ignored unless the column is required, and a value yields to a column of that name. A recording (``time_s``) may have gaps:
    cells without a number, and rare samples outside the plausible range, which become NaN. In a table of points each of them
    is an error. Samples of a recording at standstill are removed first, because speed, pressure and slip are undefined there.

    Raises InputError if a column is missing, a cell is not a finite number, or a value is outside its plausible range.
    """
    mapping = {name: one for name, one in mapping.items() if name not in shared or _applies(name, one, raw)}
    given = {name: column.value for name, column in mapping.items() if column.value is not None}
    raw = with_values(raw, given) if given else raw
    headings = _headings(raw, mapping, shared)
    found: dict[str, np.ndarray] = {}
    raw, warnings = _without_rows_that_are_none(raw, headings)
    raw, at_rest = _without_standstill(raw, headings)
    for channel in SWEEP_CHANNELS:
        if channel.name not in headings:
            continue
        name, gaps = channel.name, "time_s" in headings and channel.name != "time_s"
        mapped = _as_its_channel(name, mapping, headings, raw, warnings)
        source = _Source(raw, channel, headings[name], mapped, gaps, warnings)
        values = _read(source)
        if values is not None and name in UNCERTAINTIES:  # the table lists them after their channels
            values = _credible(source, values, found.get(UNCERTAINTIES[name], np.zeros(0)))
        if values is not None:
            found[name] = values
    taken = {*headings, *headings.values()}
    extras = {heading: raw.column(heading) for heading in raw.headings if heading not in taken}
    warnings += _misspelt(raw, extras, found)
    direction = found.get("direction")
    if direction is not None:
        found["direction"] = np.where(direction > 0, "forward", "backward")
    order = sorted(found, key=lambda name: raw.headings.index(headings[name]))
    table = pd.DataFrame({**{name: found[name] for name in order}, **extras}, copy=False)
    return Columns(raw, table, direction, tuple(warnings), {name: headings[name] for name in order}, at_rest)


def _as_its_channel(
    name: str, mapping: Mapping[str, Column], headings: Mapping[str, str], raw: RawTable, warnings: list[str]
) -> Column | None:
    """What ``tyre.toml`` gives for a column; uncertainties without a unit are in that of their readings, which is warned of."""
    mapped, readings, heading = mapping.get(name), UNCERTAINTIES.get(name, ""), headings[name]
    if readings not in headings or heading == name or raw.unit(heading):
        return mapped
    if mapped is not None and (mapped.unit or mapped.scale != 1.0):
        return mapped
    given = mapping.get(readings, Column())
    unit, scale = given.unit or raw.unit(headings[readings]), abs(given.scale)
    if scale == 1.0 and (not unit or spelt(unit) == spelt(BY_NAME[name].unit)):
        return mapped
    warnings.append(
        f"{raw.path}:{raw.heading_line}: column {heading}: states no unit; read as {headings[readings]} is, "
        f"{f'in {unit}' if unit else f'times {scale:g}'}; if that is wrong, give its unit under [columns]"
    )
    return Column(column=heading, unit=unit or None, scale=scale)


def _without_standstill(raw: RawTable, headings: Mapping[str, str]) -> tuple[RawTable, np.ndarray]:
    """The rows of a recording at which the wheel rolls, and the lines (m,) of the others."""
    rolls = np.ones(len(raw), dtype=bool)
    if "time_s" in headings and "V_mps" in headings:
        rolls = ~standing(numbers(raw.column(headings["V_mps"])))
    return raw if np.all(rolls) else raw.of_rows(rolls), np.asarray(raw.lines)[~rolls]


def standing(V: np.ndarray) -> np.ndarray:
    """Mask (n,) of the samples at standstill, from the speed of the road in any unit and with any sign; False where it is NaN.

    The limit is relative to the median speed of the rolling wheel, so most of a recording may be at standstill.
    """
    speed = np.abs(V)
    largest = np.max(speed, where=np.isfinite(speed), initial=0.0)
    rolling = speed[speed > constants.STANDSTILL * largest]
    return np.asarray(speed < constants.STANDSTILL * (np.median(rolling) if len(rolling) else 0.0))


def _without_rows_that_are_none(raw: RawTable, headings: Mapping[str, str]) -> tuple[RawTable, list[str]]:
    """The rows to read, and sentences about rows and cells that a spreadsheet added: rows of means, and cells such as ``#NV``.

    Rows of means are skipped. A cell such as ``#NV`` is a missing sample in a recording; a table of points loses the row.
    """
    out = np.zeros(len(raw), dtype=bool)
    sentences = []
    for heading, cells in zip(raw.headings, raw.cells, strict=True):
        if isinstance(cells, np.ndarray):
            continue
        texts = {cell for cell in cells if isinstance(cell, str)}
        means = set(filter(is_summary, texts)) if _is_of_numbers(cells) else set()
        errors = set(filter(is_spreadsheet_error, texts)) if heading in headings.values() else set()
        for words, costs_its_row in ((means, True), (errors, "time_s" not in headings)):
            wrong = np.array([cell in words for cell in cells], dtype=bool)
            if not np.any(wrong):
                continue
            out |= wrong & costs_its_row
            first = int(wrong.argmax())
            also = f" and {int(wrong.sum()) - 1} more of this kind" if wrong.sum() > 1 else ""
            done = "the row is skipped" if costs_its_row else "treated as missing"
            place = f"{raw.path}:{int(raw.lines[first])}: column {heading}"
            sentences.append(f'{place}: "{cells[first]}"{also} is no reading; {done}')
    return (raw, []) if np.all(out) else (raw.of_rows(~out) if np.any(out) else raw, sentences)


def _is_of_numbers(cells: Cells) -> bool:
    """Whether most cells of a column are numbers."""
    return bool(2 * np.sum(np.isfinite(numbers(cells))) > len(cells))


def _applies(name: str, column: Column, raw: RawTable) -> bool:
    """Whether a key of ``[columns]``, which is for all files, holds for this one."""
    if column.value is not None:
        return name not in raw.headings
    in_file = (column.column or name) in raw.headings
    return in_file or (BY_NAME[name].required and name not in raw.headings)


def _headings(raw: RawTable, mapping: Mapping[str, Column], shared: Collection[str]) -> dict[str, str]:
    """The heading of every contract column that the file has."""
    headings = {name: column.column or name for name, column in mapping.items()}
    for channel in SWEEP_CHANNELS:
        if channel.name not in headings and channel.name in raw.headings:
            headings[channel.name] = channel.name
    for name, heading in headings.items():
        if heading not in raw.headings:
            raise _not_in_file(raw, name, heading, "[columns]" if name in shared else "[sweep.columns]")
    missing = [channel for channel in SWEEP_CHANNELS if channel.required and channel.name not in headings]
    if missing:
        raise _missing(raw, missing)
    return headings


def _not_in_file(raw: RawTable, name: str, heading: str, table: str) -> InputError:
    near = _nearest(raw, BY_NAME[name])
    hint = f'the nearest heading is "{near}"' if near else f"the headings are {', '.join(raw.headings)}"
    sentence = f'has no heading "{heading}", which {table} gives for {name}; {hint}'
    return InputError(sentence, file=raw.path, line=raw.heading_line)


def _nearest(raw: RawTable, channel: Channel) -> str:
    """The heading that most likely names a channel; none whose unit is of another quantity."""
    return nearest_heading(
        channel, [name for name in raw.headings if _unit_of(channel, raw.unit(name)) is not None]
    )


def _unit_of(channel: Channel, unit: str) -> str | None:
    """A unit that a file states, "" if it is none; None if it is one of another quantity than the channel's."""
    if not (unit and is_unit(unit)):
        return ""
    return unit if has_dimension(unit, channel.unit) else None


def _missing(raw: RawTable, channels: Sequence[Channel]) -> InputError:
    """The error about required columns that a file lacks, with a remedy for each."""
    near = {channel: _nearest(raw, channel) for channel in channels}
    entries = [
        f'{channel.name} = {{ column = "{heading}", unit = "{_unit_of(channel, raw.unit(heading)) or channel.unit}" }}'
        for channel, heading in near.items()
        if heading
    ]
    lost = [f"{channel.name} ({channel.description})" for channel, heading in near.items() if not heading]
    first, *others = (channel.name for channel in channels)
    said = "is missing"
    if others:
        said += f", and so {'is' if len(others) == 1 else 'are'} {', '.join(others)}"
    if entries:
        said += (
            "; if the file has other headings, write under [sweep.columns], or under [columns] for all files: "
            f"{', '.join(entries)}, with the true unit; or let `mffit init --from` or `mffit open` recognise them"
        )
    if lost:
        said += (
            f"; add {', '.join(lost)}, or give the heading, or one value for all rows such as gamma_deg = 0 "
            f"(the headings are {', '.join(raw.headings)})"
        )
    return InputError(said, file=raw.path, line=raw.heading_line, column=first)


def _read(source: _Source) -> np.ndarray | None:
    """The values (n,) of a column in the contract's unit; None if all its cells are blank."""
    cells, channel = source.cells, source.channel
    if _all_blank(cells):
        if channel.required:
            raise source.refusal("has no values; complete it", 0)
        return None
    if channel.kind == "label":
        different, where = np.unique(np.asarray(cells), return_inverse=True)
        return np.array([text_of(cell) for cell in different.tolist()], dtype=object)[where]
    if channel.kind == "direction":
        return _directions(source)
    values = _numbers(source)
    if channel.name == "time_s" and np.any(np.isnan(values)):
        values = _without_missing_times(source, values)
    return _in_range(source, _in_contract_unit(source, values))


def _without_missing_times(source: _Source, time: np.ndarray) -> np.ndarray:
    """The times of the samples; missing ones are interpolated, or refused if those before and after do not determine them."""
    complete = with_missing_times(time)
    untold = np.isnan(complete)
    missing = untold if np.any(untold) else np.isnan(time)
    row = int(missing.argmax())
    lines = np.asarray(source.raw.lines)[missing]
    said = f"empty in {'line' if len(lines) == 1 else 'lines'} {line_text(lines)}"
    if np.any(untold):
        sentence = (
            f"{said}, where the times before and after are missing or not as far apart as so many samples; complete the cells or "
            "remove the rows"
        )
        raise source.refusal(sentence, row)
    source.warnings.append(str(source.refusal(f"{said}; interpolated at the rate of the recording", row)))
    return complete


def with_missing_times(time: np.ndarray) -> np.ndarray:
    """The times (n,) of samples in any unit, with each NaN interpolated if the times before and after it are as far apart as so
    many samples of the recording's rate; else it stays NaN.
    """
    known = np.flatnonzero(np.isfinite(time))
    samples, steps = np.diff(known), np.diff(time[known])
    if np.all(samples > 1):
        return time
    step = float(np.median(steps[samples == 1]))
    told = np.r_[False, 2.0 * np.abs(steps - samples * step) < step, False]
    rows = np.arange(len(time))
    between = np.searchsorted(known, rows)
    return np.where(np.isnan(time) & told[between], np.interp(rows, known, time[known]), time)


def _directions(source: _Source) -> np.ndarray:
    cells = source.cells
    different, where = np.unique(np.asarray(cells), return_inverse=True)
    words = [text_of(cell).lower() for cell in different.tolist()]
    wrong = np.array([word not in DIRECTIONS for word in words])[where]
    if np.any(wrong):
        row = int(wrong.argmax())
        raise source.refusal(
            f'"{shortened(text_of(cells[row]))}" is not a direction; write forward or backward', row
        )
    return np.array([DIRECTIONS.get(word, 0) for word in words])[where]


def _numbers(source: _Source) -> np.ndarray:
    cells = source.cells
    values = numbers(cells)
    bad = ~np.isfinite(values)
    if not np.any(bad):
        return values
    if source.may_have_gaps:
        bad &= np.array([not _is_gap(cell) for cell in np.asarray(cells, dtype=object)])
        values = np.where(np.isinf(values), np.nan, values)
    elif source.channel.name in MAY_BE_BLANK:
        bad &= np.array([not _is_blank(cell) for cell in cells])
    if np.any(bad):
        row = int(bad.argmax())
        raise source.refusal(_bad_cell(text_of(cells[row]), source.channel), row)
    return values


def numbers(cells: Cells) -> np.ndarray:
    """A column's numbers (n,), NaN for cells that are not numbers."""
    if isinstance(cells, np.ndarray):
        return cells
    return pd.to_numeric(pd.Series(list(cells), dtype=object), errors="coerce").to_numpy(dtype=float)


def _bad_cell(cell: str, channel: Channel) -> str:
    """Why a cell is not a finite number, and what to do."""
    if cell == "":
        return "this cell is empty; complete it (merged cells hold their value only in the first one) or remove the row"
    quoted = f'"{shortened(cell)}"'
    if _is_gap(cell):
        return f"{quoted} is not a measurement; complete it or remove the row"
    if has_decimal_comma(cell):
        return f"{quoted} has a decimal comma; write {with_decimal_point(cell)}"
    unit = NUMBER_WITH_UNIT.fullmatch(cell)
    if unit:
        return (
            f"{quoted} has a unit in the cell; write the number alone, in {channel.unit}, or with "
            f'unit = "{shortened(unit[1])}" for this column under [sweep.columns]'
        )
    expected = f"a number in {channel.unit}" if channel.unit else "a plain number"
    return f"{quoted} is a text where {expected} is expected; correct it or remove the row"


def _all_blank(cells: Cells) -> bool:
    return bool(np.all(np.isnan(cells))) if isinstance(cells, np.ndarray) else all(map(_is_blank, cells))


def _is_blank(cell: str | float) -> bool:
    """Whether a cell is empty: "", or NaN in formats of numbers."""
    return not cell if isinstance(cell, str) else bool(np.isnan(cell))


def _is_gap(cell: str | float) -> bool:
    """Whether a cell is a text for a missing reading, or an empty cell of numbers."""
    if not isinstance(cell, str):
        return True
    return cell.lower().lstrip("+-") in WORDS["no_reading"] or is_spreadsheet_error(cell)


def text_of(cell: str | float) -> str:
    """A cell as a text, "" if it is empty."""
    return cell.strip() if isinstance(cell, str) else "" if np.isnan(cell) else f"{cell:.15g}"


def _in_contract_unit(source: _Source, values: np.ndarray) -> np.ndarray:
    """Values in the contract's unit, from the unit that ``tyre.toml`` names, else from that of the file."""
    channel, mapped = source.channel, source.mapped
    scale, named = (1.0, None) if mapped is None else (mapped.scale, mapped.unit)
    unit = source.unit
    if not unit:
        return scale * values
    try:
        return scale * converted(values, unit, channel.unit)
    except UnknownUnitError as error:
        sentence = f"{error}; correct the unit of this column"
        if named:
            raise InputError(sentence, key=f"columns.{channel.name}.unit") from None
        raw = source.raw
        raise InputError(sentence, file=raw.path, line=raw.heading_line, column=source.heading) from None


def _in_range(source: _Source, values: np.ndarray) -> np.ndarray:
    """The values, checked against the plausible range; rare spikes of a recording become NaN, and more are refused."""
    channel = source.channel
    outside = _outside(values, channel)
    if not np.any(outside):
        return values
    row, count = int(outside.argmax()), int(outside.sum())
    unit = f" {channel.unit}" if channel.unit else ""
    sentence = f"{values[row]:g}{unit} is outside {channel.lower:g} to {channel.upper:g}{unit}"
    if not implausible(values, channel, may_have_gaps=source.may_have_gaps):
        also = f" (with {count - 1} more)" if count > 1 else ""
        source.warnings.append(str(source.refusal(f"{sentence}{also}; treated as missing", row)))
        return np.where(outside, np.nan, values)
    hint = channel.below if values[row] < channel.lower else channel.above
    remedy = f"{hint}, convert it or name its unit under [sweep.columns]" if hint else "correct it"
    if stated := source.unit:
        remedy = f'its unit is stated as "{stated}"; correct the unit or the value'
    raise source.refusal(f"{sentence}; {remedy}", row)


def _outside(values: np.ndarray, channel: Channel) -> np.ndarray:
    return (values < channel.lower) | (values > channel.upper)


def implausible(values: np.ndarray, channel: Channel, *, may_have_gaps: bool) -> bool:
    """Whether more values (n,) are outside the plausible range of the channel than spikes of a recording explain."""
    share = constants.RARE_SAMPLES if may_have_gaps else 0.0
    return bool(np.sum(_outside(values, channel)) > share * len(values))


def _credible(source: _Source, u: np.ndarray, readings: np.ndarray) -> np.ndarray:
    """Uncertainties, with NaN for values that no rig can have, because such a point would outweigh all others.

    ``readings`` (n,) are those of the channel; (0,) if the file has none.
    """
    limit = constants.SMALLEST_U_OF_READINGS * float(np.nanmax(np.abs(readings), initial=0.0))
    if not np.any(u > limit):
        least = "zero" if np.all(u <= 0.0) else f"{limit:.2g}, a ten-millionth of the largest reading,"
        sentence = f"is not above {least} in any row, as a standard uncertainty must be; complete or remove the column"
        raise source.refusal(sentence, int((u <= limit).argmax()))
    limit = max(limit, constants.SMALLEST_U_OF_OTHERS * float(np.median(u[u > limit])))
    wrong = u <= limit
    if not np.any(wrong):
        return u
    row, count = int(wrong.argmax()), int(wrong.sum())
    least = "zero" if u[row] <= 0.0 else f"{limit:.2g}, so this point would outweigh all others"
    also = f" here and in {count - 1} more {'row' if count == 2 else 'rows'}" if count > 1 else ""
    source.warnings.append(
        str(source.refusal(f"{u[row]:g} is not above {least}; treated as not stated{also}", row))
    )
    return np.where(wrong, np.nan, u)


def _misspelt(raw: RawTable, extras: Mapping[str, Cells], found: Mapping[str, object]) -> list[str]:
    """Warnings about unused headings that resemble the name of a missing channel, or name it in another unit."""
    sentences = []
    for heading, cells in extras.items():
        near = nearest_channel(heading, likeness=constants.LIKENESS_OF_UNUSED_HEADING)
        is_constant = isinstance(cells, np.ndarray) and bool(np.all(cells == cells[0]))
        if near and near not in found and not is_constant:
            said = f'column "{heading}" is not used; if it is {near}, rename it'
            unit = BY_NAME[near].unit
            sentences.append(f"{raw.path}: {said}{f' and write it in {unit}' if unit else ''}")
    return sentences
