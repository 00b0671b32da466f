"""Figures of fixed projects, stored beside the number of the method, which has one set of figures for ever.

``python tests/mffit/method_figures.py --raise`` raises ``METHOD`` in ``mffit/made.py`` and stores the figures of today, in the
change that moves them. ``methods.csv`` keeps the digest of the figures of every number; its lines are never changed.
"""

from __future__ import annotations

import csv
import hashlib
import json
import math
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import mffit
from mffit import made
from mffit.as_json import Json, plain

SAMPLES = Path(__file__).parents[2] / "samples"
PROJECTS = ("front-120-70", "flat-track", "flat-track-combined")
"""A disc with points and a recording, a flat track with points, and one with longitudinal slip."""
STORED = Path(__file__).with_name("method_figures.json")
REGISTER = Path(__file__).with_name("methods.csv")
SAME_NUMBER = 1e-5
"""Relative change below which a number comes out again: processors and libraries round the last digits differently."""
SAME_IN_U = 1e-3
"""Change in standard uncertainties below which a number comes out again: no stated digit of it changes."""
MISSING = "missing"
"""Stands for a number that the new figures lack."""


class NumberAgain(NamedTuple):
    """A stored number, and the same number of the new figures."""

    key: str  #: dotted key
    old: Json
    new: Json
    size: float  #: change over tolerance; infinite if the new number is missing or has another type


def compared(old: Json, new: Json, key: str = "", u: float = math.nan) -> Iterator[NumberAgain]:
    """The numbers of two JSON documents, compared; true, false and null count as numbers.

    ``u`` is the uncertainty that scales the tolerance, NaN if none is stated. Texts, and keys that only the new document has, are
    not compared.
    """
    if isinstance(old, str):
        return
    if isinstance(old, dict):
        others = new if isinstance(new, dict) else {}
        for name, value in old.items():
            yield from compared(
                value, others.get(name, MISSING), f"{key}.{name}".lstrip("."), stated_u(old, name)
            )
    elif isinstance(old, list):
        others = new if isinstance(new, list) else []
        yield NumberAgain(
            f"{key}, length", len(old), len(others), 0.0 if len(old) == len(others) else math.inf
        )
        for k, (value, other) in enumerate(zip(old, others, strict=False)):
            yield from compared(value, other, f"{key}[{k}]")
    else:
        yield NumberAgain(key, old, new, change(old, new, u))


def stated_u(table: dict[str, Json], name: str) -> float:
    """Standard uncertainty of a number, from another key of the same table; NaN without one."""
    keys = (f"u_{name}", *(("stderr", "u") if name == "value" else ()))
    return next((abs(u) for key in keys if isinstance(u := table.get(key), float)), math.nan)


def change(old: Json, new: Json, u: float) -> float:
    """Change of a number over its tolerance; infinite if the types differ or a number is missing."""
    if old == new and isinstance(old, bool) == isinstance(new, bool):
        return 0.0
    if any(isinstance(x, bool) or not isinstance(x, int | float) for x in (old, new)):
        return math.inf
    tolerance = SAME_NUMBER * max(abs(old), abs(new))
    return abs(new - old) / max(tolerance, SAME_IN_U * u if u > 0.0 else 0.0)


def figures(project: str) -> dict[str, Any]:
    """The direct measurement, the misfits, the rig errors and all fitted coefficients of a build of today."""
    content = plain(mffit.build(SAMPLES / project / "tyre.toml"))
    fitted = {
        name: {key: row[key] for key in ("value", "stderr")}
        for name, row in content["fit"]["coefficients"].items()
        if row["stderr"] is not None
    }
    spin = {key: value for key, value in content["spin"].items() if key != "notes"}
    return {
        "spin": spin,
        "fit": {key: content["fit"][key] for key in ("channels", "odd", "rig")} | {"coefficients": fitted},
    }


def stored() -> dict[str, Any]:
    """The stored figures by project, under ``figures``, and the ``method`` that gave them."""
    return json.loads(STORED.read_text(encoding="utf-8"))


def digest(content: dict[str, Any]) -> str:
    """SHA-256 of figures, however they are laid out in a file."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def register(text: str) -> list[tuple[int, str]]:
    """Number of the method and digest of its figures, by the lines of a register."""
    return [(int(number), known) for number, known in csv.reader(text.splitlines())]


def moved(before: dict[str, Any], now: dict[str, Any]) -> list[NumberAgain]:
    """Figures that differ by more than rounding."""
    return [row for row in compared(before, now) if row.size > 1.0]


def store(found: dict[str, Any], *, raised: bool, program: Path = Path(made.__file__)) -> str:
    """Store figures under a new number, which is written into ``program`` if ``raised``; says what was done.

    Raises
    ------
    SystemExit
        The figures moved, but the number is that of those stored.
    """
    before, number = stored(), made.METHOD
    changes = moved(before["figures"], found)
    if number == before["method"]:
        if not changes and found.keys() == before["figures"].keys():
            return f"no figure moved, and those of method {number} stay"
        if not raised:
            raise SystemExit(
                f"{len(changes)} figures moved: they are stored under a new number only; say --raise"
            )
        text = program.read_text(encoding="utf-8")
        program.write_text(
            text.replace(f"\nMETHOD = {number}\n", f"\nMETHOD = {number + 1}\n"), encoding="utf-8"
        )
        number += 1
    STORED.write_text(json.dumps({"method": number, "figures": found}, indent=1) + "\n", encoding="utf-8")
    with REGISTER.open("a", encoding="utf-8") as lines:
        lines.write(f"{number},{digest(found)}\n")
    return f"{len(changes)} figures moved; those of today are stored as method {number}"


if __name__ == "__main__":
    print(store({project: figures(project) for project in PROJECTS}, raised="--raise" in sys.argv[1:]))
