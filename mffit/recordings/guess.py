"""Which heading of a file is which channel, and in which unit.

A heading is taken only where a name that laboratories use is all of it. The unit is the file's; where the file states
none it is the one whose numbers make sense (``unstated``), and the guess says so, to be written down and read.
"""

from __future__ import annotations

import re
from collections.abc import Collection
from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.config.models import Column
from mffit.recordings.unstated import Choice, Found, choices, customary, rotation
from mffit.sweeps.channels import BY_NAME, CHANNELS, Channel
from mffit.sweeps.raw_table import Cells, RawTable
from mffit.sweeps.units import UnknownUnitError, converted

CLOCK = re.compile(r"\d{1,4}[-./]\d{1,2}[-./]\d{1,4}[T ]+\d{1,2}:\d|\d{1,2}:\d\d:\d\d")
"""A time of day, with or without its date."""


class Guess(NamedTuple):
    """Where a channel stands in a file."""

    channel: Channel
    heading: str
    stated: str  #: unit as the file states it, "" where it does not
    unit: str  #: unit to write down: "" where the file or the heading says it
    assumed: bool  #: the unit is neither stated nor in the heading
    lower: float  #: range of the readings, in the file's unit
    upper: float
    why: str = ""  #: what an assumed unit rests on

    @property
    def column(self) -> Column:
        """The guess as ``[columns]`` has it."""
        return Column(column=self.heading, unit=self.unit or None)


class Guesses(NamedTuple):
    """The channels of a file, by the contract's names, and what is to be said of them."""

    found: dict[str, Guess]
    remarks: tuple[str, ...]


def guesses(raw: RawTable, *, unloaded_radius: float | None = None) -> Guesses:
    """The channels found in a file.

    Parameters
    ----------
    raw : the file's cells
    unloaded_radius : [m], with which a speed of rotation has to agree; None where it is not known
    """
    spelt = {_plain(heading): heading for heading in reversed(raw.headings)}
    columns: dict[str, Found] = {}
    labels: dict[str, Guess] = {}
    taken: set[str] = set()
    for channel in CHANNELS:
        names = [channel.name, *channel.aliases] if channel.kind == "number" else [channel.name]
        for name in names:
            heading = spelt.get(_plain(name))
            if heading is None or heading in taken:
                continue
            if channel.kind != "number":
                cells = raw.cells[raw.headings.index(heading)]
                if heading != channel.name and len(np.unique(np.asarray(cells))) < 2:
                    continue  # one label for all says nothing
                labels[channel.name] = Guess(channel, heading, "", "", False, np.nan, np.nan)
            elif (column := _column(raw, channel, heading)) is not None:
                columns[channel.name] = column
            else:
                continue
            taken.add(heading)
            break
    chosen = choices(columns)
    units = {name: column.unit or column.channel.unit for name, column in columns.items()}
    units |= {name: choice.unit for name, choice in chosen.items()}
    remarks = []
    turning = columns.get("omega_radps")
    if turning is not None and turning.heading != "omega_radps":
        unit, left_out = rotation(columns, units.get("V_mps", ""), unloaded_radius)
        if left_out:
            remarks.append(left_out)
            del columns["omega_radps"]
        elif not turning.unit:
            chosen["omega_radps"] = Choice(unit, f"as {unit} they agree with {columns['V_mps'].heading}")
    if said := customary(columns, units, list(chosen)):
        remarks.append(said)
    found = {name: _guess(raw, column, chosen.get(name)) for name, column in columns.items()} | labels
    if "Mz_Nm" not in found:
        remarks += _without_moment(raw, {guess.heading for guess in found.values()})
    if "time_s" not in found:
        remarks.append(_without_time(raw))
    return Guesses(
        {channel.name: found[channel.name] for channel in CHANNELS if channel.name in found}, tuple(remarks)
    )


def _plain(heading: str) -> str:
    return heading.lower().replace(" ", "_").replace("-", "_")


def _column(raw: RawTable, channel: Channel, heading: str) -> Found | None:
    """The heading as this channel; None if its unit or its values are of another kind."""
    k = raw.headings.index(heading)
    stated = raw.units[k]
    values = numbers(raw.cells[k])
    if not np.any(np.isfinite(values)) or (stated and not _is_of_kind(stated, channel)):
        return None
    return Found(channel, heading, stated or (channel.unit if heading == channel.name else ""), values)


def _is_of_kind(unit: str, channel: Channel) -> bool:
    try:
        converted(np.zeros(1), unit, channel.unit)
    except UnknownUnitError:
        return False
    return True


def _guess(raw: RawTable, column: Found, choice: Choice | None) -> Guess:
    lower, upper = float(np.nanmin(column.values)), float(np.nanmax(column.values))
    stated = raw.units[raw.headings.index(column.heading)]
    if choice is None:
        return Guess(column.channel, column.heading, stated, "", False, lower, upper)
    return Guess(column.channel, column.heading, stated, choice.unit, True, lower, upper, choice.why)


def _without_moment(raw: RawTable, taken: Collection[str]) -> list[str]:
    """Which columns may be the aligning moment that is missing."""
    moment = BY_NAME["Mz_Nm"]
    near = [
        heading
        for heading, unit in zip(raw.headings, raw.units, strict=True)
        if unit and heading not in taken and _is_of_kind(unit, moment)
    ]
    if not near:
        return []
    return [
        f"no heading is known to be {moment.name} ({moment.description}); in a unit of moments and not used: "
        f'{", ".join(near)}; if it is there, name it under [columns], as in {moment.name} = "{near[0]}"'
    ]


def _without_time(raw: RawTable) -> str:
    """That every row counts, and which column holds clock times instead of seconds."""
    sentence = f"no time: each of {len(raw)} rows is taken for a finished point"
    for heading, cells in zip(raw.headings, raw.cells, strict=True):
        if not isinstance(cells, np.ndarray) and len(cells) and CLOCK.match(str(cells[0])):
            return f'{sentence}; column "{heading}" holds clock times ("{cells[0]}"): write seconds in a column time_s'
    return (
        f'{sentence}; if they are samples of a recording, name its time, as in time_s = "..." under [columns]'
    )


def numbers(cells: Cells) -> np.ndarray:
    """A column's numbers (n,), NaN where there is none."""
    if isinstance(cells, np.ndarray):
        return cells
    return pd.to_numeric(pd.Series(list(cells), dtype=object), errors="coerce").to_numpy(dtype=float)
