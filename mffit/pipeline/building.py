"""``mffit build``: sweeps to property files."""

import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from threadpoolctl import threadpool_limits

from mffit import config as configuration
from mffit import fit as fitting
from mffit.config import Config
from mffit.config.laboratory import lab_warnings
from mffit.diagnosis import wording
from mffit.fit import FitResult
from mffit.made import Made, made
from mffit.measured import Measured
from mffit.output import refuse_early
from mffit.parts import Parts
from mffit.pipeline.build_output import WRITTEN, write_build
from mffit.pipeline.inputs import (
    base_notes,
    base_warnings,
    input_hashes,
    inputs_of,
    project_of,
    read_base,
    read_points,
)
from mffit.pipeline.judging import judged
from mffit.pipeline.left_out import left_out_by_fit
from mffit.pipeline.measuring import measure, said
from mffit.pipeline.on_road import on_road
from mffit.pipeline.provenance import Annotate, annotator
from mffit.pipeline.refining import fit_and_measure, refuse_exchanged_angles
from mffit.points import Points
from mffit.points.loading import Reading
from mffit.prediction import (
    CorrectionTable,
    MissedAtReadings,
    correction,
    missed_at_readings,
    missed_sentence,
)
from mffit.progress import JUDGING, MEASURING, READING, WRITING, Progress, silent
from mffit.results import CORRECTION, TEMPERATURE, BuildResult
from mffit.suspicion import Trust
from tir import Tyre


def build(
    config: Config | Mapping[str, Any] | str | Path,
    out: str | Path | None = None,
    *,
    ensemble: int = 0,
    with_report: bool = True,
    progress: Progress = silent,
) -> BuildResult:
    """Turn rig sweeps into an MF-6.2 tyre.

    Parameters
    ----------
    config : path of a ``tyre.toml``, its content, or a loaded Config
    out : folder to write to; nothing is written if None
    ensemble : number of property files to draw from the posterior, in addition to the best one
    with_report : write ``report.html`` and ``plots`` too; without them a build takes about half the time
    progress : called with a sentence before each step

    Returns
    -------
    BuildResult
        The tyre, the direct measurements and the fit.

    Raises
    ------
    InputError
        On bad input; nothing is written then.
    """
    began = time.perf_counter()
    config = configuration.load(config)
    progress(READING)
    read = _BuildInputs(made(input_hashes(config)), config, read_points(config), read_base(config))
    progress(MEASURING)
    parts, before = measure(config, read.reading.points, read.base)
    if out is not None:
        names = (*_names(config).values(), f"{config.tyre.name}{CORRECTION}", *WRITTEN)
        refuse_early(Path(out), names, inputs_of(config), project_of(config))
    with threadpool_limits(1):  # the matrices are small: threads cost more than they save
        measured, fitted = fit_and_measure(config, read.reading, parts, before, read.base, progress)
        refuse_exchanged_angles(config, read.reading, read.base, fitted, progress)
        progress(JUDGING)
        if ensemble:
            progress(f"drawing {ensemble} tyres from the posterior")
        result = _result(read, parts, measured, fitted, ensemble)
        result = replace(result, road=on_road(result))
    result = replace(result, seconds=time.perf_counter() - began)
    if out is not None:
        progress(f"{WRITING} {'report' if with_report else 'files'}")
        write_build(result, Path(out), read.reading.stretches, with_report=with_report)
    return result


class _BuildInputs(NamedTuple):
    """What a build reads, in this order."""

    made: Made  #: with the digests before the files are read, so that they are not those of files that replace them meanwhile
    config: Config
    reading: Reading
    base: Tyre | None


def _names(config: Config) -> dict[str, str]:
    """Name of every property file that a build may write, by use."""
    names = fitting.file_names(config.tyre.name, config.spin.exact, config.rig.on_disc)
    return {**names, TEMPERATURE: fitting.name_at_temperature(config.tyre.name)}


def _result(
    read: _BuildInputs, parts: Parts, measured: Measured, fitted: FitResult, ensemble: int
) -> BuildResult:
    """The result of a fit: its judgement, the proven model error, and the annotated tyres."""
    config, reading = read.config, read.reading
    assert fitted.files is not None
    files, names = {use: one.tyre for use, one in fitted.files.by_use.items()}, _names(config)
    of_uses = {use: files[use] for use in names if use != TEMPERATURE}
    if fitted.temperature is None:
        del names[TEMPERATURE]
    else:
        files[TEMPERATURE] = fitted.temperature.file.tyre
    of_fit, left = judged(config, reading.points, measured, fitted, of_uses)
    missed, table = _model_error(reading.points, fitted, files[fitting.fitted_use(of_uses)])
    trust = _of_all(of_fit, reading, fitted, wording.rival_of_formula(left.effect), missed)
    annotated = annotator(config, read.made, measured, fitted, trust)
    notes = (*base_notes(config, read.base), *(f"{note}." for note in reading.notes))
    fitted = replace(fitted, explanations=(*fitted.explanations, *notes))
    return BuildResult(
        config=config,
        points=reading.points,
        parts=parts,
        measured=measured,
        fit=fitted,
        files=names,
        tyres={use: annotated(files[use], use) for use in names},
        members=tuple(_members(config, fitted, ensemble, annotated)) if ensemble else (),
        plain=fitting.plain_use(config),
        warnings=(
            *said(of_fit),  # the doubts of the reading and of single sweeps are among the others
            *base_warnings(config, read.base),
            *reading.warnings,
            *measured.warnings,
            *fitted.warnings,
            *lab_warnings(config.lab, read.made.date.date()),
        ),
        trust=trust,
        remains=left,
        missed=missed,
        correction=table,
        made=read.made,
        left_out=(*reading.left_out, *left_out_by_fit(reading.points, fitted)),
        excluded=reading.excluded,
    )


def _of_all(
    trust: Trust, reading: Reading, fitted: FitResult, rival: str, missed: Mapping[str, MissedAtReadings]
) -> Trust:
    """The judgement of the fit with reasons and doubts of the reading and of single sweeps, and remarks on the model error."""
    explained = (one.sentence for one in fitted.doubts if one.looks)
    reasons = (*reading.reasons, *trust.reasons)
    remarks = (missed_sentence(missed[name], rival) for name in trust.limited if name in missed)
    return replace(
        trust,
        reasons=reasons,
        doubts=(*reading.doubts, *explained, *fitted.mounts, *trust.doubts),
        remarks=trust.remarks if reasons else tuple(remarks),
    )


def _model_error(
    points: Points, fitted: FitResult, model: Tyre
) -> tuple[dict[str, MissedAtReadings], CorrectionTable | None]:
    """The proven model error of the file ``model``, at the readings and as a table."""
    known, linear = fitted.prediction, fitted.left_by_formula
    assert known is not None
    assert linear is not None
    proven = [name for name, own in linear.channels.items() if own.is_proven]
    return missed_at_readings(known, model, points, fitted.model, proven), correction(known, model, proven)


def _members(config: Config, fitted: FitResult, count: int, annotated: Annotate) -> Iterator[Tyre]:
    """Tyres drawn from the posterior, each marked as a draw."""
    best = annotated(fitted.tyre, "turn-slip" if config.rig.on_disc else "normal")
    for i, values in enumerate(fitting.ensemble(fitted, count), 1):
        note = {"ensemble": f"draw {i} of {count} from what the fit leaves uncertain"}
        yield best.replace(**values).annotate(status=dict.fromkeys(values, "drawn"), provenance=note)
