"""A property file as source code: how it is named after the file, and written as C99 or MATLAB."""

import re
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple, Unpack

import tir
from mffit.errors import InputError
from mffit.output import digest, output_folder
from tir.codegen import c99, matlab
from tir.codegen.program import Switches
from tir.mode import SwitchOptions


class CodeOfFile(NamedTuple):
    """A property file as code."""

    tyre: tir.Tyre
    name: str  #: of the function, or prefix of the functions
    switches: Switches
    code: Any


def write_c(
    path: str | Path,
    out: str | Path,
    *,
    name: str | None = None,
    tunable: bool = False,
    transient: bool = False,
    **switches: Unpack[SwitchOptions],
) -> list[Path]:
    """Write a property file as one C99 header and one source, see :func:`tir.export_c`.

    Parameters
    ----------
    path : the property file
    out : folder to write to
    name : of the files, and prefix of the functions; by default made from the name of the property file, with ``_turn_slip``
        or ``_normal`` behind it if turn slip is not as its USE_MODE says
    tunable : also functions with the scaling factors and the temperature as arguments
    transient : also the lag of the contact, see :func:`tir.export_c`
    switches : ``turn_slip``, ``star``, ``limits``, as in :func:`tir.export_c`

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
    export = partial(tir.export_c, tunable=tunable, lag=transient)
    known = code_of(Path(path), name, export, c99.taken, **switches)
    texts = {f"{known.name}.h": known.code.header, f"{known.name}.c": known.code.source}
    return _written(Path(path), Path(out), texts)


def write_matlab(
    path: str | Path, out: str | Path, *, name: str | None = None, **switches: Unpack[SwitchOptions]
) -> list[Path]:
    """Write a property file as two MATLAB functions, see :func:`tir.export_matlab`: the tyre, and one with MFeval's columns.

    They are called ``<name>.m`` and ``<name>_mfeval.m``. Arguments, result and errors are those of :func:`write_c`.
    """
    path = Path(path)

    def export(tyre: tir.Tyre, **given: Any) -> matlab.MatlabCode:
        return tir.export_matlab(tyre, origin=f"From {path.name}, SHA-256 {digest(path)}", **given)

    known = code_of(path, name, export, matlab.taken, **switches)
    texts = {f"{known.name}.m": known.code.function, f"{known.name}_mfeval.m": known.code.mfeval}
    return _written(path, Path(out), texts)


def _written(path: Path, out: Path, texts: Mapping[str, str]) -> list[Path]:
    """Write the code of a property file by the names of its files; returns their paths."""
    with output_folder(out, by="export", protected=[path]) as folder:
        for name, text in texts.items():
            (folder / name).write_text(text, encoding="ascii", newline="\n")
    return [out / name for name in texts]


def code_of(
    path: Path,
    given: str | None,
    export: Callable[..., Any],
    is_taken: Callable[[str], bool],
    **switches: Unpack[SwitchOptions],
) -> CodeOfFile:
    """The code of a property file in a language; its name is the ``given`` one, or is made from the name of the file.

    Characters that a name cannot have become underscores. The name gets ``_turn_slip`` or ``_normal`` behind it if turn slip is
    not as the file's USE_MODE says, and ``tyre_`` in front if it does not begin with a letter or is a word of the language.
    """
    tyre = tir.read(path)
    chosen = tyre.switches(**switches)
    name = re.sub(r"[^A-Za-z0-9_]", "_", stem(path, tyre, chosen)) if given is None else given
    if given is None and (is_taken(name) or not re.match(r"[A-Za-z]", name)):
        name = f"tyre_{name}"
    try:
        return CodeOfFile(tyre, name, chosen, export(tyre, name=name, **chosen._asdict()))
    except tir.TirError as error:
        raise InputError(error.sentence, file=path) from error


def stem(path: Path, tyre: tir.Tyre, switches: Switches) -> str:
    """The name of exported files: that of the property file, and whether turn slip is on where its USE_MODE says otherwise."""
    on = switches.turn_slip
    return path.stem + ("" if on == tyre.turn_slip else "_turn_slip" if on else "_normal")
