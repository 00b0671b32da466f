"""Sweeps in ISO-W from all files of a configuration, or from a single file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from mffit.config import Config, setup_names
from mffit.config.exclusion import ExcludeTable
from mffit.config.models import SweepTable
from mffit.errors import InputError
from mffit.sweeps import constants
from mffit.sweeps.assembly import Circumstances, sweeps_of
from mffit.sweeps.channels import BY_NAME, nearest_channel
from mffit.sweeps.columns import Columns, read_columns
from mffit.sweeps.excluded import ExclusionError, take_apart
from mffit.sweeps.formats import ENDINGS, FORMATS, read
from mffit.sweeps.frames import load_is_vertical, to_contact_frame, to_contact_point
from mffit.sweeps.raw_table import RawTable
from mffit.sweeps.sweep import ExcludedRows, Sweep, Sweeps
from tir.errors import some

NUMBER = re.compile(r"\d+(?:\.\d+)?")


def load(config: Config) -> Sweeps:
    """Read every file of ``[[sweep]]``.

    Returns
    -------
    Sweeps
        In the order of the configuration, ISO-W, contact frame, SI; with warnings as sentences.

    Raises
    ------
    InputError
        A file cannot be read, or a value in it is impossible; names file, line and column. Or no reading is left.
    """
    found: list[Sweep] = []
    excluded: list[ExcludedRows] = []
    warnings: list[str] = []
    of_columns: list[tuple[Path, str]] = []
    setups = setup_names(config.rig, config.sweep)
    for index, (entry, setup) in enumerate(zip(config.sweep, setups, strict=True)):
        raw, apart = _apart(config, entry, _raw(config, index, entry))
        direction = -1 if entry.direction == "backward" else 1
        given = Circumstances(
            axes=config.rig.axes,
            file=entry.file,
            direction=direction,
            mount=1 if entry.mount == "normal" else -1,
            setup=setup,
            pressure=1e3 * config.tyre.nominal_pressure,
            speed=config.tyre.nominal_speed,
        )
        for exclusion, rows in apart:
            sweeps = _as_far_as_readable(config, index, entry, rows, given)
            excluded.append(ExcludedRows(entry.file, np.asarray(rows.lines), exclusion.why, sweeps))
        if raw is None:
            continue
        columns = _columns(config, index, entry, raw)
        of_columns.extend((raw.path, sentence) for sentence in columns.warnings)
        if entry.direction is not None and columns.direction is not None:
            warnings.extend(_contradicting(columns, entry, direction))
        found.extend(sweeps_of(columns, given))
    if not found:
        raise InputError(
            "leaves out every reading; remove some entries",
            file=config.path,
            line=config.line_of("fit.exclude"),
            key="fit.exclude",
        )
    warnings = _once(of_columns) + warnings
    vertical = config.rig.force_frame == "C" and load_is_vertical(found)
    if config.rig.force_frame == "C":
        warnings.extend(_about_frame(found, vertical=vertical))

    def in_iso_w(sweep: Sweep) -> Sweep:
        if config.rig.force_frame == "C":
            sweep = to_contact_frame(sweep, load_is_vertical=vertical)
        if config.rig.moments == "wheel-centre":
            sweep = to_contact_point(sweep, unloaded_radius=config.tyre.unloaded_radius)
        return sweep

    return Sweeps(
        tuple(in_iso_w(sweep) for sweep in found),
        tuple(warnings),
        tuple(replace(rows, sweeps=tuple(in_iso_w(sweep) for sweep in rows.sweeps)) for rows in excluded),
    )


def _once(warnings: Sequence[tuple[Path, str]]) -> list[str]:
    """Warnings with their files, each kind once: of more than two files that differ in nothing but numbers, that of the first."""
    alike: dict[str, list[tuple[Path, str]]] = {}
    for path, sentence in warnings:
        alike.setdefault(NUMBER.sub("0", sentence.removeprefix(str(path))), []).append((path, sentence))
    said = []
    for kind in alike.values():
        if len(kind) > constants.MOST_WARNINGS_OF_A_KIND:
            files = dict.fromkeys(path.name for path, _ in kind[1:])
            said.append(f"{kind[0][1]}; {len(kind) - 1} more of this kind, in {some(list(files))}")
        else:
            said += [sentence for _, sentence in kind]
    return said


def load_file(path: str | Path, *, axes: str) -> Sweeps:
    """Read one file without a configuration; pressure and speed are NaN if it does not have them.

    Parameters
    ----------
    path : file with the contract's headings, forces in the contact frame
    axes : "iso", "sae" or "adapted-sae"
    """
    columns = read_columns(read(Path(path)), {})
    given = Circumstances(axes=axes, file=str(path))
    return Sweeps(tuple(sweeps_of(columns, given)), columns.warnings)


def _refusal(config: Config, index: int, sentence: str, key: str) -> InputError:
    """The error about a key of a [[sweep]]."""
    line = config.line_of(f"sweep.{index}.{key}")
    return InputError(sentence, file=config.path, line=line, key=f"sweep[{index + 1}].{key}")


def _raw(config: Config, index: int, entry: SweepTable) -> RawTable:
    """The cells of a file."""

    def refuse(sentence: str, key: str) -> InputError:
        return _refusal(config, index, sentence, key)

    for name in entry.columns:
        if name not in BY_NAME:
            raise refuse(_unknown(name), f"columns.{name}")
    for name in config.columns:
        if name not in BY_NAME:
            key = f"columns.{name}"
            raise InputError(_unknown(name), file=config.path, line=config.line_of(key), key=key)
    if not entry.file.lower().endswith(ENDINGS):
        *names, last = (kind.name for kind in FORMATS)
        raise refuse(
            f'"{entry.file}" is not in a known format ({" ".join(ENDINGS)}); export it as {", ".join(names)} or {last}',
            "file",
        )
    path = config.folder / entry.file
    if not path.exists():
        raise refuse(
            f'there is no file "{entry.file}" in {config.folder.absolute()}; correct its name', "file"
        )
    return read(path)


def _apart(
    config: Config, entry: SweepTable, raw: RawTable
) -> tuple[RawTable | None, list[tuple[ExcludeTable, RawTable]]]:
    """The rows of a file that are kept, None without any, and the excluded ones with their entries."""
    entries = [one for one in config.fit.exclude if one.file == entry.file]
    try:
        kept, excluded = take_apart(raw, entries)
    except ExclusionError as error:
        index = config.fit.exclude.index(error.entry)
        key = f"fit.exclude.{index}.lines"
        raise InputError(
            str(error), file=config.path, line=config.line_of(key), key=f"fit.exclude[{index + 1}].lines"
        ) from None
    return kept, list(zip(entries, excluded, strict=True))


def _as_far_as_readable(
    config: Config, index: int, entry: SweepTable, raw: RawTable, given: Circumstances
) -> tuple[Sweep, ...]:
    """The sweeps of excluded rows; none if a row is damaged, which may be why it is excluded."""
    try:
        return tuple(sweeps_of(_columns(config, index, entry, raw), given))
    except InputError:
        return ()


def _columns(config: Config, index: int, entry: SweepTable, raw: RawTable) -> Columns:
    """The columns of a file's rows."""
    try:
        return read_columns(
            raw, {**config.columns, **entry.columns}, set(config.columns) - set(entry.columns)
        )
    except InputError as error:
        if error.file is None and error.key is not None:
            if error.key.split(".")[1] in entry.columns:
                raise _refusal(config, index, error.sentence, error.key) from None
            line = config.line_of(error.key)
            raise InputError(error.sentence, file=config.path, line=line, key=error.key) from None
        raise


def _unknown(name: str) -> str:
    near = nearest_channel(name, likeness=constants.LIKENESS_OF_MAPPED_COLUMN)
    hint = f'did you mean "{near}"?' if near else f"known columns are {', '.join(BY_NAME)}"
    return f"is not a column of a sweep; {hint}"


def _contradicting(columns: Columns, entry: SweepTable, direction: int) -> list[str]:
    assert columns.direction is not None
    differs = int(np.sum(columns.direction != direction))
    if not differs:
        return []
    return [
        f"{entry.file}: {differs} rows of column direction are not {entry.direction}, the direction of the [[sweep]]; "
        "the column is used"
    ]


def _about_frame(sweeps: list[Sweep], *, vertical: bool) -> list[str]:
    """Sentences about the conversion from frame C; ``vertical``: the load column is the vertical load."""
    warnings = []
    if vertical:
        warnings.append(
            "Fz_N does not vary with camber, so it is treated as the vertical load, although force_frame is C"
        )
    if any(np.any(np.isfinite(sweep.Mz) & ~np.isfinite(sweep.My)) for sweep in sweeps):
        warnings.append(
            "My_Nm is missing, so rolling resistance is neglected when Mz is turned from frame C to W"
        )
    return warnings
