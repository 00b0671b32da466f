"""The diagnosis: gap, where, what, ties, correction, what remains."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.config import Config, axis_signs
from mffit.diagnosis.answer import answer
from mffit.diagnosis.candidates import Problem
from mffit.diagnosis.conditions import by_condition
from mffit.diagnosis.declared import declared_rig
from mffit.diagnosis.explain import Explanation, explain, only_first
from mffit.diagnosis.inexact import EXACT, Inexactness
from mffit.diagnosis.inexact import declared as declared_inexactness
from mffit.diagnosis.needs import missing
from mffit.diagnosis.noise import noise_model, with_uncertainties
from mffit.diagnosis.notes import HardlyThisTyre, NoRepair, Note, NotVisible, OneSweep
from mffit.diagnosis.result import Diagnosis
from mffit.diagnosis.validate import Validation, validate
from mffit.effects import CATALOG, Effect
from mffit.errors import InputError
from mffit.points import Points
from mffit.progress import Progress, silent
from mffit.quantities import CHANNELS
from mffit.rig import RigFaults, Simulation
from mffit.scatter import robust
from mffit.suspicion import misread
from tir import Tyre

FEWEST_POINTS = 12
STRANGER = 30.0
"""Misfit in units of the noise beyond which a model is so wrong that naming an effect would be a guess."""


def diagnose(
    points: Points,
    tyre: Tyre,
    config: Config,
    *,
    rig: RigFaults | None = None,
    effects: Sequence[Effect] = CATALOG,
    coefficients: Inexactness | None = None,
    seen: bool = False,
    progress: Progress = silent,
) -> Diagnosis:
    """Find where a model disagrees with points, and the effects that explain it.

    Parameters
    ----------
    points : raw points (n,), ISO-W, angles as read
    tyre : the model of the simulation
    config : its tables ``model``, ``rig.backlash_deg`` and ``tyre.name`` are used
    rig : what is known of the rig's errors; default the declared play alone
    effects : the library to choose from; add your own records to the catalogue's
    coefficients : prior of the model's coefficients; default from ``model.u_coefficients``
    seen : whether the model was fitted to these very points
    progress : called with a sentence before each step

    Returns
    -------
    Diagnosis

    Raises
    ------
    InputError
        If points and model cannot belong together, or are too few.
    """
    progress("comparing simulation and measurement")
    given = rig or RigFaults(backlash_deg=config.rig.backlash_deg)
    if np.any(np.isfinite(points.T)):
        given = replace(given, T_ref_degC=float(np.nanmean(points.T)))
    simulates_spin = config.model.turn_slip and bool(np.any(points.phi_t))
    radius = config.rig.radius or math.nan
    start = Simulation(dict(tyre.values), given, simulates_spin, config.model.star, radius_m=radius)
    refuse_strangers(points, tyre, start)
    wrong = misread(points, start, axis_signs(config))
    if wrong is not None:
        points = points.select(np.array([name != wrong.sweep for name in points.sweep_names])[points.sweep])
    points, origin = with_uncertainties(by_condition(points), start)
    inexact = coefficients or declared_inexactness(tyre, config.model.u_coefficients)
    candidates, notes = possible(effects, points, start)
    if wrong is not None:
        notes.insert(0, wrong)
    if seen:  # what is refitted in any case is no missing effect
        candidates = [e for e in candidates if not set(e.parameters) <= set(inexact.names)]
    if len(np.unique(points.sweep)) < 2:
        candidates = []
        notes.append(OneSweep())
    progress("trying every effect")
    stated = noise_model(points, start, 0.0, origin)
    found = explain(
        points, start, stated, candidates, inexact, declared_rig(config, points, start), seen=seen
    )
    misfit, better = _misfit(found, points)
    if found.chosen.effects and misfit > STRANGER:
        notes.append(HardlyThisTyre(misfit, better))
        found = _without_effects(found)
    progress("checking on left-out sweeps")
    given_problem = Problem(points, start, found.plain.noise)
    found, validation, refused = _confirmed(found, given_problem, inexact, seen=seen)
    if refused is not None:
        notes.append(refused)
    return answer(found, given_problem, tyre, config, validation, notes, candidates)


def _confirmed(
    found: Explanation, given: Problem, inexact: Inexactness, seen: bool
) -> tuple[Explanation, Validation, NoRepair | None]:
    """What left-out sweeps confirm: everything, else the first effect alone, else nothing; and what they refuse."""
    if seen and not found.chosen.effects:  # refitting what was fitted to these points is no repair
        found = _without_effects(found)
    validation = validate(given, found.refined, inexact if found.coefficients else EXACT, seen=seen)
    if not (found.chosen.effects or found.coefficients) or _helps(validation):
        return found, validation, None
    refused = NoRepair(tuple(e.name for e in found.chosen.effects), validation)
    if len(found.chosen.effects) > 1:
        fewer = only_first(found, inexact)
        validation = validate(given, fewer.refined, inexact, seen=seen)
        if _helps(validation):
            return fewer, validation, refused
    before = validation.gap_before
    return _without_effects(found), Validation(validation.folds, before, before), refused


def _helps(validation: Validation) -> bool:
    """Whether left-out sweeps are nearer together, and in no channel farther off."""
    nearer = validation.gap_after.chi2_per_dof < validation.gap_before.chi2_per_dof
    return nearer and not validation.raised


def _without_effects(found: Explanation) -> Explanation:
    """Nothing named, nothing repaired."""
    null = found.problem.null
    return replace(found, chosen=null, refined=null, coefficients={}, steps=found.steps[:1])


def _misfit(found: Explanation, points: Points) -> tuple[float, str]:
    """How far the best explanation misses the better channel, in units of its noise as stated; a median, for wild readings.

    A channel that is lost in noise leaves the answers of the other.
    """
    n, noise = len(points), found.scatter
    residual = np.concatenate([points.Fy, points.Mz]) - found.refined.state.predict(points)
    z = np.where(np.isfinite(noise.stated), residual / noise.stated, np.nan)
    misfit = {name: robust(rows) for name, rows in zip(CHANNELS, (z[:n], z[n:]), strict=True)}
    better = min(misfit, key=lambda name: np.nan_to_num(misfit[name], nan=np.inf))
    return misfit[better], better


def refuse_strangers(points: Points, tyre: Tyre, start: Simulation) -> None:
    """A model and data that cannot belong together end the diagnosis with the likely cause."""
    if len(points) < FEWEST_POINTS:
        raise InputError(
            f"{len(points)} points are too few for a diagnosis: measure at least {FEWEST_POINTS}"
        )
    ratio = float(np.median(points.Fz)) / float(tyre["FNOMIN"])
    if not 0.1 < ratio < 10.0:
        raise InputError(
            f"the data's loads (median {np.median(points.Fz):.0f} N) and the model's FNOMIN {tyre['FNOMIN']:.0f} N are an order "
            "apart: this model is of another tyre, or one of them is not in newtons"
        )
    n, simulated = len(points), start.predict(points)
    for channel, model, measured in (("Fy", simulated[:n], points.Fy), ("Mz", simulated[n:], points.Mz)):
        known = np.isfinite(measured)
        if not np.any(known) or np.std(model[known]) == 0.0 or np.std(measured[known]) == 0.0:
            continue
        agreement = float(np.corrcoef(model[known], measured[known])[0, 1])
        if agreement < -0.3:
            raise InputError(
                f"simulated and measured {channel} run against each other (correlation {agreement:.2f}): data or model are in "
                "other axes; check [rig] axes and the signs of PKY1 and PKY6"
            )


def possible(effects: Sequence[Effect], points: Points, start: Simulation) -> tuple[list[Effect], list[Note]]:
    """Effects that the data can show, and notes on the others."""
    out: list[Effect] = []
    lacking: dict[tuple[str, ...], list[str]] = {}
    for effect in effects:
        lack = missing(effect, points)
        if effect.id == "turn-slip" and start.turn_slip:
            continue
        if lack:
            lacking.setdefault(lack, []).append(effect.id)
        else:
            out.append(effect.of_runs(sorted({points.files[k] for k in np.unique(points.file)})))
    return out, [NotVisible(lack, tuple(ids)) for lack, ids in lacking.items()]
