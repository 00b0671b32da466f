"""Figures of fixed projects, stored beside the number of the method.

``python tests/mffit/method_figures.py`` stores those of today, after ``METHOD`` in ``mffit/made.py`` was raised.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import mffit
from mffit.made import METHOD
from mffit.results.values import plain

SAMPLES = Path(__file__).parents[2] / "samples"
PROJECTS = ("front-120-70", "flat-track")
"""A disc with points and a recording, and a flat track with points."""
STORED = Path(__file__).with_name("method_figures.json")


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


def main() -> None:
    """Store the figures of today."""
    content = {"method": METHOD, "figures": {project: figures(project) for project in PROJECTS}}
    STORED.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    print(f"{STORED}: figures of method {METHOD}")


if __name__ == "__main__":
    main()
