"""One recording: its channels, by its headings, a user's choices and what else it says; or why it cannot be read."""

import math
import re
import unicodedata
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from mffit.as_json import keys
from mffit.config.models import Column
from mffit.constants import CERTAIN_SIGMA
from mffit.errors import InputError, meant
from mffit.points.clock import spread
from mffit.points.steady import gaps
from mffit.recordings.by_unit import KINDS, in_unit_of, named_alike
from mffit.recordings.guess import NO_COLUMNS, ColumnChoice, corrected, guesses
from mffit.recordings.tyre_constants import StatedByFile, stated_by
from mffit.recordings.unstated import Guess, Remark
from mffit.scatter import bends, robust
from mffit.sheets import file_of
from mffit.sweeps import formats
from mffit.sweeps.channels import BY_NAME, SWEEP_CHANNELS, Channel, unknown_channel
from mffit.sweeps.columns import numbers, with_missing_times
from mffit.sweeps.raw_table import RawTable, with_values
from mffit.sweeps.units import converted


class UnrecognisedError(InputError):
    """Required channels of a recording are not recognised; ``said`` is the sentence without what to do."""

    def __init__(self, said: str, remedy: str, *, file: Path, line: int | None) -> None:
        super().__init__(f"{said}; {remedy}", file=file, line=line)
        self.said = said


class SniffedRecording(NamedTuple):
    """One file."""

    path: Path
    kind: str  #: name of the format
    headings: tuple[str, ...]
    units: tuple[str, ...]
    samples: int
    guesses: dict[str, Guess]
    about: dict[str, str]
    rate: float  #: samples per second; NaN for finished points
    seconds: float  #: from first to last sample
    gaps: int  #: number of gaps in time
    remarks: tuple[str, ...]  #: on doubtful columns
    backward: bool = False  #: whether the wheel rolled backwards, by the file's name or a user's choice
    tyre: Mapping[str, StatedByFile] = MappingProxyType({})  #: keys of [tyre] that it states


keys(
    SniffedRecording,
    "file=path format=kind samples rate_Hz seconds gaps units channels=guesses remarks",
    units=lambda row: dict(zip(row.headings, row.units, strict=True)),
)


class ChosenFile(NamedTuple):
    """A user's choices for one recording."""

    columns: tuple[ColumnChoice, ...]  #: columns that differ from the guess
    backward: bool  #: whether the wheel rolled backwards


NOTHING_CHOSEN: Mapping[Path, ChosenFile] = {}


def recordings_of(
    files: Sequence[Path], of: Callable[[Path], SniffedRecording], *, optional: Collection[Path]
) -> tuple[tuple[SniffedRecording, ...], list[InputError]]:
    """The recordings, and the errors about optional sheets whose workbook has others that can be read."""
    found: list[SniffedRecording] = []
    refused: dict[Path, InputError] = {}
    for file in files:
        try:
            found.append(of(file))
        except InputError as error:
            refused[file] = error
    readable = {file_of(recording.path) for recording in found}
    for file, refusal in refused.items():
        if file not in optional or file_of(file) not in readable:
            raise refusal
    return tuple(found), list(refused.values())


def with_shared_units(recordings: Sequence[SniffedRecording]) -> tuple[SniffedRecording, ...]:
    """The recordings; an angle that is only noise, and whose unit no file states, has the unit of its largest readings elsewhere.

    One rig writes a heading in one unit, and an angle that is held at zero shows none.
    """
    known: dict[str, tuple[float, str, Path]] = {}
    for recording in recordings:
        for guess in _angles(recording):
            size = max(-guess.lower, guess.upper)
            known[guess.heading] = max(
                known.get(guess.heading, (0.0, "", Path())), (size, guess.unit, recording.path)
            )

    def shared(guess: Guess, path: Path) -> Guess:
        _, unit, other = known[guess.heading]
        if guess.unit == unit:
            return guess
        values = numbers(formats.read(path).column(guess.heading))
        noise = robust(bends(values[np.isfinite(values)], 3))
        if max(-guess.lower, guess.upper) > CERTAIN_SIGMA * noise:
            return guess
        why = f"{guess.lower:.3g} to {guess.upper:.3g} taken in {unit}, like {guess.heading} of {other.name}"
        return guess._replace(unit=unit, why=why)

    return tuple(
        r._replace(guesses={**r.guesses, **{one.channel.name: shared(one, r.path) for one in _angles(r)}})
        for r in recordings
    )


def _angles(recording: SniffedRecording) -> list[Guess]:
    """The angles of which neither the file nor a user states the unit."""
    return [one for one in recording.guesses.values() if one.assumed and one.channel.unit == "deg"]


def check_headings(headings: Mapping[str, str], files: Sequence[Path]) -> None:
    """Refuse unknown channels, and headings that no readable file has."""
    for name, heading in headings.items():
        if name not in BY_NAME:
            raise InputError(unknown_channel(name), key=f"--column {name}")
        there: dict[str, None] = {}
        for file in files:
            with suppress(InputError):  # recording_of raises it
                there |= dict.fromkeys(formats.read(file).headings)
        if there and heading not in there and _as_value(heading) is None:
            near = meant(heading, there)
            hint = f'did you mean "{near}"?' if near else f"the headings are {', '.join(there)}"
            raise InputError(f'no file has the heading "{heading}"; {hint}', key=f"--column {name}")


def _as_value(heading: str) -> float | None:
    """The finite number that a text is; None for any other."""
    try:
        value = float(heading)
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def recording_of(
    path: Path,
    unloaded_radius: float | None,
    chosen: ChosenFile | None,
    headings: Mapping[str, str],
    columns: Mapping[str, Column] = NO_COLUMNS,
) -> SniffedRecording:
    """A recording with its user's choices; ``columns`` are [columns] of a project that reads it.

    Raises UnrecognisedError if a required channel is missing, and InputError if a column cannot be what ``headings`` say.
    """
    raw = formats.read(path)
    values = {
        name: value
        for name, heading in headings.items()
        if heading not in raw.headings and (value := _as_value(heading)) is not None
    }
    raw = with_values(raw, values)
    tyre = stated_by(raw)
    if unloaded_radius is None and "unloaded_radius" in tyre:
        unloaded_radius = tyre["unloaded_radius"].value
    columns = {**columns, **{name: Column(value=value) for name, value in values.items()}}
    guessed = guesses(raw, unloaded_radius=unloaded_radius, named=headings, columns=columns)
    found, remarks = guessed if chosen is None else corrected(guessed, raw, chosen.columns)
    _refuse_misnamed(headings, raw, found, remarks)
    missing = [channel for channel in SWEEP_CHANNELS if channel.required and channel.name not in found]
    if missing:
        said = _unrecognised(missing, raw, {guess.heading for guess in found.values()})
        raise UnrecognisedError(*said, file=path, line=raw.heading_line)
    return SniffedRecording(
        path=path,
        kind=formats.format_of(path).name,
        headings=raw.headings,
        units=raw.units,
        samples=len(raw),
        guesses=found,
        about=dict(raw.about),
        **_clock(raw, found.get("time_s"))._asdict(),
        remarks=tuple(map(str, remarks)),
        backward="direction" not in found
        and (rolls_backward(path) or speed_is_negative(found) if chosen is None else chosen.backward),
        tyre=tyre,
    )


def _refuse_misnamed(
    headings: Mapping[str, str], raw: RawTable, found: Mapping[str, Guess], remarks: Iterable[Remark]
) -> None:
    """Raise for a heading that was named for a channel and cannot be it; ``remarks`` say why it was left out."""
    for name, heading in headings.items():
        if heading in raw.headings and (name not in found or found[name].heading != heading):
            left_out = (str(one) for one in remarks if heading in one.said and "left out" in one.said)
            why = next(
                left_out, f"it holds no numbers in a unit of {KINDS.get(BY_NAME[name].unit, 'this kind')}"
            )
            raise InputError(
                f"cannot be {name} ({BY_NAME[name].description}): {why}", file=raw.path, column=heading
            )


def _unrecognised(missing: Sequence[Channel], raw: RawTable, taken: Collection[str]) -> tuple[str, str]:
    """Which required channels are missing, with the columns that fit by their unit or name, and what to do."""
    near = {channel.name: _near(channel, raw, taken) for channel in missing}
    fitting = [f"; {name} may be {' or '.join(headings)}" for name, headings in near.items() if headings]
    example = next((f"{name}={headings[0]}" for name, headings in near.items() if headings), None)
    settings = [channel.name for channel in missing if channel.name != "Fy_N"]
    value = f", or --column {settings[0]}=VALUE for one value in all rows" if settings else ""
    return (
        f"no heading is known to be {' or '.join(near)} (the headings are {', '.join(raw.headings)}{''.join(fitting)})",
        f"give --column '{example or f'{missing[0].name}=HEADING'}'{value}, or name them under [columns] of a tyre.toml",
    )


def _near(channel: Channel, raw: RawTable, taken: Collection[str]) -> list[str]:
    """Columns that are not taken: with a channel's name and an ending such as that of a wheel, else with words that fit, else
    in its unit.
    """
    names = "|".join(re.escape(name) for name in (channel.name, *channel.aliases))
    with_ending = re.compile(rf"(?:{names})(?:[\W_\d].*|[lr])", re.IGNORECASE)
    by_name = [heading for heading in raw.headings if heading not in taken and with_ending.fullmatch(heading)]
    return by_name or named_alike(channel, raw, taken) or in_unit_of(channel, raw, taken)


class _Clock(NamedTuple):
    """Sampling of a recording; NaN and 0 for finished points."""

    rate: float = np.nan
    seconds: float = np.nan
    gaps: int = 0


def _clock(raw: RawTable, guess: Guess | None) -> _Clock:
    if guess is None:
        return _Clock()
    time = converted(numbers(raw.column(guess.heading)), guess.unit_of_readings, guess.channel.unit)
    time = with_missing_times(time)
    time = spread(time[np.isfinite(time)])
    step = float(np.median(np.diff(time))) if len(time) > 1 else np.nan
    if not step > 0.0:
        return _Clock()
    return _Clock(rate=1.0 / step, seconds=float(time[-1] - time[0]), gaps=len(gaps(time)))


LETTER = "[^\\W\\d_]"
BACKWARD = re.compile(
    rf"backward|reverse|(?<!{LETTER})(?:(?:zu)?r(?:ü|ue|u)ck(?:w(?:ä|ae|a)rts|lauf|fahrt|rollen|rollend)?|bwd|rev)(?!{LETTER})",
    re.IGNORECASE,
)
"""Words for rolling backwards in names of files; other words with the same beginning, such as Rückstellmoment, do not match."""


def rolls_backward(path: Path) -> bool:
    """Whether the name of a recording says that the wheel rolled backwards."""
    return BACKWARD.search(unicodedata.normalize("NFC", formats.stem(path.name))) is not None


def speed_is_negative(guesses: Mapping[str, Guess]) -> bool:
    """Whether a file has negative speeds."""
    return "V_mps" in guesses and guesses["V_mps"].scale < 0.0
