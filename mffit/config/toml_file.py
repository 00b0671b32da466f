"""TOML files as content and the line of every key; syntax only, no key has a meaning here."""

from __future__ import annotations

import re
import sys
import tomllib
from collections.abc import Callable, Collection
from pathlib import Path
from typing import NamedTuple

from mffit.config.locate import lines_of_keys
from mffit.config.quantities import TOO_MANY_DIGITS
from mffit.errors import InputError, readable

PROPERTY_FILE = re.compile(r"^\s*\[(MDI_HEADER|\w+_COEFFICIENTS)\]", re.MULTILINE)
"""A section that only property files have."""
LONG_NUMBER = re.compile(rf"\d[\d_]{{{sys.int_info.default_max_str_digits},}}")
DECIMAL_COMMA = re.compile(r"=\s*([-+]?\d+),(\d+)\s*(#|$)")


class TomlKind(NamedTuple):
    """A TOML file that a command asks for, and what a message says where it got something else."""

    name: str  #: usual name, ``tyre.toml``
    tables: Collection[str]  #: that such a file may have
    example: str  #: how to get one to start from
    base: str  #: how such a file names a property file
    otherwise: Callable[[Path], str]  #: what to do with a file that is neither TOML nor a property file


def read_toml(path: Path, kind: TomlKind) -> tuple[dict[str, object], dict[str, int]]:
    """Content of a TOML file, and the line of every key (see :func:`lines_of_keys`).

    Raises
    ------
    InputError
        The file cannot be read, is not UTF-8 text or not valid TOML, or is evidently a file of another kind.
    """
    is_toml = path.name.lower().endswith(".toml")
    try:
        text = _bytes(path, kind).decode("utf-8-sig")
        content = tomllib.loads(text)
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
    if not is_toml and content.keys().isdisjoint(kind.tables):
        raise _other_file(path, kind)
    return content, lines_of_keys(text)


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
    lines = text.splitlines()
    comma = DECIMAL_COMMA.search(lines[line - 1]) if line <= len(lines) else None
    remedy = f"write the number with a decimal point, {comma[1]}.{comma[2]}" if comma else "correct this line"
    return InputError(f"is not valid TOML ({reason[:1].lower()}{reason[1:]}); {remedy}", file=path, line=line)
