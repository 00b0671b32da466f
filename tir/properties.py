"""Property files: Document and table to Tyre, and Tyre to text."""

from __future__ import annotations

import math
import os
import re
import tempfile
from pathlib import Path
from types import MappingProxyType
from typing import Any

from tir.document import Document, Line, read_document
from tir.errors import Problem, TirError
from tir.parameters import BY_NAME, SECTIONS, TABLE, Parameter
from tir.tyre import Quantity, Tyre
from tir.units import KINDS, SI, factor

OLD_FITTYPS = {5, 6, 21, 51, 52}
OLD_FORMATS = {"MF_05", "PAC2002", "MF-TYRE", "PAC_MC"}
ESSENTIAL = ("UNLOADED_RADIUS", "FNOMIN")
ESSENTIAL_COEFFICIENTS = ("PCY1", "PDY1", "PKY1")
HEADER = ("MDI_HEADER", "UNITS")
MEASURED = re.compile(r"^\s*!\s*measured:\s*(\S+)\s+(\S+)\s+u\s+(\S+)\s+(\S+)\s*$")
PROVENANCE = re.compile(r"^\s*!\s*provenance:\s*([^:]+):\s*(.*?)\s*$")
STATUS = re.compile(
    r"^(fitted|measured|tied|default|from base|estimate|covered|regularised|given|diagnosed)\b"
)


def read(path: str | Path) -> Tyre:
    """Read a ``.tir`` file of MF 6.1 or 6.2.

    Units other than SI are converted, missing keys take the table's defaults; whatever looks odd is listed in
    ``Tyre.problems`` with its line.

    Raises
    ------
    TirError
        If the file is no property file, is truncated, holds an unreadable number, or is of another MF version.
    """
    return interpret(read_document(path))


def interpret(document: Document) -> Tyre:
    """The tyre that a document describes; raises as :func:`read`."""
    entries = document.entries
    if not entries:
        raise TirError("holds no 'KEY = value' line, so it is not a property file", path=document.path)
    problems: list[Problem] = []
    words = _units(document, problems)
    values: dict[str, float | str] = {}
    extra: dict[str, str] = {}
    status: dict[str, str] = {}
    for line in entries:
        if line.section == "UNITS":
            continue
        row = BY_NAME.get(line.key)
        if row is None or (line.section in HEADER):
            if line.section != "MDI_HEADER":
                extra[f"{line.section}.{line.key}"] = line.value
            continue
        if line.key in values:
            problems.append(_warning(f"{line.key} stands twice; the first value is used", line))
            continue
        if not line.section:
            problems.append(
                _warning(f"{line.key} stands before any [SECTION]; it is read all the same", line)
            )
        values[line.key] = _value(row, line, words, document.path)
        if STATUS.match(line.comment):
            status[line.key] = line.comment
    _refuse_other_versions(values, extra, document)
    _refuse_truncated(values, document)
    problems += _about_missing(values) + _about_unknown(extra)
    complete = {row.name: row.default for row in TABLE} | values
    measured, provenance = _structured_comments(document)
    return Tyre(
        values=MappingProxyType(complete),
        present=frozenset(values),
        status=MappingProxyType(status),
        measured=MappingProxyType(measured),
        provenance=MappingProxyType(provenance),
        extra=MappingProxyType(extra),
        problems=tuple(problems),
    )


def _units(document: Document, problems: list[Problem]) -> dict[str, str]:
    words = {}
    for line in document.entries:
        if line.section != "UNITS" or line.key not in KINDS or line.key in words:
            continue
        word = _unquoted(line.value).lower()
        if word not in KINDS[line.key]:
            known = ", ".join(sorted(KINDS[line.key]))
            raise TirError(
                f"{line.key} = {line.value} is no known unit: use one of {known}",
                path=document.path,
                line=line.number,
            )
        words[line.key] = word
        if KINDS[line.key][word] != 1.0:
            problems.append(
                _warning(f"{line.key} is in {word}; all values are converted to SI on reading", line)
            )
    return words


def _value(row: Parameter, line: Line, words: dict[str, str], path: str) -> float | str:
    if not line.value:
        raise TirError(
            f"{line.key} has no value: the file is damaged or cut short here", path=path, line=line.number
        )
    if row.kind == "text":
        return _unquoted(line.value)
    text = _unquoted(line.value)
    try:
        number = float(re.sub(r"(?<=[\d.])[dD](?=[+-]?\d)", "e", text))
    except ValueError:
        remedy = (
            f"; a decimal comma is not a number here, write {text.replace(',', '.')}" if "," in text else ""
        )
        raise TirError(
            f'{line.key} is "{text}", and a number was expected{remedy}',
            path=path,
            line=line.number,
            name=line.key,
        ) from None
    if not math.isfinite(number):
        raise TirError(
            f"{line.key} is {text}, which no formula can use: give a number", path=path, line=line.number
        )
    return number * factor(row.unit, words)


def _refuse_other_versions(values, extra, document: Document) -> None:
    version = values.get("FITTYP")
    form = str(values.get("PROPERTY_FILE_FORMAT", "")).upper()
    old = version is None and form in OLD_FORMATS
    if old or version in OLD_FITTYPS:
        name = f"FITTYP {version:g}" if version is not None else f"PROPERTY_FILE_FORMAT '{form}'"
        raise TirError(
            f"is an MF 5.2 file ({name}); its coefficients mean something else in MF 6.2, so it cannot be renamed: fit "
            "the tyre's data anew, or name an MF 6.1 or 6.2 file",
            path=document.path,
        )
    if version is not None and version not in (60, 61, 62):
        raise TirError(f"has FITTYP {version:g}, and only 61 and 62 are known here", path=document.path)


def _refuse_truncated(values, document: Document) -> None:
    missing = [name for name in ESSENTIAL if name not in values]
    if missing:
        raise TirError(
            f"lacks {' and '.join(missing)}, without which no force can be computed: the file is cut short or is no tyre",
            path=document.path,
        )
    if not any(name in values for name in ESSENTIAL_COEFFICIENTS):
        raise TirError(
            "has none of PCY1, PDY1, PKY1: the coefficients are missing, so the file is cut short",
            path=document.path,
        )


def _about_missing(values) -> list[Problem]:
    out = []
    version = values.get("FITTYP")
    if version is None:
        out.append(Problem("warning", "FITTYP is missing; the file is read as MF 6.2", "FITTYP"))
    elif version == 60:
        out.append(Problem("warning", "FITTYP 60 is read as MF 6.1", "FITTYP"))
    old = version in (60, 61)
    missing = [row.name for row in TABLE if row.name not in values and row.files in ("", "" if old else "62")]
    if missing:
        shown = ", ".join(missing[:6]) + (f" and {len(missing) - 6} more" if len(missing) > 6 else "")
        mf = "6.1" if old else "6.2"
        out.append(
            Problem("warning", f"{len(missing)} keys of MF {mf} are missing and take their defaults: {shown}")
        )
    return out


def _about_unknown(extra) -> list[Problem]:
    names = [key for key in extra if not key.startswith(("SHAPE.", "MDI_HEADER."))]
    if not names:
        return []
    shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
    return [
        Problem("warning", f"{len(names)} keys are no MF 6.2 parameters and are kept but not used: {shown}")
    ]


def _structured_comments(document: Document) -> tuple[dict[str, Quantity], dict[str, str]]:
    measured, provenance = {}, {}
    for line in document.lines:
        found = MEASURED.match(line.text)
        if found:
            name, value, u, unit = found.groups()
            measured[name] = Quantity(float(value), float(u), unit)
        found = PROVENANCE.match(line.text)
        if found:
            provenance[found.group(1).strip()] = found.group(2)
    return measured, provenance


def render(tyre: Tyre) -> str:
    """The complete file as text: every key in the order of the table, ASCII, CRLF.

    Raises
    ------
    TirError
        If a value is not finite.
    """
    lines = [
        "[MDI_HEADER]",
        _entry("FILE_TYPE", "'tir'"),
        _entry("FILE_VERSION", "3.0"),
        _entry("FILE_FORMAT", "'ASCII'"),
    ]
    lines += [f"! provenance: {_comment(key)}: {_comment(text)}" for key, text in tyre.provenance.items()]
    lines += [
        f"! measured: {_escaped(name)} {q.value!r} u {q.u!r} {_escaped(q.unit) or '-'}"
        for name, q in tyre.measured.items()
    ]
    lines += ["$" + "-" * 60 + "units", "[UNITS]", *(_entry(kind, f"'{word}'") for kind, word in SI.items())]
    for section in SECTIONS:
        lines += ["$" + "-" * 60 + section.lower(), f"[{section}]"]
        rows = [row for row in TABLE if row.section == section and _written(row, tyre)]
        lines += [_entry(row.name, _text(row, tyre[row.name]), _remark(row, tyre)) for row in rows]
        lines += _foreign_entries(section, tyre)
    others = dict.fromkeys(key.partition(".")[0] for key in tyre.extra)
    for section in (name for name in others if name and name not in SECTIONS):
        lines += ["$" + "-" * 60, f"[{_foreign_key(section)}]", *_foreign_entries(section, tyre)]
    return "\r\n".join(lines) + "\r\n"


def write(tyre: Tyre, path: str | Path) -> None:
    """Write :func:`render`'s text; the file at ``path`` is replaced only once the new one is complete."""
    path, text = Path(path), render(tyre)
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(handle, "w", encoding="ascii", newline="") as stream:
            stream.write(text)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise


def _written(row: Parameter, tyre: Tyre) -> bool:
    """Whether the key goes into a file: one that no common program knows only if it matters."""
    return row.files != "rare" or tyre[row.name] != row.default


def _entry(key: str, value: str, comment: str = "") -> str:
    line = f"{key:<24} = {value}"
    return f"{line:<50} ${_comment(comment)}"[:118] if comment else line


def _foreign_entries(section: str, tyre: Tyre) -> list[str]:
    """Keys that MF 6.2 does not know, as they stood; those before any section join the first."""
    homes = (section, "") if section == SECTIONS[0] else (section,)
    return [
        _entry(_foreign_key(key), _escaped(value))
        for place, value in tyre.extra.items()
        for home, _, key in [place.partition(".")]
        if home in homes
    ]


def _text(row: Parameter, value: Any) -> str:
    if row.kind == "text":
        return f"'{_comment(str(value))}'"
    number = float(value)
    if not math.isfinite(number):
        raise TirError(f"{row.name} is {number}, and a file can only hold numbers", name=row.name)
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def _remark(row: Parameter, tyre: Tyre) -> str:
    return tyre.status.get(row.name) or row.description


def _comment(text: str) -> str:
    """Text that no reader can mistake for a key: ASCII, without equals signs, semicolons and exclamation marks."""
    signs: dict[str, str | int | None] = {
        "=": ":",
        ";": ",",
        "!": ".",
        "$": " ",
        "\n": " ",
        "\r": " ",
        "\t": " ",
    }
    text = text.translate(str.maketrans(signs))
    return text.encode("ascii", "replace").decode()


def _escaped(text: str) -> str:
    """Text of another program as it stood, with signs beyond ASCII as ``\\xfc``."""
    return text.encode("ascii", "backslashreplace").decode()


def _foreign_key(key: str) -> str:
    """A key that a reader still takes for one: ``_XFC`` for a sign beyond ASCII."""
    return _escaped(key).replace("\\", "_").upper()


def _unquoted(text: str) -> str:
    text = text.strip()
    return (
        text[1:-1].strip()
        if len(text) >= 2 and text[0] == text[-1] and text[0] in "'\""
        else text.strip("'\"")
    )


def _warning(sentence: str, line: Line) -> Problem:
    return Problem("warning", f"line {line.number}: {sentence}", line.key, line.number)
