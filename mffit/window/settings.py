"""Settings of ``tyre.toml`` other than coefficients: every key of its tables that is one value, read off the models."""

from collections.abc import Iterator, Mapping
from types import UnionType
from typing import Annotated, Any, Literal, Union, get_args, get_origin

import tomlkit

from mffit.config.models import Config, SweepTable
from mffit.config.table import Table
from mffit.errors import InputError, shortened

Tables = Mapping[str, Any]
TABLES: Mapping[str, type[Table]] = {
    name: field.annotation
    for name, field in Config.model_fields.items()
    if isinstance(field.annotation, type) and issubclass(field.annotation, Table)
}
"""The tables that are there once."""


def settings(tables: Tables) -> list[dict[str, Any]]:
    """The keys of every table and of every [[sweep]], with what the file says and what holds otherwise, as TOML."""
    found = [_listed(f"[{name}]", name, "", model, tables.get(name, {})) for name, model in TABLES.items()]
    sweeps = tables.get("sweep", [])
    for sweep in [sweeps] if isinstance(sweeps, Mapping) else sweeps:
        found.append(_listed(f"[[sweep]] {sweep['file']}", "sweep", sweep["file"], SweepTable, sweep))
    return found


def _listed(title: str, table: str, file: str, model: type[Table], given: Tables) -> dict[str, Any]:
    keys = []
    for name, field in model.model_fields.items():
        accepted = list(_accepted(field.annotation))
        if name == "file" or any(kind in (tuple, dict) or _is_table(kind) for kind in accepted):
            continue
        default = "" if field.default is None else "required" if field.is_required() else toml(field.default)
        choices = [
            toml(value) for kind in accepted if get_origin(kind) is Literal for value in get_args(kind)
        ]
        value = toml(given[name]) if name in given else ""
        if choices and value:
            choices = list(dict.fromkeys([*choices, value]))  # another name of one
        keys.append({"key": name, "value": value, "default": default, "choices": choices})
    return {"title": title, "table": table, "file": file, "keys": keys}


def _accepted(kind: Any) -> Iterator[Any]:
    """The plain types of an annotation."""
    if get_origin(kind) is Annotated:
        yield from _accepted(get_args(kind)[0])
    elif get_origin(kind) in (Union, UnionType):
        for one in get_args(kind):
            yield from _accepted(one)
    else:
        yield get_origin(kind) if get_origin(kind) in (tuple, dict) else kind


def _is_table(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, Table)


def toml(value: Any) -> str:
    """A value as ``tyre.toml`` writes it, on one line."""
    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        table.update(value)
        return str(table.as_string())
    return str(tomlkit.item(value).as_string())


def value_of(text: str) -> Any:
    """Parse a TOML value; text that is not valid TOML is returned as a string."""
    try:
        (value,) = tomlkit.parse(f"x = {text}").values()
    except ValueError:
        if any(mark in text for mark in "\"'\n[{="):
            raise InputError(
                f"{shortened(text)} is no value; write a number, true, false, a date or a text in quotes"
            ) from None
        return text
    return value
