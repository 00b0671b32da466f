"""Quality flags and specimens from the summary of a test: a table next to the recordings, with a row per run."""

import re
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

from mffit.as_json import keys
from mffit.config.lines import ranges_text
from mffit.errors import InputError
from mffit.recordings import constants
from mffit.recordings.guess import candidates
from mffit.sheets import WORKBOOKS, file_of
from mffit.sweeps import formats
from mffit.sweeps.about import WORDS, simplified
from mffit.sweeps.channels import BY_NAME
from mffit.sweeps.columns import text_of
from mffit.sweeps.raw_table import RawTable


class SummaryRow(NamedTuple):
    """One recording's row in a summary."""

    recording: Path
    place: str  #: file and line of the summary
    bad: str  #: why the run is bad; "" if it is not
    specimen: str  #: "" if none is named


class BadRun(NamedTuple):
    """A recording that a summary calls bad."""

    recording: Path
    lines: str  #: all of them, such as "6-24"
    why: str


keys(BadRun, "file=recording lines why")


def apart(files: Sequence[Path]) -> tuple[list[Path], tuple[SummaryRow, ...]]:
    """The recordings among the files, and the rows about them in summaries among the files and in their folders."""
    given = [file for file in files if _may_be_summary(file) and _raw_summary(file) is not None]
    recordings = [file for file in files if file not in given] or list(files)
    folders = dict.fromkeys(file.absolute().parent for file in recordings)
    known = {file_of(file.absolute()) for file in files}
    inside = [file for folder in folders for file in sorted(folder.iterdir())]
    beside = [file for file in inside if file.absolute() not in known and _may_be_summary(file)]
    rows = [row for file in (*given, *beside) for table in _tables(file) for row in _rows(table, recordings)]
    return recordings, tuple(row for row in rows if row.bad or row.specimen)


def bad_runs(rows: Iterable[SummaryRow]) -> tuple[BadRun, ...]:
    """The recordings that a summary calls bad, with the range of all their lines, for ``[fit] exclude``."""
    found: dict[Path, BadRun] = {}
    for row in rows:
        if row.bad and row.recording not in found:
            lines = formats.read(row.recording).lines
            whole = ranges_text([(int(lines[0]), int(lines[-1]))])
            found[row.recording] = BadRun(row.recording, whole, f"{row.place}: {row.bad}")
    return tuple(found.values())


def two_specimens(rows: Iterable[SummaryRow]) -> str:
    """A sentence that recordings are of two tyres, if summaries name two specimens; "" otherwise."""
    named = [row for row in rows if row.specimen]
    other = next((row for row in named if row.specimen != named[0].specimen), None)
    if other is None:
        return ""
    first = named[0]
    return (
        f'{first.recording} and {other.recording} are of two tyres: specimens "{first.specimen}" ({first.place}) and '
        f'"{other.specimen}" ({other.place}); make a project of each'
    )


def _may_be_summary(file: Path) -> bool:
    """Whether a file is a text table or a workbook, and no larger than a list of runs."""
    endings = (".csv", ".txt", ".tsv", *WORKBOOKS)
    file = file_of(file)
    return (
        file.name.lower().endswith(endings)
        and not file.name.startswith((".", "~"))
        and file.is_file()
        and file.stat().st_size < constants.LARGEST_SUMMARY
    )


def _tables(file: Path) -> list[Path]:
    """The tables of a file; none if it cannot be read."""
    try:
        return formats.tables_of(file)
    except InputError:
        return []


def _raw_summary(file: Path) -> RawTable | None:
    """The table of a file that names runs; None if the file is a recording or cannot be read."""
    try:
        raw = formats.read(file)
    except InputError:
        return None
    is_recording = all(candidates(raw, BY_NAME[channel]) for channel in ("alpha_deg", "Fy_N"))
    return raw if WORDS["run"] & _columns(raw).keys() and not is_recording else None


def _columns(raw: RawTable) -> dict[str, str]:
    """The first heading of each simplified name."""
    return {simplified(heading.strip()).rstrip("."): heading for heading in reversed(raw.headings)}


def _rows(file: Path, recordings: Sequence[Path]) -> Iterator[SummaryRow]:
    """The rows of a summary that are about these recordings."""
    raw = _raw_summary(file)
    if raw is None:
        return
    columns = _columns(raw)

    def text(kind: str, row: int) -> str:
        heading = next((columns[name] for name in reversed(columns) if name in WORDS[kind]), None)
        return "" if heading is None else text_of(raw.column(heading)[row])

    for row, line in enumerate(raw.lines):
        recording = _recording(text("run", row), recordings)
        if recording is not None:
            bad = _bad(text("quality", row), text("good", row), text("remark", row))
            yield SummaryRow(recording, f"{file.name}, line {int(line)}", bad, text("specimen", row))


def _bad(quality: str, good: str, remark: str) -> str:
    """Why a run is bad, by its flags; "" if it is not."""
    flagged = []
    if simplified(quality).rstrip(".!") in WORDS["bad"]:
        flagged.append(quality)
    if simplified(good).rstrip(".!") in WORDS["bad"] | WORDS["no"]:
        flagged.append(f"not valid ({good})")
    return ", ".join(filter(None, [*flagged, remark])) if flagged else ""


def _recording(name: str, recordings: Sequence[Path]) -> Path | None:
    """The recording that a cell names, by its file or by the number of the run; None if none or several fit."""
    stems = {path: formats.stem(path.name).lower() for path in recordings}
    exact = [path for path in recordings if name.lower() in (path.name.lower(), stems[path])]
    if exact:
        return exact[0] if len(exact) == 1 else None
    pattern = rf"{re.escape(name.lower())}(?!\d)"
    if name.isdigit():
        pattern = (
            rf"(?:(?:run|test|lauf|messung|versuch|nr)[\s_.-]*0*{int(name)}(?!\d)|(?<!\d)0*{int(name)}$)"
        )
    found = [path for path, stem in stems.items() if name and re.search(pattern, stem)]
    return found[0] if len(found) == 1 else None
