"""The formula of a property file: by its FITTYP, else its keys, else its PROPERTY_FILE_FORMAT."""

import re
from collections.abc import Collection, Mapping
from pathlib import Path
from typing import NamedTuple

from tir.document import Document, number_of, read_document, unquoted
from tir.errors import some
from tir.parameters import BY_NAME
from tir.targets import FITTYPS, fittyps_text

OLD_FITTYPS = {
    5: "MF-Tyre 5",
    6: "MF-Tyre 5.2",
    21: "MF-Tyre 5.2 with MF-Swift",
    51: "MF-MCTyre 1.0, a motorcycle tyre",
    52: "MF-MCTyre 1.1, a motorcycle tyre",
}
CAR_FITTYPS = (5, 6, 21)
HEADER = ("MDI_HEADER", "UNITS")
OLD_KEYS = frozenset(
    {
        *("PHY3", "QTZ1", "MBELT", "QPX1", "QPZ1", "QPZ2", "IP", "IP_NOM"),
        *("PTX1", "PTX2", "PTX3", "PTX4", "PTY1", "PTY2", "PTY3"),
        *("LGAX", "LGAY", "LGAZ", "LGYR", "LKYG", "LSGKP", "LSGAL"),
    }
)
"""Keys that only files of the 5.2 generation have, PAC2002 and the old formula for motorcycles among them."""
MOTORCYCLE_KEYS = frozenset({"PCY2", "LCC", "LKC", "LEC"})
"""Keys that only the old formula for motorcycles has: a camber force with a shape of its own."""
NEW_KEYS = frozenset(
    {
        *("PEY5", "PKY4", "PKY5", "PKY6", "PKY7", "PPY5", "PPMX1", "PPZ1", "PPZ2", "RBX3", "RBY4"),
        *("QSX12", "QSX13", "QSX14", "QDZ10", "QDZ11", "LKYC", "LKZC", "LMP"),
    }
)
"""Coefficients of MF 6 that MF 5.2 and PAC2002 lack. Those of turn slip, of pressure and of Mx are in PAC2002 too."""
NEUTRAL = {"PKY4": 2.0}
"""Values at which a coefficient has no effect, where that is neither 0 nor, for a scaling factor, 1."""
PRESSURES = frozenset({"NOMPRES", "INFLPRES"})
"""Keys of MF 6.1 that old files may have too, for programs that require them."""
MOTORCYCLE_TAG = re.compile(r"(PAC|MF)_?MC")
OLD_TAG = re.compile(r"PAC2002|MF_?05|MF_?TYRE$|(^|\D)5(_?[012])?$")
NEW_TAG = re.compile(r"(^|\D)6(_?[012])?$")
KNOWN_TAGS = (MOTORCYCLE_TAG, OLD_TAG, NEW_TAG)
OTHER_FORMULA_TAG = re.compile(r"PAC_?TIME|PAC_?(89|94)")
"""Formulae of Pacejka's family with names of coefficients in common, but with other equations."""
VERSION = re.compile(r"\bTIRE_VERSION\s*:\s*([^(]*?)\s*(?:\(.*)?$")
"""A remark with which several programs open their files."""
ANY_TAG = frozenset({"", "USER", "MF"})
"""Formats that name no formula."""


class Formula(NamedTuple):
    """The formula of a file."""

    kind: str  #: "6", "5.2", "motorcycle", "other" for another tyre model, or "unknown"
    name: str  #: in words
    why: str  #: what in the file says so, for a sentence


def formula_of(document: Document, fittyp: float | None = None) -> Formula:
    """The formula of a file; ``fittyp`` replaces the FITTYP that it states."""
    stated: dict[str, str] = {}
    for line in document.entries:
        if line.section not in HEADER:
            stated.setdefault(line.key, unquoted(line.value))
    if fittyp is None:
        fittyp = number_of(stated.get("FITTYP", ""))
    if fittyp is not None:
        return _of_fittyp(fittyp, stated)
    remarks = (VERSION.search(line.text) for line in document.lines if not line.key)
    return _of_keys(stated, next((found.group(1) for found in remarks if found), ""))


def is_old(path: str | Path) -> bool:
    """Whether a file is of MF 5.2 or PAC2002, which can be converted."""
    return formula_of(read_document(path)).kind == "5.2"


def _acting(group: Collection[str], stated: Mapping[str, str]) -> set[str]:
    """Keys of a group whose values have an effect; others may only be there for programs that require every key."""
    values = {key: number_of(stated[key]) for key in group if key in stated}
    neutral = {key: NEUTRAL.get(key, 1.0 if key.startswith("L") else 0.0) for key in values}
    return {key for key, value in values.items() if value is not None and value != neutral[key]}


def _of_fittyp(fittyp: float, stated: Mapping[str, str]) -> Formula:
    why = f"FITTYP {fittyp:g}"
    if fittyp in FITTYPS:
        return Formula("6", f"MF 6.{int(fittyp) % 10}", why)
    if fittyp not in OLD_FITTYPS:
        return Formula("unknown", why, f"has {why}, but only {fittyps_text()} are supported")
    new = _acting(NEW_KEYS, stated)
    if fittyp in CAR_FITTYPS and new and not OLD_KEYS.intersection(stated):
        said = f"has {why} ({OLD_FITTYPS[int(fittyp)]}), but coefficients that only MF 6 has ({_shown(new)})"
        return Formula("unknown", why, said)
    kind = "5.2" if fittyp in CAR_FITTYPS else "motorcycle"
    return Formula(kind, OLD_FITTYPS[int(fittyp)], why)


def _of_keys(stated: Mapping[str, str], remark: str) -> Formula:
    form = stated.get("PROPERTY_FILE_FORMAT", "")
    tag, why = _plain(form), f"PROPERTY_FILE_FORMAT '{form}'"
    if tag in ANY_TAG and any(pattern.search(_plain(remark)) for pattern in KNOWN_TAGS):
        tag, why = _plain(remark), f"the remark TIRE_VERSION : {remark}"
    old, new, motorcycle = ({*stated} & group for group in (OLD_KEYS, NEW_KEYS, MOTORCYCLE_KEYS))
    if old and new:
        old, new = _acting(old, stated), _acting(new, stated)
    magic = {key for key in stated if key in BY_NAME and BY_NAME[key].section.endswith("_COEFFICIENTS")}
    known = [pattern for pattern in KNOWN_TAGS if pattern.search(tag)]
    if OTHER_FORMULA_TAG.search(tag) or not (magic or old or known or tag in ANY_TAG):
        return Formula("other", form, why)
    if motorcycle or MOTORCYCLE_TAG.search(tag):
        return Formula("motorcycle", "MF-MCTyre", f"keys {_shown(motorcycle)}" if motorcycle else why)
    name = "PAC2002" if "PAC2002" in tag else "MF-Tyre 5.2"
    if old and new:
        return Formula("unknown", "", f"has keys of MF 5.2 ({_shown(old)}) and of MF 6 ({_shown(new)})")
    if old:
        return Formula("5.2", name, why if OLD_TAG in known else f"keys {_shown(old)}")
    if new:
        return Formula("6", "MF 6", f"keys {_shown(new)}")
    if known:
        return Formula("5.2", name, why) if OLD_TAG in known else Formula("6", "MF 6", why)
    if PRESSURES.intersection(stated):
        return Formula("6", "MF 6", f"keys {_shown(PRESSURES.intersection(stated))}")
    return Formula("unknown", "", "does not say which version of the Magic Formula it is of")


def _plain(form: str) -> str:
    """A format in capitals, with an underscore for all other signs."""
    return re.sub(r"[^A-Z0-9]+", "_", form.upper()).strip("_")


def _shown(keys: Collection[str]) -> str:
    return some(sorted(keys))
