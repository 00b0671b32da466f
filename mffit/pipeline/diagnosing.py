"""``mffit diagnose``: which effects explain the difference between a simulation and the measurement."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from threadpoolctl import threadpool_limits

import tir
from mffit import as_json
from mffit import config as configuration
from mffit.config import Config
from mffit.diagnosis import Diagnosis, corrected_points, wording
from mffit.diagnosis import diagnose as find_effects
from mffit.diagnosis.notes import DiagnosisNote, DirectMethodRedone, ModelFittedFirst, ModelOfLastBuild
from mffit.diagnosis.result import WITH_TERMS
from mffit.diagnosis.search import Asked
from mffit.diagnosis.strangers import another_tyre
from mffit.effects import CATALOG, Effect
from mffit.errors import InputError
from mffit.made import made
from mffit.output import UNKNOWN, Project, digest, output_folder, refuse_early, seen_from
from mffit.pipeline.building import build
from mffit.pipeline.inputs import input_hashes, inputs_of, project_of, read_base, read_points
from mffit.pipeline.left_out import left_out_by_diagnosis
from mffit.pipeline.measuring import epsilon_gamma, without_play
from mffit.pipeline.provenance import fitted_to, known_of_model, marked, rig_of_build, use_of, was_edited
from mffit.points import Points
from mffit.points.loading import Reading
from mffit.prediction.stored import load
from mffit.progress import READING, WRITING_DIAGNOSIS, Progress, silent
from mffit.rig import Simulation
from mffit.scatter import rms
from mffit.sweeps import formats
from tir import Tyre
from tir.errors import TirError

WRITTEN = ("diagnosis.json", "diagnosis.html")
"""Files that every diagnosis writes in addition to its property file."""


@formats.reading_once()
def diagnose(
    config: Config | Mapping[str, Any] | str | Path,
    model: Tyre | str | Path | None = None,
    *,
    out: str | Path | None = None,
    effects: Sequence[Effect] = CATALOG,
    repair_all: bool = False,
    progress: Progress = silent,
) -> Diagnosis:
    """Find where a simulation's model and the measurement disagree, and which effects explain it.

    Parameters
    ----------
    config : path of a ``tyre.toml``, its content, or a loaded Config
    model : the model that the simulation uses; default the file of the last build, otherwise one fitted now
    out : folder to write to; nothing is written if None
    effects : the effects to test; add records of your own to the default
    repair_all : correct model and readings for every named effect, also for those below a confidence of 0.5
    progress : called with a sentence before each step

    Returns
    -------
    Diagnosis
        With the direct method repeated on corrected points if a rig effect was found.

    Raises
    ------
    InputError, tir.errors.TirError
        The sweeps or the model cannot be used; nothing is written then.
    """
    config = configuration.load(config)
    progress(READING)
    reading = read_points(config, continuous=True)
    read = [*inputs_of(config), last_build(config), *([Path(model)] if isinstance(model, str | Path) else [])]
    if out is not None:
        names = (f"{config.tyre.name}.tir", f"{config.tyre.name}{WITH_TERMS}", *WRITTEN)
        refuse_early(Path(out), names, read, project_of(config))
    chosen = chosen_model(config, model, progress)
    with threadpool_limits(1):
        found = _explained(config, reading, chosen, effects, repair_all=repair_all, progress=progress)
    diagnosis = _stated(config, reading, found, chosen, out)
    if out is not None:
        progress(WRITING_DIAGNOSIS)
        write_diagnosis(diagnosis, Path(out), project_of(config), protected=read)
    return diagnosis


def _explained(
    config: Config,
    reading: Reading,
    chosen: ChosenModel,
    effects: Sequence[Effect],
    *,
    repair_all: bool,
    progress: Progress,
) -> Diagnosis:
    """The effects that explain the misfit of the chosen model."""
    other = another_tyre(chosen.tyre, config)
    if other is not None:
        progress(other.sentence)
    same = fitted_to(chosen.tyre, config)
    known = known_of_model(chosen.tyre, config, chosen.file, same=same, fresh=chosen.fresh)
    points, known = without_model_error(reading.points, chosen, known)
    asked = replace(
        known,
        rig=rig_of_build(chosen.tyre) if same else None,
        effects=effects,
        repair_all=repair_all,
        as_read=reading.points if reading.as_read is None else reading.as_read,
        taken_off=reading.taken_off,
        culprits=other is None,
    )
    found = find_effects(points, chosen.tyre, config, asked, progress)
    return replace(found, notes=(*([] if other is None else [other]), *chosen.notes, *found.notes))


def without_model_error(points: Points, chosen: ChosenModel, known: Asked) -> tuple[Points, Asked]:
    """The points without the model error that the build of the model found, and the question with what the build left then.

    A formula misses the same tyre alike in every campaign, so this is neither an effect nor noise. A plain file beside one that
    holds at a temperature also misses by what its coefficients took up of the warming.
    """
    if not known.left or chosen.file is None:
        return points, known
    try:
        predictor, _, fitted = load(chosen.file.parent)
    except (InputError, TirError):  # a build of an earlier version, or a folder that was tidied
        return points, known
    names = [name for name, own in predictor.channels.items() if own.is_proven and name in known.left]
    model, given = (Simulation.of(tyre, turn_slip=predictor.curved) for tyre in (fitted, chosen.tyre))
    if was_edited(chosen.tyre, chosen.file):  # its edits are to be found
        given = model
    beyond, plain = (one.readings(points, names) for one in (model, given))
    moved = {name: beyond[name] - plain[name] for name in names}
    missed = {name: math.hypot(predictor.channels[name].size, rms(moved[name])) for name in names}
    u = {name: rms(predictor.u_missed(name, model, points)) for name in names}
    left = dict(known.left) | {
        name: math.hypot(math.sqrt(max(known.left[name] ** 2 - size**2, 0.0)), u[name])
        for name, size in missed.items()
    }
    without = {name: points.channel(name) - moved[name] - predictor.missed(name, points) for name in names}
    return points.replace(**without), replace(known, left=left, missed=missed)


def _stated(
    config: Config, reading: Reading, found: Diagnosis, chosen: ChosenModel, out: str | Path | None
) -> Diagnosis:
    """The diagnosis with its origin, the direct method on corrected points, and its judgement."""
    hashes = input_hashes(config)
    if chosen.file is not None:
        hashes[str(chosen.file)] = digest(chosen.file)
    found = replace(
        found,
        notes=(*found.notes, *_redone(config, reading.points, found, read_base(config))),
        made=made(hashes),
        lab=config.lab,
        left_out=(*reading.left_out, *left_out_by_diagnosis(reading.points, found)),
        given_file=_seen_from(out, chosen.file),
        written_anyway=chosen.fresh,
    )
    why = wording.reasons(found)
    return replace(
        found,
        headline=wording.headline(found),
        reasons=why,
        tyre=marked(found.tyre, why),
        with_terms=found.with_terms and marked(found.with_terms, why),
    )


def _seen_from(out: str | Path | None, file: Path | None) -> str:
    """Path of the given property file relative to the output folder, with slashes; a phrase for a model without a file."""
    if file is None:
        return "the given model"
    if out is None:
        return file.as_posix()
    return seen_from(Path(out), file)


class ChosenModel(NamedTuple):
    """The model that a diagnosis examines."""

    tyre: Tyre
    notes: tuple[DiagnosisNote, ...] = ()  #: on the choice
    file: Path | None = None  #: that it was read from

    @property
    def fresh(self) -> bool:
        """Whether it was fitted just now."""
        return any(isinstance(note, ModelFittedFirst) for note in self.notes)


def chosen_model(config: Config, model: Tyre | str | Path | None, progress: Progress) -> ChosenModel:
    """The given model, otherwise that of the last build, otherwise one fitted now."""
    if isinstance(model, Tyre):
        return ChosenModel(model)
    if model is not None:
        return ChosenModel(tir.read(model), file=Path(model))
    plain = last_build(config)
    wanted = "turn-slip" if config.model.turn_slip and config.rig.on_disc else "normal"
    for path in (plain, plain.with_name(f"{config.tyre.name}-{wanted}.tir")):
        if path.is_file() and use_of(tyre := tir.read(path)) in (wanted, None):
            return ChosenModel(tyre, () if path == plain else (ModelOfLastBuild(path.name),), path)
    fitted = build(config, progress=progress).tyres[wanted]
    return ChosenModel(fitted, (ModelFittedFirst(turn_slip=wanted == "turn-slip"),))


def last_build(config: Config) -> Path:
    """Default path of the property file of a build."""
    return config.folder / "out" / f"{config.tyre.name}.tir"


def _redone(
    config: Config, points: Points, diagnosis: Diagnosis, base: Tyre | None
) -> tuple[DirectMethodRedone, ...]:
    """The direct method on points corrected for the rig effects, if any were found."""
    causes = tuple(found.effect.name for found in diagnosis.repaired if found.effect.kind == "rig")
    if not config.rig.on_disc or not causes:
        return ()
    corrected = corrected_points(points, diagnosis.state)
    before = epsilon_gamma(config, points, base)
    return (DirectMethodRedone(causes, before, epsilon_gamma(without_play(config), corrected, base)),)


def write_diagnosis(
    diagnosis: Diagnosis, out: Path, of: Project = UNKNOWN, protected: Iterable[Path] = ()
) -> None:
    """Write every output of a diagnosis, or nothing; the ``protected`` files, which were read, are not replaced."""
    from mffit import report

    with output_folder(out, by="diagnose", of=of, protected=protected) as folder:
        if diagnosis.delivers or diagnosis.written_anyway:
            diagnosis.tyre.write(folder / diagnosis.model_after)
        if diagnosis.with_terms is not None:
            diagnosis.with_terms.write(folder / str(diagnosis.model_with_terms))
        as_json.write(folder / "diagnosis.json", diagnosis)
        report.write_diagnosis(diagnosis, folder)
