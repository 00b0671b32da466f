"""A property file as MATLAB functions, with names made from that of the file."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import tir
from mffit.export.code import code_of, written
from mffit.output import digest
from tir.codegen.matlab import MatlabCode, taken


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
    path = Path(path)

    def export(tyre: tir.Tyre, **given: Any) -> MatlabCode:
        return tir.export_matlab(tyre, origin=f"From {path.name}, SHA-256 {digest(path)}", **given)

    known = code_of(path, name, turn_slip, export, taken, limits=limits)
    texts = {f"{known.name}.m": known.code.function, f"{known.name}_mfeval.m": known.code.mfeval}
    return written(path, Path(out), texts)
