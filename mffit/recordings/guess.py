"""Which heading of a file is which channel, and in which unit.

A heading is a channel only if the whole heading is a name that laboratories use. The unit is that of the file. If the file
states none, it is the unit in which the numbers are plausible (``unstated``); the guess says so, for the user to check.
"""

import re
from collections.abc import Collection, Mapping
from typing import NamedTuple

import numpy as np

from mffit.config.models import Column
from mffit.points.constants import FEWEST_POINTS
from mffit.recordings import constants
from mffit.recordings.by_unit import is_of_kind, only_ones, questions, taken_for
from mffit.recordings.slip_definition import SLIP, slip_definition
from mffit.recordings.unstated import Choice, FoundChannel, Guess, Remark, choices
from mffit.sweeps.about import simplified
from mffit.sweeps.channels import BY_NAME, SWEEP_CHANNELS, Channel
from mffit.sweeps.columns import UNCERTAINTIES, numbers, standing
from mffit.sweeps.frames import FORCES, MOMENTS, letter_of
from mffit.sweeps.raw_table import RawTable, with_values
from mffit.sweeps.units import converted, is_unit, spelt
from mffit.sweeps.wide import FROM_NAMES
from tir.errors import counted

WITH_UNIT = re.compile(r"(.+?)(?:\s*[/,_]\s*|\s+in\s+)([^_,\s]+)")
"""A heading that ends with its unit: ``Fz / N``, ``Fz, N``, ``Fz in N``, ``Fz_N``."""


OF_SLIP = re.compile(r"slip|schlupf", re.IGNORECASE)
OF_ANGLE = re.compile(r"angle|winkel|side|lat|quer|schr[äa]g", re.IGNORECASE)


ABOUT_LETTERS = {
    "C": "turned with the wheel carrier, about the wheel centre",
    "H": "horizontal, about the wheel centre",
}
"""TYDEX letters of axes other than the contact frame W, and their description."""


NOTHING_NAMED: Mapping[str, str] = {}
NO_COLUMNS: Mapping[str, Column] = {}


class ColumnChoice(NamedTuple):
    """A user's choice of channel, unit and sign for a column."""

    heading: str
    channel: str  #: "" if it is not used
    unit: str  #: "" if the file states it
    minus: bool  #: the file has the other sign


class Guesses(NamedTuple):
    """The channels of a file, by the contract's names, with remarks for the user."""

    found: dict[str, Guess]
    remarks: tuple[Remark, ...]


def guesses(
    raw: RawTable,
    *,
    unloaded_radius: float | None = None,
    named: Mapping[str, str] = NOTHING_NAMED,
    columns: Mapping[str, Column] = NO_COLUMNS,
) -> Guesses:
    """The guessed channels of a file, and remarks.

    The unloaded radius [m], if known, checks the speed of rotation. ``named`` are the user's headings by channel, which replace
    those that laboratories use; ``columns`` are [columns] of a project that reads the file, or values that the user gives for
    all rows. Samples at standstill are ignored.
    """
    values = {name: column.value for name, column in columns.items() if column.value is not None}
    raw = with_values(raw, values)
    guessed = _guessed(raw, unloaded_radius, named, values)
    for name in values.keys() & guessed.found.keys():
        guessed.found[name] = guessed.found[name]._replace(value=values[name])
    declared = {name: column.column or name for name, column in columns.items() if column.value is None}
    there = {name: heading for name, heading in declared.items() if heading in raw.headings}
    chosen = {name: _as_declared(raw, name, heading, columns[name]) for name, heading in there.items()}
    return _with_chosen(guessed, raw, chosen, set(there.values())) if there else guessed


def _as_declared(raw: RawTable, name: str, heading: str, column: Column) -> Guess:
    """The column of a channel as [columns] of a project reads it."""
    channel, why = BY_NAME[name], "as [columns] of tyre.toml says"
    guess = Guess(channel, heading)
    if channel.kind == "number":
        guess = FoundChannel(channel, heading, raw.unit(heading), numbers(raw.column(heading))).guess(None)
    return guess._replace(
        unit=column.unit or "", scale=column.scale, against=column.against, over=column.over, why=why
    )


def _guessed(
    raw: RawTable, unloaded_radius: float | None, named: Mapping[str, str], given: Collection[str]
) -> Guesses:
    """The channels by what laboratories call them, and remarks; see :func:`guesses`."""
    raw, of_rest = _rolling(raw)
    named = {name: heading for name, heading in named.items() if heading in raw.headings}
    columns = {
        c.name: known[0]._replace(given=c.name in given)
        for c in SWEEP_CHANNELS
        if c.kind == "number" and c.name != SLIP and (known := candidates(raw, c, named))
    }
    slips = candidates(raw, BY_NAME[SLIP], named) or _called_slip(raw)
    taken = {column.heading for column in (*columns.values(), *slips)} | set(named.values())
    by_unit = only_ones(raw, columns, taken)
    columns |= by_unit
    speed = columns.get("V_mps")
    rolls_back = speed is not None and float(np.nanmedian(speed.values)) < 0.0
    if speed is not None and rolls_back:
        columns["V_mps"] = speed._replace(values=-speed.values)
    columns, of_axes = _in_one_frame(columns)
    chosen, left_out, of_units = choices(columns, unloaded_radius)
    columns = {name: column for name, column in columns.items() if name not in left_out}
    found = {name: column.guess(chosen.get(name)) for name, column in columns.items()}
    remarks = [*of_rest, *of_axes, *left_out.values(), *of_units, *_unknown_units(raw, found)]
    found |= _labels(raw, named)
    for name in [name for name in by_unit if name in found]:
        found[name] = found[name]._replace(why="taken by its unit")
    if rolls_back and "V_mps" in found:
        found["V_mps"] = found["V_mps"].reversed("the speed is negative in the file")
    if why := _of_finished_points(columns, found):
        time = found.pop("time_s")
        found["t_s"] = time._replace(channel=BY_NAME["t_s"], why=why)
    taken_by_unit = {column.heading for column in by_unit.values()}
    remarks += [taken_for(guess) for guess in found.values() if guess.heading in taken_by_unit]
    slip = slip_definition(slips, columns, lambda name: found[name].unit_of_readings)
    remarks += slip.remarks
    if slip.guess is not None:
        found[SLIP] = slip.guess
    if slip.force_reversed:
        found["Fx_N"] = found["Fx_N"].reversed(slip.force_reversed)
    remarks += _asked(raw, found)
    found = _as_their_channels(found)
    ordered = {channel.name: found[channel.name] for channel in SWEEP_CHANNELS if channel.name in found}
    return Guesses(ordered, tuple(remarks))


def _asked(raw: RawTable, found: Mapping[str, Guess], answered: Collection[str] = ()) -> list[Remark]:
    """Questions about channels that a file may have, the load in its names, and its time; not about ``answered`` headings."""
    asked = questions(raw, found, {guess.heading for guess in found.values()} | set(answered))
    load = found.get("Fz_N")
    if FROM_NAMES in raw.about and load is not None and not load.stated:
        unit = load.unit_of_readings
        remedy = f'Fz_N = {{ column = "{load.heading}", unit = "lbf" }} under [columns], with the true unit'
        said = f"the load is taken {raw.about[FROM_NAMES]}, in {unit}: is it in {unit}?"
        asked.append(Remark(said, f" If not, write {remedy}"))
    if not found.keys() & {"time_s", "t_s"}:
        remedy = (
            'if rows are samples of a recording, name its time under [columns], for example time_s = "..."'
        )
        asked.append(Remark("no time: each row is treated as a finished point", f"; {remedy}"))
    return asked


def _rolling(raw: RawTable) -> tuple[RawTable, list[Remark]]:
    """The rows of a recording at which the wheel rolls, and a remark about the others."""
    speeds = candidates(raw, BY_NAME["V_mps"])
    if not speeds or not candidates(raw, BY_NAME["time_s"]):
        return raw, []
    rests = standing(speeds[0].values)
    count = int(np.sum(rests))
    return (
        (raw.of_rows(~rests), [Remark(f"left out at standstill: {count} of {counted(len(raw), 'row')}")])
        if count
        else (raw, [])
    )


def corrected(guessed: Guesses, raw: RawTable, choices: Collection[ColumnChoice]) -> Guesses:
    """The guesses, with the user's choices in place of the guesses for the same columns."""
    if not choices:
        return guessed
    touched = {choice.heading for choice in choices}
    chosen = {}
    for choice in choices:
        if choice.channel:
            channel, stated = BY_NAME[choice.channel], raw.unit(choice.heading)
            column = FoundChannel(channel, choice.heading, stated, numbers(raw.column(choice.heading)))
            guess = column.guess(Choice(choice.unit, "as chosen"))
            chosen[channel.name] = guess._replace(assumed=False, scale=-1.0 if choice.minus else 1.0)
    return _with_chosen(guessed, raw, chosen, touched)


def _with_chosen(
    guessed: Guesses, raw: RawTable, chosen: Mapping[str, Guess], touched: Collection[str]
) -> Guesses:
    """The guesses with chosen columns in place of those of the ``touched`` headings; what that answers is not asked."""
    kept = {name: guess for name, guess in guessed.found.items() if guess.heading not in touched}
    found = _as_their_channels({**kept, **chosen})
    ordered = {c.name: found[c.name] for c in SWEEP_CHANNELS if c.name in found}
    words = "|".join(map(re.escape, {*touched, *chosen}))
    about = re.compile(rf"(?<![\w\[])(?:{words})(?![\w\]])")
    asked = _asked(raw, guessed.found)
    doubts = [one for one in guessed.remarks if one not in asked and not about.search(one.said)]
    return Guesses(ordered, (*doubts, *_asked(raw, ordered, touched)))


def _as_their_channels(found: Mapping[str, Guess]) -> dict[str, Guess]:
    """The guesses, with uncertainties of which no unit is stated in the unit of their readings."""
    units = dict[str, Guess]()
    for name, readings in UNCERTAINTIES.items():
        u, read = found.get(name), found.get(readings)
        if u is None or read is None or u.stated or u.heading == name or (u.unit and not u.assumed):
            continue
        unit = read.unit_of_readings
        units[name] = u._replace(unit=unit, assumed=True, why=f"taken in {unit}, like {read.heading}")
    return {**found, **units}


def _in_one_frame(columns: dict[str, FoundChannel]) -> tuple[dict[str, FoundChannel], list[Remark]]:
    """The columns, and remarks on their axes by TYDEX's letters.

    A moment is dropped if its axes differ from those of the decisive moment (Mz, else My, else Mx).
    """
    letters = {name: letter_of(columns[name].heading) for name in (*FORCES, *MOMENTS) if name in columns}
    of_moments = [letters[name] for name in reversed(MOMENTS) if name in letters]
    odd = [name for name in MOMENTS if name in letters and letters[name] != of_moments[0]]
    remarks = [
        Remark(f"{columns[name].heading} is left out: it is in other axes than the other moments")
        for name in odd
    ]
    kept = {name: column for name, column in columns.items() if name not in odd}
    for letter, what in ABOUT_LETTERS.items():
        named = [kept[name].heading for name in letters if name in kept and letters[name] == letter]
        if named:
            said = f"{', '.join(named)}: {what}, as TYDEX names it; converted to the contact frame and point"
            remarks.append(Remark(said))
    return kept, remarks


def candidates(
    raw: RawTable, channel: Channel, named: Mapping[str, str] = NOTHING_NAMED
) -> list[FoundChannel]:
    """Columns with a known name of a channel and suitable readings, in the order of the names; else the one that is ``named``."""
    names = [named[channel.name]] if channel.name in named else _known_headings(raw, channel, named.values())
    columns = [_column(raw, channel, heading) for heading in names]
    return [column for column in columns if column is not None]


def _called_slip(raw: RawTable) -> list[FoundChannel]:
    """Columns with the word slip in their heading that are not angles; the forces decide which one is the slip."""
    headings = [
        heading for heading in raw.headings if OF_SLIP.search(heading) and not OF_ANGLE.search(heading)
    ]
    columns = [_column(raw, BY_NAME[SLIP], heading) for heading in headings]
    return [column for column in columns if column is not None]


def _known_headings(raw: RawTable, channel: Channel, others: Collection[str]) -> list[str]:
    """The headings with a known name of a channel that are not among the ``others``, in the order of the names.

    A name with its unit, such as ``Camber / deg``, is known, too.
    """
    with_unit = {heading: WITH_UNIT.fullmatch(heading) for heading in reversed(raw.headings)}
    plain = {simplified(m[1]): heading for heading, m in with_unit.items() if m}
    names = [simplified(name) for name in (channel.name, *channel.aliases)]
    full = {simplified(heading): heading for heading in reversed(raw.headings)}
    found = [full[name] for name in names if name in full]
    found += [plain[name] for name in names if name in plain and _unit_within(plain[name], channel)]
    return [heading for heading in dict.fromkeys(found) if heading not in others]


def _unit_within(heading: str, channel: Channel) -> str:
    """The unit that a heading states after a name; "" if the unit is of another kind, or the heading is the contract's."""
    found = WITH_UNIT.fullmatch(heading)
    unit = found[2] if found and heading != channel.name else ""
    return unit if spelt(unit) and is_unit(unit) and is_of_kind(unit, channel) else ""


def _column(raw: RawTable, channel: Channel, heading: str) -> FoundChannel | None:
    """The column of a heading as this channel; None without readings or with a unit of another dimension."""
    stated = raw.unit(heading)
    if stated and is_unit(stated):
        return FoundChannel.of(raw, channel, heading) if is_of_kind(stated, channel) else None
    return FoundChannel.of(raw, channel, heading, _unit_within(heading, channel))


def _unknown_units(raw: RawTable, found: Mapping[str, Guess]) -> list[Remark]:
    """Remarks on columns whose stated unit is unknown."""
    return [
        Remark(
            f'the unit "{stated}" of {guess.heading} is not known, so it is taken as {guess.unit_of_readings}',
            "; if it is another one, correct it under [columns]",
        )
        for guess in found.values()
        if (stated := raw.unit(guess.heading)) and not is_unit(stated)
    ]


def _labels(raw: RawTable, named: Mapping[str, str]) -> dict[str, Guess]:
    """Columns of labels or directions; a heading in another spelling counts only if its labels differ, each in several rows."""
    headings = {simplified(heading).rstrip("."): heading for heading in reversed(raw.headings)}
    found = {}
    for channel in SWEEP_CHANNELS:
        names = map(simplified, (channel.name, *channel.aliases))
        heading = named.get(channel.name, next((headings[name] for name in names if name in headings), None))
        if channel.kind == "number" or heading is None:
            continue
        own, counts = np.unique(np.asarray(raw.column(heading)), return_counts=True)
        if heading == channel.name or (len(own) > 1 and np.median(counts) >= FEWEST_POINTS):
            found[channel.name] = Guess(channel, heading)
    return found


def _of_finished_points(columns: Mapping[str, FoundChannel], found: Mapping[str, Guess]) -> str:
    """The reason to read the time column as times of finished points; "" if it holds times of samples."""
    if "time_s" not in columns or "t_s" in columns or columns["time_s"].heading == "time_s":
        return ""
    time = columns["time_s"].values
    seconds = converted(time[np.isfinite(time)], found["time_s"].unit_of_readings, "s")
    if len(seconds) < 2:
        return ""
    step = float(np.median(np.abs(np.diff(seconds))))
    least, most = constants.TIME_BETWEEN_POINTS
    return f"rows are {step:.3g} s apart, so each is a finished point" if least < step < most else ""
