"""JSON of a build: measurements, fit and files."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from mffit import fleet as combining
from mffit.diagnosis.one_step import BestEffect
from mffit.diagnosis.remains import Remains
from mffit.fit import Coefficient, FitResult
from mffit.fit.bands import BandOfCombined, BandsByPressure
from mffit.fit.borrowed.campaign import Joined
from mffit.fit.borrowed.sister import Lent
from mffit.fit.influences.between_runs import BetweenRuns
from mffit.fit.influences.nuisance_choice import Verdict
from mffit.fit.influences.temperature import AtTemperature
from mffit.fit.relaxation import Relaxation
from mffit.fit.written.files import Files
from mffit.made import Made
from mffit.measured import KEYS, LoadResult, Measured, SetupResult, SetupScatter
from mffit.points.left_out import LeftOut
from mffit.results.as_json.values import picked, plain, stated
from mffit.results.records import BuildResult
from mffit.rig_errors import unit_of
from mffit.suspicion import Doubt, Outlier

NOT_JUDGED: Mapping[str, float] = {}


def build(result: BuildResult) -> dict[str, Any]:
    """The content of ``result.json``."""
    return {
        "trusted": result.trusted,
        "reasons": list(result.reasons),
        "in_doubt": list(result.trust.doubts),
        "tyre": result.config.tyre.model_dump(exclude_none=True),
        "spin": spin(result.measured),
        "fit": fit(result.fit, result.trust.over_noise),
        "residuals": residuals(result.remains),
        "remarks": list(result.trust.remarks),
        "tir": result.tir_path,
        "files": dict(result.files),
        "made": made(result.made),
        "lab": result.config.lab.model_dump(mode="json", exclude_none=True),
        "left_out": [left_out(row) for row in result.left_out],
        "warnings": list(result.warnings),
        "doubts": [_doubt(row) for row in result.fit.doubts],
        "outliers": [outlier(row) for row in result.fit.outliers],
    }


def made(found: Made) -> dict[str, Any]:
    """How and from what a result was made."""
    return asdict(found) | {"date": found.date.isoformat()}


def left_out(row: LeftOut) -> dict[str, Any]:
    """One entry of the list of readings that are left out, have less weight or are doubted."""
    return asdict(row) | {"rule": row.rule or None, "channel": row.channel or None}


def spin(measured: Measured) -> dict[str, Any]:
    """The content of ``spin.json``; SI units, ISO signs, u with k = 1.

    It is the ``spin`` part of ``result.json``, which judges the whole build and has ``made`` and judgement beside it.
    """
    row = measured.nominal
    numbers = _load(row)
    judged = {
        "trusted": measured.trusted,
        "reasons": list(measured.reasons),
        "warnings": list(measured.warnings),
    }
    return (
        ({} if measured.made is None else judged)
        | numbers
        | {
            "epsilon_gamma_model": measured.epsilon_gamma_model,
            **stated("epsilon_gamma_debiased", measured.epsilon_gamma_debiased),
            "pecp1": measured.pecp1,
            "pecp2": measured.pecp2,
            "u_pecp2": measured.u_pecp2,
            "budget": [line._asdict() for line in measured.budget],
            "expanded": _expanded(row),
            "u_epsilon_gamma_monte_carlo": row.u_monte_carlo if row else None,
            "interval_95_monte_carlo": list(row.interval) if row and row.interval else None,
            **stated("camber_skew_deg", measured.camber_skew),
            "misaligned": measured.axis_off,
            "coverage_factor": 1,
            "setups": [_setup(other) for other in row.setups] if row else [],
            "setup_scatter": _scatter(measured.setup_scatter),
            "notes": list(measured.notes),
            "per_load": [_load(other) for other in measured.per_load],
            **({} if measured.made is None else {"made": made(measured.made)}),
        }
    )


def _expanded(row: LoadResult | None) -> dict[str, Any] | None:
    """The expanded uncertainty of eps_gamma; infinite degrees of freedom are null."""
    found = row.expanded if row else None
    if found is None:
        return None
    return {
        "U_epsilon_gamma": found.U,
        "coverage_factor": found.k,
        "coverage_probability": found.probability,
        "effective_dof": found.dof,
    }


def fit(found: FitResult, over_noise: Mapping[str, float] = NOT_JUDGED) -> dict[str, Any]:
    """The ``fit`` part of ``result.json``; ``over_noise`` is the misfit of each channel over its stated noise."""
    return {
        "channels": {
            name: {**asdict(row), "over_noise": over_noise.get(name)} for name, row in found.channels.items()
        },
        "radii": {name: asdict(row) for name, row in found.radii.agreement(found.tyre.values).items()},
        "odd": {name: asdict(row) for name, row in found.odd.items()},
        "coefficients": {name: _coefficient(row) for name, row in found.coefficients.items()},
        "rig": _rig(found.rig if found.temperature is None else found.temperature.rig),
        "temperature": None if found.temperature is None else _temperature(found.temperature),
        "modelled": [] if found.choice is None else [_verdict(row) for row in found.choice.verdicts],
        "runs": None if found.runs is None else _runs(found.runs),
        "relaxation": _relaxation(found.relaxation) if found.relaxation else None,
        "campaigns": [_joined(row) for row in found.joined],
        "sister": None if found.lent is None else _sister(found.lent),
        "confounded": [
            picked(row, "setting", "correlation", "coefficient", "growth") for row in found.confounded
        ],
        "bands": _bands(found.bands, found.band_of_combined) if found.bands is not None else None,
        "posterior": plain(picked(found.posterior, "names", "covariance")),
        "coverage": [picked(row, "stage", "supported", "held", "missing") for row in found.coverage],
        "left": found.left,
        "files": _files(found.files) if found.files is not None else {},
        "explanations": list(found.explanations),
        "seconds": found.seconds,
    }


def residuals(found: Remains) -> dict[str, Any]:
    """What the fit leaves: the effect that would explain it best (null if none can be seen), structure, prediction."""
    return {
        "effect": None if found.effect is None else _best_effect(found.effect),
        "structure": {
            "chance": found.structure.chance,
            "comparisons": len(found.structure.comparisons),
            "found": [
                {"channel": c.channel, "over": c.over, "log_chance": c.log_chance}
                for c in found.structure.found
            ],
        },
        "sweep": None if found.sweep is None else {"name": found.sweep.name, "looks_like": found.sweep.looks},
        "held": [picked(row, "name", "sigma", "share") for row in found.held],
        "left_out": {name: asdict(row) for name, row in found.left_out.items()},
    }


def _best_effect(found: BestEffect) -> dict[str, Any]:
    step = found.best
    return {
        **picked(step.effect, "id", "name", "kind"),
        "parameters": {name: {"value": value, "stderr": u} for name, (value, u) in step.numbers.items()},
        "share": step.share,
        "was_expected": step.known,
        "sigma": found.sigma,
        "chance": found.chance,
        "significant": found.significant,
        "as_good": [other.effect.id for other in found.rivals],
        "tried": found.tried,
    }


def _rig(rig: Mapping[str, tuple[float, float]]) -> dict[str, Any]:
    return {name: {"value": value, "stderr": u, "unit": unit_of(name)} for name, (value, u) in rig.items()}


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


def _runs(found: BetweenRuns) -> dict[str, Any]:
    """The scatter of what every run has of its own; the values of the runs are in ``rig``."""
    return {
        "names": list(found.runs),
        "scatter": _rig(found.scatter),
        "channels_without": {name: asdict(row) for name, row in found.alone.items()},
    }


def _relaxation(found: Sequence[Relaxation]) -> dict[str, Any]:
    """Relaxation lengths from steps of the sideslip angle, and under ``slip`` from steps of slip."""
    sideways, slip = map(_relaxation_of, found)
    return {**sideways, "slip": slip}


def _relaxation_of(found: Relaxation) -> dict[str, Any]:
    """Relaxation lengths in one direction, and what follows from them or is missing."""
    sigma = found.direction.sigma
    return {
        "runs": [
            {
                "file": run.file,
                "load_N": run.load,
                "p_kPa": run.pressure / 1e3,
                **stated(f"{sigma}_m", run.length),
                f"{sigma}_file_m": run.written,
            }
            for run in found.runs
        ],
        "coefficients": list(found.found),
        "missing": found.missing or None,
    }


def _joined(found: Joined) -> dict[str, Any]:
    """What another campaign gave, and the ratio of grips of the two surfaces."""
    shared = found.campaign.shared
    return {
        "toml": found.campaign.name,
        "groups": list(found.groups),
        **stated("ratio_of_grips", found.grip),
        "loads_N": None if shared is None else shared[0].tolist(),
        "p_kPa": None if shared is None else shared[1] / 1e3,
        "coefficients": list(found.found),
    }


def _sister(found: Lent) -> dict[str, Any]:
    """Longitudinal and combined slip of a tyre measured only sideways: both ratios to the sister tyre, and what was borrowed."""
    return {
        "file": found.sister.file,
        **stated("friction", found.friction),
        **stated("stiffness", found.stiffness),
        "u_friction_of_sisters": found.sister.u_friction,
        "u_stiffness_of_sisters": found.sister.u_stiffness,
        "coefficients": list(found.found),
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
    out |= {
        "epsilon_gamma_secant": row.epsilon_secant,
        "epsilon_gamma_secant_bias": row.secant_bias,
        "epsilon_gamma_slope": row.epsilon_slope,
        "epsilon_gamma_moment": row.epsilon_moment,
        "u_epsilon_gamma_moment": None,
    }
    out |= stated("epsilon_gamma_debiased", row.epsilon_debiased)
    for key, part in (
        ("alpha_M_deg", row.alpha_M),
        ("alpha_0_deg", row.misalignment),
        ("ply_steer_deg", row.ply_steer),
    ):
        out |= stated(key, part, scale=math.degrees(1.0))
    out |= stated("conicity_N", row.conicity)
    return out | {"F_forward_N": row.F_forward, "F_backward_N": row.F_backward}


def _setup(row: SetupResult) -> dict[str, Any]:
    """The zeros of one set-up on one path, by themselves."""
    return {
        "setup": row.name,
        "path_centre": "left" if row.phi_t < 0.0 else "right",
        "path_radius_m": abs(1.0 / row.phi_t),
        **stated("F_phit_N", row.F_phit),
        **stated("C_phit_Nm", row.C_phit),
        **stated("epsilon_gamma", row.epsilon_gamma),
        **stated("alpha_M_deg", row.alpha_M, scale=math.degrees(1.0)),
        "misaligned": row.misaligned,
    }


def _scatter(found: SetupScatter | None) -> dict[str, Any] | None:
    """Scatter of repeated set-ups beside what is declared."""
    if found is None:
        return None
    alpha, u_alpha = (
        None if x is None else math.degrees(x) for x in (found.between_alpha, found.declared_alpha)
    )
    return {
        "load_N": found.load,
        "setups": list(found.setups),
        "between_N": found.between,
        "degrees_of_freedom": found.degrees_of_freedom,
        "declared_N": found.declared,
        "chance": found.chance,
        "within_N": found.within,
        "degrees_of_freedom_within": found.degrees_of_freedom_within,
        "stated_N": found.stated,
        "between_alpha_deg": alpha,
        "declared_alpha_deg": u_alpha,
        "excess_N": found.excess,
    }


def _bands(found: BandsByPressure, combined: BandOfCombined | None) -> dict[str, Any]:
    """Rms half widths of the 95 % bands of Fy at the usual pressure and at the others, what widens the latter, and of Fx.

    Those of Fx are at the one sideslip at which longitudinal slip was run, and halfway to it.
    """
    return {
        "pressure_kPa": found.main / 1e3,
        "Fy_N": found.half,
        "Fy_exact_zeros_N": found.half_of_exact_zeros,
        "other_pressures_kPa": [p / 1e3 for p in found.others],
        "other_Fy_N": found.half_of_others if found.others else None,
        "unseen": found.unseen or None,
        "share": found.share,
        "combined": None
        if combined is None
        else {
            "sideslip_deg": math.degrees(combined.sideslip),
            "Fx_N": combined.half_at,
            "halfway_Fx_N": combined.half_between,
        },
    }


def _coefficient(found: Coefficient) -> dict[str, Any]:
    partner = found.correlated_with or None
    return {
        **picked(found, "value", "stderr", "stage", "fixed", "at_bound"),
        "interval_95": list(found.interval) if found.interval else None,
        "status": found.status,
        "origin": found.origin or found.status,
        "by": "hand" if found.by_hand else None,
        "held": found.held,
        "bounds": list(found.bounds) if found.bounds else None,
        "prior": {"value": found.prior.expected, "u": found.prior.spread} if found.prior else None,
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
            "weight": files.weight,
            "camber_max_deg": None if files.camber_limit is None else math.degrees(files.camber_limit),
            "turn_slip_force_lacking_N": {f"{radius:g} m": force for radius, force in files.lacking.items()},
        }
    return {**out, "ranges": {"tested": dict(files.tested), "written": dict(files.written)}}
