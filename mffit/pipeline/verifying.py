"""``mffit build --verify OUT``: a new run from the stored inputs, and whether every number comes out again."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

import tir
from mffit import config as configuration
from mffit import fleet
from mffit.config import Config
from mffit.errors import InputError, readable
from mffit.fleet import Information
from mffit.output import digest, written_by
from mffit.pipeline.build_output import FOLDER, write_members
from mffit.pipeline.building import build
from mffit.pipeline.inputs import input_names
from mffit.progress import Progress, silent
from mffit.results import BuildResult, Verification, as_json
from mffit.results.verification import NumberAgain, compared
from tir import Tyre

RESULT, RESOLVED = "result.json", "resolved.toml"


def verify(out: str | Path, *, progress: Progress = silent) -> Verification:
    """Build again from the inputs of an earlier build, and compare every number; nothing is written.

    Parameters
    ----------
    out : folder that ``mffit build`` wrote
    progress : called with a sentence before each step

    Returns
    -------
    Verification
        The numbers of ``result.json``, ``information.json`` and every property file that did not come out again, the largest
        change first.

    Raises
    ------
    InputError
        The folder holds no complete build, or an input is gone or was changed since.
    """
    out = Path(out)
    stored = _stored(out)
    config = _configuration(out)
    _check_inputs(config, stored["made"]["inputs"])
    drawn = sorted(path.name for path in (out / FOLDER).glob("*.tir"))
    result = build(config, ensemble=len(drawn), progress=progress)
    progress("comparing")
    again = compared(RESULT, stored, json.loads(as_json.text(result)))
    again += _information_again(out / fleet.INFORMATION, result)
    made = stored["made"]
    return Verification(
        folder=str(out),
        compared=(*again, *_property_files(out, stored, drawn, result)),
        method=(made["method"], result.made.method),
        version=(made["version"], result.made.version),
        source=(made["source"], result.made.source),
        libraries=(dict(made.get("libraries", {})), result.made.libraries),
    )


def _stored(out: Path) -> dict[str, Any]:
    """The content of ``result.json``."""
    path = out / RESULT
    with readable(path, missing="there is no such file; name a folder that mffit build wrote"):
        text = path.read_bytes()
    try:
        found: dict[str, Any] = json.loads(text)
        tables = (found["files"], found["fit"]["coefficients"], found["made"]["inputs"])
        whole = all(isinstance(table, dict) for table in tables) and {"method", "version", "source"} <= set(
            found["made"]
        )
    except (ValueError, LookupError, TypeError, AttributeError):
        whole = False
    if not whole:
        raise InputError(
            "is not the result of a build of this version, or was damaged; build it again", file=path
        )
    return found


def _configuration(out: Path) -> Config:
    """The configuration of the build, if it is unchanged since."""
    path = out / RESOLVED
    if path.is_file() and RESOLVED not in written_by(out, "build"):
        raise InputError(
            "was changed since the build, or .mffit.json beside it was; restore it or build again", file=path
        )
    return configuration.load(path)


def _check_inputs(config: Config, hashes: Mapping[str, str]) -> None:
    """Refuse inputs that are gone or that differ from those of the build."""
    names = input_names(config)
    if len(names) != len(hashes):
        raise InputError(
            f"names {len(names)} inputs, but {RESULT} states {len(hashes)}; build again", file=config.path
        )
    for name, known in zip(names, hashes.values(), strict=True):
        path = Path(os.path.normpath(config.folder / name))  # as people write it: without out/..
        if not path.is_file():
            raise InputError("is gone, but the build read it; put it back", file=path)
        found = digest(path)
        if found != known:
            raise InputError(
                f"was changed since the build (SHA-256 {found[:16]}..., then {known[:16]}...); restore it or build again",
                file=path,
            )


def _property_files(
    out: Path, stored: Mapping[str, Any], drawn: list[str], result: BuildResult
) -> Iterator[NumberAgain]:
    """Every property file against the new one, which is written to a temporary folder as a build would write it."""
    spread = {name: row["stderr"] for name, row in stored["fit"]["coefficients"].items()}
    with tempfile.TemporaryDirectory() as folder:
        new = Path(folder)
        for use, name in result.files.items():
            result.tyres[use].write(new / name)
        write_members(result, new)
        for name in (*stored["files"].values(), *(f"{FOLDER}/{name}" for name in drawn)):
            if not name.endswith(".tir"):
                continue
            path = out / name
            if not path.is_file():
                raise InputError(f"is gone, but {RESULT} names it; build again", file=path)
            again = _numbers(tir.read(new / name), spread) if (new / name).is_file() else {}
            yield from compared(name, _numbers(tir.read(path), spread), again)


def _information_again(path: Path, result: BuildResult) -> list[NumberAgain]:
    """The numbers of the stored ``information.json`` compared with those of the new run."""
    assert result.fit.search is not None
    before, now = fleet.read_information(path), fleet.information(result.fit.search)
    told = {} if before is None else dict(zip(before.names, np.diag(before.matrix).tolist(), strict=True))
    return compared(path.name, _of_information(before, told), _of_information(now, told))


def _of_information(found: Information | None, told: Mapping[str, float]) -> dict[str, Any]:
    """The numbers of ``information.json`` by name; what the stored points ``told`` of each is the scale of its changes."""
    if found is None:
        return {}
    u = {name: known**-0.5 for name, known in told.items() if known > 0.0}
    vectors = {"expected": found.expected, "values": found.values, **found.moved_by}
    tables = {
        key: {name: {"value": x, "u": u.get(name)} for name, x in zip(found.names, row.tolist(), strict=True)}
        for key, row in vectors.items()
    }
    known = fleet.to_json(found)
    slopes = dict(zip(found.names, known["vector"], strict=True))
    vector = {name: {"value": x, "u": 1.0 / u[name] if name in u else None} for name, x in slopes.items()}
    return {**tables, "vector": vector, "matrix": known["matrix"], "spread": known["spread"]}


def _numbers(tyre: Tyre, spread: Mapping[str, float | None]) -> dict[str, Any]:
    """Coefficients and measured quantities of a property file, with their uncertainties."""
    values = {
        name: {"value": float(value), "stderr": spread.get(name)}
        for name, value in tyre.values.items()
        if isinstance(value, int | float)
    }
    measured = {name: {"value": q.value, "u": q.u} for name, q in tyre.measured.items()}
    return {**values, "measured": measured}
