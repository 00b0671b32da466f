"""A property file as C99 source, with names made from that of the file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import tir
from mffit.errors import InputError
from mffit.output import output_folder
from tir.codegen.c99 import Code, taken


def write_c(
    path: str | Path,
    out: str | Path,
    *,
    name: str | None = None,
    turn_slip: bool | None = None,
    limits: bool = False,
    tunable: bool = False,
    transient: bool = False,
) -> list[Path]:
    """Write a property file as one C99 header and one source, see :func:`tir.export_c`.

    Parameters
    ----------
    path : the property file
    out : folder to write to
    name : of the files, and prefix of the functions; by default made from the name of the property file, with ``_turn_slip``
        or ``_normal`` behind it if turn slip is not as its USE_MODE says
    turn_slip : whether spin acts; default: if the units digit of the file's USE_MODE is 5
    limits : as in a call of the tyre
    tunable : also functions with the scaling factors and the temperature as arguments
    transient : also the lag of the contact, see :func:`tir.export_c`

    Returns
    -------
    list of Path
        The written files.

    Raises
    ------
    InputError
        The name is not a name in C, a value is not finite, or the folder cannot be written to.
    TirError
        The file cannot be read.
    """
    path, out = Path(path), Path(out)
    known = as_c(path, name, turn_slip, limits=limits, tunable=tunable, lag=transient)
    with output_folder(out, by="export", protected=[path]) as folder:
        (folder / f"{known.name}.h").write_text(known.code.header, encoding="ascii", newline="\n")
        (folder / f"{known.name}.c").write_text(known.code.source, encoding="ascii", newline="\n")
    return [out / f"{known.name}.h", out / f"{known.name}.c"]


class CodeOfFile(NamedTuple):
    """A property file as C code."""

    tyre: tir.Tyre
    name: str  #: prefix of the functions
    turn_slip: bool
    code: Code


def as_c(path: Path, given: str | None, turn_slip: bool | None, **switches: bool) -> CodeOfFile:
    """The code of a property file, with a ``given`` name or one made from that of the file."""
    tyre = tir.read(path)
    on = tyre.turn_slip if turn_slip is None else turn_slip
    name = name_in_code(path, tyre, on, taken) if given is None else given
    try:
        return CodeOfFile(tyre, name, on, tir.export_c(tyre, name=name, turn_slip=on, **switches))
    except tir.TirError as error:
        raise InputError(error.sentence, file=path) from error


def name_in_code(path: Path, tyre: tir.Tyre, turn_slip: bool, is_taken: Callable[[str], bool]) -> str:
    """A name in a language, made from that of the property file.

    Other characters become underscores. The name gets ``_turn_slip`` or ``_normal`` behind it if turn slip is not as the file's
    USE_MODE says, and ``tyre_`` in front if it does not begin with a letter or is a word of the language.
    """
    name = re.sub(r"[^A-Za-z0-9_]", "_", path.stem) + mode_suffix(tyre, turn_slip)
    return name if re.match(r"[A-Za-z]", name) and not is_taken(name) else f"tyre_{name}"


def mode_suffix(tyre: tir.Tyre, on: bool) -> str:
    """The end of the name of exported files, which says whether turn slip is on where the file's USE_MODE says otherwise."""
    return "" if on == tyre.turn_slip else "_turn_slip" if on else "_normal"
