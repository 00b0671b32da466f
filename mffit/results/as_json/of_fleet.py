"""JSON of many builds and of a fleet."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from mffit import fleet as combining
from mffit.fleet import Fleet
from mffit.results.as_json.values import value_of
from mffit.results.records import BuildOutcome
from mffit.rig_errors import unit_of


def outcome(found: BuildOutcome) -> dict[str, Any]:
    """One of many builds, as ``mffit build --json`` prints it."""
    return {
        "tyre_toml": str(found.source),
        "name": found.name,
        "out": None if found.out is None else str(found.out),
        "state": found.state,
        "sentence": found.sentence or None,
        "seconds": found.seconds,
        "epsilon_gamma": value_of(found.epsilon_gamma),
        "rmse": dict(found.misfit),
        "warnings": found.warnings,
        "trusted": found.trusted if found.whole else None,
        "reasons": list(found.reasons),
        "in_doubt": list(found.in_doubt),
        "tir": found.file or None,
    }


def fleet(found: Fleet) -> dict[str, Any]:
    """The content of ``fleet.json``."""
    numbers = dict(found.rows[0].numbers)
    return {
        "tyres": [
            {
                "name": row.specimen.name,
                "folder": str(row.specimen.folder),
                "rig": row.rig + 1,
                "epsilon_gamma": {key: value_of(getattr(row, key)) for key in combining.EPSILON},
                **{key: value_of(q) for key, q in row.numbers.items()},
                "rmse": dict(row.specimen.misfit),
                "strain": dict(row.strain),
                "warnings": list(row.specimen.warnings),
            }
            for row in found.rows
        ],
        "scatter": {
            name: {**asdict(s), "beyond": s.beyond}
            for key, name in {
                **{k: f"epsilon_gamma_{k}" for k in combining.EPSILON},
                **{k: k for k in numbers},
            }.items()
            if (s := found.scatter(key)) is not None
        },
        "rigs": [
            None
            if rig is None
            else {
                "errors": {
                    n: {"value": value, "stderr": u, "unit": unit_of(n)} for n, (value, u) in rig.rig.items()
                },
                "population": {
                    name: {**asdict(p), "assumed": p.assumed} for name, p in rig.population.items()
                },
            }
            for rig in found.rigs
        ],
        "notes": list(found.notes),
    }
