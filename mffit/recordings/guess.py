"""Which heading of a file is which channel, and in which unit.

A heading is taken only where a name that laboratories use is all of it. The unit is the file's; where the file states
none it is the one whose numbers make sense, and the guess says so, to be written down and read.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import pandas as pd

from mffit.config.models import Column
from mffit.sweeps.channels import CHANNELS, Channel
from mffit.sweeps.raw_table import Cells, RawTable
from mffit.sweeps.units import UnknownUnitError, converted

ALTERNATIVES = {
    "deg": (("deg", 1.6, 90.0), ("rad", 0.0, 1.6)),
    "N": (("N", 100.0, np.inf), ("kN", 0.0, 100.0)),
    "kPa": (("bar", 0.0, 12.0), ("psi", 12.0, 60.0), ("kPa", 60.0, 1500.0), ("Pa", 1500.0, np.inf)),
    "m/s": (("m/s", 0.0, 25.0), ("km/h", 25.0, np.inf)),
}
"""Units by the largest value that a channel reaches, for files that do not state them: unit, from, to."""


class Guess(NamedTuple):
    """Where a channel stands in a file."""

    channel: Channel
    heading: str
    stated: str  #: unit as the file states it, "" where it does not
    unit: str  #: unit to write down: "" where the file or the heading says it
    assumed: bool  #: the unit is neither stated nor in the heading
    lower: float  #: range of the readings, in the file's unit
    upper: float

    @property
    def column(self) -> Column:
        """The guess as ``[columns]`` has it."""
        return Column(column=self.heading, unit=self.unit or None)


def guesses(raw: RawTable) -> dict[str, Guess]:
    """The channels found in a file, by the contract's names."""
    spelt = {_plain(heading): heading for heading in reversed(raw.headings)}
    found: dict[str, Guess] = {}
    for channel in CHANNELS:
        names = [channel.name, *channel.aliases] if channel.kind == "number" else [channel.name]
        for name in names:
            heading = spelt.get(_plain(name))
            if heading is None or any(guess.heading == heading for guess in found.values()):
                continue
            guess = _guess(raw, channel, heading)
            if guess is not None:
                found[channel.name] = guess
                break
    return found


def _plain(heading: str) -> str:
    return heading.lower().replace(" ", "_").replace("-", "_")


def _guess(raw: RawTable, channel: Channel, heading: str) -> Guess | None:
    """The heading as this channel; None if its unit or its values are of another kind."""
    k = raw.headings.index(heading)
    stated = raw.units[k]
    if channel.kind != "number":
        if heading != channel.name and len(np.unique(np.asarray(raw.cells[k]))) < 2:
            return None  # one label for all says nothing
        return Guess(channel, heading, stated, "", False, np.nan, np.nan)
    values = numbers(raw.cells[k])
    if not np.any(np.isfinite(values)):
        return None
    lower, upper = float(np.nanmin(values)), float(np.nanmax(values))
    if stated:
        try:
            converted(np.zeros(1), stated, channel.unit)
        except UnknownUnitError:
            return None
        return Guess(channel, heading, stated, "", False, lower, upper)
    if heading == channel.name or not channel.unit:
        return Guess(channel, heading, "", "", False, lower, upper)
    # One spike does not make another unit.
    size = float(np.nanpercentile(np.abs(values), 99.5))
    fitting = [unit for unit, least, most in ALTERNATIVES.get(channel.unit, ()) if least <= size < most]
    return Guess(channel, heading, "", fitting[0] if fitting else channel.unit, True, lower, upper)


def numbers(cells: Cells) -> np.ndarray:
    """A column's numbers (n,), NaN where there is none."""
    if isinstance(cells, np.ndarray):
        return cells
    return pd.to_numeric(pd.Series(list(cells), dtype=object), errors="coerce").to_numpy(dtype=float)
