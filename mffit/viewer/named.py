"""The tyres of a page: read from their files, with different names and with their ranges."""

import math
from collections.abc import Iterable, Mapping
from pathlib import Path
from types import MappingProxyType

import tir
from mffit.errors import InputError
from mffit.tested import end_tested, estimated
from mffit.viewer.controls import CONTROLS, OUTPUTS, Control, written_range
from tir import Tyre
from tir.codegen.program import Switches, refuse_zero_divisors
from tir.mode import doubt

Given = str | Path | Tyre
"""A property file, or a tyre."""


def named(
    given: Given | Mapping[str, Given] | Iterable[Given], lacking: Mapping[str, float] = MappingProxyType({})
) -> dict[str, Tyre]:
    """Tyres by name: the given name, or the shortest end of the path that differs from all others.

    ``lacking`` has values [SI] of keys that a file lacks.

    Raises InputError if no tyre is given, or if a value is not finite; TirError if a file cannot be read.
    """
    if isinstance(given, str | Path | Tyre):
        given = [given]
    if isinstance(given, Mapping):
        found = {str(name): _tyre(one, lacking) for name, one in given.items()}
    else:
        given = list(given)
        names = tell_apart([_path(one) for one in given])
        found = {name: _tyre(one, lacking) for name, one in zip(names, given, strict=True)}
    if not found:
        raise InputError("no tyre is given: name at least one .tir file")
    for name, tyre in found.items():
        _refuse_what_cannot_be_drawn(name, tyre)
    return found


def tell_apart(paths: list[Path]) -> list[str]:
    """The last part of each path without suffix; equal names get their folders, or else a number."""
    depth, names = 1, [path.stem for path in paths]
    while len(set(names)) < len(names) and depth < max(len(path.parts) for path in paths):
        depth += 1
        names = [Path(*path.with_suffix("").parts[-depth:]).as_posix() for path in paths]
    if len(set(names)) < len(names):
        names = [f"{name} ({i})" for i, name in enumerate(names, 1)]
    return names


def described(name: str, tyre: Tyre, parameters: Iterable[str]) -> dict[str, object]:
    """The data of a tyre for the page: parameters, ranges in SI, and whether its file is for turn slip."""
    return {
        "name": name,
        "values": {key: float(tyre[key]) for key in parameters},
        "ranges": {control.name: _ranges(tyre, control) for control in CONTROLS if control.limits},
        "turn_slip": tyre.turn_slip,
        "estimated": [name for name in estimated(tyre) if name in OUTPUTS],
        "doubt": bool(doubt(tyre.values, tyre.present)),
    }


def _ranges(tyre: Tyre, control: Control) -> dict[str, object]:
    assert control.limits is not None
    ends = [end_tested(tyre.status.get(key, "")) for key in control.limits]
    return {"written": written_range(tyre, control), "tested": None if None in ends else ends}


def _path(given: Given) -> Path:
    if isinstance(given, Tyre):
        return Path(given.document.path if given.document is not None and given.document.path else "tyre")
    return Path(given)


def _tyre(given: Given, lacking: Mapping[str, float]) -> Tyre:
    return given if isinstance(given, Tyre) else tir.read(given, **lacking)


def _refuse_what_cannot_be_drawn(name: str, tyre: Tyre) -> None:
    refuse_zero_divisors(tyre.p, Switches(tyre.turn_slip), OUTPUTS)
    for key, value in tyre.values.items():
        if isinstance(value, float) and not math.isfinite(value):
            raise InputError(
                f"{name}: {key} is {value}, so its curves cannot be drawn: write a number into the file"
            )
