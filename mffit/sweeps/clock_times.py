"""Columns of clock times, such as ``2026-03-01T12:03:04.5``, as seconds."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from mffit.sweeps.about import WORDS
from mffit.sweeps.raw_table import Cells, RawTable

CLOCK = re.compile(
    r"(\d{1,4}):(\d\d)(?::(\d\d))?(?:[.,:](\d+))?\s*([ap]\.?m\.?)?\s*(?:Z|UTC|[+-]\d\d:?\d\d)?$",
    re.IGNORECASE,
)
"""A time of day or an elapsed time; of two numbers with a fraction, the first are the minutes."""
DATE = re.compile(r"$|.*\d.*[T ,]$")
"""What may precede a clock time."""


class _ClockTime(NamedTuple):
    """One clock time."""

    date: str  #: as written, "" without one
    seconds: float  #: since midnight, or since the hour
    has_hours: bool


def with_clock_times(raw: RawTable) -> RawTable:
    """The table with columns of clock times as seconds: those since the first midnight; later midnights count on."""
    cells, units = list(raw.cells), list(raw.units)
    for k, column in enumerate(raw.cells):
        seconds = None if isinstance(column, np.ndarray) else _seconds(column)
        if seconds is not None:
            cells[k], units[k] = seconds, "s"
    return replace(raw, cells=tuple(cells), units=tuple(units))


def _seconds(cells: Cells) -> np.ndarray | None:
    """Seconds (n,), NaN where a cell is empty; None if the cells are not clock times, or all equal."""
    filled = [
        (row, str(cell)) for row, cell in enumerate(cells) if str(cell).lower() not in WORDS["no_reading"]
    ]
    found: list[_ClockTime] = []
    for _, cell in filled:
        clock = _clock(cell)
        if clock is None:
            return None
        found.append(clock)
    if len(set(found)) < 2:
        return None
    times = np.array([clock.seconds for clock in found])
    period = 86_400.0 if found[0].has_hours else 3_600.0
    if found[0].date:
        midnights = np.array([one.date != next_.date for one, next_ in itertools.pairwise(found)])
    else:
        midnights = np.diff(times) < -0.5 * period
    seconds = np.full(len(cells), np.nan)
    seconds[[row for row, _ in filled]] = times + period * np.r_[0, np.cumsum(midnights)]
    return seconds


def _clock(cell: str) -> _ClockTime | None:
    """The clock time that a cell holds; None if it holds none."""
    found = CLOCK.search(cell)
    date = cell[: found.start()] if found else ""
    if found is None or not DATE.match(date):
        return None
    first, second, third, part, half = found.groups()
    fraction = float(f"0.{part or 0}")
    if third is None and part is not None:
        return _ClockTime(date, 60.0 * int(first) + int(second) + fraction, has_hours=False)
    hours = int(first) % 12 + 12 * (half[0] in "pP") if half else int(first)
    return _ClockTime(date, 3_600.0 * hours + 60.0 * int(second) + int(third or 0) + fraction, has_hours=True)
