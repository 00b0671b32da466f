"""Data that contradict what a configuration declares are refused in the words of that configuration."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mffit.config.models import Column, Config
from mffit.errors import InputError


@contextmanager
def as_declared(config: Config) -> Iterator[None]:
    """Refusals of a column within this block name the heading that the file has and the unit that was declared for it."""
    try:
        yield
    except InputError as error:
        raise _said(error, config) from None


def _said(error: InputError, config: Config) -> InputError:
    declared = _declared(error, config)
    if declared is None:
        return error
    heading = declared.column or error.column
    sentence = error.sentence.replace(f'column = "{error.column}"', f'column = "{heading}"')
    if declared.unit is not None:
        sentence += f"; {heading} is declared as {declared.unit}"
    return InputError(sentence, file=error.file, line=error.line, column=heading, key=error.key)


def _declared(error: InputError, config: Config) -> Column | None:
    """What the configuration says of the column at fault, if it says anything."""
    if error.column is None or error.file is None:
        return None
    for entry in config.sweep:
        if Path(entry.file).name == error.file.name and error.column in entry.columns:
            return entry.columns[error.column]
    return config.columns.get(error.column)
