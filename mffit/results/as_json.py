"""The JSON files: made from the records here and nowhere else, with the keys that users' scripts rely on."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np

from mffit import fleet as combining
from mffit.comparison import Comparison, Difference
from mffit.comparison import wording as compared
from mffit.diagnosis import Diagnosis, Found, Gap, wording
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.where import Region
from mffit.fit import Coefficient, Doubt, FitResult, Outlier
from mffit.fit.files import Files
from mffit.fleet import Fleet
from mffit.measured import KEYS, Alignment, LoadResult, Measured
from mffit.measured import wording as say
from mffit.planning import Plan, Run
from mffit.planning import wording as planned
from mffit.recordings import Sniffed
from mffit.recordings.stretch_table import stretch_table
from mffit.results.build import BuildResult
from mffit.results.many import Outcome
from mffit.rig import UNITS
from tir import Quantity
from tir.errors import Problem


def build(result: BuildResult) -> dict[str, Any]:
    """The content of ``result.json``."""
    return {
        "tyre": result.config.tyre.model_dump(exclude_none=True),
        "spin": spin(result.measured),
        "fit": fit(result.fit),
        "tir": result.tir_path,
        "files": dict(result.files),
        "warnings": list(result.warnings),
        "doubts": [_doubt(row) for row in result.fit.doubts],
        "outliers": [_outlier(row) for row in result.fit.outliers],
    }


def spin(measured: Measured) -> dict[str, Any]:
    """The content of ``spin.json``, which is the ``spin`` part of ``result.json``; SI units, ISO signs, u with k = 1."""
    row = measured.nominal
    numbers = {key: value for key, value in _load(row).items() if key != "load_N"}
    return numbers | {
        "epsilon_gamma_model": measured.epsilon_gamma_model,
        **_stated("epsilon_gamma_debiased", measured.epsilon_gamma_debiased),
        "pecp1": measured.pecp1,
        "pecp2": measured.pecp2,
        "u_pecp2": measured.u_pecp2,
        "budget": [line._asdict() for line in measured.budget],
        "u_epsilon_gamma_monte_carlo": row.u_monte_carlo if row else None,
        "misaligned": measured.misaligned,
        "coverage_factor": 1,
        "notes": [say.note(fact) for fact in measured.notes],
        "per_load": [_load(other) for other in measured.per_load],
    }


def fit(found: FitResult) -> dict[str, Any]:
    """The ``fit`` part of ``result.json``."""
    return {
        "channels": {name: asdict(row) for name, row in found.channels.items()},
        "odd": {name: asdict(row) for name, row in found.odd.items()},
        "coefficients": {name: _coefficient(row) for name, row in found.coefficients.items()},
        "rig": {
            name: {"value": value, "stderr": u, "unit": UNITS[name]} for name, (value, u) in found.rig.items()
        },
        "posterior": {
            "names": list(found.posterior.names),
            "covariance": found.posterior.covariance.tolist(),
        },
        "stages": [
            {
                "name": stage.name,
                "parameters": list(stage.parameters),
                "rmse_Fy_N": stage.rmse_Fy,
                "rmse_Mz_Nm": stage.rmse_Mz,
            }
            for stage in found.stages
        ],
        "coverage": [
            {
                "stage": row.stage,
                "supported": row.supported,
                "held": list(row.held),
                "missing": list(row.missing),
            }
            for row in found.coverage
        ],
        "files": _files(found.files) if found.files is not None else {},
        "explanations": list(found.explanations),
        "seconds": found.seconds,
    }


def diagnosis(found: Diagnosis) -> dict[str, Any]:
    """The content of ``diagnosis.json``."""
    return {
        "headline": found.headline,
        "gap_before": _gap(found.gap_before),
        "gap_after": _gap(found.gap_after),
        "validation": {
            "method": wording.method(found.validation),
            "gap_before": _gap(found.validation.gap_before),
            "gap_after": _gap(found.validation.gap_after),
        },
        "where": [_region(region) for region in found.where],
        "effects": [_effect(effect, found.signs) for effect in found.effects],
        "alternatives": [{"id": name, "confidence": weight} for name, weight in found.ranked_alternatives()],
        "limits": [
            {"id": row.effect.id, "of_usual_size": row.share, "ruled_out": row.ruled_out}
            for row in found.limits
        ],
        "unexplained": found.unexplained,
        "unexplained_where": [_region(region) for region in found.unexplained_where],
        "noise_floor": _noise(found.noise),
        "outliers": [_outlier(row) for row in found.outliers],
        "coefficients": {n: {"value": v, "stderr": s} for n, (v, s) in found.coefficients.items()},
        "model_after": found.model_after,
        "notes": wording.notes(found),
    }


def alignment(found: Alignment) -> dict[str, Any]:
    """What ``mffit align --json`` prints; forces in N, ISO signs, the correction in degrees of the rig's axis."""
    return {
        "correction_deg": found.correction_deg,
        "u_correction_deg": found.u_deg,
        "aligned": found.aligned,
        "steps": [asdict(step) for step in found.steps],
        "warnings": list(found.warnings),
    }


def sniffed(found: Sniffed) -> dict[str, Any]:
    """What ``mffit sniff --json`` prints; conditions in SI."""
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
            }
            for row in found.recordings
        ],
        "axes": list(found.axes),
        "conditions": {
            name: [level._asdict() for level in levels] for name, levels in found.conditions.items()
        },
        "points": len(found.points),
        "stretches": stretch_table(found.reading.stretches).to_dict("records"),
        "warnings": list(found.reading.warnings),
    }


def problems(path: Path, found: Sequence[Problem]) -> dict[str, Any]:
    """What ``mffit check --json`` prints."""
    return {"file": str(path), "problems": [asdict(problem) for problem in found]}


def outcome(found: Outcome) -> dict[str, Any]:
    """One of many builds."""
    return {
        "tyre_toml": str(found.source),
        "name": found.name,
        "out": None if found.out is None else str(found.out),
        "state": found.state,
        "sentence": found.sentence or None,
        "seconds": found.seconds,
        "epsilon_gamma": _value(found.epsilon_gamma),
        "rmse": dict(found.misfit),
        "warnings": found.warnings,
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
                "epsilon_gamma": {key: _value(getattr(row, key)) for key in combining.EPSILON},
                **{key: _value(q) for key, q in row.numbers.items()},
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
                    n: {"value": value, "stderr": u, "unit": UNITS[n]} for n, (value, u) in rig.rig.items()
                },
                "population": {name: asdict(p) for name, p in rig.population.items()},
            }
            for rig in found.rigs
        ],
    }


def plan(found: Plan) -> dict[str, Any]:
    """The content of ``plan.json``; uncertainties in the unit of the goal, k = 1, null where nothing is measured."""
    seen = found.identified
    return {
        "goal": {
            "kind": found.goal.kind,
            "name": found.goal.name,
            "label": found.goal.label,
            "unit": found.goal.unit,
        },
        "headline": planned.headline(found),
        "promise": planned.promise(found),
        "identified": planned.identified(seen),
        "ties": [{**asdict(tie), "told": tie.told} for tie in seen.ties],
        "u_now": found.now,
        "u_then": found.then,
        "told_below": found.told_below,
        "u_epsilon_gamma_direct": found.direct_now,
        "u_epsilon_gamma_joint": found.joint_now,
        "runs": [
            _run(step.run)
            | {
                "u_before": step.before,
                "u_after": step.after,
                "u_epsilon_gamma_direct": step.direct,
                "u_epsilon_gamma_joint": step.joint,
            }
            for step in found.steps
        ],
        "alone": [_run(trial.run) | {"u_after": trial.u} for trial in found.trials],
    }


def comparison(found: Comparison) -> dict[str, Any]:
    """The content of ``compare.json``; SI units, ISO signs, u with k = 1, null where it is not known."""
    return {
        "first": found.first,
        "second": found.second,
        "headline": compared.headline(found),
        "numbers": [_difference(row) for row in found.numbers],
        "coefficients": [_difference(row) for row in found.coefficients],
        "curves": [
            {
                "channel": gap.channel,
                "over": gap.over,
                "load_N": gap.load,
                "rms": gap.rms,
                "largest": gap.largest[0],
                "at_deg": math.degrees(gap.largest[1]),
            }
            for gap in found.curves
        ],
        "sweeps": [asdict(gap) for gap in found.sweeps],
        "notes": list(found.notes),
    }


def _value(number: Quantity | None) -> dict[str, Any] | None:
    return None if number is None else {"value": number.value, "u": number.u}


def text(content: Any) -> str:
    """One of the above as text; numbers that are not finite become null."""
    return json.dumps(_plain(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _difference(row: Difference) -> dict[str, Any]:
    return {**asdict(row), "change": row.change, "u_change": row.u, "in_u": row.z}


def _run(run: Run) -> dict[str, Any]:
    return {
        "name": run.name,
        "kind": run.kind.value,
        "title": planned.title(run),
        "reason": planned.reason(run),
        "points": run.cost,
        "rig": dict(run.rig),
    }


def write(path: Path, content: Mapping[str, Any]) -> None:
    """Write one of the above as UTF-8."""
    path.write_text(text(content), encoding="utf-8")


def write_information(path: Path, result: BuildResult) -> None:
    """Write ``information.json``, a line per key, as programs read it and few people do."""
    assert result.fit.search is not None
    content = _plain(combining.to_json(combining.information(result.fit.search)))
    lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items())
    path.write_text("{\n" + lines + "\n}\n", encoding="utf-8")


def _doubt(row: Doubt) -> dict[str, Any]:
    return {
        "sweep": row.sweep,
        "file": row.file,
        "channel": row.channel,
        "rms": row.rms,
        "ratio": row.ratio,
        "share": row.share,
        "looks_like": row.looks or None,
    }


def _outlier(row: Outlier) -> dict[str, Any]:
    return {
        "file": row.file,
        "line": row.line or None,
        "sweep": row.sweep,
        "channel": row.channel,
        "measured": row.measured,
        "expected": row.expected,
        "ratio": row.ratio,
    }


def _load(row: LoadResult | None) -> dict[str, Any]:
    """The numbers of one load; all null if nothing was measured."""
    out: dict[str, Any] = {"load_N": row and row.load}
    for name, key in KEYS.items():
        out |= _stated(key, getattr(row, name, None))
    if row is None:
        return out
    out |= {"epsilon_gamma_secant": row.epsilon_secant, "epsilon_gamma_slope": row.epsilon_slope}
    out |= _stated("epsilon_gamma_moment", row.epsilon_moment)
    out |= _stated("alpha_M_deg", row.alpha_M, scale=math.degrees(1.0))
    return out | {"F_forward_N": row.F_forward, "F_backward_N": row.F_backward}


def _stated(key: str, number: Quantity | None, scale: float = 1.0) -> dict[str, float | None]:
    if number is None:
        return {key: None, f"u_{key}": None}
    return {key: scale * number.value, f"u_{key}": scale * number.u}


def _coefficient(found: Coefficient) -> dict[str, Any]:
    partner = found.correlated_with or None
    return {
        "value": found.value,
        "stderr": found.stderr,
        "stage": found.stage,
        "fixed": found.fixed,
        "at_bound": found.at_bound,
        "interval_95": list(found.interval) if found.interval else None,
        "status": found.status,
        "origin": found.origin or found.status,
        "correlated_with": partner,
        "correlation": found.correlation if partner else None,
    }


def _files(files: Files) -> dict[str, Any]:
    """How good each written file is, by use, and the ranges."""
    out: dict[str, Any] = {
        use: {
            "USE_MODE": int(file.tyre["USE_MODE"]),
            **{
                place: {channel: asdict(misfit) for channel, misfit in channels.items()}
                for place, channels in file.misfit.items()
            },
            "camber_stiffness_N_per_rad": file.camber_stiffness,
        }
        for use, file in files.by_use.items()
    }
    for use, names in files.changed.items():
        out[use]["coefficients"] = {name: files.by_use[use].tyre[name] for name in names}
    if files.lacking:
        out["normal"] |= {
            "camber_stiffness_loss": files.stiffness_loss,
            "turn_slip_force_lacking_N": {f"{radius:g} m": force for radius, force in files.lacking.items()},
        }
    return {**out, "ranges": {"tested": dict(files.tested), "written": dict(files.written)}}


def _noise(noise: Noise) -> dict[str, Any]:
    """The noise that was found, beside the one that was stated."""
    return {
        "Fy_N": noise.Fy,
        "Mz_Nm": noise.Mz,
        "source": wording.source(noise),
        "stated_Fy_N": noise.typically_stated("Fy"),
        "stated_Mz_Nm": noise.typically_stated("Mz"),
        "scatter": {name: asdict(row) for name, row in noise.scatter.items()},
    }


def _gap(gap: Gap) -> dict[str, float]:
    return {"Fy_rmse_N": gap.Fy_rmse_N, "Mz_rmse_Nm": gap.Mz_rmse_Nm, "chi2_per_dof": gap.chi2_per_dof}


def _region(region: Region) -> dict[str, Any]:
    limits = {name: list(limits) for name, limits in region.region.items()}
    return {"channel": region.channel, "region": limits, "bias": region.bias, "z": region.z}


def _effect(found: Found, signs: Mapping[str, float]) -> dict[str, Any]:
    return {
        "id": found.effect.id,
        "name": found.effect.name,
        "kind": found.effect.kind,
        "physics": found.effect.physics,
        "confidence": found.confidence,
        "parameters": {
            n: {"was": found.before[n], "value": v, "stderr": s} for n, (v, s) in found.parameters.items()
        },
        "to_do": wording.remedy(found, signs),
        "gap_after": _gap(found.gap_after),
        "tied_with": list(found.tied_with),
        "separate_by": wording.separation(found.separation),
        **({} if found.T_ref is None else {"T_ref_degC": found.T_ref}),
    }


def _plain(value: Any) -> Any:
    """JSON has no NaN and no numpy types."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(item) for item in value]
    if isinstance(value, np.generic):
        value = value.item()
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value
