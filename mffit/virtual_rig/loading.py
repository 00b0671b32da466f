"""From the text of ``rig.toml`` to a :class:`RigPlan`, or one sentence saying what to put right."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from mffit import config as configuration
from mffit.config.locate import lines_of_keys
from mffit.errors import InputError
from mffit.virtual_rig import plan
from mffit.virtual_rig.plan import RigPlan, RigTables

OWN = frozenset(RigTables.model_fields)
"""Tables that only ``rig.toml`` has; all others are those of ``tyre.toml``."""

KEYS = sorted({key for table in (RigTables, *plan.TABLES) for key in table.model_fields})
"""Every key of those tables, to guess what a misspelt one was meant to be."""


def load_plan(source: str | Path | Mapping[str, Any], *, folder: str | Path | None = None) -> RigPlan:
    """Read and check a virtual test campaign.

    Parameters
    ----------
    source : path of a ``rig.toml``, or its content as a mapping
    folder : where relative file names start; default the file's own, the current one for a mapping

    Raises
    ------
    InputError
        The file cannot be read, is no TOML, or a key is unknown, missing or makes no sense.
    """
    if isinstance(source, Mapping):
        return _checked(source, None, Path(folder or "."), {})
    path = Path(source)
    text = _text(path)
    try:
        content = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise InputError(f"is not valid TOML: {error}; correct it", file=path) from None
    return _checked(content, path, Path(folder or path.parent), lines_of_keys(text))


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8-sig")
    except FileNotFoundError:
        raise InputError(
            "there is no such file; samples/front-120-70/rig.toml is one to start from", file=path
        ) from None
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot be read ({error}); give a text file in UTF-8", file=path) from None


def _checked(content: Mapping[str, Any], path: Path | None, folder: Path, lines: dict[str, int]) -> RigPlan:
    own = {key: value for key, value in content.items() if key in OWN}
    try:
        tables = RigTables.model_validate(own)
    except ValidationError as error:
        raise _problem(error, path, lines) from None
    shared = {key: value for key, value in content.items() if key not in OWN}
    shared["sweep"] = [{"file": sweep.file} for sweep in tables.sweep]
    try:
        declared = configuration.load(shared, folder=folder)
    except InputError as error:
        raise InputError(
            error.sentence, file=path, line=_line(error.key or "", lines), key=error.key
        ) from None
    if declared.rig.type == "flat-track" and any(
        row.u_effective_radius is None for row in tables.rolling_radius
    ):
        raise InputError(
            "a flat track has no disc to turn; give u_effective_radius", file=path, key="rolling_radius"
        )
    return RigPlan(declared, tables, folder)


def _problem(error: ValidationError, path: Path | None, lines: dict[str, int]) -> InputError:
    """The first problem in pydantic's order, as one sentence."""
    detail: Any = error.errors()[0]
    loc = detail["loc"]
    key = ".".join(str(part) for part in loc)
    shown = "".join(f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in loc).lstrip(".")
    return InputError(_sentence(detail), file=path, line=_line(key, lines), key=shown)


def _sentence(detail: Any) -> str:
    kind = detail["type"]
    if kind == "sentence":
        return detail["ctx"]["sentence"]
    if kind == "missing":
        return "is missing; add it"
    if kind == "extra_forbidden":
        near = difflib.get_close_matches(str(detail["loc"][-1]), KEYS, n=1)
        return f'is unknown; did you mean "{near[0]}"?' if near else "is unknown; remove it"
    said = detail["msg"]
    return f"{said[:1].lower()}{said[1:]}; correct it"


def _line(key: str, lines: dict[str, int]) -> int | None:
    """Line of the key, else of the table around it."""
    while key and key not in lines:
        key = key.rpartition(".")[0]
    return lines.get(key)
