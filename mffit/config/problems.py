"""One sentence with file, line and key from pydantic's errors about the tables of a TOML file.

The keys to suggest for an unknown one are those of the pydantic models.
"""

import re
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from mffit.config.quantities import TOO_MANY_DIGITS
from mffit.config.toml_file import line_of
from mffit.errors import InputError, meant, shortened

Keys = Mapping[str, tuple[str, ...]]
"""The keys of every table by its dotted name; "" is the top of the file, ``*`` any key."""

Model = TypeVar("Model", bound=BaseModel)

KINDS = {
    "float_type": "a number",
    "int_type": "a whole number",
    "string_type": "a text in quotes",
    "bool_type": "true or false",
    "finite_number": "a finite number",
    "model_type": "a table",
    "dict_type": "a table",
    "tuple_type": "a table or an array of tables",
    "date_type": "a date such as 2026-03-01",
}
"""By pydantic's type of error, what the value should be."""

DATE_IN_QUOTES = re.compile(r"\s*\d{4}-\d\d-\d\d\s*")
NUMBER_IN_QUOTES = re.compile(r"\s*[-+]?[\d.]+([eE][-+]?\d+)?\s*")


class _Mistake(NamedTuple):
    key: str  #: dotted, entries of an array counted from 0
    line: int | None
    sentence: str
    is_unknown: bool = False
    meant: str = ""  #: dotted key that an unknown one probably is; empty if none is near


def validated(
    model: type[Model],
    content: Mapping[str, object],
    *,
    path: Path | None,
    lines: dict[str, int],
    known: Keys,
) -> Model:
    """The content of a file as a model; ``path`` is None for a mapping.

    ``lines`` are as by :func:`lines_of_keys`, ``known`` as by :func:`known_keys`. Raises InputError with the problem to solve
    first and the keys of all others.
    """
    try:
        return model.model_validate(dict(content))
    except ValidationError as error:
        mistakes = [_mistake(detail, lines, known) for detail in error.errors()]
    # A misspelt key is often the one that is missing: name it first.
    mistakes.sort(key=lambda mistake: (not mistake.is_unknown, mistake.line or 0))
    first = mistakes[0]
    solved = {first.key, *(mistake.meant for mistake in mistakes)}
    others = sorted({mistake.key for mistake in mistakes} - solved)
    also = f" (also wrong: {', '.join(shown(key, lines) for key in others)})" if others else ""
    raise InputError(first.sentence + also, file=path, line=first.line, key=shown(first.key, lines))


def _mistake(detail: ErrorDetails, lines: dict[str, int], known: Keys) -> _Mistake:
    key = _key_at_fault(detail)
    line = line_of(key, lines) or (1 if lines else None)
    if detail["type"] != "extra_forbidden":
        return _Mistake(key, line, _sentence(detail, key, lines))
    table, name = _split(key, known)
    near = meant(name, known.get(table, ()))
    if not near or any(name in keys for keys in known.values()):
        return _Mistake(key, line, _unknown(table, name, known), is_unknown=True)
    place = f"{key.rpartition('.')[0]}.{near}".lstrip(".")
    return _Mistake(key, line, f'is unknown; did you mean "{near}"?', is_unknown=True, meant=place)


def _key_at_fault(detail: ErrorDetails) -> str:
    """Dotted key: the place that pydantic gives, and within it the key that a validator of ours names.

    A validator names a key from the top of the file without the numbers of entries (``rig.path``), or within its own table.
    """
    loc = [str(part) for part in detail["loc"]]
    named = [part for part in detail.get("ctx", {}).get("key", "").split(".") if part]
    if loc and named and named[0] == loc[0]:
        named = named[1:]
    return ".".join([*loc, *named])


def shown(key: str, lines: dict[str, int]) -> str:
    """The key as a message gives it: ``sweep[3].file`` counts from 1; a single ``[table]`` is not counted."""
    table = key.partition(".")[0]
    if table in lines:
        key = key.replace(f"{table}.0", table, 1)
    return re.sub(r"\.(\d+)(?=\.|$)", lambda found: f"[{int(found[1]) + 1}]", key)


def _sentence(detail: ErrorDetails, key: str, lines: dict[str, int]) -> str:
    kind, given, context = detail["type"], detail["input"], detail.get("ctx", {})
    if kind == "sentence":
        return str(context["sentence"])
    if kind == "missing":
        return _missing(key, lines)
    if kind == "literal_error":
        expected = re.sub(
            r"\b(True|False)\b", lambda word: word[0].lower(), context["expected"]
        )  # as TOML has them
        return f"{_quoted(given)} is not allowed; write {expected}"
    if kind == "greater_than":
        return f"{given:g} is not above {context['gt']:g}; correct it"
    if kind == "greater_than_equal":
        return f"{given:g} is below {context['ge']:g}; correct it"
    if kind == "too_short":
        return "is empty; give at least one"
    if kind == "float_type" and isinstance(given, str) and NUMBER_IN_QUOTES.fullmatch(given):
        return f'"{given}" is a text, not a number; remove the quotes'
    if kind == "date_type" and isinstance(given, str) and DATE_IN_QUOTES.fullmatch(given):
        return f'"{given}" is a text, not a date; remove the quotes'
    if kind == "float_type" and isinstance(given, int) and not isinstance(given, bool):
        return TOO_MANY_DIGITS
    if kind in KINDS:
        point = ", with a decimal point" if kind == "float_type" and "," in str(given) else ""
        return f"{_quoted(given)} is not {KINDS[kind]}; write one{point}"
    message = detail["msg"]
    return f"{message[:1].lower()}{message[1:]}; correct it"


def _missing(key: str, lines: dict[str, int]) -> str:
    table = key.rpartition(".")[0]
    if not table:
        return f"is missing; add the table [{key}]"
    name = re.sub(r"\.\d+$", "", table)
    if name != table and "." in name:  # an inline table of a list
        return "is missing; add it to this entry"
    is_entry = name != table and name not in lines
    return f"is missing; add it to {f'[[{name}]]' if is_entry else f'[{name}]'}"


def _quoted(given: object) -> str:
    if isinstance(given, str):
        return f'"{shortened(given)}"'
    if isinstance(given, bool):
        return "true" if given else "false"
    if isinstance(given, dict):
        return "a table"
    return "a list" if isinstance(given, list | tuple) else shortened(str(given))


def _unknown(table: str, name: str, known: Keys) -> str:
    homes = [home for home, keys in known.items() if name in keys and home != table]
    if homes:
        return f"is unknown here; move it to {f'[{homes[0]}]' if homes[0] else 'the top of the file'}"
    return f"is unknown; known here are {', '.join(known.get(table, known['']))}"


def _split(key: str, known: Keys) -> tuple[str, str]:
    """Table and name of a key, as ``known`` lists them."""
    *parts, name = [part for part in key.split(".") if not part.isdigit()] or [key]
    table = ".".join(parts)
    free = ".".join([*parts[:-1], "*"])
    return (free if table not in known and free in known else table), name


def known_keys(*models: type[BaseModel]) -> dict[str, tuple[str, ...]]:
    """The keys of every table of a file. Where two models have a table of one name, the first counts; at the top of the file
    all.
    """
    known: dict[str, tuple[str, ...]] = {}

    def collect(model: type[BaseModel], table: str) -> None:
        known.setdefault(table, tuple(model.model_fields))
        for name, field in model.model_fields.items():
            for inner, below in _models(field.annotation):
                collect(inner, ".".join(part for part in (table, name, below) if part))

    for model in models:
        collect(model, "")
    known[""] = tuple(dict.fromkeys(name for model in models for name in model.model_fields))
    return known


def _models(annotation: object, below: str = "") -> list[tuple[type[BaseModel], str]]:
    """Models within the type of a field, with ``*`` for those under keys of any name."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [(annotation, below)]
    below = "*" if getattr(annotation, "__origin__", None) is dict else below
    return [found for inner in getattr(annotation, "__args__", ()) for found in _models(inner, below)]
