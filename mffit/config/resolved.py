"""The configuration of a run as plain TOML types, for ``resolved.toml``."""

import os
from pathlib import Path
from typing import Any

from mffit.config.models import Config


def resolved(config: Config, folder: str | Path) -> dict[str, Any]:
    """Every key with its value as plain TOML types, including defaults; keys without a value are left out.

    If ``folder``, where the result will be written, is inside the configuration's own folder, relative file names become
    relative to ``folder``, so that both folders can be moved together; otherwise they become absolute.
    """
    content = config.model_dump(exclude_none=True)
    entries = (*content["sweep"], *content["fit"]["exclude"])
    for table, key in (
        *((entry, "file") for entry in entries),
        (content["tyre"], "base"),
        (content["tyre"], "priors"),
    ):
        if key in table:
            table[key] = _moved(table[key], config.folder, Path(folder))
    for sweep in content["sweep"]:
        if not sweep["columns"]:
            del sweep["columns"]
    content["fit"], content["lab"] = _filled(content["fit"]), _filled(content["lab"])
    return {name: value for name, value in _filled(content).items() if value != {}}


def _filled(table: dict[str, Any]) -> dict[str, Any]:
    """The keys of a table that are not empty, with its lists of tables as lists."""
    plain = {name: list(value) if isinstance(value, tuple) else value for name, value in table.items()}
    return {name: value for name, value in plain.items() if value not in ("", [])}


def _moved(file: str, start: Path, folder: Path) -> str:
    path = (start / file).absolute()
    if Path(file).is_absolute() or not folder.absolute().is_relative_to(start.absolute()):
        return str(path)
    return Path(os.path.relpath(path, folder.absolute())).as_posix()
