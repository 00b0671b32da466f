"""Columns that a ``tyre.toml`` does not name, taken where headings and stated units leave no doubt."""

from __future__ import annotations

from collections.abc import Mapping

from mffit.config import Config
from mffit.config.models import Column, SweepTable
from mffit.recordings.guess import Guess, candidates, guesses
from mffit.sweeps import formats
from mffit.sweeps.channels import SWEEP_CHANNELS
from mffit.sweeps.raw_table import RawTable

DECISIVE = ("time_s", "kappa")
"""Optional channels without which a file means something else: a recording would be a table of points."""


def with_recognised(config: Config) -> tuple[Config, tuple[str, ...]]:
    """The configuration with the columns of files whose required columns have other headings, and a remark on each file.

    A file is left as it is, to be refused in one sentence, if a required column, or one on which the meaning of the file
    depends, has no known heading, two of them, or no stated unit.
    """
    entries, remarks = [], []
    for entry in config.sweep:
        found = _recognised(config, entry)
        if found is None:
            entries.append(entry)
            continue
        taken, without_unit = found
        columns = {name: guess.column for name, guess in taken.items()}
        entries.append(entry.model_copy(update={"columns": {**columns, **entry.columns}}))
        remarks.append(_remark(entry, taken, without_unit))
    if not remarks:
        return config, ()
    return config.model_copy(update={"sweep": type(config.sweep)(entries)}), tuple(remarks)


def _recognised(config: Config, entry: SweepTable) -> tuple[dict[str, Guess], dict[str, Guess]] | None:
    """Channels of a file by their headings, with a unit and without; None if nothing is missing or a doubt remains."""
    path = config.folder / entry.file
    if not path.is_file() or not entry.file.lower().endswith(formats.ENDINGS):
        return None
    raw = formats.read(path)
    given = _given(raw, {**config.columns, **entry.columns})
    missing = [channel for channel in SWEEP_CHANNELS if channel.required and channel.name not in given]
    if not missing:
        return None
    found = guesses(raw, unloaded_radius=config.tyre.unloaded_radius).found
    new = {name: guess for name, guess in found.items() if name not in given}
    taken = {name: guess for name, guess in new.items() if not guess.assumed}
    without_unit = {name: guess for name, guess in new.items() if guess.assumed}
    if any(channel.name not in taken or len(candidates(raw, channel)) > 1 for channel in missing):
        return None
    return None if any(name in without_unit for name in DECISIVE) else (taken, without_unit)


def _given(raw: RawTable, mapping: Mapping[str, Column]) -> set[str]:
    """The channels that a file has under the contract's headings or those of ``tyre.toml``."""
    mapped = {name for name, column in mapping.items() if (column.column or name) in raw.headings}
    return mapped | {channel.name for channel in SWEEP_CHANNELS if channel.name in raw.headings}


def _remark(entry: SweepTable, taken: Mapping[str, Guess], without_unit: Mapping[str, Guess]) -> str:
    columns = ", ".join(
        f'{name} is "{guess.heading}"' + f" in {guess.unit_of_readings}" * bool(guess.unit_of_readings)
        for name, guess in taken.items()
        if guess.heading != name
    )
    headings = ", ".join(guess.heading for guess in without_unit.values())
    also = f"; {headings} state no unit and are not used" if headings else ""
    return f"{entry.file}: columns are recognised by heading and stated unit: {columns}{also}; [columns] overrides this"
