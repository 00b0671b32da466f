"""Writing property files: the file's own text with its changes, or a new file for a program.

A new file has every key in the order of the table, in ASCII with CR LF, in a form that every program reads. In the text that a
tyre was read from, only the characters of changed values differ: keys that the tyre gives and the file lacks are added to their
section, and the comment of a key is replaced if the origin of its value has changed.
"""

import math
import os
import tempfile
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from tir.document import Document, FileLine, commented, folded, unquoted
from tir.errors import TirError
from tir.parameters import BY_NAME, SECTIONS, TABLE, Parameter
from tir.properties import ESSENTIAL, PROVENANCE, QUANTITY, described, parameter_of, units_of
from tir.record import TyreRecord
from tir.targets import DEFAULT, Target, target_of, use_mode_words, vendor
from tir.units import SI, factor


def render(tyre: TyreRecord, target: Target) -> str:
    """The complete file as text; the comment of a key marks a default. Raises TirError if a value is not finite."""
    lines = [
        "[MDI_HEADER]",
        entry("FILE_TYPE", "'tir'"),
        entry("FILE_VERSION", "3.0"),
        entry("FILE_FORMAT", "'ASCII'"),
        *structured_comments(tyre),
        "$" + "-" * 60 + "units",
        "[UNITS]",
        *(entry(kind, f"'{word}'") for kind, word in SI.items()),
    ]
    for section in SECTIONS:
        lines += ["$" + "-" * 60 + section.lower(), f"[{section}]"]
        rows = [row for row in TABLE if row.section == section and _written(row, tyre, target)]
        lines += [
            entry(row.name, value_text(row, _value(row, tyre, target)), remark(row, tyre)) for row in rows
        ]
        if section == "MODEL":
            lines += [entry(key, text or vendor(tyre["USE_MODE"])) for key, text in target.more.items()]
    return "\r\n".join(lines) + "\r\n"


def _written(row: Parameter, tyre: TyreRecord, target: Target) -> bool:
    """Whether a key is written; one that common programs do not know only if it differs from its default."""
    if row.files == "62" and _value(BY_NAME["FITTYP"], tyre, target) < 62:
        return False
    return row.name not in target.without and (row.files != "rare" or tyre[row.name] != row.default)


def _value(row: Parameter, tyre: TyreRecord, target: Target) -> Any:
    if row.name == "FITTYP":
        given = tyre["FITTYP"]
        return given if given in target.fittyps and row.name in tyre.present else target.fittyps[0]
    return target.values.get(row.name, tyre[row.name])


def structured_comments(tyre: TyreRecord) -> Iterator[str]:
    """Provenance, measured and fitted quantities as comment lines that ``tir.read`` understands."""
    for key, text in tyre.provenance.items():
        yield from folded(f"! provenance: {comment_text(key)}: {comment_text(text)}")
    for name, q in tyre.measured.items():
        unit = q.unit.encode("ascii", "backslashreplace").decode()
        yield from folded(f"! {q.origin}: {comment_text(name)} {q.value!r} u {q.u!r} {unit or '-'}")


def entry(key: str, value: str, comment: str = "") -> str:
    """One line with a key."""
    line = f"{key:<24} = {value}"
    return commented(f"{line:<50}", comment_text(comment)) if comment else line


def value_text(row: Parameter, value: Any) -> str:
    """The value as text in SI; it reads back as the same value. Raises TirError if a number is not finite."""
    if row.kind == "text":
        text = comment_text(str(value))
        if "'" not in text:
            return f"'{text}'"
        return '"' + text.replace('"', "'") + '"'  # a file cannot hold both kinds of quotes
    number = float(value)
    if not math.isfinite(number):
        raise TirError(
            f"{row.name} is {number}, but a file can only hold finite numbers; change it", name=row.name
        )
    return str(int(number)) if number.is_integer() and abs(number) < 1e15 else repr(number)


def remark(row: Parameter, tyre: TyreRecord) -> str:
    """The comment of a key: the origin of its value, else its description."""
    if row.name in tyre.status:
        return tyre.status[row.name]
    if row.name not in tyre.present:
        return f"default, not measured: {row.description}"
    return use_mode_words(tyre["USE_MODE"]) if row.name == "USE_MODE" else row.description


SIGNS: dict[str, str | int | None] = {
    "=": ":", ";": ",", "!": ".", "$": " ", "\n": " ", "\r": " ", "\t": " ",
}  # fmt: skip


def comment_text(text: str) -> str:
    """Text that no reader can mistake for a key: ASCII, without equals signs, semicolons and exclamation marks."""
    return text.translate(str.maketrans(SIGNS)).encode("ascii", "replace").decode()


def merged(tyre: TyreRecord, document: Document) -> Document:
    """The document with the values, origins, measured quantities and provenance of the tyre.

    Raises TirError if a changed value is not finite.
    """
    lines = {line.key: line for line in reversed(document.entries) if parameter_of(line) is not None}
    given_on_reading = {name: tyre[name] for name in ESSENTIAL if name not in lines}
    before, words = described(TyreRecord, document, given_on_reading), units_of(document, [])
    added = [row for row in TABLE if row.name not in lines and row.name in tyre.present]
    changed = {}
    for row in (row for row in TABLE if row.name in lines):
        line = lines[row.name]
        given = row.name in before.present or row.name in tyre.present
        new = line
        if given and (row.name not in before.present or tyre[row.name] != before[row.name]):
            new = new.with_value(_text(row, tyre[row.name], words, line))
        if tyre.status.get(row.name) != before.status.get(row.name):
            new = new.with_comment(comment_text(remark(row, tyre)))
        if new is not line:
            changed[line.number] = new
    document = document.changed(changed)
    if added:
        document = document.inserted(_places(document, added, lines, tyre, words))
    if tyre.measured != before.measured or tyre.provenance != before.provenance:
        document = _with_structured_comments(document, tyre)
    return document


def _text(row: Parameter, value: Any, words: dict[str, str], line: FileLine | None = None) -> str:
    """The value as text, in the file's units and with the quotes of the line."""
    if row.kind == "text":
        text = value_text(row, value)
        quoted = line is None or not line.value or line.value[0] in "'\""
        return text.replace("'", line.value[0] if line and line.value else "'") if quoted else unquoted(text)
    value_text(row, value)  # raises if the value is not finite
    wanted, size = float(value), factor(row.unit, words)
    found = wanted / size
    near = (found, math.nextafter(found, -math.inf), math.nextafter(found, math.inf))
    return value_text(row, next((x for x in near if x * size == wanted), found))


def _places(
    document: Document,
    rows: list[Parameter],
    lines: dict[str, FileLine],
    tyre: TyreRecord,
    words: dict[str, str],
) -> dict[int, list[str]]:
    """New lines, by the number of the line that each follows: that of the preceding key of the table."""
    heads = {line.section: line.number for line in reversed(document.lines) if line.head}
    last = document.lines[-1].number
    if not document.lines[-1].text:
        last -= 1
    texts: dict[int, list[str]] = defaultdict(list)
    for section in SECTIONS:
        new = [row for row in rows if row.section == section]
        if not new:
            continue
        if section not in heads:
            texts[last] += [f"[{section}]"]
        for row in new:
            above = [
                lines[other.name].number
                for other in TABLE
                if other.section == section
                and other.order < row.order
                and other.name in lines
                and lines[other.name].section == section
            ]
            place = above[-1] if above else heads.get(section, last)
            texts[place].append(entry(row.name, _text(row, tyre[row.name], words), remark(row, tyre)))
    return dict(texts)


def _with_structured_comments(document: Document, tyre: TyreRecord) -> Document:
    old = [
        number
        for numbers, text in document.comments
        if QUANTITY.match(text) or PROVENANCE.match(text)
        for number in numbers
    ]
    place = max((line.number for line in document.entries if line.section == "MDI_HEADER"), default=0)
    return document.without(old).inserted({place: list(structured_comments(tyre))})


def content(tyre: TyreRecord, target: str | None = None) -> tuple[str, str]:
    """Text and encoding of the tyre's file; see :meth:`tir.Tyre.text`. A correction is not written, with a warning."""
    tyre.leave_correction("a property file")
    if target is None and tyre.document is not None:
        document = merged(tyre, tyre.document)
        return document.text, document.encoding
    chosen = target_of(target or DEFAULT)
    if target is None:  # without a named program, keys of other programs that were given are kept
        own = {row.name for row in TABLE if tyre[row.name] != row.default}
        chosen = replace(chosen, without=tuple(name for name in chosen.without if name not in own))
    return render(tyre, chosen), "ascii"


def replace_file(path: Path, content: bytes) -> None:
    """Write a file in one step: the one at ``path`` is replaced only once the new one is complete."""
    handle, temporary = tempfile.mkstemp(prefix=f".{path.name}-", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            stream.write(content)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
