"""A new property file: every key in the order of the table, ASCII, CR LF, in a form that every program reads."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

from tir.document import commented, folded
from tir.errors import TirError
from tir.parameters import BY_NAME, SECTIONS, TABLE, Parameter
from tir.record import TyreRecord
from tir.targets import Target, use_mode_words, vendor
from tir.units import SI


def render(tyre: TyreRecord, target: Target) -> str:
    """The complete file as text; the comment of a key marks a default.

    Raises
    ------
    TirError
        If a value is not finite.
    """
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
    """Provenance and measured quantities as comment lines that ``tir.read`` understands."""
    for key, text in tyre.provenance.items():
        yield from folded(f"! provenance: {comment_text(key)}: {comment_text(text)}")
    for name, q in tyre.measured.items():
        unit = q.unit.encode("ascii", "backslashreplace").decode()
        yield from folded(f"! measured: {comment_text(name)} {q.value!r} u {q.u!r} {unit or '-'}")


def entry(key: str, value: str, comment: str = "") -> str:
    """One line with a key."""
    line = f"{key:<24} = {value}"
    return commented(f"{line:<50}", comment_text(comment)) if comment else line


def value_text(row: Parameter, value: Any) -> str:
    """The value as text in SI; it reads back as the same value.

    Raises
    ------
    TirError
        If a number is not finite.
    """
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
