"""JSON of recordings, alignments and checks of property files."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mffit.measured import Alignment
from mffit.recordings import Sniffed
from mffit.recordings.stretch_table import stretch_table
from tir.errors import Problem


def alignment(found: Alignment) -> dict[str, Any]:
    """The output of ``mffit align --json``; forces in N, ISO signs, the correction in degrees of the rig's axis."""
    return {
        "correction_deg": found.correction_deg,
        "u_correction_deg": found.u_deg,
        "u_axis_deg": found.u_axis_deg,
        "aligned": found.aligned,
        "steps": [asdict(step) for step in found.steps],
        "warnings": list(found.warnings),
    }


def sniffed(found: Sniffed) -> dict[str, Any]:
    """The output of ``mffit sniff --json``; conditions in SI."""
    return {
        "recordings": [
            {
                "file": str(row.path),
                "format": row.kind,
                "samples": row.samples,
                "rate_Hz": row.rate,
                "seconds": row.seconds,
                "gaps": row.gaps,
                "units": dict(zip(row.headings, row.units, strict=True)),
                "channels": {
                    name: {**guess._asdict(), "channel": guess.channel.name}
                    for name, guess in row.guesses.items()
                },
                "remarks": list(row.remarks),
            }
            for row in found.recordings
        ],
        "axes": list(found.axes),
        "conditions": {
            name: [level._asdict() for level in levels] for name, levels in found.conditions.items()
        },
        "points": len(found.points),
        "bad_runs": [
            {"file": str(run.recording), "lines": run.lines, "why": run.why} for run in found.bad_runs
        ],
        "stretches": stretch_table(found.reading.stretches).to_dict("records"),
        "warnings": [*found.reading.notes, *found.reading.warnings],
    }


def problems(path: Path, found: Sequence[Problem]) -> dict[str, Any]:
    """The output of ``mffit check --json``."""
    return {"file": str(path), "problems": [asdict(problem) for problem in found]}
