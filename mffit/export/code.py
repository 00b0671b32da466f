"""A property file as code of any language: how it is named after the file, and written."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import tir
from mffit.errors import InputError
from mffit.output import output_folder


def written(path: Path, out: Path, texts: Mapping[str, str]) -> list[Path]:
    """Write the code of a property file by the names of its files; returns their paths."""
    with output_folder(out, by="export", protected=[path]) as folder:
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="ascii", newline="\n")
    return [out / name for name in texts]


class CodeOfFile(NamedTuple):
    """A property file as code."""

    tyre: tir.Tyre
    name: str  #: of the function, or prefix of the functions
    turn_slip: bool
    code: Any


def code_of(
    path: Path,
    given: str | None,
    turn_slip: bool | None,
    export: Callable[..., Any],
    is_taken: Callable[[str], bool],
    **switches: bool,
) -> CodeOfFile:
    """The code of a property file in a language; its name is the ``given`` one, or is made from the name of the file.

    Characters that a name cannot have become underscores. The name gets ``_turn_slip`` or ``_normal`` behind it if turn slip is
    not as the file's USE_MODE says, and ``tyre_`` in front if it does not begin with a letter or is a word of the language.
    """
    tyre = tir.read(path)
    on = tyre.turn_slip if turn_slip is None else turn_slip
    name = re.sub(r"[^A-Za-z0-9_]", "_", path.stem) + mode_suffix(tyre, on) if given is None else given
    if given is None and (is_taken(name) or not re.match(r"[A-Za-z]", name)):
        name = f"tyre_{name}"
    try:
        return CodeOfFile(tyre, name, on, export(tyre, name=name, turn_slip=on, **switches))
    except tir.TirError as error:
        raise InputError(error.sentence, file=path) from error


def mode_suffix(tyre: tir.Tyre, on: bool) -> str:
    """The end of the name of exported files, which says whether turn slip is on where the file's USE_MODE says otherwise."""
    return "" if on == tyre.turn_slip else "_turn_slip" if on else "_normal"
