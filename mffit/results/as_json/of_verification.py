"""JSON of a verification."""

from __future__ import annotations

import math
from dataclasses import asdict
from typing import Any

from mffit.results.as_json.values import picked
from mffit.results.verification import NumberChange, Verification


def verification(found: Verification) -> dict[str, Any]:
    """The output of ``mffit build --verify --json``."""
    return {
        **picked(found, "folder", "same", "headline", "numbers", "exact"),
        "method": dict(zip(("stored", "now"), found.method, strict=True)),
        "version": dict(zip(("stored", "now"), found.version, strict=True)),
        "libraries": dict(zip(("stored", "now"), map(dict, found.libraries), strict=True)),
        "changes": [_change(row) for row in found.changes],
        "notes": list(found.notes),
    }


def _change(row: NumberChange) -> dict[str, Any]:
    return {**asdict(row), "size": row.size if math.isfinite(row.size) else None}
