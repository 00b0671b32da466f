"""From the text of ``tyre.toml`` to a checked :class:`Config`, or one sentence saying what to put right."""

from __future__ import annotations

import difflib
import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError

from mffit.config.locate import lines_of_keys
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


def load(source: str | Path | Mapping[str, Any] | Config, *, folder: str | Path | None = None) -> Config:
    """Read and check a configuration.

    Parameters
    ----------
    source : path of a ``tyre.toml``, its content as a mapping, or a Config, which is returned as it is
    folder : where relative file names start; default the file's own, the current one for a mapping

    Returns
    -------
    Config
        Every default filled in.

    Raises
    ------
    InputError
        The file cannot be read, is no TOML, or a key is unknown, missing or makes no sense.
    """
    if isinstance(source, Config):
        return source
    if isinstance(source, Mapping):
        return _checked(source, None, Path(folder or "."), {})
    path = Path(source)
    text = _text(path)
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(error, path, text) from None
    return _checked(content, path, Path(folder or path.parent), lines_of_keys(text))


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig")
    except FileNotFoundError:
        raise InputError(
            "there is no such file; `mffit init DIR` writes one to start from", file=path
        ) from None
    except IsADirectoryError:
        raise InputError("is a folder; give the tyre.toml in it", file=path) from None
    except OSError as error:
        raise InputError(f"cannot be read ({error.strerror}); check its permissions", file=path) from None
    except UnicodeDecodeError:
        raise InputError("is not UTF-8 text; save it as UTF-8", file=path) from None


def _syntax_error(error: tomllib.TOMLDecodeError, path: Path, text: str) -> InputError:
    said = str(error)
    place = re.search(r"\(at line (\d+), column (\d+)\)", said)
    line = int(place[1]) if place else max(len(text.splitlines()), 1)
    what = said.partition(" (at ")[0]
    return InputError(
        f"is not valid TOML here ({what[:1].lower()}{what[1:]}); correct this line", file=path, line=line
    )


def _checked(content: Mapping[str, Any], path: Path | None, folder: Path, lines: dict[str, int]) -> Config:
    try:
        config = Config.model_validate(dict(content))
    except ValidationError as error:
        raise _first_problem(error, content, path, lines) from None
    config._path, config._folder, config._lines = path, folder, lines
    return config


def _first_problem(
    error: ValidationError, content: Mapping[str, Any], path: Path | None, lines: dict[str, int]
) -> InputError:
    """The problem that stands first in the file, with the number of the others."""
    problems = []
    for detail in error.errors():
        key = detail.get("ctx", {}).get("key") or _dotted(detail["loc"])
        key = _counted(key, detail["loc"])
        problems.append((_line(key, lines), key, _sentence(detail, key, content)))
    # An unknown key often is the misspelt one that is missing elsewhere: name it first.
    problems.sort(key=lambda found: (not found[2].startswith("is unknown"), found[0] or 0))
    line, key, sentence = problems[0]
    others = list(dict.fromkeys(other for _, other, _ in problems[1:] if other != key))
    if others:
        sentence += f" (also wrong: {', '.join(_shown(other) for other in others)})"
    return InputError(sentence, file=path, line=line, key=_shown(key))


def _dotted(loc: tuple[int | str, ...]) -> str:
    return ".".join(str(part) for part in loc)


def _counted(key: str, loc: tuple[int | str, ...]) -> str:
    """A key that a table named itself by, with the number of the entry it stands in."""
    if len(loc) > 1 and isinstance(loc[1], int) and key.split(".")[:2] != [str(loc[0]), str(loc[1])]:
        return f"{loc[0]}.{loc[1]}" + key.removeprefix(str(loc[0]))
    return key


def _line(key: str, lines: dict[str, int]) -> int | None:
    """Line of the key, else of the table around it; a single table may stand for the first of many."""
    while key:
        for candidate in (key, key.replace(".0", "", 1)):
            if candidate in lines:
                return lines[candidate]
        key = key.rpartition(".")[0]
    return 1 if lines else None


def _shown(key: str) -> str:
    """The key as a user reads it: ``sweep[3].file`` counts from 1."""
    return re.sub(r"\.(\d+)(?=\.|$)", lambda found: f"[{int(found[1]) + 1}]", key)


def _sentence(detail: Any, key: str, content: Mapping[str, Any]) -> str:
    kind, given = detail["type"], detail["input"]
    if kind == "sentence":
        return detail["ctx"]["sentence"]
    if kind == "missing":
        table = key.rpartition(".")[0]
        return f"is missing; add it to [{_shown(table)}]" if table else f"is missing; add the table [{key}]"
    if kind == "extra_forbidden":
        return _unknown(key, content)
    if kind == "literal_error":
        return f"{_quoted(given)} is none of {detail['ctx']['expected']}; choose one of them"
    if kind in KINDS:
        return f"{_quoted(given)} is not {KINDS[kind]}; write one"
    raise AssertionError(f"no sentence for {kind}")


def _quoted(given: Any) -> str:
    if isinstance(given, str):
        return f'"{given}"'
    if isinstance(given, bool):
        return "true" if given else "false"
    return (
        "a table" if isinstance(given, dict) else "a list" if isinstance(given, list | tuple) else str(given)
    )


def _unknown(key: str, content: Mapping[str, Any]) -> str:
    parts = [part for part in key.split(".") if not part.isdigit()]
    known = known_keys()
    here = ".".join(parts[:-1])
    siblings = known.get(here, ())
    near = difflib.get_close_matches(parts[-1], siblings, n=1, cutoff=0.6)
    if near:
        return f'is unknown; did you mean "{near[0]}"?'
    homes = [table for table, keys in known.items() if parts[-1] in keys and table != here]
    if homes:
        return (
            f"is unknown here; it belongs to [{homes[0]}]"
            if homes[0]
            else "is unknown here; it stands at the top"
        )
    return f"is unknown; known here are {', '.join(siblings)}"


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
