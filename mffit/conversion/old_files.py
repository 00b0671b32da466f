"""Old property files, read without loss: their values under the names of MF 6.2 where those mean the same."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

from tir import Problem, TirError
from tir.defaults import completed
from tir.document import Document, read_document
from tir.errors import some
from tir.parameters import BY_NAME, TABLE, TURN_SLIP
from tir.properties import (
    CAR_FITTYPS,
    MOTORCYCLE_FORMATS,
    OLD_FITTYPS,
    OLD_FORMATS,
    add_given,
    number_of,
    of_motorcycles,
    stated_values,
    unquoted,
)

OWN = {
    name: replace(BY_NAME["PHY1"], name=name, section="", default=default, unit=unit)
    for names, default, unit in (
        (("PHY3", "PTX1", "PTX2", "PTX3", "PTY1", "PTY2", "QPZ1", "QPZ2"), 0.0, "-"),
        (("LGAX", "LGAY", "LGAZ", "LSGKP", "LSGAL", "LKYG"), 1.0, "-"),
        (("IP", "IP_NOM"), math.nan, "Pa"),
    )
    for name in names
}
"""Parameters that only old files have and that the forces need."""
VERSION = ("FITTYP", "PROPERTY_FILE_FORMAT")
NEEDED = ("FNOMIN", "UNLOADED_RADIUS")
OF_62 = {"PKY4": 2.0, "QSY7": 1.0, "QSY8": 0.0}
"""Values of MF 6.2 by which its formulae are those of MF 5.2; every other coefficient that 5.2 lacks is 0."""


@dataclass(frozen=True, slots=True)
class OldFile:
    """An old property file in SI, its own keys beside those of MF 6.2."""

    kind: str  #: in words, such as "MF-Tyre 5.2"
    values: Mapping[str, Any]  #: every parameter of MF 6.2 and of :data:`OWN`
    present: frozenset[str]
    problems: tuple[Problem, ...]
    document: Document  #: the text, byte for byte

    @property
    def path(self) -> Path:
        """The file."""
        return Path(self.document.path)


def is_old(path: str | Path) -> bool:
    """Whether a file states a version that :func:`read_old` reads."""
    return _version(read_document(path)) in (*map(str, CAR_FITTYPS), *OLD_FORMATS)


def read_old(
    path: str | Path, given: Mapping[str, float] = MappingProxyType({}), fittyp: int | None = None
) -> OldFile:
    """An MF 5.2 or PAC2002 file; arguments as in :func:`mffit.conversion.convert.convert`.

    Raises TirError if the file is of another version, or lacks what every force needs.
    """
    document = read_document(path)
    kind = _kind(document, fittyp)
    problems: list[Problem] = []
    values, _, unused = stated_values(document, problems, BY_NAME | OWN)
    for key in VERSION:
        values.pop(key, None)
    add_given(values, given, problems)
    missing = [name for name in NEEDED if name not in values]
    if missing:
        raise TirError(
            f"lacks {' and '.join(missing)}, which every force needs: add it",
            path=document.path,
            name=missing[0],
        )
    if unused:
        keys = [key.partition(".")[2] for key in unused]
        problems.append(Problem("warning", f"keys that are not used: {some(keys)}"))
    present = frozenset(values)
    return OldFile(kind, MappingProxyType(old_completed(values)), present, tuple(problems), document)


def old_completed(given: Mapping[str, Any]) -> dict[str, Any]:
    """Every parameter of 6.2 and of :data:`OWN`: the given values, and defaults for all others.

    Missing coefficients are 0, except where the formulae of 6.2 need another value to be those of 5.2.
    """
    values = completed({name: x for name, x in given.items() if name in BY_NAME})
    for row in TABLE:
        if (
            row.section.endswith("_COEFFICIENTS")
            and not row.scaling
            and row.section != TURN_SLIP
            and row.name not in given
        ):
            values[row.name] = OF_62.get(row.name, 0.0)
    return {**values, **{name: row.default for name, row in OWN.items()}, **given}


def _version(document: Document) -> str:
    """The version as FITTYP or PROPERTY_FILE_FORMAT state it, if it is one of the 5.2 generation; else empty."""
    stated = {
        line.key: unquoted(line.value).upper() for line in reversed(document.entries) if line.key in VERSION
    }
    number = number_of(stated.get("FITTYP", ""))
    if number is not None:
        return f"{number:g}" if number in OLD_FITTYPS else ""
    form = stated.get("PROPERTY_FILE_FORMAT", "")
    return form if form in OLD_FORMATS | MOTORCYCLE_FORMATS else ""


def _kind(document: Document, fittyp: int | None) -> str:
    if fittyp is not None and fittyp not in CAR_FITTYPS:
        raise TirError(f"FITTYP {fittyp} cannot be converted: give {', '.join(map(str, CAR_FITTYPS))}")
    version = _version(document) if fittyp is None else str(fittyp)
    if not version:
        raise TirError(
            "states no FITTYP of MF 5.2 (5, 6, 21) and no PROPERTY_FILE_FORMAT of PAC2002: a file of MF 6.1 or 6.2 needs no "
            "conversion, other formulas cannot be converted; if it is of MF 5.2 all the same, use --fittyp 6",
            path=document.path,
        )
    if version in OLD_FORMATS:
        return version
    number = number_of(version)
    if number not in CAR_FITTYPS:
        stated = f"PROPERTY_FILE_FORMAT '{version}'" if number is None else f"FITTYP {version}"
        raise TirError(of_motorcycles(stated), path=document.path)
    return OLD_FITTYPS[int(number)]
