"""JSON of a diagnosis."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

from mffit.diagnosis import AcceptedEffect, Diagnosis, wording
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.validation import Gap
from mffit.quantities import column
from mffit.results.as_json.of_build import left_out, made, outlier
from mffit.results.as_json.values import picked


def diagnosis(found: Diagnosis) -> dict[str, Any]:
    """The content of ``diagnosis.json``."""
    return {
        "trusted": found.trusted,
        "reasons": list(found.reasons),
        "headline": found.headline,
        "gap_before": _gap(found.gap_before),
        "gap_after": _gap(found.gap_after),
        "validation": {
            "method": wording.method(found.validation),
            "gap_before": _gap(found.validation.gap_before),
            "gap_after": _gap(found.validation.gap_after),
            "gap_file": _gap(found.validation.gap_file),
        },
        "where": [asdict(region) for region in found.where],
        "effects": [_effect(effect, found.signs_of(effect.effect)) for effect in found.effects],
        "alternatives": [{"id": name, "confidence": weight} for name, weight in found.ranked_alternatives()],
        "limits": [
            {"id": row.effect.id, "of_usual_size": row.share, "ruled_out": row.ruled_out}
            for row in found.limits
        ],
        "unexplained": found.unexplained,
        "unexplained_where": [asdict(region) for region in found.unexplained_where],
        "noise_floor": _noise(found.noise),
        "outliers": [outlier(row) for row in found.outliers],
        "coefficients": {n: {"value": v, "stderr": s} for n, (v, s) in found.coefficients.items()},
        "model_after": found.model_after,
        "model_with_terms": found.model_with_terms,
        "notes": wording.notes(found),
        "lab": found.lab.model_dump(mode="json", exclude_none=True),
        "left_out": [left_out(row) for row in found.left_out],
        **({} if found.made is None else {"made": made(found.made)}),
    }


def _gap(gap: Gap) -> dict[str, float]:
    """Misfit of every channel and chi-squared."""
    return {column(name, "rmse"): rmse for name, rmse in gap.rmse.items()} | {
        "chi2_per_dof": gap.chi2_per_dof
    }


def _noise(noise: Noise) -> dict[str, Any]:
    """The estimated and the stated noise."""
    return {
        **{column(name): noise.typical(name) for name in noise.channels},
        "source": wording.source(noise),
        **{f"stated_{column(name)}": noise.typically_stated(name) for name in noise.channels},
        "scatter": {name: {**asdict(row), "span": row.span.value} for name, row in noise.scatter.items()},
    }


def _effect(found: AcceptedEffect, signs: Mapping[str, float]) -> dict[str, Any]:
    return {
        **picked(found.effect, "id", "name", "kind", "physics"),
        **({"campaign": found.effect.campaign} if found.effect.campaign else {}),
        "confidence": found.confidence,
        "repaired": found.repaired,
        "parameters": {
            n: {"was": found.before[n], "value": v, "stderr": s} for n, (v, s) in found.parameters.items()
        },
        "to_do": wording.remedy(found, signs),
        "gap_after": _gap(found.gap_after),
        "tied_with": list(found.tied_with),
        "separate_by": wording.separation(found.separation),
        **({} if found.T_ref is None else {"T_ref_degC": found.T_ref}),
    }
