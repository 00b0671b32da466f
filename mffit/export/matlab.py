"""A property file as MATLAB functions, with names made from that of the file."""

from __future__ import annotations

from pathlib import Path

import tir
from mffit.errors import InputError
from mffit.export.c import name_in_code
from mffit.output import digest, output_folder
from tir.codegen.matlab import taken


def write_matlab(
    path: str | Path,
    out: str | Path,
    *,
    name: str | None = None,
    turn_slip: bool | None = None,
    limits: bool = False,
) -> list[Path]:
    """Write a property file as two MATLAB functions, see :func:`tir.export_matlab`: the tyre, and one with MFeval's columns.

    Parameters
    ----------
    path : the property file
    out : folder to write ``<name>.m`` and ``<name>_mfeval.m`` to
    name : of the function; by default made from the name of the property file, with ``_turn_slip`` or ``_normal`` behind it if
        turn slip is not as its USE_MODE says
    turn_slip : whether spin acts; default: if the units digit of the file's USE_MODE is 5
    limits : as in a call of the tyre

    Returns
    -------
    list of Path
        The written files.

    Raises
    ------
    InputError
        The name cannot be used in MATLAB, or the folder cannot be written to.
    TirError
        The file cannot be read.
    """
    path, out = Path(path), Path(out)
    tyre = tir.read(path)
    on = tyre.turn_slip if turn_slip is None else turn_slip
    name = name_in_code(path, tyre, on, taken) if name is None else name
    origin = f"From {path.name}, SHA-256 {digest(path)}"
    try:
        code = tir.export_matlab(tyre, name=name, turn_slip=on, limits=limits, origin=origin)
    except tir.TirError as error:
        raise InputError(error.sentence, file=path) from error
    with output_folder(out, by="export", protected=[path]) as folder:
        (folder / f"{name}.m").write_text(code.function, encoding="ascii", newline="\n")
        (folder / f"{name}_mfeval.m").write_text(code.mfeval, encoding="ascii", newline="\n")
    return [out / f"{name}.m", out / f"{name}_mfeval.m"]
