"""What pydantic finds wrong, as one sentence with file, line and key."""

from __future__ import annotations

import difflib
import re
from pathlib import Path
from typing import Any, NamedTuple

from pydantic import BaseModel, ValidationError

from mffit.config.models import Column, Config
from mffit.errors import InputError

KINDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "a text in quotes",
    "bool_type": "true or false",
    "finite_number": "a finite number",
    "model_type": "a table",
    "dict_type": "a table",
    "tuple_type": "a table or an array of tables",
}


class _Problem(NamedTuple):
    key: str  #: dotted, entries of an array counted from 0
    line: int | None
    sentence: str
    cures: str  #: dotted key that is missing only because of this one


def first_problem(error: ValidationError, path: Path | None, lines: dict[str, int]) -> InputError:
    """The problem to solve first, with the keys of all others.

    Parameters
    ----------
    error : what pydantic found
    path : the file, None for a mapping
    lines : line of every key, see :func:`lines_of_keys`
    """
    problems = [_problem(detail, lines) for detail in error.errors()]
    # A misspelt key is often the one that is missing: name it first.
    problems.sort(key=lambda problem: (not problem.sentence.startswith("is unknown"), problem.line or 0))
    first = problems[0]
    cured = {problem.cures for problem in problems}
    others = {problem.key for problem in problems[1:]} - {first.key} - cured
    sentence = first.sentence
    if others:
        sentence += f" (also wrong: {', '.join(_shown(key, lines) for key in sorted(others))})"
    return InputError(sentence, file=path, line=first.line, key=_shown(first.key, lines))


def _problem(detail: Any, lines: dict[str, int]) -> _Problem:
    loc = detail["loc"]
    key = detail.get("ctx", {}).get("key") or ".".join(str(part) for part in loc)
    if len(loc) > 1 and isinstance(loc[1], int) and not key.startswith(f"{loc[0]}.{loc[1]}"):
        # A table that names its own key does not know which entry of the array it is.
        key = f"{loc[0]}.{loc[1]}" + key.removeprefix(str(loc[0]))
    near = _nearest(key) if detail["type"] == "extra_forbidden" else ""
    cures = f"{key.rpartition('.')[0]}.{near}".lstrip(".") if near else ""
    return _Problem(key, _line(key, lines), _sentence(detail, key, near), cures)


def _line(key: str, lines: dict[str, int]) -> int | None:
    """Line of the key, else of the table around it; a single table may stand for the first of many."""
    while key:
        for candidate in (key, key.replace(".0", "", 1)):
            if candidate in lines:
                return lines[candidate]
        key = key.rpartition(".")[0]
    return 1 if lines else None


def _shown(key: str, lines: dict[str, int]) -> str:
    """The key as a user reads it: ``sweep[3].file`` counts from 1; a table that is alone is not counted."""
    table = key.partition(".")[0]
    if table in lines:
        key = key.replace(f"{table}.0", table, 1)
    return re.sub(r"\.(\d+)(?=\.|$)", lambda found: f"[{int(found[1]) + 1}]", key)


def _sentence(detail: Any, key: str, near: str) -> str:
    kind, given = detail["type"], detail["input"]
    if kind == "sentence":
        return detail["ctx"]["sentence"]
    if kind == "missing":
        table = re.sub(r"\.\d+$", "", key.rpartition(".")[0])
        return f"is missing; add it to [{table}]" if table else f"is missing; add the table [{key}]"
    if kind == "extra_forbidden":
        return f'is unknown; did you mean "{near}"?' if near else _unknown(key)
    if kind == "literal_error":
        return f"{_quoted(given)} is none of {detail['ctx']['expected']}; choose one of them"
    if kind == "float_type" and isinstance(given, str) and re.fullmatch(r"\s*[-+]?[\d.]+\s*", given):
        return f'"{given}" is a text, not a number; remove the quotes'
    if kind in KINDS:
        return f"{_quoted(given)} is not {KINDS[kind]}; write one"
    said = detail["msg"]
    return f"{said[:1].lower()}{said[1:]}; correct it"


def _quoted(given: Any) -> str:
    if isinstance(given, str):
        return f'"{given}"' if len(given) <= 60 else f'"{given[:60]}..."'
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, dict):
        return "a table"
    return "a list" if isinstance(given, list | tuple) else str(given)


def _nearest(key: str) -> str:
    """The known key of the same table that is spelt most like this one; empty if none is near."""
    table, name = _split(key)
    near = difflib.get_close_matches(name, known_keys().get(table, ()), n=1, cutoff=0.6)
    return near[0] if near else ""


def _unknown(key: str) -> str:
    table, name = _split(key)
    known = known_keys()
    homes = [home for home, keys in known.items() if name in keys and home != table]
    if homes:
        return f"is unknown here; it belongs {f'to [{homes[0]}]' if homes[0] else 'to the top of the file'}"
    return f"is unknown; known here are {', '.join(known.get(table, known['']))}"


def _split(key: str) -> tuple[str, str]:
    """Table and name of a key, as :func:`known_keys` lists them."""
    parts = [part for part in key.split(".") if not part.isdigit()] or [key]
    if parts[:2] == ["sweep", "columns"] and len(parts) == 4:
        parts[2] = "*"
    return ".".join(parts[:-1]), parts[-1]


def known_keys() -> dict[str, tuple[str, ...]]:
    """The keys of every table, by its dotted name; "" is the top of the file."""
    known: dict[str, tuple[str, ...]] = {}

    def collect(model: type[BaseModel], name: str) -> None:
        known[name] = tuple(model.model_fields)
        for field, info in model.model_fields.items():
            for inner in _models(info.annotation):
                collect(inner, f"{name}.{field}" if name else field)

    collect(Config, "")
    known["sweep.columns.*"] = tuple(Column.model_fields)
    return known


def _models(annotation: Any) -> list[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [] if annotation is Column else [annotation]
    return [model for inner in getattr(annotation, "__args__", ()) for model in _models(inner)]
