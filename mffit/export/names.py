"""Names in C, made from the names of files."""

from __future__ import annotations

import re
from pathlib import Path

import tir
from mffit.errors import InputError
from tir.codegen.c99 import taken


def identifier(path: Path, given: str | None = None, mode: str = "") -> str:
    """The prefix of the functions: the given name, or else the file's name with underscores for other characters.

    It gets ``tyre_`` in front if it does not begin with a letter or is a word of C, and ``mode`` behind it.
    """
    if given is not None:
        return given
    name = re.sub(r"[^A-Za-z0-9_]", "_", path.stem) + mode
    return name if re.match(r"[A-Za-z]", name) and not taken(name) else f"tyre_{name}"


def other_mode(tyre: tir.Tyre, turn_slip: bool) -> str:
    """What a name gets behind it if turn slip is not as the file's USE_MODE says; else nothing."""
    if turn_slip == tyre.turn_slip:
        return ""
    return "_turn_slip" if turn_slip else "_normal"


def c_of(tyre: tir.Tyre, path: Path, name: str, **switches: bool) -> tir.codegen.c99.Code:
    """The tyre as C code; raises InputError with the file if C does not allow a name or a value."""
    try:
        return tir.export_c(tyre, name=name, **switches)
    except tir.TirError as error:
        raise InputError(error.sentence, file=path) from error
