"""A property file as C99 source, with names made from that of the file."""

from __future__ import annotations

import re
from pathlib import Path

import tir
from mffit.errors import InputError
from mffit.output import output_folder
from tir.codegen.c99 import taken


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
    tyre = tir.read(path)
    on = tyre.turn_slip if turn_slip is None else turn_slip
    name = identifier(path, name, other_mode(tyre, on))
    code = c_of(tyre, path, name, turn_slip=on, limits=limits, tunable=tunable, lag=transient)
    with output_folder(out, by="export", protected=[path]) as folder:
        (folder / f"{name}.h").write_text(code.header, encoding="ascii", newline="\n")
        (folder / f"{name}.c").write_text(code.source, encoding="ascii", newline="\n")
    return [out / f"{name}.h", out / f"{name}.c"]


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
