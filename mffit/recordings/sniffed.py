"""``mffit sniff``: channels, conditions and axes of recordings; the axes are those that agree with physics."""

import itertools
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from mffit import config as configuration
from mffit.as_json import keys
from mffit.config import Config
from mffit.config.loading import STAND_IN, is_pattern, matches
from mffit.config.models import Column
from mffit.errors import InputError
from mffit.points import levels
from mffit.points.loading import Reading, read
from mffit.points.points import Points
from mffit.points.stretch import MOVE, StretchNote, stretch_table
from mffit.recordings.guess import NO_COLUMNS, NOTHING_NAMED
from mffit.recordings.recording import (
    NOTHING_CHOSEN,
    ChosenFile,
    SniffedRecording,
    check_headings,
    recording_of,
    recordings_of,
    rolls_backward,
    speed_is_negative,
    with_shared_units,
)
from mffit.recordings.summary import BadRun, apart, bad_runs, two_specimens
from mffit.recordings.tyre_constants import StatedByFile
from mffit.sheets import file_of
from mffit.suspicion import contradictions, signatures, under_axes
from mffit.suspicion.all_files import moment_reversed
from mffit.suspicion.other_tyre import two_tyres
from mffit.sweeps import formats
from tir.conventions import FLIPPED

REVERSIBLE = ("Fz_N", "alpha_deg", "gamma_deg", "Fy_N", "Mz_Nm")
"""Columns that may have the sign of other axes."""


class Level(NamedTuple):
    """One value of a setting, at which there are points."""

    value: float  #: in SI
    points: int
    upper: float | None = None  #: of an angle that is swept from ``value``; None where it is held


@dataclass(frozen=True, slots=True)
class Sniffed:
    """The content of recordings."""

    recordings: tuple[SniffedRecording, ...]
    axes: tuple[str, ...]  #: axes that agree with physics, those of ``reading`` first; empty if none agrees
    wrong: tuple[str, ...]  #: contradictions with physics under the axes tried first
    reading: Reading  #: points and stretches under the likeliest axes
    conditions: dict[str, tuple[Level, ...]]
    """Levels of load [N], camber [rad], pressure [Pa], speed [m/s] and, of slip sweeps, sideslip [rad]."""

    of_two_tyres: bool = False  #: whether the last warning of ``reading`` is about two tyres
    bad_runs: tuple[BadRun, ...] = ()  #: recordings that a summary of the test calls bad
    evidence: tuple[str, ...] = ()  #: what the axes were decided from, as phrases; empty if nothing decides
    reversible: tuple[tuple[tuple[str, ...], str], ...] = ()
    """If no axes agree, the fewest columns whose reversal lets some agree, each choice of them with the axes."""

    @property
    def points(self) -> Points:
        """Points under the likeliest axes."""
        return self.reading.points


keys(
    Sniffed,
    "recordings axes conditions points bad_runs stretches warnings",
    points=lambda found: len(found.points),
    stretches=lambda found: stretch_table(found.reading.stretches).to_dict("records"),
    warnings=lambda found: [*found.reading.notes, *found.reading.warnings],
)


@formats.reading_once()
def sniff(
    paths: Sequence[str | Path],
    *,
    unloaded_radius: float | None = None,
    chosen: Mapping[Path, ChosenFile] = NOTHING_CHOSEN,
    headings: Mapping[str, str] = NOTHING_NAMED,
    columns: Mapping[str, Column] = NO_COLUMNS,
) -> Sniffed:
    """The content of recordings.

    Parameters
    ----------
    paths : files, also as patterns like ``runs/*.csv``; of a workbook, all visible sheets with data, or ``book.xlsx#Sheet``
    unloaded_radius : [m], to check the speed of rotation; None if it is not known
    chosen : a user's choices for some of the files
    headings : headings that are not recognised, by channel, for all files that have them; or a number, for all rows
    columns : [columns] of the project that reads the files

    Raises
    ------
    InputError
        A file cannot be read or lacks a required channel, a pattern matches no file, or a file is named twice. Of several
        sheets of a workbook, those that cannot be read are left out with a warning, unless it is all of them.
    """
    named = [file for path in paths for file in files_of(path)]
    if not named:
        raise InputError("no file is named; name at least one recording")
    twice = [file for k, file in enumerate(named) if file in named[:k]]
    if twice:
        raise InputError("is named twice; remove one", file=twice[0])
    files, summaries = apart([table for file in named for table in formats.tables_of(file)])
    check_headings(headings, files)

    def of(file: Path) -> SniffedRecording:
        return recording_of(file, unloaded_radius, chosen.get(file), headings, columns)

    recordings, refused = recordings_of(files, of, optional=set(files) - set(named))
    recordings = with_shared_units(recordings)
    bad = bad_runs(summaries)
    if len(bad) == len(recordings):
        raise InputError(f"every run is bad, as {bad[0].why}", file=files[0])
    found, config = _read_under_axes(recordings, bad, unloaded_radius)
    two = [
        *map(two_tyres.said, two_tyres.find(found.points, config)),
        *filter(None, [two_specimens(summaries)]),
    ][:1]
    warnings = (
        *found.reading.warnings,
        *(f"{error} (this sheet is left out)" for error in refused),
        *(f"{each.recording} is left out: {each.why}" for each in bad),
        *(moment_reversed.said(facts) for facts in moment_reversed.find(found.points, config)),
        *two,
    )
    return replace(found, reading=found.reading._replace(warnings=warnings), of_two_tyres=bool(two))


def _read_under_axes(
    recordings: Sequence[SniffedRecording], bad: tuple[BadRun, ...], radius: float | None
) -> tuple[Sniffed, Config]:
    """The recordings in the first rolling directions in which the likeliest axes agree with them, else under the first axes that
    do; and the configuration of these directions under the likeliest axes, "sae" for negative loads and "iso" for others.
    """
    load_falls = any(r.guesses["Fz_N"].lower + r.guesses["Fz_N"].upper < 0.0 for r in recordings)
    axes = "sae" if load_falls else "iso"
    for directed in _either_way(recordings):
        config = configuration_of(directed, axes, bad, radius)
        reading = read(config, may_be_empty=True)
        agreeing, wrong = axes_of(reading.points, axes, load_falls=load_falls)
        if axes in agreeing:
            break
    if agreeing and agreeing[0] != axes:
        reading = read(configuration_of(directed, agreeing[0], bad, radius), may_be_empty=True)
    return Sniffed(
        recordings=directed,
        axes=agreeing,
        wrong=wrong,
        reading=reading,
        conditions=conditions_of(directed, reading),
        bad_runs=bad,
        evidence=evidence_of(reading.points, load_falls=load_falls),
        reversible=() if agreeing else reversible(reading.points, axes, load_falls=load_falls),
    ), config


def files_of(path: str | Path) -> list[Path]:
    """The file of this name, or the files that match this pattern, sorted by name.

    Raises InputError if no file matches, the name is that of a folder, or there is no such file.
    """
    if is_pattern(str(path), Path()):
        found = matches(str(path), Path())
        if not found:
            raise InputError("no file matches this pattern; correct it", file=path)
        return [Path(name) for name in found]
    file = Path(path)
    if file.is_dir():
        inside = sorted(each.name for each in file.iterdir() if each.name.lower().endswith(formats.ENDINGS))
        remedy = (
            f'name the files in it, for example "{file}/*{Path(inside[0]).suffix}"'
            if inside
            else "name a recording"
        )
        raise InputError(f"is a folder; {remedy}", file=file)
    if not file_of(file).exists():
        raise InputError("there is no such file; correct its name", file=file)
    return [file]


def _either_way(recordings: Sequence[SniffedRecording]) -> Iterator[tuple[SniffedRecording, ...]]:
    """The recordings, and then, if only a negative speed says that some roll backwards, these as rolling forwards.

    Some rigs count the speed of a belt that runs forwards as negative.
    """
    yield tuple(recordings)
    doubtful = [
        r.backward and speed_is_negative(r.guesses) and not rolls_backward(r.path) for r in recordings
    ]
    if any(doubtful):
        yield tuple(
            r._replace(backward=r.backward and not d) for r, d in zip(recordings, doubtful, strict=True)
        )
        yield tuple(recordings)


def configuration_of(
    recordings: Sequence[SniffedRecording],
    axes: str,
    bad: Sequence[BadRun] = (),
    radius: float | None = None,
) -> Config:
    """A configuration that reads these files without the bad runs, with a placeholder for the tyre except its ``radius`` [m]."""
    sweeps = [
        {
            "file": str(recording.path.absolute()),
            "columns": {
                name: guess.column.model_dump(exclude_none=True) for name, guess in recording.guesses.items()
            },
        }
        | ({"direction": "backward"} if recording.backward else {})
        for recording in recordings
    ]
    content = {
        "tyre": {"name": "sniffed", **STAND_IN} | ({} if radius is None else {"unloaded_radius": radius}),
        "rig": {"type": "flat-track", "axes": axes},
        "fit": {
            "exclude": [
                {"file": str(run.recording.absolute()), "lines": run.lines, "why": run.why} for run in bad
            ]
        },
        "sweep": sweeps,
    }
    return configuration.load(content)


def axes_of(points: Points, declared: str, *, load_falls: bool) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """The axes under which the points behave like a tyre, and contradictions under the ``declared`` axes, under which they were
    read.

    The declared axes come first. If axes that a file format prescribes are among them, only these are returned. If the load is
    reported as a negative force (``load_falls``), axes with positive load are skipped.
    """
    agreeing = []
    for axes in (declared, *(axes for axes in FLIPPED if axes != declared)):
        if load_falls and "Fz" not in FLIPPED[axes]:
            continue
        if not contradictions(signatures(under_axes(points, declared, axes))):
            agreeing.append(axes)
    prescribed = {formats.format_of(Path(file)).axes for file in points.files}
    agreeing = [axes for axes in agreeing if axes in prescribed] or agreeing
    return tuple(agreeing), tuple(contradictions(signatures(points)))


def reversible(points: Points, declared: str, *, load_falls: bool) -> tuple[tuple[tuple[str, ...], str], ...]:
    """The fewest columns whose reversal lets axes agree with points that were read under the ``declared`` axes, with the axes.

    A load in ISO-W is positive either way; its sign decides which axes are possible.
    """
    possible = [name for name in REVERSIBLE if load_falls or name != "Fz_N"]
    for number in range(1, len(possible)):
        found = []
        for names in itertools.combinations(possible, number):
            fields = [name.partition("_")[0] for name in names if name != "Fz_N"]
            turned = points.replace(**{field: -getattr(points, field) for field in fields})
            agreeing, _ = axes_of(turned, declared, load_falls=load_falls and "Fz_N" not in names)
            found += [(names, axes) for axes in sorted(agreeing, key=list(FLIPPED).index)[:1]]
        if found:
            return tuple(found)
    return ()


SLOPES = {
    "cornering": "the slope of side force over sideslip",
    "camber": "the slope of side force over camber",
    "aligning": "the slope of the aligning moment over sideslip",
    "backward": "the slope of side force over sideslip in backward runs",
}
"""Words for the slopes whose signs depend on the axes."""


def evidence_of(points: Points, *, load_falls: bool) -> tuple[str, ...]:
    """What these points say about the axes: slopes with a significant sign, and a negative load (``load_falls``)."""
    found = signatures(points)
    slopes = [word for name, word in SLOPES.items() if getattr(found, name).sign]
    large = ["the camber thrust at large camber"] if np.isfinite(found.thrust) else []
    return (*slopes, *large, *(["the negative load"] if load_falls else []))


def axes_reason(sniffed: Sniffed) -> str:
    """What the axes were decided from, and why several axes fit."""
    first, *others = sniffed.axes
    prescribing = [r.kind for r in sniffed.recordings if formats.format_of(r.path).axes == first]
    if prescribing:
        return f"as {prescribing[0]} prescribes"
    *most, last = sniffed.evidence or ("",)
    reasons = [f"from {' and '.join(filter(None, (', '.join(most), last)))}"] if last else []
    if others:
        quoted = " or ".join(f'"{axes}"' for axes in others)
        reasons.append(", ".join((f"{quoted} would fit, too", *_undecided(sniffed))))
    return "; ".join(reasons)


def _undecided(sniffed: Sniffed) -> list[str]:
    """Why a slope that would decide between axes is unknown: its angle does not move, or the force does not follow it."""
    angles = {
        "cornering": (levels.SIDESLIP, sniffed.points.alpha),
        "camber": (levels.CAMBER, sniffed.points.gamma),
    }
    said = []
    for name, (quantity, angle) in angles.items():
        if SLOPES[name] not in sniffed.evidence:
            moves = np.ptp(angle) > quantity.tolerance if len(angle) else False
            said.append(f"as {SLOPES[name]} is not clear" if moves else f"as {quantity.name} does not change")
    return said


def stated_of_tyre(sniffed: Sniffed) -> dict[str, StatedByFile]:
    """The keys of [tyre] that recordings state; of several recordings, the first counts."""
    found: dict[str, StatedByFile] = {}
    for recording in sniffed.recordings:
        found = {**recording.tyre, **found}
    return found


def conditions_of(recordings: Sequence[SniffedRecording], reading: Reading) -> dict[str, tuple[Level, ...]]:
    """The levels of every setting with their points, from stretches that give points and from finished points.

    Sideslip has levels only in sweeps of longitudinal slip; pressure and speed only where they are measured.
    """
    kept = [note for note in reading.stretches if note.kind != MOVE and not note.dropped]
    finished = points_from(reading.points, set(reading.points.files) - {note.file for note in kept})
    pressed = holding(recordings, "p_kPa")
    with_pressure = [note for note in kept if note.file in pressed]
    values = {
        levels.LOAD: _of_points(kept, [note.Fz_N for note in kept], finished.Fz),
        levels.CAMBER: _of_points(kept, np.radians([note.gamma_deg for note in kept]), finished.gamma),
        levels.PRESSURE: _of_points(
            with_pressure, [1e3 * note.p_kPa for note in with_pressure], points_from(finished, pressed).p
        ),
        levels.SPEED: points_from(reading.points, holding(recordings, "V_mps")).V,
    }
    found = {quantity.name: _levels(value, quantity) for quantity, value in values.items()}
    driven = [note for note in kept if note.swept == "kappa"]
    if driven:
        sideslip = np.radians([0.5 * (note.alpha_from_deg + note.alpha_to_deg) for note in driven])
        found[levels.SIDESLIP.name] = _levels(_of_points(driven, sideslip, ()), levels.SIDESLIP)
    return found


def _of_points(notes: Sequence[StretchNote], values: ArrayLike, finished: ArrayLike) -> np.ndarray:
    """A setting at every point (n,): the value of its stretch, then those of finished points."""
    return np.append(np.repeat(values, [note.points for note in notes]), finished)


def holding(recordings: Sequence[SniffedRecording], channel: str) -> frozenset[str]:
    """Absolute paths of the recordings with this channel, as points and stretches name them."""
    return frozenset(str(r.path.absolute()) for r in recordings if channel in r.guesses)


def points_from(points: Points, files: Collection[str]) -> Points:
    """The points of some files."""
    return points.select(np.array([file in files for file in points.files], dtype=bool)[points.file])


def _levels(values: np.ndarray, quantity: levels.LevelKind) -> tuple[Level, ...]:
    """The levels; of camber without points between them, which are a last one with their range."""
    swept = quantity is levels.CAMBER
    of = levels.labels(values, quantity) if swept else levels.nearest_labels(values, quantity)
    held = [
        Level(float(np.median(values[of == k])), int(np.sum(of == k))) for k in range(of.max(initial=-1) + 1)
    ]
    rest = values[(of == levels.NO_LEVEL) & np.isfinite(values)] if swept else values[:0]
    between = [Level(float(rest.min()), len(rest), float(rest.max()))] if len(rest) else []
    return (*held, *between)
