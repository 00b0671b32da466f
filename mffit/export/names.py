"""What a file's name becomes in C."""

from __future__ import annotations

import re
from pathlib import Path

import tir
from mffit.errors import InputError
from tir.codegen.c99 import taken


def identifier(path: Path, given: str | None = None) -> str:
    """The name in front of the functions: the one given, else the file's with underscores for what C does not allow.

    Behind ``tyre_`` where it begins with no letter, or C has the name itself.
    """
    if given is not None:
        return given
    name = re.sub(r"[^A-Za-z0-9_]", "_", path.stem)
    return name if re.match(r"[A-Za-z]", name) and not taken(name) else f"tyre_{name}"


def c_of(tyre: tir.Tyre, path: Path, name: str, **switches: bool) -> tir.codegen.c99.Code:
    """The tyre as C; raises InputError, with the file, for a name or a value that C cannot have."""
    try:
        return tir.export_c(tyre, name=name, **switches)
    except tir.TirError as error:
        raise InputError(error.sentence, file=path) from error
