"""``mffit build``: sweeps to property files."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from threadpoolctl import threadpool_limits

from mffit import config as configuration
from mffit import fit as fitting
from mffit.config import Config
from mffit.config.laboratory import lab_warnings
from mffit.diagnosis import wording
from mffit.fit import FitResult
from mffit.made import made
from mffit.output import refuse_early
from mffit.pipeline.build_output import WRITTEN, write_build
from mffit.pipeline.inputs import base_notes, base_warnings, input_hashes, inputs_of, read_base, read_points
from mffit.pipeline.judging import judged
from mffit.pipeline.left_out import left_out_by_fit
from mffit.pipeline.measuring import measure, said
from mffit.pipeline.provenance import TEMPERATURE, Annotate, annotator
from mffit.pipeline.refining import fit_and_measure
from mffit.prediction import correction, missed_at_readings, missed_sentence
from mffit.progress import JUDGING, MEASURING, READING, WRITING, Progress, silent
from mffit.results import CORRECTION, BuildResult
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
    ensemble : number of property files to draw from the posterior, beside the best one
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
    reading = read_points(config)
    base = read_base(config)
    made_of = made(input_hashes(config))
    progress(MEASURING)
    parts, before = measure(config, reading.points, base)
    names = fitting.file_names(config.tyre.name, config.spin.exact, config.rig.on_disc)
    special = fitting.name_at_temperature(config.tyre.name)
    if out is not None:
        further = f"{config.tyre.name}{CORRECTION}"
        refuse_early(Path(out), (*names.values(), special, further, *WRITTEN), inputs_of(config))
    with threadpool_limits(1):  # the matrices are small: threads cost more than they save
        measured, fitted = fit_and_measure(config, reading, parts, before, base, progress)
        progress(JUDGING)
        assert fitted.files is not None
        files = fitted.files.by_use
        trust, left = judged(
            config, reading.points, measured, fitted, {use: files[use].tyre for use in names}
        )
        judgement = said(trust)  # the doubts of the reading are among its warnings
        trust = replace(trust, doubts=(*reading.doubts, *trust.doubts))
        if ensemble:
            progress(f"drawing {ensemble} tyres from the posterior")
        annotated = annotator(config, made_of, measured, fitted, trust)
        known = fitted.prediction
        assert known is not None
        assert fitted.left_by_formula is not None
        proven = [name for name, own in fitted.left_by_formula.channels.items() if own.is_proven]
        model = files[fitting.fitted_use(names)].tyre
        missed = missed_at_readings(known, model, reading.points, fitted.model, proven)
        table = correction(known, model, proven)
        if trust.trusted:
            rival = wording.rival_of_formula(left.effect)
            remarks = (missed_sentence(missed[name], rival) for name in trust.limited if name in missed)
            trust = replace(trust, remarks=tuple(remarks))
        members = tuple(_members(config, fitted, ensemble, annotated)) if ensemble else ()
    notes = (*base_notes(config, base), *(f"{note}." for note in reading.notes))
    fitted = replace(fitted, explanations=(*fitted.explanations, *notes))
    tyres = {use: annotated(files[use].tyre, use) for use in names}
    if fitted.temperature is not None:
        tyres[TEMPERATURE] = annotated(fitted.temperature.file.tyre, TEMPERATURE)
        names = {**names, TEMPERATURE: special}
    warnings = (
        *judgement,
        *base_warnings(config, base),
        *reading.warnings,
        *measured.warnings,
        *fitted.warnings,
        *lab_warnings(config.lab, made_of.date.date()),
    )
    result = BuildResult(
        config=config,
        points=reading.points,
        parts=parts,
        measured=measured,
        fit=fitted,
        files=names,
        tyres=tyres,
        members=members,
        plain=fitting.plain_use(config),
        warnings=warnings,
        seconds=time.perf_counter() - began,
        trust=trust,
        remains=left,
        prediction=known,
        missed=missed,
        correction=table,
        made=made_of,
        left_out=(*reading.left_out, *left_out_by_fit(reading.points, fitted)),
        excluded=reading.excluded,
    )
    if out is not None:
        progress(f"{WRITING} {'report' if with_report else 'files'}")
        write_build(result, Path(out), reading.stretches, with_report=with_report)
    return result


def _members(config: Config, fitted: FitResult, count: int, annotated: Annotate) -> Iterator[Tyre]:
    """Tyres drawn from the posterior, each marked as a draw."""
    best = annotated(fitted.tyre, "turn-slip" if config.rig.on_disc else "normal")
    for i, values in enumerate(fitting.ensemble(fitted, count), 1):
        note = {"ensemble": f"draw {i} of {count} from what the fit leaves uncertain"}
        yield best.replace(**values).annotate(status=dict.fromkeys(values, "drawn"), provenance=note)
