"""One build read back from its folder, for what many of them say together."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tir
from mffit.errors import InputError
from mffit.fleet.information import Information, from_json
from tir import Quantity, Tyre

RESULT, RESOLVED, INFORMATION = "result.json", "resolved.toml", "information.json"


@dataclass(frozen=True, slots=True)
class Specimen:
    """A built tyre."""

    name: str
    folder: Path
    tyre: Tyre  #: the fitted model
    file: str  #: the property file with the plain name
    on_disc: bool
    rig: Mapping[str, Any]  #: the table [rig] that the build was told
    information: Information | None  #: None where nothing was free
    epsilon_gamma: Quantity | None  #: of the direct method
    misfit: Mapping[str, float]  #: rms by channel, [N] and [Nm]
    warnings: tuple[str, ...]


def read(folder: str | Path) -> Specimen:
    """Read a folder that ``mffit build`` wrote.

    Raises
    ------
    InputError
        It is none, or not a whole one.
    """
    folder = Path(folder)
    if not (folder / RESULT).is_file():
        near = "; its folder out/ is" if (folder / "out" / RESULT).is_file() else ""
        raise InputError(
            f"is not a folder that `mffit build` wrote, as it holds no {RESULT}{near}; name such a folder",
            file=folder,
        )
    result = _json(folder / RESULT)
    try:
        resolved = tomllib.loads((folder / RESOLVED).read_text(encoding="utf-8"))
        files, spin = result["files"], result["spin"]
        on_disc = resolved["rig"]["type"] == "rotating-disk"
        use = "turn-slip" if on_disc and "turn-slip" in files else next(iter(files))
        epsilon = spin["epsilon_gamma"]
        return Specimen(
            name=str(result["tyre"]["name"]),
            folder=folder,
            tyre=tir.read(folder / files[use]),
            file=str(result["tir"]),
            on_disc=on_disc,
            rig=resolved["rig"],
            information=_information(folder / INFORMATION),
            epsilon_gamma=None
            if epsilon is None
            else Quantity(float(epsilon), float(spin["u_epsilon_gamma"]), "-"),
            misfit={name: row["rmse"] for name, row in result["fit"]["channels"].items() if row["n"]},
            warnings=tuple(result["warnings"]),
        )
    except (OSError, LookupError, TypeError, ValueError, AttributeError, StopIteration):
        raise InputError(
            "is not a whole folder of `mffit build`; build this tyre again", file=folder
        ) from None


def _information(path: Path) -> Information | None:
    if not path.is_file():
        raise InputError("is missing, as in builds of earlier versions; build this tyre again", file=path)
    content = _json(path)
    try:
        return from_json(content) if content["names"] else None
    except (LookupError, TypeError, ValueError, AttributeError):
        raise InputError("is not what `mffit build` writes; build this tyre again", file=path) from None


def _json(path: Path) -> Any:
    try:
        return json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        raise InputError("cannot be read as JSON; build this tyre again", file=path) from None
