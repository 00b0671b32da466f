"""Errors about a column that name the heading and the unit declared for it."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from mffit.config.models import Column, Config
from mffit.errors import InputError


@contextmanager
def as_declared(config: Config) -> Iterator[None]:
    """Within this block, errors about a column name its heading in the file and the unit declared for it."""
    try:
        yield
    except InputError as error:
        raise _with_heading(error, config) from None


def _with_heading(error: InputError, config: Config) -> InputError:
    declared = _declared(error, config)
    if declared is None:
        return error
    heading = declared.column or error.column
    sentence = error.sentence.replace(f'column = "{error.column}"', f'column = "{heading}"')
    if declared.unit is not None:
        sentence += f"; {heading} is declared as {declared.unit}"
    return InputError(sentence, file=error.file, line=error.line, column=heading, key=error.key)


def _declared(error: InputError, config: Config) -> Column | None:
    """The declaration of the column at fault; None without one."""
    if error.column is None or error.file is None:
        return None
    for entry in config.sweep:
        if Path(entry.file).name == error.file.name and error.column in entry.columns:
            return entry.columns[error.column]
    return config.columns.get(error.column)
