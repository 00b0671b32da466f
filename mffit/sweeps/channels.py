"""The columns that a sweep file may have, from ``channels.csv``."""

import csv
from collections.abc import Iterable
from dataclasses import dataclass
from importlib import resources

from mffit.constants import LIKENESS_OF_MISSPELT
from mffit.errors import meant
from mffit.sweeps.about import simplified
from mffit.sweeps.units import has_dimension


@dataclass(frozen=True, slots=True)
class Channel:
    """One row of the table."""

    name: str  #: the contract's heading, with its unit
    kind: str  #: "number", "label" or "direction"
    unit: str  #: as pint reads it
    lower: float  #: plausible range, in ``unit``
    upper: float
    required: bool
    below: str  #: usual cause of a value below the range
    above: str  #: usual cause of a value above the range
    aliases: tuple[str, ...]  #: headings that rigs use; they do not state a unit, so they are only suggested
    words: str  #: pattern of the words by which a heading names it
    words_of_kind: str  #: pattern of the words of its kind, which a heading without a unit has as well
    description: str

    @property
    def stem(self) -> str:
        """The name without its unit, in lower case."""
        return (self.name.rpartition("_")[0] or self.name).lower()


def _read() -> tuple[Channel, ...]:
    text = resources.files(__package__).joinpath("channels.csv").read_text(encoding="utf-8")
    return tuple(
        Channel(
            **row
            | {
                "lower": float(row["lower"] or "-inf"),
                "upper": float(row["upper"] or "inf"),
                "required": row["required"] == "yes",
                "aliases": tuple(row["aliases"].split()),
            }
        )
        for row in csv.DictReader(text.splitlines())
    )


SWEEP_CHANNELS = _read()
BY_NAME = {channel.name: channel for channel in SWEEP_CHANNELS}
NAMED = {simplified(name): one for one in SWEEP_CHANNELS for name in (one.name, *one.aliases)}
"""The channel of every known name."""


def nearest_heading(channel: Channel, headings: Iterable[str]) -> str:
    """The heading that most likely names this channel; "" if none does. Names of other channels are ignored."""
    known = {heading: NAMED.get(simplified(heading)) for heading in headings}
    if named := [heading for heading, one in known.items() if one is channel]:
        return named[0]
    written = {heading.lower(): heading for heading, one in known.items() if one is None}
    near = meant(channel.name.lower(), written)
    starts = [heading for low, heading in written.items() if low.startswith(channel.stem)]
    return written[near] if near else starts[0] if starts else ""


def nearest_channel(heading: str, *, likeness: float) -> str:
    """The channel that a heading names in another unit, or else the one whose name is most similar.

    It is "" if all similarities are below ``likeness``, from 0 to 1.
    """
    stem, _, unit = heading.rpartition("_")
    lower = {channel.name.lower(): channel.name for channel in SWEEP_CHANNELS}
    in_other_unit = (c.name for c in SWEEP_CHANNELS if c.stem == stem.lower() and has_dimension(unit, c.unit))
    return next(in_other_unit, "") or lower.get(meant(heading.lower(), lower, likeness=likeness), "")


def unknown_channel(name: str) -> str:
    """Error sentence about an unknown name of a channel."""
    near = nearest_channel(name, likeness=LIKENESS_OF_MISSPELT)
    hint = f'did you mean "{near}"?' if near else f"known columns are {', '.join(BY_NAME)}"
    return f"is not a column of a sweep; {hint}"
