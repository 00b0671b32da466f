"""JSON of a conversion."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from mffit.conversion import Conversion, wording


def conversion(found: Conversion, out: Path) -> dict[str, Any]:
    """The output of ``mffit convert --json``: SI units, shares of 1."""
    reasons = wording.reasons(found)
    return {
        "file": str(found.old.path),
        "written": str(out),
        "kind": found.old.kind,
        "trusted": not reasons,
        "reasons": reasons,
        "ranges": found.reach._asdict(),
        "fitted": list(found.fitted),
        "curvature_held_to_1": dict(found.held),
        "misfit": [row._asdict() for row in found.misfit],
        "problems": [asdict(problem) for problem in found.old.problems],
    }
