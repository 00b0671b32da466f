"""The columns a sweep file may have, from ``channels.csv``; knows no file and no axes."""

from __future__ import annotations

import csv
import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import resources


@dataclass(frozen=True, slots=True)
class Channel:
    """One row of the table."""

    name: str  #: the contract's heading, with its unit
    kind: str  #: "number", "label" or "direction"
    unit: str  #: as pint reads it
    lower: float  #: plausible range, in ``unit``
    upper: float
    required: bool
    below: str  #: what a value under the range usually is
    above: str  #: what a value over the range usually is
    aliases: tuple[str, ...]  #: headings that rigs use; never taken silently, as they do not say their unit
    description: str


def _read() -> tuple[Channel, ...]:
    text = resources.files(__package__).joinpath("channels.csv").read_text(encoding="utf-8")
    return tuple(
        Channel(
            name=row["name"],
            kind=row["kind"],
            unit=row["unit"],
            lower=float(row["lower"] or "-inf"),
            upper=float(row["upper"] or "inf"),
            required=row["required"] == "yes",
            below=row["below"],
            above=row["above"],
            aliases=tuple(row["aliases"].split()),
            description=row["description"],
        )
        for row in csv.DictReader(text.splitlines())
    )


CHANNELS = _read()
BY_NAME = {channel.name: channel for channel in CHANNELS}


def nearest_heading(channel: Channel, headings: Iterable[str]) -> str:
    """The heading of a file that most likely is this channel; empty if none is near."""
    headings = list(headings)
    spelt = {heading.lower(): heading for heading in headings}
    for alias in (channel.name, *channel.aliases):
        if alias.lower() in spelt:
            return spelt[alias.lower()]
    near = difflib.get_close_matches(channel.name.lower(), spelt, n=1, cutoff=0.6)
    stem = channel.name.rpartition("_")[0].lower() or channel.name.lower()
    starts = [heading for low, heading in spelt.items() if low.startswith(stem)]
    return spelt[near[0]] if near else starts[0] if starts else ""


def nearest_channel(heading: str, *, likeness: float = 0.8) -> str:
    """The channel whose name is spelt most like a heading; empty below a ``likeness`` of 0 to 1."""
    lower = {name.lower(): name for name in BY_NAME}
    near = difflib.get_close_matches(heading.lower(), lower, n=1, cutoff=likeness)
    return lower[near[0]] if near else ""
