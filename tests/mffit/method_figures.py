"""Figures of fixed projects, stored beside the number of the method, which has one set of figures for ever.

``python tests/mffit/method_figures.py --raise`` raises ``METHOD`` in ``mffit/made.py`` and stores the figures of today, in the
change that moves them. ``methods.csv`` keeps the digest of the figures of every number; its lines are never changed.
"""

from __future__ import annotations

import csv
import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import mffit
from mffit import made
from mffit.results.values import plain
from mffit.results.verification import NumberAgain, compared

SAMPLES = Path(__file__).parents[2] / "samples"
PROJECTS = ("front-120-70", "flat-track", "flat-track-combined")
"""A disc with points and a recording, a flat track with points, and one with longitudinal slip."""
STORED = Path(__file__).with_name("method_figures.json")
REGISTER = Path(__file__).with_name("methods.csv")


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
    """Figures that differ by more than rounding: see ``mffit/results/constants.py``."""
    return [row for name in before for row in compared(name, before[name], now.get(name)) if row.size > 1.0]


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
