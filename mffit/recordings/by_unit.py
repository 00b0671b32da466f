"""Columns under unknown headings, by the unit that the file states for them, and by words in the heading.

If pressure, speed or time is missing and only one unused column is in a unit of it, that column is taken, with a question. Where
the unit fits several channels, or several columns fit, the question proposes the column whose heading has fitting words.
"""

import re
from collections.abc import Collection, Mapping, Sequence

import numpy as np

from mffit.recordings.tyre_constants import NAMES
from mffit.recordings.unstated import FoundChannel, Guess, Remark
from mffit.sweeps.channels import SWEEP_CHANNELS, Channel
from mffit.sweeps.columns import UNCERTAINTIES, implausible, numbers
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.units import UnknownUnitError, converted, spelt

KINDS = {
    "kPa": "pressure", "m/s": "speed", "s": "time", "degC": "temperature", "deg": "angle", "N": "force", "N m": "moment",
    "rad/s": "rotation",
}  # fmt: skip
"""Word for the kind of each of the contract's units whose readings are seldom anything else; lengths may be of everything."""
ONE_CHANNEL = ("kPa", "m/s", "s")
"""Units that leave one channel; a temperature may be that of the air or the track instead."""
NOT_THE_TYRES = re.compile(r"amb|umgeb|baro|atmos|hydr|air|wind", re.IGNORECASE)
"""Words in headings of pressures and speeds that are not the tyre's."""
BRAKING = re.compile("brak|brems", re.IGNORECASE)
"""Words in the heading of a force that is positive when braking."""
ANGLE = re.compile(r"deg|rad|°")


def is_of_kind(unit: str, channel: Channel) -> bool:
    """Whether readings in a unit can be converted to that of a channel; a ratio and an angle cannot."""
    try:
        converted(np.zeros(1), unit, channel.unit)
    except UnknownUnitError:
        return False
    is_angle = ANGLE.search(spelt(unit)) is not None
    return is_angle if channel.unit == "deg" else channel.unit != "" or not is_angle


def in_unit_of(channel: Channel, raw: RawTable, taken: Collection[str]) -> list[str]:
    """The headings of numbers that are not taken and whose stated unit is one of the channel's kind."""
    return [
        heading
        for heading, unit in zip(raw.headings, raw.units, strict=True)
        if unit
        and heading not in taken
        and heading.upper() not in NAMES
        and is_of_kind(unit, channel)
        and np.any(np.isfinite(numbers(raw.column(heading))))
    ]


def only_ones(
    raw: RawTable, found: Mapping[str, FoundChannel], taken: Collection[str]
) -> dict[str, FoundChannel]:
    """Missing channels that the unit of a single column leaves no choice for."""
    by_unit = {}
    for channel in SWEEP_CHANNELS:
        if channel.unit not in ONE_CHANNEL or channel.name in ("t_s", *found):
            continue
        near = in_unit_of(channel, raw, taken)
        if len(near) == 1 and (column := FoundChannel.of(raw, channel, near[0])) and _fits(column):
            by_unit[channel.name] = column
    return by_unit


def _fits(column: FoundChannel) -> bool:
    """Whether the readings can be those of the channel."""
    if column.channel.name == "time_s":
        steps = np.diff(column.values[np.isfinite(column.values)])
        return bool(np.all(steps >= 0.0) and np.any(steps > 0.0))
    values = converted(column.values, column.stated, column.channel.unit)
    return not NOT_THE_TYRES.search(column.heading) and not implausible(
        values, column.channel, may_have_gaps=True
    )


def taken_for(guess: Guess) -> Remark:
    """The question about a column that is taken because of its unit."""
    channel = guess.channel
    return Remark(
        f"{guess.heading} [{guess.stated}] is taken as {channel.name} ({channel.description}), because no other unused column "
        f"has a unit of {KINDS[channel.unit]}: is that right?",
        f" If not, remove {channel.name} under [columns]",
    )


def named_alike(channel: Channel, raw: RawTable, taken: Collection[str]) -> list[str]:
    """The headings of numbers that are not taken and whose words fit the channel, in a unit of its kind or named as of it."""
    if not channel.words:
        return []
    which, kind = (re.compile(words, re.IGNORECASE) for words in (channel.words, channel.words_of_kind))
    in_unit = in_unit_of(channel, raw, taken)
    return [
        heading
        for heading in raw.headings
        if heading not in taken
        and which.search(heading)
        and (heading in in_unit or (not raw.unit(heading) and kind.search(which.sub(" ", heading))))
        and np.any(np.isfinite(numbers(raw.column(heading))))
    ]


def questions(raw: RawTable, found: Collection[str], taken: Collection[str]) -> list[Remark]:
    """Questions about missing channels: for those that words of unused columns fit, and for every kind of unit of the others."""
    asked, proposed = [], set(taken)
    missing = [c for c in SWEEP_CHANNELS if c.name not in (*found, *UNCERTAINTIES, "t_s")]
    for channel in list(missing):
        if near := named_alike(channel, raw, proposed):
            asked.append(question([channel], near, raw, "with such words in the heading"))
            missing.remove(channel)
            proposed.update(near)
    for unit, kind in KINDS.items():
        rest = [channel for channel in missing if channel.unit == unit]
        near = in_unit_of(rest[0], raw, proposed) if rest else []
        if near:
            asked.append(question(rest, near, raw, f"in a unit of {kind}"))
    return asked


def question(missing: Sequence[Channel], near: Sequence[str], raw: RawTable, alike: str) -> Remark:
    """Ask whether one of the columns ``near`` is one of the missing channels; ``alike`` says why these columns are proposed."""
    names = [f"{channel.name} ({channel.description})" for channel in missing]
    columns = ", ".join(f'"{heading}" [{raw.unit(heading)}]'.removesuffix(" []") for heading in near)
    name, heading = missing[0].name, near[0]
    sign = ", with scale = -1 if braking is positive in it" if name == "Fx_N" else ""
    return Remark(
        f"no heading is known to be {' or '.join(names)}; unused columns {alike}: {columns}; is it one of them?",
        f" Then give --column '{name}={heading}', or write {name} = \"{heading}\" under [columns]{sign}",
    )
