"""The text that a tyre was read from, with its changes: only the characters of changed values differ.

Keys that the tyre gives and the file lacks are added to their section. The comment of a key is replaced if the origin of its
value has changed.
"""

from __future__ import annotations

import math
from collections import defaultdict
from typing import Any

from tir.document import Document, FileLine
from tir.parameters import SECTIONS, TABLE, Parameter
from tir.properties import ESSENTIAL, MEASURED, PROVENANCE, described, parameter_of, units_of, unquoted
from tir.record import TyreRecord
from tir.rendering import comment_text, entry, remark, structured_comments, value_text
from tir.units import factor


def merged(tyre: TyreRecord, document: Document) -> Document:
    """The document with the values, origins, measured quantities and provenance of the tyre.

    Raises
    ------
    TirError
        If a changed value is not finite.
    """
    lines: dict[str, FileLine] = {}
    for line in document.entries:
        if parameter_of(line) is not None:
            lines.setdefault(line.key, line)
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
        if MEASURED.match(text) or PROVENANCE.match(text)
        for number in numbers
    ]
    header = [line.number for line in document.entries if line.section == "MDI_HEADER"]
    place = max(header, default=0)
    kept = document.without(old)
    return kept.inserted({place: list(structured_comments(tyre))})
