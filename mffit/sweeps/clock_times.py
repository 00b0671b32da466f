"""Columns of clock times, such as ``2026-03-01T12:03:04.5``, as seconds."""

import re
from dataclasses import replace

import numpy as np
import pandas as pd

from mffit.sweeps.about import WORDS
from mffit.sweeps.raw_table import Cells, RawTable

CLOCK = re.compile(
    r"^(?P<date>|.*\d.*[T ,])(?P<first>\d{1,4}):(?P<second>\d\d)(?::(?P<third>\d\d))?(?:[.,:](?P<part>\d+))?"
    r"\s*(?P<half>[ap]\.?m\.?)?\s*(?:Z|UTC|[+-]\d\d:?\d\d)?$",
    re.IGNORECASE,
)
"""A time of day, with or without a date, or an elapsed time; of two numbers with a fraction, the first are the minutes."""


def with_clock_times(raw: RawTable) -> RawTable:
    """The table with columns of clock times as seconds since the first midnight; later midnights count on."""
    cells, units = list(raw.cells), list(raw.units)
    for k, column in enumerate(raw.cells):
        seconds = None if isinstance(column, np.ndarray) else _seconds(column)
        if seconds is not None:
            cells[k], units[k] = seconds, "s"
    return replace(raw, cells=tuple(cells), units=tuple(units))


def _seconds(cells: Cells) -> np.ndarray | None:
    """Seconds (n,), NaN where a cell is empty; None if the cells are not clock times, or all equal."""
    filled = {
        row: str(cell) for row, cell in enumerate(cells) if str(cell).lower() not in WORDS["no_reading"]
    }
    if not filled or not CLOCK.match(next(iter(filled.values()))):
        return None
    found = pd.Series(filled).str.extract(CLOCK)
    if found["first"].isna().any():
        return None
    in_minutes = found["third"].isna() & found["part"].notna()
    of_afternoon = found["half"].fillna("").str.lower().str.startswith("p")
    texts = found.fillna("0").assign(part="0." + found["part"].fillna("0"))
    first, second, third, part = (texts[name].astype(float) for name in ("first", "second", "third", "part"))
    hours = first.where(found["half"].isna(), first % 12.0 + 12.0 * of_afternoon)
    times = (3_600.0 * hours + 60.0 * second + third).where(~in_minutes, 60.0 * first + second) + part
    if times.nunique() < 2 and found["date"].nunique() < 2:
        return None
    period = 3_600.0 if in_minutes.iloc[0] else 86_400.0
    if found["date"].iloc[0]:
        midnights = found["date"].ne(found["date"].shift()).to_numpy()[1:]
    else:
        midnights = np.diff(times) < -0.5 * period
    seconds = np.full(len(cells), np.nan)
    seconds[found.index] = times + period * np.r_[0, np.cumsum(midnights)]
    return seconds
