"""Sweeps in ISO-W from all files of a configuration, or from a single file."""

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

import numpy as np

from mffit.config import Config, setup_names
from mffit.config.lines import ranges_text
from mffit.config.models import SweepTable
from mffit.constants import NAMED_IN_SENTENCE
from mffit.errors import InputError
from mffit.sheets import file_of, sheet_in
from mffit.sweeps.about import named_tyre, other_names
from mffit.sweeps.assembly import sweeps_of
from mffit.sweeps.channels import BY_NAME, unknown_channel
from mffit.sweeps.columns import Columns, read_columns
from mffit.sweeps.formats import ENDINGS, FORMATS, read
from mffit.sweeps.frames import (
    FileFrame,
    MixedAxesError,
    forces_turned,
    frame_of,
    letter_of,
    load_is_vertical,
    moments_turned,
    to_contact_point,
)
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.sweep import ExcludedRows, Sweep, Sweeps
from tir.errors import counted, some

NUMBER = re.compile(r"\d+(?:\.\d+)?")


class _File(NamedTuple):
    """What is read of a file."""

    raw: RawTable  #: the whole table
    sweeps: tuple[Sweep, ...] = ()  #: without the excluded rows, in the rig's frame
    columns: Columns | None = None  #: None if every row is excluded
    frame: FileFrame | None = None  #: None if no row can be read
    excluded: tuple[ExcludedRows, ...] = ()
    of_excluded: tuple[Sweep, ...] = ()  #: sweeps of the excluded rows, as far as they can be read
    contradicting: tuple[str, ...] = ()  #: sentences about rows in another direction than the [[sweep]]


def load(config: Config) -> Sweeps:
    """The sweeps of every file of ``[[sweep]]``, in its order, in ISO-W, contact frame, SI; with warnings as sentences.

    Raises InputError if a file cannot be read, a value is implausible, or ``[fit] exclude`` leaves no reading.
    """
    setups = setup_names(config.rig, config.sweep)
    files = {
        entry.file: _file(config, index, entry, setup)
        for index, (entry, setup) in enumerate(zip(config.sweep, setups, strict=True))
    }
    read = [(file, file.columns, file.frame) for file in files.values() if file.columns and file.frame]
    if not read:
        raise config.refusal("leaves out every reading; remove some entries", "fit.exclude")
    found = [sweep for file in files.values() for sweep in file.sweeps]
    frames = {name: file.frame for name, file in files.items() if file.frame is not None}
    open_loads = [s for s in found if frames[s.file].forces_lean and frames[s.file].load_is_vertical is None]
    vertical = load_is_vertical(open_loads)
    of_columns = [
        (columns.raw.path, sentence)
        for _, columns, frame in read
        for sentence in (*_overridden(columns, config, frame), *columns.warnings)
    ]
    warnings = (
        *other_names({columns.raw.path: named_tyre(columns.raw.about) for _, columns, _ in read}),
        *_once(of_columns),
        *(sentence for file, *_ in read for sentence in file.contradicting),
        *_sheets_left_out({name: file.raw for name, file in files.items()}),
        *_about_frames(found, frames, vertical=vertical),
    )

    def in_iso_w(sweeps: Sequence[Sweep]) -> tuple[Sweep, ...]:
        return tuple(_in_iso_w(sweep, frames[sweep.file], config, vertical=vertical) for sweep in sweeps)

    return Sweeps(
        in_iso_w(found),
        warnings,
        tuple(rows for file in files.values() for rows in file.excluded),
        in_iso_w([sweep for file in files.values() for sweep in file.of_excluded]),
        tuple(
            (name, f.columns.standing) for name, f in files.items() if f.columns and len(f.columns.standing)
        ),
    )


def _in_iso_w(sweep: Sweep, frame: FileFrame, config: Config, *, vertical: bool) -> Sweep:
    """The sweep with forces and moments in frame W about the contact point."""
    if frame.forces_lean:
        stated = frame.load_is_vertical
        sweep = forces_turned(sweep, load_is_vertical=vertical if stated is None else stated)
    if frame.moments_lean:
        sweep = moments_turned(sweep)
    if frame.at_centre:
        sweep = to_contact_point(sweep, unloaded_radius=config.tyre.unloaded_radius)
    return sweep


def _file(config: Config, index: int, entry: SweepTable, setup: str) -> _File:
    """What is read of the file of a [[sweep]]; of excluded rows, which may be damaged, as much as can be read."""
    whole = _raw(config, index, entry)
    excluded = _excluded(config, entry, whole)
    out = np.isin(whole.lines, np.concatenate([np.empty(0, int), *(rows.line for rows in excluded)]))

    def read(rows: np.ndarray) -> tuple[Columns, tuple[Sweep, ...], FileFrame]:
        columns = _columns(config, index, entry, whole.of_rows(rows) if np.any(out) else whole)
        return columns, tuple(sweeps_of(columns, config, entry, setup)), _frame(config, columns)

    # All at once, or entry by entry where a damaged row stops that.
    apart: list[tuple[Columns, tuple[Sweep, ...], FileFrame]] = []
    with suppress(InputError):
        apart = [read(out)] if np.any(out) else []
    for rows in [] if apart else excluded:
        with suppress(InputError):
            apart.append(read(np.isin(whole.lines, rows.line)))
    of_excluded = tuple(sweep for _, sweeps, _ in apart for sweep in sweeps)
    if np.all(out):
        return _File(whole, (), None, apart[-1][2] if apart else None, excluded, of_excluded)
    columns, sweeps, frame = read(~out)
    contradicting = tuple(_contradicting(columns, entry))
    return _File(whole, sweeps, columns, frame, excluded, of_excluded, contradicting)


def _sheets_left_out(tables: Mapping[str, RawTable]) -> list[str]:
    """Sentences about sheets with data that no [[sweep]] reads; ``tables`` are those read, by their names in ``tyre.toml``."""
    left: dict[Path, list[str]] = {}
    for name, raw in tables.items():
        book = file_of(name)
        left[book] = [sheet for sheet in left.get(book, raw.others) if sheet in raw.others]
    said = []
    for book, sheets in left.items():
        if sheets:
            quoted = some([f'"{sheet}"' for sheet in sheets])
            have = (
                f"sheet {quoted} has data and is"
                if len(sheets) == 1
                else f"sheets {quoted} have data and are"
            )
            said.append(
                f"{book}: {have} left out; to take a sheet, add a [[sweep]] with "
                f'file = "{sheet_in(book, sheets[0]).as_posix()}"'
            )
    return said


def _once(warnings: Sequence[tuple[Path, str]]) -> list[str]:
    """The sentences; of many that differ only in numbers, only the first, with the count and files of the others."""
    alike: dict[str, list[tuple[Path, str]]] = {}
    for path, sentence in warnings:
        alike.setdefault(NUMBER.sub("0", sentence.removeprefix(str(path))), []).append((path, sentence))
    said = []
    for kind in alike.values():
        if len(kind) > NAMED_IN_SENTENCE:
            files = dict.fromkeys(path.name for path, _ in kind[1:])
            said.append(f"{kind[0][1]}; {len(kind) - 1} more of this kind, in {some(list(files))}")
        else:
            said += [sentence for _, sentence in kind]
    return said


def _raw(config: Config, index: int, entry: SweepTable) -> RawTable:
    for table, columns in ((f"sweep.{index}.columns", entry.columns), ("columns", config.columns)):
        for name in columns:
            if name not in BY_NAME:
                raise config.refusal(unknown_channel(name), f"{table}.{name}")
    if entry.file and (config.folder / entry.file).is_dir():
        wrong = f'"{entry.file}" is a folder; name a file in it, or a pattern such as "{entry.file}/*.csv"'
        raise config.refusal(wrong, f"sweep.{index}.file")
    if not file_of(entry.file).name.lower().endswith(ENDINGS):
        *names, last = (kind.name for kind in FORMATS)
        raise config.refusal(
            f'"{entry.file}" is not in a known format ({" ".join(ENDINGS)}); export it as {", ".join(names)} or {last}',
            f"sweep.{index}.file",
        )
    path = config.folder / entry.file
    if not file_of(path).exists():
        raise config.refusal(
            f'there is no file "{file_of(entry.file)}" in {config.folder.absolute()}; correct its name',
            f"sweep.{index}.file",
        )
    return read(path)


def _excluded(config: Config, entry: SweepTable, raw: RawTable) -> tuple[ExcludedRows, ...]:
    """The rows of a file that each entry of ``[fit] exclude`` leaves out; of two that name a line, the first has it.

    Rows are excluded before any check, so that a user can exclude a damaged row without editing the file.
    """
    lines = np.asarray(raw.lines)
    check_excluded(config, entry.file, lines)
    own = [one for one in config.fit.exclude if one.file == entry.file]
    place = np.full(len(lines), len(own))
    for k, one in reversed([*enumerate(own)]):
        for first, last in one.ranges:
            place[np.searchsorted(lines, first) : np.searchsorted(lines, last, "right")] = k
    rows = np.split(
        np.argsort(place, kind="stable"), np.searchsorted(np.sort(place), np.arange(1, len(own) + 1))
    )
    return tuple(
        ExcludedRows(entry.file, lines[mine], one.why)
        for one, mine in zip(own, rows, strict=False)
        if len(mine)
    )


def check_excluded(config: Config, file: str, lines: np.ndarray) -> None:
    """Check that the ranges of ``[fit] exclude`` for a file begin and end at lines (n,) with readings.

    Raises InputError if a range begins or ends at another line.
    """
    named = [end for one in config.fit.exclude if one.file == file for end in np.ravel(one.ranges)]
    if np.all(np.isin(named, lines)):
        return
    for index, one in enumerate(config.fit.exclude):
        ends = np.array(one.ranges).ravel() if one.file == file else np.array([], int)
        wrong = ends[~np.isin(ends, lines)]
        if len(wrong):
            sentence = _no_reading(Path(file).name, lines, int(wrong[0]))
            raise config.refusal(sentence, f"fit.exclude.{index}.lines")


def _no_reading(name: str, lines: np.ndarray, wrong: int) -> str:
    first, last = int(np.min(lines)), int(np.max(lines))
    place = f"the readings of {name} are in lines {ranges_text([(first, last)])}"
    if wrong > last:
        return f"line {wrong} is beyond the end of the file; {place}"
    reason = "is above the first reading" if wrong < first else "holds no reading"
    return f"line {wrong} {reason}; {place}"


def _frame(config: Config, columns: Columns) -> FileFrame:
    """The frame of a file."""
    try:
        return frame_of(columns.headings, config.rig)
    except MixedAxesError as error:
        raise InputError(str(error), file=columns.raw.path, line=columns.raw.heading_line) from None


def _overridden(columns: Columns, config: Config, frame: FileFrame) -> list[str]:
    """A sentence about keys of [rig] that the letters of TYDEX's headings contradict."""
    found = {
        "force_frame": "C" if frame.forces_lean else "W",
        "moments": "wheel-centre" if frame.at_centre else "contact",
    }
    wrong = [
        f'{key} = "{getattr(config.rig, key)}"'
        for key, value in found.items()
        if key in config.rig.model_fields_set and getattr(config.rig, key) != value
    ]
    if not wrong:
        return []
    named = [heading for heading in columns.headings.values() if letter_of(heading)]
    return [
        f"{columns.raw.path}: {' and '.join(wrong)} of [rig] does not hold here, because the last letter of {', '.join(named)} "
        "states axes and reference point, as TYDEX defines them; rename these headings if they do not mean it"
    ]


def _columns(config: Config, index: int, entry: SweepTable, raw: RawTable) -> Columns:
    """The columns of a file's rows."""
    try:
        return read_columns(
            raw, {**config.columns, **entry.columns}, set(config.columns) - set(entry.columns)
        )
    except InputError as error:
        if error.file is None and error.key is not None:
            own = f"sweep.{index}." if error.key.split(".")[1] in entry.columns else ""
            raise config.refusal(error.sentence, own + error.key) from None
        raise


def _contradicting(columns: Columns, entry: SweepTable) -> list[str]:
    """A sentence about rows whose direction is not that of the [[sweep]]."""
    if entry.direction is None or columns.direction is None:
        return []
    differs = int(np.sum(columns.direction != (-1 if entry.direction == "backward" else 1)))
    if not differs:
        return []
    return [
        f"{entry.file}: column direction is not {entry.direction}, the direction of the [[sweep]], in "
        f"{counted(differs, 'row')}; the column is used"
    ]


def _about_frames(sweeps: Sequence[Sweep], frames: Mapping[str, FileFrame], *, vertical: bool) -> list[str]:
    """Sentences about approximations in the conversion to frame W and the contact point.

    ``vertical`` states that the load column was found to be the vertical load although the other forces are in frame C.
    """
    warnings = []
    if vertical:
        warnings.append(
            "Fz_N does not vary with camber, so it is treated as the vertical load, although force_frame is C"
        )
    if any(frames[s.file].moments_lean and np.any(np.isfinite(s.Mz) & ~np.isfinite(s.My)) for s in sweeps):
        warnings.append(
            "My_Nm is missing, so rolling resistance is neglected when Mz is turned from frame C to W"
        )
    centred = [s for s in sweeps if frames[s.file].at_centre]
    if any(np.any(np.isfinite(s.Mx) & ~np.isfinite(s.RL)) for s in centred):
        warnings.append(
            "RL_m is missing, so Mx is moved from the wheel centre to the contact point with the unloaded radius and wrong by "
            "the tyre's deflection times the side force; measure the loaded radius, or do not use Mx_Nm"
        )
    if any(np.any(np.isfinite(s.My) & ~np.isfinite(s.Fx)) for s in centred):
        warnings.append(
            "Fx_N is missing, so My cannot be moved from the wheel centre to the contact point; add Fx_N, or do not use My_Nm"
        )
    return warnings
