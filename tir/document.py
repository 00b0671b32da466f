"""Property-file text as lines: sections, keys and comments, with their places; knows no key's meaning."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from tir.errors import TirError

SECTION = re.compile(r"^\[([^\]]*)\]")
ENTRY = re.compile(r"^([A-Za-z_][\w.\- ]*?)\s*=\s*(.*)$")
QUOTED = re.compile(r"'([^']*)'|\"([^\"]*)\"")


@dataclass(frozen=True, slots=True)
class Line:
    """One line of the file; a key, a section head, or neither."""

    number: int  #: from 1
    text: str  #: without the line end
    section: str = ""  #: section in force, upper case
    key: str = ""  #: upper case; "" if the line holds none
    value: str = ""  #: without comment and blanks; quotes kept
    comment: str = ""


@dataclass(frozen=True, slots=True)
class Document:
    """A whole file: its lines as read, and what is needed to write it back."""

    lines: tuple[Line, ...]
    encoding: str
    path: str

    @property
    def entries(self) -> tuple[Line, ...]:
        """Lines that hold a key."""
        return tuple(line for line in self.lines if line.key)


def read_document(path: str | Path) -> Document:
    """Read a file of any of the usual encodings and line ends.

    Raises
    ------
    TirError
        If the file is missing, empty, or not text.
    """
    path = Path(path)
    try:
        raw = path.read_bytes()
    except OSError as error:
        raise TirError(
            f"cannot be read ({(error.strerror or 'error').lower()}): check the path", path=path
        ) from error
    text, encoding = _decode(raw, path)
    return parse_document(text, encoding=encoding, path=str(path))


def parse_document(text: str, *, encoding: str = "ascii", path: str = "") -> Document:
    """Cut text into lines and recognise sections, keys and comments."""
    lines, section, table = [], "", False
    for number, content in enumerate(re.split(r"\r\n|\r|\n", text), start=1):
        stripped = content.strip()
        head = SECTION.match(stripped)
        if head:
            section, table = head.group(1).strip().upper(), False
            lines.append(Line(number, content, section))
            continue
        if stripped.startswith("{"):
            table = True
        entry = None if table or not stripped or stripped[0] in "$!({" else ENTRY.match(stripped)
        if entry is None:
            lines.append(Line(number, content, section))
            continue
        value, comment = split_comment(entry.group(2))
        lines.append(Line(number, content, section, entry.group(1).strip().upper(), value, comment))
    return Document(tuple(lines), encoding, path)


def split_comment(text: str) -> tuple[str, str]:
    """Value and comment of what stands behind the equals sign; quotes protect comment signs."""
    quoted = QUOTED.match(text.strip())
    if quoted:
        rest = text.strip()[quoted.end() :]
        return quoted.group(0), rest.strip().lstrip("$!").strip()
    cut = min((i for i in (text.find("$"), text.find("!")) if i >= 0), default=len(text))
    return text[:cut].strip(), text[cut:].strip().lstrip("$!").strip()


def _decode(raw: bytes, path: Path) -> tuple[str, str]:
    if not raw.strip():
        raise TirError("is empty: a property file was expected", path=path)
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff") or b"\x00" in raw[:200]:
        raise TirError("is UTF-16 or binary: save it as plain text (ASCII or UTF-8)", path=path)
    for encoding in ("utf-8-sig", "latin-1"):
        try:
            return raw.decode(encoding), encoding
        except UnicodeDecodeError:
            continue
    raise AssertionError("latin-1 decodes every byte")
