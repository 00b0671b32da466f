"""The diagnosis, step by step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from mffit.config import Config, axis_signs, declared_faults
from mffit.diagnosis.answer import answer, named_effects, not_accepted
from mffit.diagnosis.conditions import by_condition
from mffit.diagnosis.explain import explain, only_first
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.inexact import Inexactness, with_zeros
from mffit.diagnosis.inexact import declared as declared_inexactness
from mffit.diagnosis.needs import possible, without
from mffit.diagnosis.notes import DiagnosisNote, NoRepair, OneSweep, TakenOff, WithinPlay
from mffit.diagnosis.priors import declared_priors, zeros_of_setups
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.repair import checked, repair
from mffit.diagnosis.rest import hardly_this_tyre, remaining
from mffit.diagnosis.result import Diagnosis
from mffit.diagnosis.stated import stated_noise, with_uncertainties
from mffit.diagnosis.strangers import offsets_or_memory, refuse_strangers, without_noise
from mffit.diagnosis.validation import Validation, raw_gap
from mffit.effects import CATALOG, Effect
from mffit.fit.plan import channels_of
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.rig import Simulation
from mffit.rig_errors import T_REF
from mffit.suspicion.misread import misread
from tir import Tyre


def diagnose(
    points: Points,
    tyre: Tyre,
    config: Config,
    *,
    rig: Mapping[str, float] | None = None,
    effects: Sequence[Effect] = CATALOG,
    coefficients: Inexactness | None = None,
    seen: bool = False,
    repair_all: bool = False,
    as_read: Points | None = None,
    taken_off: Sequence[str] = (),
    culprits: bool = True,
    progress: Progress = silent,
) -> Diagnosis:
    """The diagnosis of a model: where it disagrees with points (n,), ISO-W, angles as read, and the effects that explain this.

    Of ``config``, the declarations of model, rig and tyre name are used. ``rig`` are known rig errors, of the rig or of a
    set-up, by default the declared play alone; ``coefficients`` is the prior of the model's coefficients, by default from
    ``model.u_coefficients``; ``seen``: the model was fitted to these points; ``repair_all``: see :mod:`mffit.diagnosis.repair`.
    ``as_read`` are the points (n,) before known errors were subtracted, about which ``taken_off`` has sentences. ``culprits``:
    search for a wrongly recorded sweep, which needs a model of this tyre.

    Raises InputError if points and model cannot belong together, or there are too few points.
    """
    progress("comparing simulation and measurement")
    start = _simulation(points, tyre, config, rig)
    channels = channels_of(points)
    refuse_strangers(points, tyre, start, channels)
    given_points, given_start, every = points, start, points if as_read is None else as_read
    wrong = misread(points, start, axis_signs(config), channels) if culprits else None
    kept = np.ones(len(points), dtype=bool)
    if wrong is not None:
        kept = np.array([name != wrong.sweep for name in points.sweep_names])[points.sweep]
    points = points.select(kept)
    points, origin = with_uncertainties(by_condition(points), start, channels)
    inexact = coefficients or declared_inexactness(tyre, config.model.u_coefficients)
    candidates, notes = _candidates(effects, points, start, known=inexact.names if seen else ())
    progress("trying every effect")
    declared = declared_priors(config, points, start, channels)
    zeros = [name for name in zeros_of_setups(points, channels) if name in declared]
    inexact = with_zeros(inexact, declared, zeros) if zeros else inexact
    noise = stated_noise(points, origin, channels)
    found = explain(points, start, noise, candidates, inexact, declared, seen=seen)
    beyond = hardly_this_tyre(found)
    if wrong is not None and beyond:
        return diagnose(
            given_points,
            tyre,
            config,
            rig=rig,
            effects=effects,
            coefficients=coefficients,
            seen=seen,
            repair_all=repair_all,
            as_read=as_read,
            taken_off=taken_off,
            culprits=False,
            progress=progress,
        )
    if beyond:
        found = found.withdrawn()
    progress("checking on left-out sweeps")
    given = DiagnosisProblem(points, start, found.independent)
    found, validation, refused = _confirmed(found, given, inexact, seen=seen)
    found = found if found.further is not None else found.contested()
    named = named_effects(found, given)
    rivals = not_accepted(found)
    done = repair(found, named, given, inexact, validation, rivals, seen=seen, every=repair_all)
    rest = (*beyond, *remaining(found))
    memories = offsets_or_memory(found.scatter, candidates, found.chosen.ids)
    remarks = (
        *(TakenOff(sentence) for sentence in taken_off),
        wrong,
        without_noise(found.scatter),
        *memories,
        _within_play(done.explanation),
        *notes,
        refused,
        done.refused,
    )
    notes = [note for note in remarks if note is not None]
    before = raw_gap(every, given_start, kept, found.scatter)
    return answer(found, named, rest, done, given, tyre, config, notes, candidates, rivals, before, seen)


def _within_play(found: Explanation) -> WithinPlay | None:
    """The note on readings at which friction decides where the wheel rests; None without any."""
    count = int(np.sum(found.refined.state.floats(found.problem.points)))
    return WithinPlay(count) if count else None


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


def _candidates(
    effects: Sequence[Effect], points: Points, start: Simulation, known: Sequence[str]
) -> tuple[list[Effect], list[DiagnosisNote]]:
    """Candidate effects, and notes on effects that are not visible; effects of the ``known``, refitted coefficients are left out.

    If coefficients are refitted, the reference temperature is fixed at the mean of the points.
    """
    candidates, hidden = possible(effects, points, start)
    if known:
        candidates = [without(effect, T_REF) for effect in candidates]
    if len(np.unique(points.sweep)) < 2:
        return [], [*hidden, OneSweep()]
    return [e for e in candidates if not set(e.parameters) <= set(known)], [*hidden]


def _confirmed(
    found: Explanation, given: DiagnosisProblem, inexact: Inexactness, *, seen: bool
) -> tuple[Explanation, Validation, NoRepair | None]:
    """The explanation if left-out sweeps confirm it, else its first effect alone, else none; its validation; the refusal."""
    done, validation, refused = checked(found, given, inexact, seen=seen)
    if refused is not None and len(found.chosen.effects) > 1:
        done, validation, _ = checked(only_first(found, inexact), given, inexact, seen=seen)
    return done, validation, refused
