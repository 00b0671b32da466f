"""Property-file text as lines, byte for byte: sections, keys and comments with their places, but not their meaning."""

from __future__ import annotations

import codecs
import os
import re
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from tir.constants import LONGEST_WRITTEN_LINE
from tir.errors import TirError

SECTION = re.compile(r"^\s*\[([^\]]*)\]")
ENTRY = re.compile(r"^(\s*)([A-Za-z_][\w.\- ]*?)(\s*=[^\S\r\n]*)(.*)$", re.DOTALL)
QUOTED = re.compile(r"'([^']*)'|\"([^\"]*)\"")
LINE_END = re.compile(r"(\r\n|\r|\n)")
NUMBER = re.compile(
    r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[edED][+-]?\d+)?|[+-]?(?:inf|infinity|nan)", re.ASCII | re.IGNORECASE
)
"""Numbers as files have them, with Fortran's exponents. Python's ``float`` alone would accept 1_5 as 15."""
KEY_ALONE = re.compile(r"\s*([A-Za-z_]\w*)\s*(?:=\s*)?")
VALUE_ALONE = re.compile(r"(\s*=?[^\S\r\n]*)(.*)", re.DOTALL)
CONTINUED = "!>"
"""Start of a line that continues the comment line above."""
BYTE_ORDER_MARKS = {"utf-16-le": codecs.BOM_UTF16_LE, "utf-16-be": codecs.BOM_UTF16_BE}
"""Byte order mark of each encoding that has one."""
NO_TEXT = {
    b"MATLAB 5.0": "a MATLAB file",
    b"\x89HDF": "a MATLAB 7.3 or other HDF5 file",
    b"PK\x03\x04": "an Excel workbook or another zip archive",
    b"\xd0\xcf\x11\xe0": "an Excel workbook of the old kind",
    b"\x1f\x8b": "a compressed file",
    b"%PDF": "a PDF",
}
"""Other kinds of file by their first bytes."""
NOT_THE_FILE = {
    b"<!doctype": "a web page about the file: download the file itself, such as by Raw on its page",
    b"<html": "a web page about the file: download the file itself, such as by Raw on its page",
    b"version https://git-lfs": "a pointer of Git LFS: fetch the file itself by git lfs pull",
}
"""Placeholders of files that were not downloaded, by their first bytes in lower case, and the remedy."""
AS_TEXT = (
    "write each coefficient on a line of its own, such as PCY1 = 1.3, with UNLOADED_RADIUS and FNOMIN, and FITTYP = 62 for MF "
    "6.2; or in Python tir.Tyre.from_values({'PCY1': 1.3, ...}).write('tyre.tir')"
)
"""The remedy for coefficients that are not in a property file."""


@dataclass(frozen=True, slots=True)
class FileLine:
    """One line of the file; a key, a section head, or neither."""

    number: int  #: from 1
    text: str  #: without the line end
    section: str = ""  #: section that holds the line, upper case
    key: str = ""  #: upper case; "" if the line holds none
    value: str = ""  #: without comment and surrounding blanks, with quotes
    comment: str = ""
    end: str = ""  #: the line end; "" behind the last line
    start: int = 0  #: column at which the value begins

    @property
    def head(self) -> bool:
        """Whether the line opens a section."""
        return not self.key and SECTION.match(self.text) is not None

    @property
    def apart(self) -> bool:
        """Whether the key is on a line above, alone."""
        return bool(self.key) and ENTRY.match(self.text) is None

    def with_value(self, value: str) -> FileLine:
        """The line with another value and all other characters unchanged."""
        if value == self.value:
            return self
        rest = self.text[self.start + len(self.value) :]
        if not self.value and rest.strip():
            value += " "  # a comment may follow a missing value at once
        text = self.text[: self.start] + value + rest
        return replace(self, text=text, value=value)

    def with_comment(self, comment: str) -> FileLine:
        """The line with another comment behind the value."""
        before = self.text[: self.start + len(self.value)]
        text = commented(f"{before:<49}", comment)
        return replace(self, text=text, comment=text[len(before) :].strip(" $"))


@dataclass(frozen=True, slots=True, repr=False)
class Document:
    """A whole file: its lines as read, its encoding and its path."""

    lines: tuple[FileLine, ...]
    encoding: str
    path: str

    def __repr__(self) -> str:
        return f"<Document {self.path!r}: {len(self.lines)} lines, {self.encoding}>"

    @property
    def entries(self) -> tuple[FileLine, ...]:
        """Lines that hold a key."""
        return tuple(line for line in self.lines if line.key)

    @property
    def comments(self) -> Iterator[tuple[list[int], str]]:
        """Lines without a key, each with those that continue it: their numbers, and the whole text."""
        numbers: list[int] = []
        whole = ""
        for line in self.lines:
            if numbers and line.text.startswith(CONTINUED):
                numbers.append(line.number)
                whole += line.text[len(CONTINUED) :]
                continue
            if numbers:
                yield numbers, whole
            numbers, whole = ([], "") if line.key else ([line.number], line.text)
        if numbers:
            yield numbers, whole

    @property
    def text(self) -> str:
        """The whole text of the file, with its own line ends."""
        return "".join(line.text + line.end for line in self.lines)

    @property
    def line_end(self) -> str:
        """The most frequent line end; CR LF if there is none."""
        known = Counter(line.end for line in self.lines if line.end)
        return known.most_common(1)[0][0] if known else "\r\n"

    def changed(self, lines: dict[int, FileLine]) -> Document:
        """The document with some lines replaced, by line number."""
        return replace(self, lines=tuple(lines.get(line.number, line) for line in self.lines))

    def without(self, numbers: Iterable[int]) -> Document:
        """The document without the lines of these numbers; the others keep their numbers."""
        gone = set(numbers)
        return replace(self, lines=tuple(line for line in self.lines if line.number not in gone))

    def inserted(self, texts: dict[int, list[str]]) -> Document:
        """The document with new lines after those of these numbers (0: before the first), renumbered."""
        end, out = self.line_end, [text + self.line_end for text in texts.get(0, [])]
        for line in self.lines:
            out.append(line.text + line.end)
            new = texts.get(line.number, [])
            if new:
                if not line.end and line.text:
                    out[-1] += end
                out += [text + end for text in new]
        return parse_document("".join(out), encoding=self.encoding, path=self.path)


def commented(line: str, comment: str) -> str:
    """The line with a comment behind it, which is cut where readers may stop; the line itself is not."""
    return f"{line} ${comment}"[: max(LONGEST_WRITTEN_LINE, len(line))].rstrip()


def folded(line: str) -> list[str]:
    """A comment line as lines that every reader takes; those behind the first begin with :data:`CONTINUED`."""
    out = []
    while len(line) > LONGEST_WRITTEN_LINE:
        at = line.rfind(" ", len(CONTINUED) + 1, LONGEST_WRITTEN_LINE + 1)
        at = at if at > 0 else LONGEST_WRITTEN_LINE
        out.append(line[:at])
        line = CONTINUED + line[at:]
    return [*out, line]


def read_document(path: str | Path) -> Document:
    """The document read from a file in any usual encoding and with any line ends.

    Raises TirError if the file is missing, empty, or not text.
    """
    path = Path(path)
    try:
        raw = _pipe_content(path) if path.is_fifo() else path.read_bytes()
    except OSError as error:
        raise TirError(
            f"cannot be read ({(error.strerror or 'error').lower()}): check the path", path=path
        ) from error
    text, encoding = _decode(raw, path)
    return parse_document(text, encoding=encoding, path=str(path))


def _pipe_content(path: Path) -> bytes:
    """Content of a named pipe. Raises TirError if nothing writes to it, because opening it would block."""
    with os.fdopen(os.open(path, os.O_RDONLY | os.O_NONBLOCK), "rb") as stream:
        first = stream.raw.read(1)  # None: a program has opened it and has not written yet
        if first == b"":
            raise TirError("is a pipe into which no program writes: give a file", path=path)
        os.set_blocking(stream.fileno(), True)
        return (first or b"") + stream.read()


def parse_document(text: str, *, encoding: str = "ascii", path: str = "") -> Document:
    """The document of a text: lines with their sections, keys and comments."""
    pieces = LINE_END.split(text)
    lines, section, table = [], "", False
    for number, content in enumerate(pieces[::2], start=1):
        end = pieces[2 * number - 1] if 2 * number - 1 < len(pieces) else ""
        stripped = content.strip()
        head = SECTION.match(stripped)
        if head:
            section, table = head.group(1).strip().upper(), False
            lines.append(FileLine(number, content, section, end=end))
            continue
        if stripped.startswith("{"):
            table = True
        aside = table or not stripped or stripped[0] in "$!({"
        value_of = None if aside else _key_above(lines, content)
        if value_of is not None:
            lines[value_of[0]] = replace(lines[value_of[0]], key="", value="", comment="")
            lines.append(_value_below(FileLine(number, content, section, value_of[1], end=end)))
            continue
        entry = None if aside else ENTRY.match(content)
        if entry is None:
            lines.append(FileLine(number, content, section, end=end))
            continue
        value, comment = split_comment(entry.group(4))
        start = entry.start(4) + (len(entry.group(4)) - len(entry.group(4).lstrip()) if value else 0)
        lines.append(
            FileLine(number, content, section, entry.group(2).strip().upper(), value, comment, end, start)
        )
    return Document(tuple(lines), encoding, path)


def _key_above(lines: Sequence[FileLine], content: str) -> tuple[int, str] | None:
    """Index and key of the line above that holds a key alone, if ``content`` is its value: "= 4000", or "4000" below "FNOMIN =".

    None if the value belongs to no such line.
    """
    value = split_comment(content)[0]
    begun = value.startswith("=")
    if not begun and number_of(value) is None and not QUOTED.fullmatch(value):
        return None
    above = next((i for i in reversed(range(len(lines))) if lines[i].text.strip()), None)
    found = None if above is None else KEY_ALONE.fullmatch(lines[above].text)
    if above is None or found is None or ("=" in lines[above].text) == begun:
        return None
    return above, found.group(1).upper()


def _value_below(line: FileLine) -> FileLine:
    """The line that holds the value of a key above it, with value and comment."""
    found = VALUE_ALONE.fullmatch(line.text)
    assert found is not None
    value, comment = split_comment(found.group(2))
    return replace(line, value=value, comment=comment, start=found.end(1))


def split_comment(text: str) -> tuple[str, str]:
    """Value and comment from the text after the equals sign; comment signs within quotes belong to the value."""
    quoted = QUOTED.match(text.strip())
    if quoted:
        rest = text.strip()[quoted.end() :]
        return quoted.group(0), rest.strip().lstrip("$!").strip()
    cut = min((i for i in (text.find("$"), text.find("!")) if i >= 0), default=len(text))
    return text[:cut].strip(), text[cut:].strip().lstrip("$!").strip()


def unquoted(text: str) -> str:
    """The text without the quotes around it."""
    text = text.strip()
    whole = len(text) >= 2 and text[0] == text[-1] and text[0] in "'\""
    return text[1:-1].strip() if whole else text.strip("'\"")


def number_of(text: str) -> float | None:
    """The number that a text states, with Fortran's exponents too; None if it is not a number."""
    if not NUMBER.fullmatch(text):
        return None
    return float(re.sub(r"(?<=[\d.])[dD]", "e", text))


def encoded(text: str, encoding: str) -> bytes:
    """The bytes of a text, with the byte order mark of its encoding."""
    return BYTE_ORDER_MARKS.get(encoding, b"") + text.encode(encoding)


def _decode(raw: bytes, path: Path) -> tuple[str, str]:
    if not raw.strip():
        raise TirError("is empty: a property file was expected", path=path)
    for begins, what in NO_TEXT.items():
        if raw.startswith(begins):
            raise TirError(f"is {what}, not the text of a property file: {AS_TEXT}", path=path)
    for begins, what in NOT_THE_FILE.items():
        if raw[:200].lstrip().lower().startswith(begins):
            raise TirError(f"is {what}", path=path)
    for encoding, mark in BYTE_ORDER_MARKS.items():
        if raw.startswith(mark):
            try:
                return raw.removeprefix(mark).decode(encoding), encoding
            except UnicodeDecodeError:
                break
    if b"\x00" in raw[:200]:
        raise TirError(
            "is UTF-16 without a byte order mark, or binary: save it as plain text (ASCII or UTF-8)",
            path=path,
        )
    for encoding in ("utf-8-sig" if raw.startswith(codecs.BOM_UTF8) else "utf-8", "latin-1"):
        try:
            return raw.decode(encoding), encoding
        except UnicodeDecodeError:
            continue
    raise AssertionError("latin-1 decodes every byte")
