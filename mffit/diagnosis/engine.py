"""The diagnosis, step by step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from mffit.config import Config, axis_signs, declared_faults
from mffit.diagnosis.answer import answer, named_effects, not_accepted
from mffit.diagnosis.conditions import by_condition
from mffit.diagnosis.estimated import beyond_build, odd_runs
from mffit.diagnosis.explain import explain
from mffit.diagnosis.inexact import declared as declared_inexactness
from mffit.diagnosis.inexact import with_rig
from mffit.diagnosis.needs import possible, without
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.notes import (
    CountsAsExact,
    DiagnosisNote,
    LeftByFormula,
    MoreThanBuild,
    NoRepair,
    NotVisible,
    OneSweep,
    TakenOff,
    WithinPlay,
    WithoutModelError,
)
from mffit.diagnosis.priors import declared_priors, zeros_of_setups
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.repair import Confirmed, Repair, checked, repair
from mffit.diagnosis.rest import hardly_this_tyre, remaining
from mffit.diagnosis.result import Diagnosis
from mffit.diagnosis.search import NOTHING_KNOWN, Asked, Search
from mffit.diagnosis.stated import stated_noise, with_uncertainties
from mffit.diagnosis.strangers import offsets_or_memory, refuse_strangers, without_noise
from mffit.diagnosis.validation import raw_gap
from mffit.effects import Effect
from mffit.fit.plan import channels_of
from mffit.points import Points
from mffit.progress import COMPARING, CONTESTING, CORRECTING, LEAVING_OUT, Progress, silent
from mffit.rig import Simulation
from mffit.rig_errors import T_REF
from mffit.suspicion.misread import Misread, misread
from tir import Tyre


def diagnose(
    points: Points, tyre: Tyre, config: Config, asked: Asked = NOTHING_KNOWN, progress: Progress = silent
) -> Diagnosis:
    """The diagnosis of a model: where it disagrees with points (n,), ISO-W, angles as read, and the effects that explain this.

    Of ``config``, the declarations of model, rig and tyre name are used. ``progress`` is called with a sentence before each
    step.

    Raises InputError if points and model cannot belong together, or there are too few points.
    """
    progress(COMPARING)
    start, channels = _simulation(points, tyre, config, asked.rig), channels_of(points)
    refuse_strangers(points, tyre, start, channels)
    wrong = misread(points, start, axis_signs(config), channels) if asked.culprits else None
    kept = np.ones(len(points), dtype=bool)
    if wrong is not None:
        kept = np.array([name != wrong.sweep for name in points.sweep_names])[points.sweep]
    examined, origin = with_uncertainties(by_condition(points.select(kept)), start, channels)
    search = _search(examined, stated_noise(examined, origin, channels), start, tyre, config, asked)
    search = replace(search, progress=progress)
    found = explain(search)
    beyond = hardly_this_tyre(found)
    if wrong is not None and beyond:  # no sweep is wrong for a model of another tyre
        return diagnose(points, tyre, config, replace(asked, culprits=False), progress)
    if beyond:
        found = found.withdrawn()
    progress(LEAVING_OUT)
    given = DiagnosisProblem(examined, start, found.independent)
    found, validation, refused = checked(found, given, search)
    progress(CONTESTING)
    found = found.contested()
    rest = (*beyond, *remaining(found))
    others = not_accepted(found)
    confirmed = Confirmed(found, given, named_effects(config, found, given, others), others, rest)
    progress(CORRECTING)
    done = repair(confirmed, validation, search)
    notes = _notes(search, confirmed, wrong, done, refused)
    before = raw_gap(points if asked.as_read is None else asked.as_read, start, kept, found.scatter)
    return answer(search, confirmed, done, notes, before)


def _notes(
    search: Search, confirmed: Confirmed, wrong: Misread | None, done: Repair, refused: NoRepair | None
) -> list[DiagnosisNote]:
    """What the reader of a diagnosis must know in addition to its effects."""
    found = confirmed.found
    playing = int(np.sum(done.explanation.refined.state.floats(done.explanation.problem.points)))
    more = {} if confirmed.rest else beyond_build(found, search)
    by_build = bool(search.asked.left)
    u = search.excusing(found.smooth)
    misses = not confirmed.rest and (found.smooth.expected if by_build else found.smooth.found)
    left = LeftByFormula(search.asked.left or search.by_coefficients, not by_build) if misses else None
    remarks = (
        *(TakenOff(sentence) for sentence in search.asked.taken_off),
        WithoutModelError(search.asked.missed) if search.asked.missed else None,
        wrong,
        odd_runs(done.explanation, search, doubted=bool(confirmed.rest or more)),
        MoreThanBuild(more) if more else left,
        CountsAsExact(u, search.config.model.u_coefficients) if u else None,
        without_noise(found.scatter),
        *offsets_or_memory(found.scatter, search.candidates, found.chosen.ids),
        WithinPlay(playing) if playing else None,
        *search.hidden,
        refused,
        done.refused,
    )
    return [note for note in remarks if note is not None]


def _simulation(points: Points, tyre: Tyre, config: Config, rig: Mapping[str, float] | None) -> Simulation:
    """The given model with the declared and known rig errors, referred to the mean temperature of the points."""
    given = declared_faults(config.rig)
    if np.any(np.isfinite(points.T)):
        given = given.replace(T_ref_degC=float(np.nanmean(points.T)))
    return Simulation(
        values=dict(tyre.values),
        faults=given,
        turn_slip=config.model.turn_slip and bool(np.any(points.phi_t)),
        star=config.model.star,
        radius_m=config.rig.radius or math.nan,
    ).with_numbers(rig or {})


def _search(
    points: Points, stated: Noise, start: Simulation, tyre: Tyre, config: Config, asked: Asked
) -> Search:
    """The search for effects in points (n,) with the ``stated`` noise, around the given model ``start``."""
    inexact = asked.coefficients or declared_inexactness(tyre, config.model.u_coefficients)
    candidates, hidden = _candidates(asked.effects, points, start, known=inexact.names if asked.seen else ())
    declared = declared_priors(config, points, start, stated.channels)
    zeros = [name for name in zeros_of_setups(points, stated.channels) if declared.get(name, (0.0, 0.0))[1]]
    return Search(
        tyre=tyre,
        config=config,
        asked=asked,
        points=points,
        start=start,
        stated=stated,
        candidates=tuple(candidates),
        hidden=tuple(hidden),
        inexact=with_rig(inexact, declared, zeros),
        declared=declared,
    )


def _candidates(
    effects: Sequence[Effect], points: Points, start: Simulation, known: Sequence[str]
) -> tuple[list[Effect], list[NotVisible | OneSweep]]:
    """Candidate effects, and notes on effects that are not visible; effects of the ``known``, refitted coefficients are left out.

    If coefficients are refitted, the reference temperature is fixed at the mean of the points.
    """
    candidates, hidden = possible(effects, points, start)
    if known:
        candidates = [without(effect, T_REF) for effect in candidates]
    if len(np.unique(points.sweep)) < 2:
        return [], [*hidden, OneSweep()]
    return [e for e in candidates if not set(e.parameters) <= set(known)], [*hidden]
