"""A property file as C99 source."""

from __future__ import annotations

from pathlib import Path

import tir
from mffit.export.code import code_of, written
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
    path = Path(path)
    known = code_of(path, name, turn_slip, tir.export_c, taken, limits=limits, tunable=tunable, lag=transient)
    return written(
        path, Path(out), {f"{known.name}.h": known.code.header, f"{known.name}.c": known.code.source}
    )
