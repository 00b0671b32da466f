"""JSON keys of a build: ``result.json``, ``information.json``, and a line of ``mffit build --json``."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping
from pathlib import Path

from mffit.diagnosis.remains import BestEffect, OddSweep, Remains
from mffit.fit import Coefficient, FitResult
from mffit.fit.bands import BandBesideSweeps, Bands
from mffit.fit.coverage import StageCoverage
from mffit.fit.influences.modelled import AtTemperature, BetweenRuns
from mffit.fit.influences.nuisance_choice import Verdict
from mffit.fit.posterior import Posterior
from mffit.fit.relaxation import Relaxation
from mffit.fit.written.files import Files
from mffit.fit.written.misfit import FileFigures
from mffit.fleet import information, to_json
from mffit.points.left_out import LeftOut
from mffit.prediction import MissedAtReadings, missed_sentence
from mffit.results.records import BuildOutcome, BuildResult
from mffit.results.values import Json, document, keys, plain, with_u
from mffit.rig_errors import unit_of
from mffit.suspicion import Doubt, HeldNumber, Outlier

NOT_JUDGED: Mapping[str, float] = {}
Estimates = Mapping[str, tuple[float, float]]
"""Numbers with their standard errors, by name."""

keys(
    BuildResult,
    "trusted reasons in_doubt=trust.doubts tyre=config.tyre spin=measured fit residuals remarks=trust.remarks "
    "tir=tir_path files made lab=config.lab left_out warnings doubts=fit.doubts outliers=fit.outliers",
    fit=lambda found: fit(found.fit, found.trust.over_noise),
    residuals=lambda found: residuals(found.remains, found.missed),
    files=lambda found: {
        **found.files,
        **({"correction": found.correction_name} if found.correction else {}),
    },
)
keys(
    BuildOutcome,
    "tyre_toml=source name out state sentence? seconds epsilon_gamma rmse=misfit warnings trusted reasons in_doubt tir=file?",
    trusted=lambda found: found.trusted if found.whole else None,
)
keys(LeftOut, "* rule? channel?")
keys(Doubt, "sweep file channel rms ratio share looks_like=looks?")
keys(Outlier, "file line? sweep channel measured expected ratio")


def fit(found: FitResult, over_noise: Mapping[str, float] = NOT_JUDGED) -> dict[str, Json]:
    """The ``fit`` part of ``result.json``; ``over_noise`` is the ratio of misfit to stated noise, by channel."""
    channels: dict[str, Json] = {
        name: {**document(row), "over_noise": over_noise.get(name)} for name, row in found.channels.items()
    }
    return document(found) | {"channels": channels}


def estimates(numbers: Estimates) -> dict[str, object]:
    """JSON of numbers with their standard errors."""
    return {name: {"value": value, "stderr": u} for name, (value, u) in numbers.items()}


def of_rig(numbers: Estimates) -> dict[str, object]:
    """JSON of the rig's numbers with their standard errors and units."""
    return {n: {"value": value, "stderr": u, "unit": unit_of(n)} for n, (value, u) in numbers.items()}


keys(
    FitResult,
    "channels radii odd coefficients rig temperature modelled runs relaxation confounded bands "
    "posterior coverage left files explanations seconds",
    radii=lambda found: found.radii.agreement(found.tyre.values),
    rig=lambda found: of_rig(found.rig if found.temperature is None else found.temperature.rig),
    modelled=lambda found: () if found.choice is None else found.choice.verdicts,
    relaxation=lambda found: (
        {**document(found.relaxation[0]), "slip": found.relaxation[1]} if found.relaxation else None
    ),
    files=lambda found: found.files or {},
)
keys(
    Coefficient,
    "value stderr stage fixed at_bound interval_95=interval status origin by held bounds prior correlated_with? correlation",
    origin=lambda row: row.origin or row.status,
    by=lambda row: "hand" if row.by_hand else None,
    prior=lambda row: row.prior and {"value": row.prior.expected, "u": row.prior.spread},
    correlation=lambda row: row.correlation if row.correlated_with else None,
)
keys(
    AtTemperature,
    "T_ref_degC T_min_degC=T_range.0 T_max_degC=T_range.1 terms channels without_terms=alone left_out_rmse coefficients moved",
    terms=lambda found: of_rig(found.terms),
    left_out_rmse=lambda found: {"temperature": found.left_out, "plain": found.left_out_plain},
    moved=lambda found: {
        name: {"plain": there, "value": here, "stderr": u} for name, (there, here, u) in found.moved.items()
    },
)
keys(
    Verdict,
    "id=nuisance.id name=nuisance.name modelled reason numbers=nuisance.numbers left_out_rmse",
    left_out_rmse=lambda row: {"with": row.beside, "without": row.without} if row.beside else None,
)
keys(BetweenRuns, "names=runs scatter channels_without=alone", scatter=lambda found: of_rig(found.scatter))
keys(
    Relaxation,
    "runs coefficients missing?",
    runs=lambda found: [
        {
            "file": run.file,
            "load_N": run.load,
            "p_kPa": run.pressure / 1e3,
            **with_u(f"{found.direction.sigma}_m", run.length),
            f"{found.direction.sigma}_file_m": run.written,
        }
        for run in found.runs
    ],
    coefficients=lambda found: list(found.found),
)
keys(
    Bands,
    "pressure_kPa=main Fy_N=half Fy_exact_zeros_N=half_of_exact_zeros other_pressures_kPa=others other_Fy_N unseen? share "
    "combined",
    other_Fy_N=lambda found: found.half_of_others if found.others else None,
)
keys(BandBesideSweeps, "sideslip_deg Fx_N=half_at halfway_Fx_N=half_beside")
keys(Posterior, "names covariance")
keys(StageCoverage, "stage supported held missing")
keys(
    Files,
    "**by_use ranges",
    by_use=lambda files: {use: _file(files, use) for use in files.by_use},
    ranges=lambda files: {"tested": files.tested, "written": files.written},
)
keys(
    FileFigures,
    "USE_MODE **misfit camber_stiffness_N_per_rad",
    USE_MODE=lambda file: int(file.tyre["USE_MODE"]),
)


def _file(files: Files, use: str) -> dict[str, object]:
    """JSON of a written file: its misfits, and for the file without turn slip also the forces that it lacks."""
    file, out = files.by_use[use], dict[str, object](document(files.by_use[use]))
    if use in files.changed:
        out["coefficients"] = {name: file.tyre[name] for name in files.changed[use]}
    if use == "normal" and files.lacking:
        limit = files.camber_limit
        out |= {
            "camber_stiffness_loss": files.stiffness_loss,
            "weight": files.weight,
            "camber_max_deg": None if limit is None else math.degrees(limit),
            "turn_slip_force_lacking_N": {f"{r:g} m": force for r, force in files.lacking.items()},
        }
    return out


keys(
    Remains,
    "effect missed sweep held left_out",
    missed=lambda found: {
        name: {"rms": one.size, "log_evidence": one.proof, "over": one.missed_over}
        for name, one in (found.linear.channels if found.linear else {}).items()
    },
)


def residuals(remains: Remains, missed: Mapping[str, MissedAtReadings]) -> dict[str, Json]:
    """The ``residuals`` part of ``result.json``.

    Where model error at the readings is proven, ``rms`` is that of the written file, and ``most`` is the region of its maximum.
    """
    found = document(remains)
    for name, one in missed.items():
        of_channel = found["missed"][name]  # type: ignore[call-overload, index]
        of_channel |= {"rms": one.size, "of_file": one.size, "most": plain(one.region)}  # type: ignore[operator]
        of_channel["sentence"] = missed_sentence(one)
    return found


keys(OddSweep, "name looks_like=looks")
keys(HeldNumber, "name sigma share")
keys(
    BestEffect,
    "id=best.effect.id name=best.effect.name kind=best.effect.kind parameters share=best.share was_expected=best.known sigma "
    "chance significant as_good tried",
    parameters=lambda found: estimates(found.best.numbers),
    as_good=lambda found: [other.effect.id for other in found.rivals],
)


def write_information(path: Path, result: BuildResult) -> None:
    """Write ``information.json``, one line per key, because it is mainly read by programs."""
    assert result.fit.search is not None
    content = document(to_json(information(result.fit.search)))
    lines = ",\n".join(f"{json.dumps(key)}: {json.dumps(value)}" for key, value in content.items())
    path.write_text("{\n" + lines + "\n}\n", encoding="utf-8")
