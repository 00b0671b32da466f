"""``mffit sniff``: what recordings hold, with the axes that physics says."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mffit import config as configuration
from mffit.config import Config
from mffit.config.globs import is_wild, matches
from mffit.errors import InputError
from mffit.points import levels
from mffit.points.loading import Reading, read
from mffit.points.points import Points
from mffit.points.steady import gaps
from mffit.points.stretch import MOVE
from mffit.recordings.guess import Guess, guesses, numbers
from mffit.suspicion import contradictions, signatures, under_axes
from mffit.sweeps import formats
from mffit.sweeps.channels import CHANNELS
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.units import converted
from tir.conventions import FLIPPED

STAND_IN = {"unloaded_radius": 0.3, "nominal_load": 1500.0, "nominal_pressure": 250.0}
"""Of a tyre of which nothing is known yet; no result of reading depends on it."""


class Recording(NamedTuple):
    """One file."""

    path: Path
    kind: str  #: name of the format
    headings: tuple[str, ...]
    units: tuple[str, ...]
    samples: int
    guesses: dict[str, Guess]
    about: dict[str, str]
    rate: float  #: samples per second; NaN for finished points
    seconds: float  #: from first to last
    gaps: int  #: in time
    remarks: tuple[str, ...]  #: what is doubtful about its columns


class Level(NamedTuple):
    """One condition that the recordings return to."""

    value: float  #: in SI
    stretches: int


@dataclass(frozen=True, slots=True)
class Sniffed:
    """What recordings hold."""

    recordings: tuple[Recording, ...]
    axes: tuple[str, ...]  #: that agree with physics, the likeliest first; empty if none does
    wrong: tuple[str, ...]  #: what the likeliest axes contradict, if none agrees
    reading: Reading  #: points and stretches under the likeliest axes
    conditions: dict[
        str, tuple[Level, ...]
    ]  #: by quantity: load [N], camber [rad], pressure [Pa], speed [m/s]

    @property
    def points(self) -> Points:
        """Under the likeliest axes."""
        return self.reading.points


@formats.reading_once()
def sniff(paths: Sequence[str | Path], *, unloaded_radius: float | None = None) -> Sniffed:
    """Look into recordings.

    Parameters
    ----------
    paths : files, also as patterns like ``runs/*.csv``
    unloaded_radius : [m], with which a speed of rotation has to agree; None where it is not known

    Raises
    ------
    InputError
        A file cannot be read, a pattern matches none, a file lacks a required channel, or the same file is named twice.
    """
    files = [file for path in paths for file in files_of(path)]
    if not files:
        raise InputError("no file is named; name one recording or more")
    twice = [file for k, file in enumerate(files) if file in files[:k]]
    if twice:
        raise InputError("is named twice; remove one", file=twice[0])
    recordings = tuple(_recording(file, unloaded_radius) for file in files)
    axes = _first_axes(recordings)
    config = configuration_of(recordings, axes)
    reading = read(config, may_be_empty=True)
    agreeing, wrong = axes_of(reading.points, axes, load_falls=axes == "sae")
    if agreeing and agreeing[0] != axes:
        reading = read(configuration_of(recordings, agreeing[0]), may_be_empty=True)
    return Sniffed(recordings, agreeing, wrong, reading, conditions_of(recordings, reading))


def files_of(path: str | Path) -> list[Path]:
    """The files that a name or a pattern stands for, in the order of their names."""
    if not is_wild(str(path), Path()):
        file = Path(path)
        if not file.exists():
            raise InputError("there is no such file; correct its name", file=file)
        if file.is_dir():
            inside = sorted(
                each.name for each in file.iterdir() if each.name.lower().endswith(formats.ENDINGS)
            )
            remedy = (
                f'name those in it, as "{file}/*{Path(inside[0]).suffix}"' if inside else "name a recording"
            )
            raise InputError(f"is a folder; {remedy}", file=file)
        return [file]
    found = matches(str(path), Path())
    if not found:
        raise InputError("no file matches this pattern; correct it", file=path)
    return [Path(name) for name in found]


def _recording(path: Path, unloaded_radius: float | None) -> Recording:
    raw = formats.read(path)
    found, remarks = guesses(raw, unloaded_radius=unloaded_radius)
    missing = [channel for channel in CHANNELS if channel.required and channel.name not in found]
    if missing:
        raise InputError(
            f"no heading is known to be {' or '.join(channel.name for channel in missing)} ({', '.join(raw.headings)} are "
            "there); name them under [columns] of a tyre.toml",
            file=path,
            line=raw.heading_line,
        )
    kind = next(kind.name for kind in formats.FORMATS if formats.reads(kind, path))
    rate, seconds, holes = _clock(raw, found)
    return Recording(
        path, kind, raw.headings, raw.units, len(raw), found, dict(raw.about), rate, seconds, holes, remarks
    )


def _clock(raw: RawTable, found: dict[str, Guess]) -> tuple[float, float, int]:
    if "time_s" not in found:
        return float("nan"), float("nan"), 0
    clock = found["time_s"]
    time = converted(
        numbers(raw.cells[raw.headings.index(clock.heading)]),
        clock.unit or clock.stated or clock.channel.unit,
        clock.channel.unit,
    )
    steps = np.diff(time)
    usual = float(np.median(steps)) if len(steps) else float("nan")
    if not usual > 0.0:
        return float("nan"), float("nan"), 0
    return 1.0 / usual, float(time[-1] - time[0]), len(gaps(time))


def _first_axes(recordings: Sequence[Recording]) -> str:
    """Axes that the sign of the load allows."""
    negative = [r.guesses["Fz_N"].lower + r.guesses["Fz_N"].upper < 0.0 for r in recordings]
    return "sae" if any(negative) else "iso"


def configuration_of(recordings: Sequence[Recording], axes: str) -> Config:
    """A configuration that reads these files and stands for no tyre."""
    sweeps = [
        {
            "file": str(recording.path.absolute()),
            "columns": {
                name: guess.column.model_dump(exclude_none=True) for name, guess in recording.guesses.items()
            },
        }
        for recording in recordings
    ]
    content = {
        "tyre": {"name": "sniffed", **STAND_IN},
        "rig": {"type": "flat-track", "axes": axes},
        "sweep": sweeps,
    }
    return configuration.load(content)


def axes_of(points: Points, declared: str, *, load_falls: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The axes under which points do what every tyre does, and what they contradict under the declared ones.

    Parameters
    ----------
    points : read under ``declared``
    declared : axes
    load_falls : the load is reported as a negative force, which only some axes do
    """
    agreeing = []
    for axes in (declared, *(axes for axes in FLIPPED if axes != declared)):
        if load_falls and "Fz" not in FLIPPED[axes]:
            continue
        found = signatures(under_axes(points, declared, axes))
        if not contradictions(found):
            agreeing.append((found.camber.sign >= 0, axes))
    return tuple(axes for _, axes in sorted(agreeing, key=lambda pair: pair[0])), tuple(
        contradictions(signatures(points))
    )


def conditions_of(recordings: Sequence[Recording], reading: Reading) -> dict[str, tuple[Level, ...]]:
    """The levels of every setting among the stretches that give points, or among finished points.

    Pressure and speed count where they were measured; a setting that no recording holds has no level.
    """
    kept = [note for note in reading.stretches if note.kind != MOVE and not note.dropped]
    points = reading.points
    pressed = holding(recordings, "p_kPa")
    values = {
        levels.LOAD: np.array([note.Fz_N for note in kept]) if kept else points.Fz,
        levels.CAMBER: np.radians([note.gamma_deg for note in kept]) if kept else points.gamma,
        levels.PRESSURE: 1e3 * np.array([note.p_kPa for note in kept if note.file in pressed])
        if kept
        else points_from(points, pressed).p,
        levels.SPEED: points_from(points, holding(recordings, "V_mps")).V,
    }
    return {quantity.name: _levels(found, quantity) for quantity, found in values.items()}


def holding(recordings: Sequence[Recording], channel: str) -> frozenset[str]:
    """The files that hold a channel, as points and stretches name them."""
    return frozenset(str(r.path.absolute()) for r in recordings if channel in r.guesses)


def points_from(points: Points, files: Collection[str]) -> Points:
    """The points of some files."""
    return points.select(np.array([file in files for file in points.files], dtype=bool)[points.file])


def _levels(values: np.ndarray, quantity: levels.LevelKind) -> tuple[Level, ...]:
    near = levels.nearest_labels(values, quantity)
    return tuple(
        Level(float(np.median(values[near == k])), int(np.sum(near == k)))
        for k in range(near.max(initial=-1) + 1)
    )
