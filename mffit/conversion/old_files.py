"""Old property files, read without loss: their values under the names of MF 6.2 where those mean the same."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from tir import Problem, TirError
from tir.defaults import completed
from tir.document import Document, read_document
from tir.errors import listed, some
from tir.formula import CAR_FITTYPS, OLD_FITTYPS, formula_of
from tir.parameters import BY_NAME, TABLE, TURN_SLIP
from tir.properties import add_given, refuse_formulas, stated_values

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
CURVES = {"longitudinal": ("PCX1", "PDX1", "PKX1"), "side": ("PCY1", "PDY1", "PKY1", "PKY2")}
"""What a force needs: shape, peak and slope."""
OF_62 = {"PKY4": 2.0, "QSY7": 1.0, "QSY8": 0.0}
"""Values of MF 6.2 by which its formulae are those of MF 5.2; every other coefficient that 5.2 lacks is 0."""


@dataclass(frozen=True, slots=True)
class OldFile:
    """An old property file in SI, with its own keys in addition to those of MF 6.2."""

    kind: str  #: in words, such as "MF-Tyre 5.2"
    values: Mapping[str, Any]  #: every parameter of MF 6.2 and of :data:`OWN`
    present: frozenset[str]
    problems: tuple[Problem, ...]
    document: Document  #: the text, byte for byte

    @property
    def path(self) -> Path:
        """The file."""
        return Path(self.document.path)


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
    _refuse_incomplete_curves(values, document)
    refuse_load_of_zero(values, path)
    keys = [
        key.partition(".")[2] for key in unused if not key.startswith("MODEL.")
    ]  # those control a program
    if keys:
        problems.append(Problem("warning", f"keys that are not used: {some(keys)}"))
    present = frozenset(values)
    return OldFile(kind, MappingProxyType(old_completed(values)), present, tuple(problems), document)


def _refuse_incomplete_curves(values: Mapping[str, Any], document: Document) -> None:
    """Raise TirError for a force of which some coefficients are there but not all, and for a file without any force."""
    begun = {word: names for word, names in CURVES.items() if any(values.get(name) for name in names)}
    for word, names in begun.items():
        missing = [name for name in names if name not in values]
        if missing:
            raise TirError(
                f"lacks {listed(missing)}, without which its {word} force is unknown: add the missing lines, or take the "
                "complete file",
                path=document.path,
                name=missing[0],
            )
    if not begun:
        every = listed([*CURVES["longitudinal"], *CURVES["side"]])
        raise TirError(
            f"has no force: none of {every} is there with a value other than 0", path=document.path
        )


def refuse_load_of_zero(values: Mapping[str, Any], path: str | Path) -> None:
    """Raise TirError if the load is divided by 0 in the cornering stiffness, which is then unknown."""
    if values.get("PKY1") and values.get("PKY2") == 0.0:
        raise TirError(
            "PKY2 is 0, but the cornering stiffness divides the load by it: give its value",
            path=path,
            name="PKY2",
        )


def refuse_no_numbers(forces: Mapping[str, np.ndarray], path: str | Path) -> None:
    """Raise TirError if a force of a file is not a number at some condition, so that nothing can be fitted to it."""
    wrong = [channel for channel, force in forces.items() if not np.all(np.isfinite(force))]
    if wrong:
        raise TirError(
            f"{wrong[0]} is not a number everywhere in the ranges: correct what mffit check names", path=path
        )


def old_completed(given: Mapping[str, Any]) -> dict[str, Any]:
    """Every parameter of 6.2 and of :data:`OWN`: the given values, and defaults for all others.

    Missing coefficients are 0, except where the formulae of 6.2 need another value to be those of 5.2, and PKY2, by which loads
    are divided: it does not matter where there is no side force.
    """
    values = completed({name: x for name, x in given.items() if name in BY_NAME})
    kept = {*given, "PKY2", *(row.name for row in TABLE if row.scaling or row.section == TURN_SLIP)}
    for row in TABLE:
        if row.section.endswith("_COEFFICIENTS") and row.name not in kept:
            values[row.name] = OF_62.get(row.name, 0.0)
    return {**values, **{name: row.default for name, row in OWN.items()}, **given}


def _kind(document: Document, fittyp: int | None) -> str:
    """The formula of an old file in words, such as "MF-Tyre 5.2"; raises TirError if it is of another one."""
    if fittyp is not None:
        if fittyp not in CAR_FITTYPS:
            raise TirError(f"FITTYP {fittyp} cannot be converted: give {', '.join(map(str, CAR_FITTYPS))}")
        return OLD_FITTYPS[fittyp]
    formula = formula_of(document)
    refuse_formulas(formula, document)
    if formula.kind == "6":
        raise TirError(
            f"is of {formula.name} ({formula.why}) and needs no conversion; if it is of MF 5.2 all the same, use --fittyp 6",
            path=document.path,
        )
    if formula.kind == "unknown":
        raise TirError(
            f"{formula.why}: if it is of MF 5.2, use --fittyp 6; a file of MF 6.1 or 6.2 needs no conversion",
            path=document.path,
        )
    return formula.name
