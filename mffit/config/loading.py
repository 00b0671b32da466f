"""From the text of ``tyre.toml`` to a checked :class:`Config`, or one sentence saying what to put right."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mffit.config.globs import with_globs_expanded
from mffit.config.locate import lines_of_keys
from mffit.config.models import Config
from mffit.config.problems import first_problem
from mffit.errors import InputError

OF_A_PLAN = frozenset({"truth", "faults", "noise", "conditions"})
"""Tables that only the plan of a virtual rig has."""


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
        if not path.name.lower().endswith(".toml") and not content.keys() & Config.model_fields.keys():
            raise _other_file(path)
    except tomllib.TOMLDecodeError as error:
        raise _syntax_error(error, path, text) from None
    if plan := content.keys() & OF_A_PLAN:
        raise InputError(
            f"is a rig.toml, a plan for the virtual rig, as its [{min(plan)}] says: run `mffit simulate` on it and build what "
            "that writes",
            file=path,
        )
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
        if not path.name.lower().endswith(".toml"):
            raise _other_file(path) from None
        raise InputError("is not UTF-8 text; save it as UTF-8", file=path) from None


def _other_file(path: Path) -> InputError:
    """What to do with a file that is evidently something else."""
    if path.name.lower().endswith(".tir"):
        return InputError(
            'is a property file, not a tyre.toml: `mffit check` looks at it, and a tyre.toml names it as base = "..." '
            "under [tyre]",
            file=path,
        )
    return InputError(
        f"is not a tyre.toml; if it is a recording or a table of points, `mffit init --from {path.name} DIR` writes one for it",
        file=path,
    )


def _syntax_error(error: tomllib.TOMLDecodeError, path: Path, text: str) -> InputError:
    if not path.name.lower().endswith(".toml"):
        return _other_file(path)
    said = str(error)
    place = re.search(r"\(at line (\d+), column (\d+)\)", said)
    line = int(place[1]) if place else max(len(text.splitlines()), 1)
    what = said.partition(" (at ")[0]
    return InputError(
        f"is not valid TOML here ({what[:1].lower()}{what[1:]}); correct this line", file=path, line=line
    )


def _checked(content: Mapping[str, Any], path: Path | None, folder: Path, lines: dict[str, int]) -> Config:
    content, lines = with_globs_expanded(content, path, folder, lines)
    try:
        config = Config.model_validate(dict(content))
    except ValidationError as error:
        raise first_problem(error, path, lines) from None
    config._path, config._folder, config._lines = path, folder, lines
    return config
