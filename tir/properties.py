"""Interpretation of a property file: from its document and the table to the record of a tyre."""

import math
import re
from collections.abc import Collection, Mapping, Sequence
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any, NamedTuple, TypeVar

import numpy as np

from tir.codegen.program import Switches, parameters_of
from tir.defaults import completed
from tir.document import AS_TEXT, NUMBER, Document, FileLine, number_of, unquoted
from tir.equations.forces import Forces, State
from tir.errors import Problem, TirError, counted, some
from tir.formula import HEADER, OLD_KEYS, Formula, formula_of
from tir.mode import asks_for_turn_slip
from tir.parameters import BY_NAME, TABLE, TURN_SLIP, Parameter
from tir.record import Quantity, TyreRecord
from tir.targets import TARGETS
from tir.units import KINDS, factor, known_word

Kind = TypeVar("Kind", bound=TyreRecord)
OF_PROGRAMS = {"SWITCH_INTEG"} | {key for target in TARGETS.values() for key in target.more}
"""Keys of [MODEL] that control how a program runs the model; they are not parameters of the tyre."""
LONG_NAME, LIKENESS = 6, 0.85
"""Length from which a name without a number is compared with others, and the likeness that counts as a misspelling."""
LARGEST = float(np.finfo(np.float32).max)
"""Largest size of a value: simulation programs have no larger one in single precision, and squares of it are finite here."""
DEFAULTS_OF_A_CALL = {"LONGVL", "INFLPRES", "FITTYP"}
"""Values that a call takes where it gives none, and the formula."""
OF_SLIP = tuple(name for name in Forces._fields if name not in ("Fz", "My"))
"""Forces and moments of slip."""
ESSENTIAL = ("UNLOADED_RADIUS", "FNOMIN")
OPTION = "; mffit check, show, compare and convert take --unloaded-radius"
ESSENTIAL_COEFFICIENTS = ("PCY1", "PDY1", "PKY1")
QUANTITY = re.compile(r"^\s*!\s*(measured|fitted):\s*(\S+)\s+(\S+)\s+u\s+(\S+)\s+(\S+)\s*$")
PROVENANCE = re.compile(r"^\s*!\s*provenance:\s*([^:]+):\s*(.*?)\s*$")
STATUS = re.compile(
    r"^(fitted|measured|tied|default|from (?:base|sister|another campaign)|estimate|covered|regularised|given|held|"
    r"diagnosed|converted)\b"
)


def described(kind: type[Kind], document: Document, lacking: Mapping[str, float | str]) -> Kind:
    """The tyre of a document, with values of keys that it lacks; raises as :func:`tir.read`."""
    if not document.entries:
        raise TirError(
            f"holds no 'KEY = value' line, so it is not a property file{_otherwise(document)}",
            path=document.path,
        )
    problems: list[Problem] = []
    values, status, extra = stated_values(document, problems)
    added = add_given(values, lacking, problems)
    status |= dict.fromkeys(added, "given when the file was read")
    formula = formula_of(document, values.get("FITTYP"))
    refuse_formulas(formula, document, (*STRANGE, "5.2"))
    _refuse_truncated(values, document)
    refuse_formulas(formula, document, ("unknown",))
    problems += _about_a_cut_number(values, document) + _about_values_below(document)
    stated = {line.key for line in document.entries if parameter_of(line)} | added
    complete = completed(values)
    problems += _about_empty(complete, values, document)
    problems += _about_missing(complete, values, stated) + _about_unknown(extra, stated)
    measured, provenance = _structured_comments(document)
    return kind(
        values=MappingProxyType(complete),
        present=frozenset(values),
        status=MappingProxyType(status),
        measured=MappingProxyType(measured),
        provenance=MappingProxyType(provenance),
        extra=MappingProxyType(extra),
        on_reading=tuple(problems),
        document=document,
    )


class StatedValues(NamedTuple):
    """The content of a document by key."""

    values: dict[str, Any]  #: in the units of the table
    status: dict[str, str]  #: origin of a value
    extra: dict[str, str]  #: text of unknown keys, as "SECTION.KEY"


def stated_values(
    document: Document, problems: list[Problem], known: Mapping[str, Parameter] = BY_NAME
) -> StatedValues:
    """The values of a document, with a problem for each that is unusual; raises TirError for one that cannot be used."""
    words = units_of(document, problems)
    found = StatedValues({}, {}, {})
    for line in document.entries:
        row = None if line.section in HEADER else known.get(line.key)
        if row is None:
            if line.section not in HEADER:
                found.extra[f"{line.section}.{line.key}"] = line.value
            continue
        if line.key in found.values:
            problems.append(_warning(f"{line.key} appears twice; the first value is used", line))
            continue
        if not line.section:
            problems.append(
                _warning(f"{line.key} comes before the first [SECTION]; it is read all the same", line)
            )
        value = value_of(row, line, words, document, problems)
        if value is None:
            continue
        found.values[line.key] = value
        if STATUS.match(line.comment):
            found.status[line.key] = line.comment
    return found


def add_given(
    values: dict[str, Any], given: Mapping[str, float | str], problems: list[Problem]
) -> frozenset[str]:
    """Add given values of keys that a file lacks; returns their names. A value that the file has itself stays, with a problem.

    Raises TirError if a name is unknown, or a value is not finite where a number is needed.
    """
    added = TyreRecord.from_values(given).present - values.keys()
    for name, value in given.items():
        if not isinstance(value, str) and not math.isfinite(value):
            raise TirError(f"the given {name} is {value}, which no formula can use: give a number", name=name)
        if name in added:
            values[name] = value
        else:
            sentence = f"{name} is in the file, {values[name]}: the given {value} is not used"
            problems.append(Problem("warning", sentence, name))
    return added


def parameter_of(line: FileLine) -> Parameter | None:
    """The parameter of a line with a key; None in the header and for keys that are not in MF 6.2."""
    return None if line.section in HEADER else BY_NAME.get(line.key)


def units_of(document: Document, problems: list[Problem]) -> dict[str, str]:
    """The unit that the file states for each kind of quantity."""
    words = {}
    for line in document.entries:
        if line.section != "UNITS" or line.key not in KINDS or line.key in words:
            continue
        word = known_word(line.key, line.value)
        if word not in KINDS[line.key]:
            known = ", ".join(sorted(KINDS[line.key]))
            raise TirError(
                f"{line.key} = {line.value} is an unknown unit: use one of {known}",
                path=document.path,
                line=line.number,
            )
        words[line.key] = word
        if KINDS[line.key][word] != 1.0:
            problems.append(
                _warning(
                    f"{line.key} is in {unquoted(line.value)}; all values are converted to SI on reading",
                    line,
                )
            )
    return words


def value_of(
    row: Parameter, line: FileLine, words: dict[str, str], document: Document, problems: list[Problem]
) -> float | str | None:
    """The value in the unit of the table; None, with a problem added, if it is missing and the file can still be used."""
    if row.kind == "text" and line.value:
        return unquoted(line.value)
    text = unquoted(line.value)
    number = number_of(text)
    if number is not None and abs(number) <= LARGEST:
        return number * factor(row.unit, words)
    if not text:
        if row.name in (*ESSENTIAL, *ESSENTIAL_COEFFICIENTS) or line.number == len(document.lines):
            raise TirError(
                f"{line.key} has no value: the file is damaged or truncated here",
                path=document.path,
                line=line.number,
                name=line.key,
            )
        return None
    said = f'{line.key} is "{text}", but a number was expected' if number is None else ""
    said = said or f"{line.key} is {text}, which no formula can use"
    results = parameters_of(Forces._fields + State._fields, Switches(True, limits=True))
    if row.name in BY_NAME and row.name not in results | DEFAULTS_OF_A_CALL:
        problems.append(_warning(f"{said}; no force needs it, so its default is taken", line))
        return None
    remedy = ": give a number"
    if number is None and "," in text:
        remedy = f"; decimal commas are not allowed, write {text.replace(',', '.')}"
    if number is None and NUMBER.match(text) and "," not in text:
        remedy = ": only a comment may follow the number, and it begins with $ or !"
    elif row.name == "FITTYP":
        remedy = ": write a number, such as 61 for MF 6.1"
    if text.endswith(";") and number_of(text[:-1].strip()) is not None:
        remedy = ": leave the semicolon out"
    raise TirError(f"{said}{remedy}", path=document.path, line=line.number, name=line.key)


OTHER_FORMULAS: Mapping[str, str] = {
    "motorcycle": "is of MF-MCTyre, the old formula for motorcycles ({why}: {name}), whose camber force is another one: fit the "
    "tyre's data again; or, if it is a car's tyre of MF 5.2 under a wrong name, write FITTYP 6 or use mffit convert --fittyp 6",
    "other": "is of another tyre model, {name} ({why}), whose coefficients are not those of MF 5.2 or MF 6: take the tyre's file "
    "of MF 6.1 or 6.2, or fit its data; if the name is wrong, use mffit convert --fittyp 6 for MF 5.2, or write FITTYP = 62 into "
    "[MODEL]",
    "5.2": "is a file of the MF 5.2 generation ({why}: {name}); its coefficients have another meaning in MF 6.2, so renaming it "
    "does not help: mffit convert makes an MF 6.2 file of it by a fit to its forces",
    "unknown": "{why}: if it is of MF 6, write FITTYP = 61 or FITTYP = 62 into its [MODEL], or give it in Python, "
    "tir.read(path, FITTYP=62); if it is of MF 5.2, use mffit convert --fittyp 6",
}
"""By the kind of a formula that is not read as MF 6, why its file cannot be used, and what to do."""
STRANGE = ("motorcycle", "other")
"""Kinds that are not converted to MF 6 either."""


def refuse_formulas(formula: Formula, document: Document, kinds: Collection[str] = STRANGE) -> None:
    """Raise TirError for a formula of these kinds, by default those that are neither MF 6 nor converted to it."""
    if formula.kind in kinds:
        sentence = OTHER_FORMULAS[formula.kind].format(why=formula.why, name=formula.name)
        raise TirError(sentence, path=document.path, name="FITTYP" if formula.kind == "unknown" else None)


def _refuse_truncated(values: Mapping[str, float | str], document: Document) -> None:
    coefficients = any(name in values for name in ESSENTIAL_COEFFICIENTS)
    missing = [name for name in ESSENTIAL if name not in values]
    if missing:
        remedy = f"the file is truncated, is for another tyre model, or is not a property file{_otherwise(document)}"
        if coefficients:
            homes = " and ".join(f"{name} to [{BY_NAME[name].section}]" for name in missing)
            remedy = f"add {homes}, or give it in Python: tir.read(path, {missing[0]}=...)"
            remedy += OPTION * (missing == ["UNLOADED_RADIUS"])
        raise TirError(
            f"lacks {' and '.join(missing)}, which every force needs: {remedy}",
            path=document.path,
            name=missing[0],
        )
    if not coefficients:
        raise TirError(
            "has none of PCY1, PDY1, PKY1: the coefficients are missing, so the file is truncated"
            f"{_otherwise(document)}",
            path=document.path,
        )


def _otherwise(document: Document) -> str:
    """What to do if a line names a coefficient in another form than a property file, such as a table or a script; else empty."""
    for line in document.lines:
        words = [] if line.text.lstrip().startswith(("$", "!")) else re.findall(r"[A-Za-z]\w*", line.text)
        names = [word for word in words if word.upper().replace("_", "") in ESSENTIAL_COEFFICIENTS]
        if names and line.key != names[0].upper().replace("_", ""):
            return f"; line {line.number} names {names[0]} in another form: {AS_TEXT}"
    return ""


def _about_values_below(document: Document) -> list[Problem]:
    """A problem if values are on other lines than their keys."""
    apart = [line for line in document.entries if line.apart]
    said = f"the values of {some([line.key for line in apart])} are on the lines below their keys"
    return [_warning(f"{said}; other programs may want one line", line) for line in apart[:1]]


def _about_a_cut_number(values: Mapping[str, float | str], document: Document) -> list[Problem]:
    """A problem, or an error, if the file ends without a line end and may be truncated within its last number."""
    line = document.lines[-1]
    row = parameter_of(line)
    if row is None or row.kind == "text" or line.start + len(line.value) < len(line.text):
        return []  # text after the number shows that the number is complete
    behind = [other for other in TABLE if other.order > row.order and other.files == ""]
    if not behind or any(other.name in values for other in behind):
        return []
    said = (
        f"the file ends with {line.key} = {line.value}, without a line end and without the keys that usually follow, "
        f"{behind[0].name} and more"
    )
    if all(x.section == TURN_SLIP != row.section for x in behind):  # many complete files lack this section
        return [_warning(f"{said}: check whether the file was truncated", line)]
    raise TirError(
        f"{said}: the file is truncated; use the complete one, or end the line if the number is right",
        path=document.path,
        line=line.number,
        name=line.key,
    )


def _about_empty(complete: Mapping[str, Any], given: Collection[str], document: Document) -> list[Problem]:
    """A problem for keys without a value."""
    lines = {line.key: line for line in reversed(document.entries) if parameter_of(line)}
    rows = [
        row
        for row in TABLE
        if row.name in lines and row.name not in given and not unquoted(lines[row.name].value)
    ]
    if not rows:
        return []
    names = _defaults_in_words(rows, complete)
    verb, taken = ("has", "its default is") if len(rows) == 1 else ("have", "defaults are")
    first = lines[names[0].split()[0]]
    return [_warning(f"{counted(len(rows), 'key')} {verb} no value, {taken} taken: {some(names)}", first)]


SECTIONS_OF_FORCES = {
    "LONGITUDINAL_COEFFICIENTS": "Fx",
    "LATERAL_COEFFICIENTS": "Fy",
    "ALIGNING_COEFFICIENTS": "Mz",
}
"""Force or moment that each section describes alone."""


def _about_missing(complete: Mapping[str, Any], given: Collection[str], stated: set[str]) -> list[Problem]:
    """Problems for missing keys of the file's version; those without a usable value have been reported already."""
    version = complete["FITTYP"] if "FITTYP" in given else None
    missing = [
        row
        for row in TABLE
        if row.name not in stated and (row.files == "" or (row.files == "62" and version not in (60, 61)))
    ]
    names = _defaults_in_words(missing, complete)
    mf, verbs = "6.1" if version in (60, 61) else "6.2", "is" if len(names) == 1 else "are"
    lacking = f"{counted(len(names), f'key of MF {mf}')} {verbs} missing, defaults are taken: {some(names)}"
    sentences = [lacking] if names else []
    if version == 60:
        sentences = ["; ".join(["FITTYP 60 is read as MF 6.1", *sentences])]
    if version is None:
        sentences.insert(0, "FITTYP is missing; the file is read as MF 6.2")
    empty = [
        Problem(
            "warning",
            f"no key of [{section}] is in the file, which may end before it: all of {force} is default",
            section,
        )
        for section, force in SECTIONS_OF_FORCES.items()
        if stated.isdisjoint(row.name for row in TABLE if row.section == section)
    ]
    of_keys = [Problem("warning", said, "FITTYP" * said.startswith("FITTYP")) for said in sentences]
    return [*empty, *of_keys]


def _defaults_in_words(missing: Sequence[Parameter], complete: Mapping[str, Any]) -> list[str]:
    """Missing keys, first those whose defaults contribute to a force, with the values taken."""
    acting = parameters_of(OF_SLIP, Switches(asks_for_turn_slip(complete))) | {"INFLPRES"}
    neutral = {row.name for row in missing if complete[row.name] == (1.0 if row.scaling else 0.0)}
    first = [row for row in missing if row.name in acting and row.name not in neutral]
    words = [f"{row.name} = {complete[row.name]:g}{f' {row.unit}' * (row.unit != '-')}" for row in first]
    return [*words, *(row.name for row in missing if row not in first)]


def _about_unknown(extra: Mapping[str, str], given: Collection[str]) -> list[Problem]:
    names = [
        key
        for key in extra
        if not key.startswith(("SHAPE.", "MDI_HEADER.")) and key.removeprefix("MODEL.") not in OF_PROGRAMS
    ]
    meant = {name: other for name in names if (other := _meant(name.rpartition(".")[2], given))}
    others, sentences = [name for name in names if name not in meant], []
    if meant:
        said = some([f"{name} (is {other} meant?)" for name, other in meant.items()])
        verb = "is" if len(meant) == 1 else "are"
        sentences.append(f"{said} {verb} not known and not used: correct the spelling")
    if others:
        said = (
            "is not an MF 6.2 parameter and is" if len(others) == 1 else "are not MF 6.2 parameters and are"
        )
        sentences.append(f"{counted(len(others), 'key')} {said} kept but not used: {some(others)}")
    return [Problem("warning", sentence) for sentence in sentences]


def _meant(key: str, given: Collection[str]) -> str:
    """The missing key of MF 6.2 that an unknown key probably is, spelt otherwise; empty if there is none."""
    plain = _plain(key)
    missing = [row.name for row in TABLE if row.name not in given]
    alike = [name for name in missing if _plain(name) == plain]
    if alike or any(sign.isdigit() for sign in key) or key in OLD_KEYS:
        return alike[0] if alike else ""  # coefficients differ by one letter or number from one another
    long = [name for name in missing if len(name) >= LONG_NAME]
    return next(iter(get_close_matches(key, long, n=1, cutoff=LIKENESS)), "")


def _plain(key: str) -> str:
    """A key without underscores, and with a letter O for each zero."""
    return key.replace("_", "").replace("0", "O")


def _structured_comments(document: Document) -> tuple[dict[str, Quantity], dict[str, str]]:
    measured, provenance = {}, {}
    for _, text in document.comments:
        found = QUANTITY.match(text)
        if found:
            origin, name, *_, unit = found.groups()
            value, u = (number_of(x) for x in found.group(3, 4))
            if value is not None and u is not None:
                measured[name] = Quantity(value, u, unit, origin)
        found = PROVENANCE.match(text)
        if found:
            provenance[found.group(1).strip()] = found.group(2)
    return measured, provenance


def _warning(sentence: str, line: FileLine) -> Problem:
    return Problem("warning", f"line {line.number}: {sentence}", line.key, line.number)
