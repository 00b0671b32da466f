"""A property file as C99 source."""

from __future__ import annotations

from pathlib import Path

import tir
from mffit.export.names import c_of, identifier
from mffit.output import output_folder


def write_c(
    path: str | Path,
    out: str | Path,
    *,
    name: str | None = None,
    turn_slip: bool = True,
    limits: bool = False,
) -> list[Path]:
    """Write a property file as one C99 header and one source, see :func:`tir.export_c`.

    Parameters
    ----------
    path : the property file
    out : folder to write to
    name : of the files, and prefix of the functions; by default made from the name of the property file
    turn_slip, limits : as in a call of the tyre

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
    name = identifier(path, name)
    code = c_of(tir.read(path), path, name, turn_slip=turn_slip, limits=limits)
    with output_folder(out, by="export", protected=[path]) as folder:
        (folder / f"{name}.h").write_text(code.header, encoding="ascii", newline="\n")
        (folder / f"{name}.c").write_text(code.source, encoding="ascii", newline="\n")
    return [out / f"{name}.h", out / f"{name}.c"]
