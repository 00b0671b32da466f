"""Sweeps in ISO-W from all files of a configuration, or from a single file."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from mffit.config import Config, setup_names
from mffit.config.models import SweepTable
from mffit.errors import InputError
from mffit.sweeps import constants
from mffit.sweeps.assembly import Circumstances, sweeps_of
from mffit.sweeps.channels import BY_NAME, nearest_channel
from mffit.sweeps.columns import Columns, read_columns
from mffit.sweeps.formats import ENDINGS, FORMATS, read
from mffit.sweeps.frames import load_is_vertical, to_contact_frame, to_contact_point
from mffit.sweeps.sweep import Sweep, Sweeps


def load(config: Config) -> Sweeps:
    """Read every file of ``[[sweep]]``.

    Returns
    -------
    Sweeps
        In the order of the configuration, ISO-W, contact frame, SI; with warnings as sentences.

    Raises
    ------
    InputError
        A file cannot be read, or a value in it is impossible; names file, line and column.
    """
    found: list[Sweep] = []
    warnings: list[str] = []
    setups = setup_names(config.rig, config.sweep)
    for index, (entry, setup) in enumerate(zip(config.sweep, setups, strict=True)):
        columns = _columns(config, index, entry)
        warnings.extend(columns.warnings)
        direction = -1 if entry.direction == "backward" else 1
        if entry.direction is not None and columns.direction is not None:
            warnings.extend(_contradicting(columns, entry, direction))
        given = Circumstances(
            axes=config.rig.axes,
            file=entry.file,
            direction=direction,
            mount=1 if entry.mount == "normal" else -1,
            setup=setup,
            pressure=1e3 * config.tyre.nominal_pressure,
            speed=config.tyre.nominal_speed,
        )
        found.extend(sweeps_of(columns, given))
    if config.rig.force_frame == "C":
        found, said = _in_contact_frame(found)
        warnings.extend(said)
    if config.rig.moments == "wheel-centre":
        found = [to_contact_point(sweep, unloaded_radius=config.tyre.unloaded_radius) for sweep in found]
    return Sweeps(tuple(found), tuple(warnings))


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


def _columns(config: Config, index: int, entry: SweepTable) -> Columns:
    def refuse(sentence: str, key: str) -> InputError:
        line = config.line_of(f"sweep.{index}.{key}")
        return InputError(sentence, file=config.path, line=line, key=f"sweep[{index + 1}].{key}")

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
    raw = read(path)
    try:
        return read_columns(
            raw, {**config.columns, **entry.columns}, set(config.columns) - set(entry.columns)
        )
    except InputError as error:
        if error.file is None and error.key is not None:
            if error.key.split(".")[1] in entry.columns:
                raise refuse(error.sentence, error.key) from None
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


def _in_contact_frame(sweeps: list[Sweep]) -> tuple[list[Sweep], list[str]]:
    vertical = load_is_vertical(sweeps)
    warnings = []
    if vertical:
        warnings.append(
            "Fz_N does not vary with camber, so it is treated as the vertical load, although force_frame is C"
        )
    if any(np.any(np.isfinite(sweep.Mz) & ~np.isfinite(sweep.My)) for sweep in sweeps):
        warnings.append(
            "My_Nm is missing, so rolling resistance is neglected when Mz is turned from frame C to W"
        )
    return [to_contact_frame(sweep, load_is_vertical=vertical) for sweep in sweeps], warnings
