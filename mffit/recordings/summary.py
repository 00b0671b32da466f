"""The summary of a test, a table with a row per run beside the recordings: set-points, quality flags, specimens."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mffit.errors import InputError
from mffit.points import levels
from mffit.points.loading import Reading
from mffit.points.stretch import MOVE
from mffit.quantities import CONDITIONS
from mffit.recordings import constants
from mffit.recordings.guess import simplified
from mffit.sweeps import formats
from mffit.sweeps.channels import BY_NAME
from mffit.sweeps.raw_table import RawTable, with_decimal_point
from mffit.sweeps.units import UnknownUnitError, converted

RUN = {
    "run", "runs", "run_no", "run_nr", "run_number", "run_#", "file", "filename", "file_name", "recording", "test", "test_no",
    "test_number", "datei", "dateiname", "messung", "messdatei", "versuch", "lauf", "nr",
}  # fmt: skip
SPECIMEN = {
    "specimen", "specimen_id", "specimen_no", "specimen_serial", "serial", "serial_no", "serial_number", "tire_serial",
    "tyre_serial", "tire_id", "tyre_id", "tireid", "barcode", "pruefling", "seriennummer", "serien_nr", "reifennummer",
    "reifen_nr",
}  # fmt: skip
QUALITY = {"quality", "quality_flag", "data_quality", "flag", "status", "result", "qualitaet", "bewertung"}
GOOD_IF_TRUE = {"valid", "ok", "good", "gueltig", "i.o"}
"""Headings of columns that say yes or no."""
REMARK = {
    "comment",
    "comments",
    "remark",
    "remarks",
    "note",
    "notes",
    "bemerkung",
    "bemerkungen",
    "kommentar",
}
BAD = {
    "bad", "invalid", "reject", "rejected", "fail", "failed", "nok", "n.i.o", "nio", "not_ok", "aborted", "void", "schlecht",
    "ungueltig", "verworfen", "abgebrochen",
}  # fmt: skip
NO = {"0", "0.0", "no", "n", "false", "nein"}
BESIDE_A_NAME = re.compile(r"^(?:nominal|target|set|setpoint|soll)_|(?:_(?:set|setpoint|soll|nominal))$|\.$")
"""What headings of set-points add to the name of a channel."""
SET_POINTS: Mapping[str, tuple[levels.LevelKind, float]] = {
    "Fz_N": (levels.LOAD, 1.0),
    "gamma_deg": (levels.CAMBER, np.radians(1.0)),
    "p_kPa": (levels.PRESSURE, 1e3),
    "V_mps": (levels.SPEED, 1.0),
}
"""Channels whose set-points a summary may name: their levels, and the factor to SI."""
CUSTOMARY_UNITS = {"Fz_N": "lbf", "p_kPa": "psi", "V_mps": "km/h"}
"""Units of set-points that state none, tried beside the contract's."""


class SummaryRow(NamedTuple):
    """What a summary says of one recording."""

    recording: Path
    line: int
    set_points: Mapping[str, tuple[float, ...]]  #: by channel, in the unit stated or in plain numbers
    units: Mapping[str, str]  #: "" if none is stated
    bad: str  #: why the run is bad; "" if nothing says so
    specimen: str  #: "" if none is named


class RunSummary(NamedTuple):
    """One table with a row per run."""

    path: Path
    rows: tuple[SummaryRow, ...]


class BadRun(NamedTuple):
    """A recording that a summary calls bad."""

    recording: Path
    lines: str  #: all of them, such as "6-24"
    why: str


def apart(files: Sequence[Path]) -> tuple[list[Path], tuple[RunSummary, ...]]:
    """Recordings among the files, and the summaries of their runs among the files and beside them."""
    given = [file for file in files if _may_be_summary(file) and _raw_summary(file) is not None]
    recordings = [file for file in files if file not in given] or list(files)
    folders = dict.fromkeys(file.absolute().parent for file in recordings)
    known = {file.absolute() for file in files}
    beside = [
        file
        for folder in folders
        for file in sorted(folder.iterdir())
        if file.absolute() not in known and _may_be_summary(file)
    ]
    found = (_summary(file, recordings) for file in (*given, *beside))
    return recordings, tuple(summary for summary in found if summary is not None)


def bad_runs(summaries: Iterable[RunSummary]) -> tuple[BadRun, ...]:
    """Every recording that a summary calls bad, with all its lines, to be excluded."""
    found: dict[Path, BadRun] = {}
    for summary in summaries:
        for row in summary.rows:
            if row.bad and row.recording not in found:
                lines = formats.read(row.recording).lines
                whole = f"{int(lines[0])}-{int(lines[-1])}" if len(lines) > 1 else f"{int(lines[0])}"
                why = f"{summary.path.name}, line {row.line}: {row.bad}"
                found[row.recording] = BadRun(row.recording, whole, why)
    return tuple(found.values())


def two_specimens(summaries: Iterable[RunSummary]) -> str:
    """That recordings are of two tyres, if a summary names two specimens; "" otherwise."""
    for summary in summaries:
        named = [row for row in summary.rows if row.specimen]
        other = next((row for row in named if row.specimen != named[0].specimen), None)
        if other is not None:
            return (
                f"{named[0].recording} and {other.recording} are of two tyres: {summary.path.name} names the specimens "
                f'"{named[0].specimen}" (line {named[0].line}) and "{other.specimen}" (line {other.line}); make a project of each'
            )
    return ""


def contradictions(summaries: Iterable[RunSummary], reading: Reading) -> list[str]:
    """Set-points of a summary that the recording of that run does not hold, a sentence each."""
    said = []
    for summary in summaries:
        for row in summary.rows:
            for name, (kind, factor) in SET_POINTS.items():
                recorded = _recorded(reading, row.recording, name) / factor
                missing = [
                    value
                    for value in row.set_points.get(name, ())
                    if not _is_held(value, row.units[name], recorded, name, kind, factor)
                ]
                if len(recorded) and missing:
                    said.append(_contradiction(summary, row, name, missing, recorded, kind, factor))
    return said


def _contradiction(
    summary: RunSummary,
    row: SummaryRow,
    name: str,
    missing: Sequence[float],
    recorded: np.ndarray,
    kind: levels.LevelKind,
    factor: float,
) -> str:
    held = np.unique(levels.level_values(factor * recorded, kind)) / factor
    unit = f" {row.units[name]}" if row.units[name] else ""
    one = "is" if len(missing) == 1 else "are"
    values = ", ".join(f"{value:g}" for value in missing)
    levels_held = ", ".join(CONDITIONS[name].of(value) for value in held)
    return (
        f"{summary.path.name}, line {row.line}: {CONDITIONS[name].word} {values}{unit} {one} named for "
        f"{row.recording.name}, which holds {levels_held}: is it the recording of this run?"
    )


def _is_held(
    value: float, unit: str, recorded: np.ndarray, name: str, kind: levels.LevelKind, factor: float
) -> bool:
    """Whether a recording holds a set-point, whose sign and, if not stated, whose unit may be another."""
    own = BY_NAME[name].unit
    units = [unit] if unit else [own, *([CUSTOMARY_UNITS[name]] if name in CUSTOMARY_UNITS else [])]
    held = np.abs(factor * recorded)
    for each in units:
        try:
            wanted = abs(factor * float(converted(np.array([value]), each, own)[0]))
        except UnknownUnitError:
            return True
        most = constants.SET_POINT_TOLERANCE * kind.tolerance * (wanted if kind.relative else 1.0)
        if np.any(np.abs(held - wanted) <= most):
            return True
    return False


def _recorded(reading: Reading, recording: Path, name: str) -> np.ndarray:
    """The values (n,) in SI that a recording holds: of its stretches, else of its finished points."""
    file = str(recording.absolute())
    points = reading.points
    rows = np.array([each == file for each in points.files], dtype=bool)[points.file]
    notes = [
        note for note in reading.stretches if note.file == file and note.kind != MOVE and not note.dropped
    ]
    if notes and name != "V_mps":
        _, factor = SET_POINTS[name]
        values = factor * np.array([getattr(note, name) for note in notes])
    else:
        values = {"Fz_N": points.Fz, "gamma_deg": points.gamma, "p_kPa": points.p, "V_mps": points.V}[name][
            rows
        ]
    return values[np.isfinite(values)]


def _may_be_summary(file: Path) -> bool:
    """Whether a file is a table of text or a workbook, and no longer than a list of runs."""
    endings = (".csv", ".txt", ".tsv", ".xlsx", ".xlsm")
    return (
        file.name.lower().endswith(endings)
        and not file.name.startswith((".", "~"))
        and file.is_file()
        and file.stat().st_size < constants.LARGEST_SUMMARY
    )


def _raw_summary(file: Path) -> RawTable | None:
    """The table of a file that has columns of a summary, and none of sideslip and side force."""
    try:
        raw = formats.read(file)
    except InputError:
        return None
    names = {_name(heading) for heading in raw.headings}
    if names & _names("alpha_deg") and names & _names("Fy_N"):
        return None
    useful = SPECIMEN | QUALITY | GOOD_IF_TRUE | set().union(*(_names(name) for name in SET_POINTS))
    return raw if names & RUN and names & useful else None


def _summary(file: Path, recordings: Sequence[Path]) -> RunSummary | None:
    """The rows of a summary that are about these recordings; None if there are none."""
    raw = _raw_summary(file)
    if raw is None:
        return None
    columns: dict[str, str] = {}
    for heading in raw.headings:
        columns.setdefault(_name(heading), heading)
    run = next(columns[name] for name in columns if name in RUN)
    rows = []
    for k, cell in enumerate(raw.column(run)):
        recording = _recording(cell, recordings)
        if recording is not None:
            rows.append(_row(raw, columns, k, recording))
    return RunSummary(file, tuple(rows)) if rows else None


def _row(raw: RawTable, columns: Mapping[str, str], k: int, recording: Path) -> SummaryRow:
    def text(names: Iterable[str]) -> str:
        heading = next((columns[name] for name in columns if name in names), None)
        return "" if heading is None else _text(raw.column(heading)[k])

    set_points, units = {}, {}
    for name in SET_POINTS:
        heading = next((columns[each] for each in columns if each in _names(name)), None)
        if heading is not None:
            set_points[name] = tuple(_numbers(raw.column(heading)[k]))
            units[name] = raw.unit(heading)
    return SummaryRow(
        recording=recording,
        line=int(raw.lines[k]),
        set_points=set_points,
        units=units,
        bad=_bad(text(QUALITY), text(GOOD_IF_TRUE), text(REMARK)),
        specimen=text(SPECIMEN),
    )


def _bad(quality: str, good: str, remark: str) -> str:
    """Why a run is bad, by its flags; "" if it is not."""
    flagged = []
    if simplified(quality).rstrip(".!") in BAD:
        flagged.append(quality)
    if simplified(good).rstrip(".!") in BAD | NO:
        flagged.append(f"not valid ({good})")
    return ", ".join(filter(None, [*flagged, remark])) if flagged else ""


def _recording(cell: str | float, recordings: Sequence[Path]) -> Path | None:
    """The recording that a cell names, by its file or by the number of the run; None if none or several fit."""
    name = _text(cell)
    stems = {path: formats.stem(path.name).lower() for path in recordings}
    exact = [path for path in recordings if name.lower() in (path.name.lower(), stems[path])]
    if exact:
        return exact[0] if len(exact) == 1 else None
    if name.isdigit():
        number = rf"(?:(?:run|test|lauf|messung|versuch|nr)[\s_.-]*0*{int(name)}(?!\d)|(?<!\d)0*{int(name)}$)"
        found = [path for path, stem in stems.items() if re.search(number, stem)]
    else:
        found = [
            path
            for path, stem in stems.items()
            if name and re.search(rf"{re.escape(name.lower())}(?!\d)", stem)
        ]
    return found[0] if len(found) == 1 else None


def _name(heading: str) -> str:
    """A heading without case, unit, and what says that it is a set-point: ``target load [lb]`` is ``load``."""
    return BESIDE_A_NAME.sub("", simplified(heading.strip()))


def _names(channel: str) -> frozenset[str]:
    """The names that a column of set-points of a channel may have, also in the plural."""
    known = (channel, *BY_NAME[channel].aliases)
    return frozenset(simplified(name) + plural for name in known for plural in ("", "s"))


def _text(cell: str | float) -> str:
    if isinstance(cell, str):
        return cell.strip()
    return "" if not np.isfinite(cell) else f"{float(cell):g}"


def _numbers(cell: str | float) -> Iterator[float]:
    """The numbers of a cell: ``14``, ``12, 10, 14``, ``2,5; 4``."""
    text = _text(cell)
    between = r"[;/|]" if re.search(r"[;/|]", text) else "," if text.count(",") > 1 else r",\s|\s"
    several = re.split(between, text)
    for part in several:
        try:
            yield float(with_decimal_point(part.strip()))
        except ValueError:
            continue
