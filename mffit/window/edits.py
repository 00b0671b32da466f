"""Changes to the text of ``tyre.toml`` that keep its comments and its formatting; no file is touched here."""

import re
from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping, Sequence
from operator import itemgetter
from typing import Any

import tomlkit
from tomlkit.items import AoT, Array, Table

from mffit.config.by_hand import KEYS
from mffit.config.lines import LineListError, LineRange, line_ranges, ranges_text
from mffit.errors import InputError, shortened
from mffit.window.settings import TABLES, value_of

SINGLE_SWEEP = re.compile(r"^([ \t]*)\[[ \t]*sweep[ \t]*\]", re.MULTILINE)
LONE_NEWLINE = re.compile(r"(?<!\r)\n")


def coefficient(text: str, *, name: str, entry: float | Mapping[str, Any] | None) -> str:
    """The text of a file with another entry for a coefficient.

    ``entry`` is the number at which it is held, or numbers by key of :data:`mffit.config.by_hand.KEYS`, which replace what the
    file gave; None or no key removes it.
    """
    keys = entry if isinstance(entry, Mapping) else {}
    if unknown := [key for key in keys if key not in KEYS]:
        raise InputError(f'"{unknown[0]}" is not a key of a coefficient; known are {", ".join(KEYS)}')

    def change(document: Any) -> None:
        if entry is None or entry == {}:
            document.get("coefficients", {}).pop(name, None)
            return
        table = _table(document, "coefficients")
        if not keys:
            table[name] = entry
            return
        own = table.get(name)
        if not isinstance(own, Table):
            table[name] = own = tomlkit.inline_table()
        for key in KEYS:
            if key not in keys:
                own.pop(key, None)
            elif own.get(key) != keys[key]:
                own[key] = keys[key]

    return _edited(text, change)


def leave_out(text: str, *, readings: Sequence[Mapping[str, Any]], why: str) -> str:
    """The text with readings added to ``[fit] exclude``: of each ``file``, as in [[sweep]], the ``lines``, such as "39-44, 60".

    An entry of the same file and reason is extended.
    """

    return _edited(text, lambda document: _leave_out(document, readings, why))


def _leave_out(document: Any, readings: Sequence[Mapping[str, Any]], why: str) -> None:
    entries = _exclude(document)
    for file, ranges in _by_file(readings).items():
        out = sorted(part for e in entries if e["file"] == file for part in _ranges(e))
        kept = _without(ranges, line_ranges(ranges_text(out)) if out else ())
        if not kept:
            continue
        own = next((e for e in entries if e["file"] == file and e.get("why") == why), None)
        if own is not None:
            own["lines"] = _lines([*_ranges(own), *kept])
            continue
        entry = tomlkit.table() if isinstance(entries, AoT) else tomlkit.inline_table()
        entry.update({"file": file, "lines": _lines(kept), "why": why})
        entries.append(entry)


def take_back(text: str, *, readings: Sequence[Mapping[str, Any]]) -> str:
    """The text with readings removed from ``[fit] exclude``; an entry without lines goes, and so does an empty list."""

    def change(document: Any) -> None:
        entries, taken, gone = _exclude(document), _by_file(readings), set[int]()
        for k, entry in enumerate(entries):
            kept = _without(_ranges(entry), taken.get(entry["file"], ()))
            if not kept:
                gone.add(k)
            elif kept != list(_ranges(entry)):
                entry["lines"] = _lines(kept)
        if len(gone) == len(entries):
            del document["fit"]["exclude"]
        elif isinstance(entries, Array) and gone and "#" not in entries.as_string():
            # Deleted one by one, every entry would number all others anew.
            lines = [f"    {entry.as_string()},\n" for k, entry in enumerate(entries) if k not in gone]
            document["fit"]["exclude"] = tomlkit.array(f"[\n{''.join(lines)}]")
        else:
            for k in sorted(gone, reverse=True):  # those before it keep their numbers
                del entries[k]

    return _edited(text, change)


def setting(text: str, *, table: str, key: str, value: str, file: str = "") -> str:
    """The text with another value, in the notation of TOML, of a key; "" removes it. ``file`` is that of table "sweep"."""

    def change(document: Any) -> None:
        if table not in TABLES and table != "sweep":
            raise InputError(f"[{shortened(table)}] has no settings here")
        own = _sweep(document, file) if table == "sweep" else _table(document, table)
        if value == "":
            own.pop(key, None)
        else:
            own[key] = value_of(value)

    return _edited(text, change)


def _sweep(document: Any, file: str) -> Any:
    """The [[sweep]] of a file."""
    sweeps = document.get("sweep", [])
    found = [sweep for sweep in ([sweeps] if isinstance(sweeps, Table) else sweeps) if sweep["file"] == file]
    if not found:
        raise InputError(f'no [[sweep]] has file = "{shortened(file)}"; load this page again')
    return found[0]


def add_recordings(text: str, *, sweeps: str, bad: Sequence[Mapping[str, Any]] = ()) -> str:
    """The text with further recordings: their [[sweep]] as TOML, added to a list ``sweep = [...]`` where the file has one.

    ``bad`` are readings among them to leave out, as in :func:`leave_out`, each with its ``why``.
    """

    is_list = isinstance(tomlkit.parse(text).get("sweep"), Array)
    if not is_list:
        text = _whole(SINGLE_SWEEP.sub(r"\1[[sweep]]", text))
        end = "\r\n" if "\r\n" in text else "\n"
        text += end + sweeps.replace("\n", end)

    def change(document: Any) -> None:
        for entry in tomlkit.parse(sweeps).unwrap()["sweep"] if is_list else ():
            table = tomlkit.inline_table()
            table.update(entry)
            document["sweep"].append(table)
        for one in bad:
            _leave_out(document, [one], str(one["why"]))

    return _edited(text, change)


EDITS: Mapping[str, Callable[..., str]] = {
    edit.__name__: edit for edit in (coefficient, leave_out, take_back, setting, add_recordings)
}
"""The changes by name."""


def _edited(text: str, change: Callable[[Any], object]) -> str:
    """The text after a change to its document, without tables that it has emptied; line ends stay those of the file."""
    text = _whole(text)
    document = tomlkit.parse(text)
    change(document)
    for name in [name for name, table in document.items() if isinstance(table, Table)]:
        if not document[name].as_string().strip() and not document[name].trivia.comment:
            del document[name]
    found = tomlkit.dumps(document)
    return LONE_NEWLINE.sub("\r\n", found) if "\r\n" in text and not LONE_NEWLINE.search(text) else found


def _whole(text: str) -> str:
    """The text with an end of its last line."""
    return text if not text or text.endswith("\n") else text + ("\r\n" if "\r\n" in text else "\n")


def _table(document: Any, name: str) -> Any:
    """The table of a document, added at its end if it has none."""
    if name not in document:
        if not document.as_string().endswith(("\n\n", "\n\r\n")):
            document.add(tomlkit.nl())
        document.add(name, tomlkit.table())
    return document[name]


def _exclude(document: Any) -> Any:
    """The list ``[fit] exclude``, added if there is none; one entry on each line."""
    table = _table(document, "fit")
    if "exclude" not in table:
        table.add("exclude", tomlkit.array().multiline(True))
    return table["exclude"]


def _by_file(readings: Iterable[Mapping[str, Any]]) -> dict[str, Sequence[LineRange]]:
    """Lines by file. Raises InputError if a reading lacks one of them, or its lines are not a list of lines."""
    found: dict[str, list[str]] = {}
    for reading in readings:
        try:
            file, lines = str(reading["file"]), str(reading["lines"])
        except (KeyError, TypeError):
            raise InputError("readings need file and lines") from None
        found.setdefault(file, []).append(lines)
    try:
        return {file: line_ranges(", ".join(lines)) for file, lines in found.items()}
    except LineListError as error:
        raise InputError(f"readings cannot be at these lines: {error}") from None


def _ranges(entry: Mapping[str, Any]) -> tuple[LineRange, ...]:
    return line_ranges(str(entry["lines"]))


def _lines(ranges: Iterable[LineRange]) -> str:
    """The list of lines as text; ranges that touch are joined."""
    return ranges_text(line_ranges(ranges_text(ranges)))


def _without(ranges: Sequence[LineRange], taken: Sequence[LineRange]) -> list[LineRange]:
    """The ranges without the lines of others; both are in order and apart."""
    kept = []
    for first, last in ranges:
        for k in range(bisect_left(taken, first, key=itemgetter(1)), len(taken)):
            begin, end = taken[k]
            if begin > last:
                break
            if first < begin:
                kept.append((first, begin - 1))
            first = end + 1
        if first <= last:
            kept.append((first, last))
    return kept
