"""JSON of a build: measurements, fit and files."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mffit import fleet as combining
from mffit.fit import Coefficient, FitResult
from mffit.fit.files import Files
from mffit.fit.nuisance_choice import Verdict
from mffit.fit.temperature import AtTemperature
from mffit.measured import KEYS, LoadResult, Measured
from mffit.results.as_json.values import picked, plain, stated
from mffit.results.records import BuildResult
from mffit.rig_errors import UNITS
from mffit.suspicion import Doubt, Outlier


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
        "outliers": [outlier(row) for row in result.fit.outliers],
    }


def spin(measured: Measured) -> dict[str, Any]:
    """The content of ``spin.json``, which is the ``spin`` part of ``result.json``; SI units, ISO signs, u with k = 1."""
    row = measured.nominal
    numbers = {key: value for key, value in _load(row).items() if key != "load_N"}
    return numbers | {
        "epsilon_gamma_model": measured.epsilon_gamma_model,
        **stated("epsilon_gamma_debiased", measured.epsilon_gamma_debiased),
        "pecp1": measured.pecp1,
        "pecp2": measured.pecp2,
        "u_pecp2": measured.u_pecp2,
        "budget": [line._asdict() for line in measured.budget],
        "u_epsilon_gamma_monte_carlo": row.u_monte_carlo if row else None,
        "misaligned": measured.misaligned,
        "coverage_factor": 1,
        "notes": list(measured.notes),
        "per_load": [_load(other) for other in measured.per_load],
    }


def fit(found: FitResult) -> dict[str, Any]:
    """The ``fit`` part of ``result.json``."""
    return {
        "channels": {name: asdict(row) for name, row in found.channels.items()},
        "odd": {name: asdict(row) for name, row in found.odd.items()},
        "coefficients": {name: _coefficient(row) for name, row in found.coefficients.items()},
        "rig": _rig(found.rig if found.temperature is None else found.temperature.rig),
        "temperature": None if found.temperature is None else _temperature(found.temperature),
        "modelled": [] if found.choice is None else [_verdict(row) for row in found.choice.verdicts],
        "confounded": [
            picked(row, "setting", "correlation", "coefficient", "growth") for row in found.confounded
        ],
        "posterior": plain(picked(found.posterior, "names", "covariance")),
        "stages": [
            picked(stage, "name", "parameters") | {"rmse_Fy_N": stage.rmse_Fy, "rmse_Mz_Nm": stage.rmse_Mz}
            for stage in found.stages
        ],
        "coverage": [picked(row, "stage", "supported", "held", "missing") for row in found.coverage],
        "files": _files(found.files) if found.files is not None else {},
        "explanations": list(found.explanations),
        "seconds": found.seconds,
    }


def _rig(rig: Mapping[str, tuple[float, float]]) -> dict[str, Any]:
    return {name: {"value": value, "stderr": u, "unit": UNITS[name]} for name, (value, u) in rig.items()}


def _temperature(found: AtTemperature) -> dict[str, Any]:
    """The model with temperature terms, which the file at one temperature states."""
    low, high = found.T_range
    return {
        "T_ref_degC": found.T_ref,
        "T_min_degC": low,
        "T_max_degC": high,
        "terms": _rig(found.terms),
        "channels": {name: asdict(row) for name, row in found.channels.items()},
        "without_terms": {name: asdict(row) for name, row in found.alone.items()},
        "left_out_rmse": {"temperature": dict(found.left_out), "plain": dict(found.left_out_plain)},
        "coefficients": {name: _coefficient(row) for name, row in found.coefficients.items()},
        "moved": {
            name: {"plain": there, "value": here, "stderr": u}
            for name, (there, here, u) in found.moved.items()
        },
    }


def _verdict(row: Verdict) -> dict[str, Any]:
    """Whether an influence is modelled beside the coefficients, and why."""
    return {
        "id": row.nuisance.id,
        "name": row.nuisance.name,
        "modelled": row.modelled,
        "reason": row.reason,
        "numbers": list(row.nuisance.numbers),
        "left_out_rmse": {"with": dict(row.beside), "without": dict(row.without)} if row.beside else None,
    }


def write_information(path: Path, result: BuildResult) -> None:
    """Write ``information.json``, one line per key, because it is mainly read by programs."""
    assert result.fit.search is not None
    content = plain(combining.to_json(combining.information(result.fit.search)))
    lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items())
    path.write_text("{\n" + lines + "\n}\n", encoding="utf-8")


def _doubt(row: Doubt) -> dict[str, Any]:
    return picked(row, "sweep", "file", "channel", "rms", "ratio", "share") | {
        "looks_like": row.looks or None
    }


def outlier(row: Outlier) -> dict[str, Any]:
    found = picked(row, "file", "line", "sweep", "channel", "measured", "expected", "ratio")
    return found | {"line": row.line or None}


def _load(row: LoadResult | None) -> dict[str, Any]:
    """The numbers at one load; all null without a measurement."""
    out: dict[str, Any] = {"load_N": row and row.load}
    for name, key in KEYS.items():
        out |= stated(key, getattr(row, name, None))
    if row is None:
        return out
    out |= {"epsilon_gamma_secant": row.epsilon_secant, "epsilon_gamma_slope": row.epsilon_slope}
    out |= stated("epsilon_gamma_moment", row.epsilon_moment)
    out |= stated("alpha_M_deg", row.alpha_M, scale=math.degrees(1.0))
    return out | {"F_forward_N": row.F_forward, "F_backward_N": row.F_backward}


def _coefficient(found: Coefficient) -> dict[str, Any]:
    partner = found.correlated_with or None
    return {
        **picked(found, "value", "stderr", "stage", "fixed", "at_bound"),
        "interval_95": list(found.interval) if found.interval else None,
        "status": found.status,
        "origin": found.origin or found.status,
        "correlated_with": partner,
        "correlation": found.correlation if partner else None,
    }


def _files(files: Files) -> dict[str, Any]:
    """Misfits of each written file by use, and the ranges."""
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
