"""Content of a TOML file and the line of each key; the keys themselves are not interpreted here."""

import re
import sys
import tomllib
from collections.abc import Callable, Collection, Mapping
from pathlib import Path
from typing import NamedTuple

import tomli_w

from mffit.config.quantities import TOO_MANY_DIGITS
from mffit.errors import InputError, readable

HEADER = re.compile(r"\s*(\[\[?)(.+?)\]\]?\s*(?:#.*)?$")
KEY = re.compile(r"""\s*((?:[\w-]+|"[^"]*"|'[^']*')(?:\s*\.\s*(?:[\w-]+|"[^"]*"|'[^']*'))*)\s*=""")
QUOTED = re.compile(r'"(?:\\.|[^"\\])*"|\'[^\']*\'|#.*')


def lines_of_keys(text: str) -> dict[str, int]:
    """Line, from 1, of every key and table of a valid TOML text, by dotted name.

    Entries of an array of tables are numbered from 0: ``sweep.0.file``. Keys of an inline table are not listed.
    """
    found: dict[str, int] = {}
    count: dict[str, int] = {}
    table, depth, fence = "", 0, ""
    for number, line in enumerate(text.splitlines(), start=1):
        if not fence and depth == 0:
            header, key = HEADER.match(line), KEY.match(line)
            if key:
                found.setdefault(_joined(table, _dotted(key[1])), number)
            elif header:
                table = _numbered(_dotted(header[2]), count, header[1] == "[[")
                found.setdefault(table, number)
        fence, depth = _after(line, fence, depth)
    return found


def toml_text(content: Mapping[str, object]) -> str:
    """Tables as a person writes them: a list of tables is one ``[[table]]`` per entry."""
    parts = []
    for name, table in content.items():
        if isinstance(table, list | tuple):
            entries = (tomli_w.dumps({name: entry}).removeprefix(f"[{name}]\n") for entry in table)
            parts += [f"[[{name}]]\n{entry}" for entry in entries]
        else:
            parts.append(tomli_w.dumps({name: table}))
    return "\n".join(parts)


def line_of(key: str, lines: dict[str, int]) -> int | None:
    """Line of a dotted key, else of the table around it; ``[table]`` may be written for the first ``[[table]]``."""
    while key:
        for candidate in (key, key.replace(".0", "", 1)):
            if candidate in lines:
                return lines[candidate]
        key = key.rpartition(".")[0]
    return None


def _dotted(name: str) -> str:
    return ".".join(part.strip().strip("\"'") for part in name.split("."))


def _joined(table: str, key: str) -> str:
    return f"{table}.{key}" if table else key


def _numbered(name: str, count: dict[str, int], is_array: bool) -> str:
    """The table's name with the current number of every array of tables in it."""
    path = ""
    parts = name.split(".")
    for depth, part in enumerate(parts):
        path = _joined(path, part)
        if is_array and depth == len(parts) - 1:
            count[path] = count.get(path, -1) + 1
        if path in count:
            path = f"{path}.{count[path]}"
    return path


def _after(line: str, fence: str, depth: int) -> tuple[str, int]:
    """State after a line: the open multi-line quotation mark, "" without one, and the number of open brackets."""
    while True:
        if fence:
            end = line.find(fence)
            if end < 0:
                return fence, depth
            line, fence = line[end + 3 :], ""
        start = re.search(r'"""|\'\'\'', line)
        plain = line[: start.start()] if start else line
        if "=" in plain or depth:
            value = QUOTED.sub("", plain.partition("=")[2] if depth == 0 else plain)
            depth += value.count("[") + value.count("{") - value.count("]") - value.count("}")
        if start is None:
            return "", depth
        fence, line = start[0], line[start.end() :]


PROPERTY_FILE = re.compile(r"^\s*\[(MDI_HEADER|\w+_COEFFICIENTS)\]", re.MULTILINE)
"""A section that only property files have."""
LONG_NUMBER = re.compile(rf"\d[\d_]{{{sys.int_info.default_max_str_digits},}}")
DECIMAL_COMMA = re.compile(r"=\s*([-+]?\d+),(\d+)\s*(#|$)")


class TomlKind(NamedTuple):
    """Kind of TOML file that a command expects, with the hints for a message about any other file."""

    name: str  #: usual name, ``tyre.toml``
    tables: Collection[str]  #: that such a file may have
    example: str  #: how to get one to start from
    base: str  #: how such a file names a property file
    otherwise: Callable[[Path], str]  #: what to do with a file that is neither TOML nor a property file


def read_toml(path: Path, kind: TomlKind) -> tuple[dict[str, object], dict[str, int]]:
    """Content of a TOML file, and the line of every key (see :func:`lines_of_keys`).

    Raises InputError if the file cannot be read, is not UTF-8 text or not valid TOML, or is evidently a file of another kind.
    """
    return tables_of(_bytes(path, kind), path, kind)


def tables_of(content: bytes, path: Path, kind: TomlKind) -> tuple[dict[str, object], dict[str, int]]:
    """As :func:`read_toml`, of bytes that the file ``path`` has or may get."""
    is_toml = path.name.lower().endswith(".toml")
    try:
        text = content.decode("utf-8-sig")
        tables = tomllib.loads(text)
    except UnicodeDecodeError:
        if not is_toml:
            raise _other_file(path, kind) from None
        raise InputError("is not UTF-8 text; save it as UTF-8", file=path) from None
    except tomllib.TOMLDecodeError as error:
        if PROPERTY_FILE.search(text):
            raise _property_file(path, kind) from None
        if not is_toml:
            raise _other_file(path, kind) from None
        raise _syntax_error(error, path, text) from None
    except ValueError:  # Python reads no longer whole number
        found = LONG_NUMBER.search(text)
        if found is None:
            raise
        line = 1 + text.count("\n", 0, found.start())
        key = next((name for name, at in lines_of_keys(text).items() if at == line), None)
        raise InputError(TOO_MANY_DIGITS, file=path, line=line, key=key) from None
    if not is_toml and tables.keys().isdisjoint(kind.tables):
        raise _other_file(path, kind)
    return tables, lines_of_keys(text)


def _bytes(path: Path, kind: TomlKind) -> bytes:
    missing = f"there is no such file; {kind.example} writes one to start from"
    with readable(path, missing=missing, folder=f"is a folder; give the {kind.name} in it"):
        return path.read_bytes()


def _other_file(path: Path, kind: TomlKind) -> InputError:
    if path.name.lower().endswith(".tir"):
        return _property_file(path, kind)
    return InputError(f"is not a {kind.name}; {kind.otherwise(path)}", file=path)


def _property_file(path: Path, kind: TomlKind) -> InputError:
    return InputError(f"is a property file, not a {kind.name}: {kind.base}", file=path)


def _syntax_error(error: tomllib.TOMLDecodeError, path: Path, text: str) -> InputError:
    message = str(error)
    place = re.search(r"\(at line (\d+), column (\d+)\)", message)
    line = int(place[1]) if place else max(len(text.splitlines()), 1)
    reason = message.partition(" (at ")[0]
    twice = re.fullmatch(r"Cannot declare \((.*?),?\) twice", reason)
    if twice:
        table = ".".join(re.findall("'([^']*)'", twice[1]))
        sentence = f"has the table [{table}] twice; write all its keys under one [{table}]"
        return InputError(sentence, file=path, line=line)
    lines = text.splitlines()
    comma = DECIMAL_COMMA.search(lines[line - 1]) if line <= len(lines) else None
    remedy = f"write the number with a decimal point, {comma[1]}.{comma[2]}" if comma else "correct this line"
    return InputError(f"is not valid TOML ({reason[:1].lower()}{reason[1:]}); {remedy}", file=path, line=line)
