"""Line numbers of the keys of a TOML text."""

from __future__ import annotations

import re

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
