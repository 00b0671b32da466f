"""The diagnosis: gap, where, what, ties, correction, what remains."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
from scipy.stats import chi2 as chi2_distribution

from mffit.config import Config
from mffit.diagnosis import wording
from mffit.diagnosis.candidates import Hypothesis, Problem
from mffit.diagnosis.conditions import by_condition
from mffit.diagnosis.needs import missing
from mffit.diagnosis.noise import Noise, noise_model, with_uncertainties
from mffit.diagnosis.notes import HardlyThisTyre, Note, NotVisible, OneSweep, UncertaintiesEnlarged
from mffit.diagnosis.result import Diagnosis, Found
from mffit.diagnosis.selection import TIE, Step, price, select
from mffit.diagnosis.ties import separation
from mffit.diagnosis.unknown import Bump, bump_scan
from mffit.diagnosis.validate import gap, validate
from mffit.diagnosis.where import Region, where
from mffit.effects import CATALOG, Effect
from mffit.errors import InputError
from mffit.points import Points
from mffit.rig import RigFaults, Simulation
from tir import Tyre
from tir.parameters import BY_NAME

FEWEST_POINTS = 12
MOST_POINTS = 800
"""Points beyond this are neighbours that say the same again: every k-th is used."""
UNEXPLAINED = 1.5
"""chi2 per reading, against the uncertainties as given, above which a diagnosis is not complete."""
STRANGER = 30.0
"""Misfit in units of the noise beyond which a model is so wrong that naming an effect would be a guess."""
LACK_OF_FIT = 1.3
"""chi2 per reading that no accepted explanation brings down: the misfit then counts as noise."""


def diagnose(
    points: Points,
    tyre: Tyre,
    config: Config,
    *,
    rig: RigFaults | None = None,
    effects: Sequence[Effect] = CATALOG,
    progress: Callable[[str], None] = lambda sentence: None,
) -> Diagnosis:
    """Find where a model disagrees with points, and the effects that explain it.

    Parameters
    ----------
    points : raw points (n,), ISO-W, angles as read
    tyre : the model of the simulation
    config : its tables ``model``, ``rig.backlash_deg`` and ``tyre.name`` are used
    rig : what is known of the rig's errors; default the declared play alone
    effects : the library to choose from; add your own records to the catalogue's
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
    declared = rig or RigFaults(backlash_deg=config.rig.backlash_deg)
    simulates_spin = config.model.turn_slip and bool(np.any(points.phi_t))
    start = Simulation(dict(tyre.values), declared, simulates_spin, config.model.star)
    refuse_strangers(points, tyre, start)
    points, origin = with_uncertainties(by_condition(points), start)
    points = thinned(points)
    noise = noise_model(points, start, config.model.u_coefficients, origin)
    candidates, notes = possible(effects, points, start)
    if len(np.unique(points.sweep)) < 2:
        candidates = []
        notes.append(OneSweep())
    progress("trying every effect")
    problem, chosen, steps, bump = _explained(points, start, noise, candidates)
    if config.model.u_coefficients and chosen.effects:
        # What an inexact coefficient does depends on the rest of the model: ask again at the one that was found.
        noise = noise_model(points, chosen.state, config.model.u_coefficients, origin)
        problem, chosen, steps, bump = _explained(points, start, noise, candidates)
    if candidates and steps and not (bump.found and not chosen.effects):
        inflation = _lack_of_fit(problem, chosen)
        if inflation > STRANGER:
            notes.append(HardlyThisTyre(inflation))
            chosen, steps = problem.null, steps[:1]
        elif inflation > 1.0:
            notes.append(UncertaintiesEnlarged(inflation))
            problem, chosen, steps, bump = _explained(points, start, noise.inflated(inflation), candidates)
    progress("checking on left-out sweeps")
    return _record(problem, tyre, config, chosen, steps, bump, notes, noise)


def _explained(
    points: Points, start: Simulation, noise: Noise, candidates: Sequence[Effect]
) -> tuple[Problem, Hypothesis, list[Step], Bump]:
    """Select effects, unless structure that no effect has explains more than all of them together."""
    problem = Problem(points, start, noise)
    scan = bump_scan(points, noise)
    rival = scan.best(problem.null)
    chosen, steps = select(problem, candidates) if candidates else (problem.null, [])
    gained = chosen.log_evidence - problem.null.log_evidence - len(chosen.effects) * price(len(candidates))
    if rival.found and rival.gain > gained:
        return problem, problem.null, steps[:1], rival
    return problem, chosen, steps, scan.best(chosen)


def thinned(points: Points) -> Points:
    """At most some eight hundred points, evenly from every sweep."""
    step = int(np.ceil(len(points) / MOST_POINTS))
    return points if step <= 1 else points.select(np.arange(0, len(points), step))


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
            out.append(effect)
    return out, [NotVisible(lack, tuple(ids)) for lack, ids in lacking.items()]


def _lack_of_fit(problem: Problem, chosen: Hypothesis) -> float:
    """Factor on all uncertainties that makes the remaining misfit noise, its correlation along sweeps counted."""
    m = len(chosen.residual)
    ratio = chosen.chi2 / m
    if ratio < LACK_OF_FIT or len(chosen.effects) < 3:
        return 1.0
    residual = np.full(2 * len(problem.points), np.nan)
    residual[problem.noise.used] = chosen.residual
    n = len(problem.points)
    products = [
        r[1:] * r[:-1]
        for k in np.unique(problem.points.sweep)
        for r in (residual[:n][problem.points.sweep == k], residual[n:][problem.points.sweep == k])
    ]
    neighbours = float(np.clip(np.nanmean(np.concatenate(products)) / ratio, 0.0, 0.95))
    return float(np.sqrt(ratio * (1.0 + neighbours) / (1.0 - neighbours)))


def _record(
    problem: Problem,
    tyre: Tyre,
    config: Config,
    chosen: Hypothesis,
    steps: Sequence[Step],
    bump: Bump,
    notes: Sequence[Note],
    noise: Noise,
) -> Diagnosis:
    points = problem.points
    before, after = problem.start.predict(points), chosen.state.predict(points)
    residual_before, residual_after = problem.measured - before, problem.measured - after
    found = tuple(_found(problem, chosen, steps, effect, noise) for effect in chosen.effects)
    remaining = where(points, residual_after, problem.noise)
    p_value = float(chi2_distribution.sf(chosen.chi2, max(len(chosen.residual) - len(chosen.numbers), 1)))
    misfit = gap(residual_after, noise).chi2_per_dof
    unexplained = (bump.found and (p_value < 0.05 or not chosen.effects)) or misfit > UNEXPLAINED
    return Diagnosis(
        points=points,
        noise=problem.noise,
        before=before,
        after=after,
        gap_before=gap(residual_before, noise),
        gap_after=gap(residual_after, noise),
        validation=validate(problem, chosen, noise),
        where=where(points, residual_before, problem.noise),
        effects=found,
        alternatives=_alternatives(steps, chosen),
        steps=tuple(steps),
        unexplained=unexplained,
        unexplained_where=((_bump_region(bump),) if bump.found else ())
        + (remaining[:4] if unexplained else ()),
        bump=bump if bump.found else None,
        state=chosen.state,
        tyre=_corrected(tyre, chosen),
        notes=tuple(notes),
        model_after=f"{config.tyre.name}.tir",
    )


def _found(
    problem: Problem, chosen: Hypothesis, steps: Sequence[Step], effect: Effect, noise: Noise
) -> Found:
    """What is said of one accepted effect: judged beside all the others that were accepted."""
    others = tuple(e for e in chosen.effects if e.id != effect.id)
    step = next(
        (s for s in steps if s.best.effects[-1].id == effect.id),
        steps[min(len(steps), len(chosen.effects)) - 1],
    )
    tied = _tied(problem, chosen, step, others)
    logs = {effect.id: chosen.log_evidence} | {t.effects[-1].id: t.log_evidence for t in tied}
    top = max(logs.values())
    share = {name: float(np.exp(v - top)) for name, v in logs.items()}
    certainty = 1.0 - step.weights().get("none", 0.0)
    separations = [separation(problem.points, chosen, t, problem.noise.Fy, problem.noise.Mz) for t in tied]
    upto = chosen if not others else step.best
    return Found(
        effect=effect,
        confidence=certainty * share[effect.id] / sum(share.values()),
        parameters={n: (chosen.numbers[n], chosen.stderr.get(n, 0.0)) for n in effect.parameters},
        gap_after=gap(problem.measured - upto.state.predict(problem.points), noise),
        tied_with=tuple(t.effects[-1].id for t in tied),
        separation=min(separations, key=lambda s: s.chi2, default=None),
    )


def _tied(problem: Problem, chosen: Hypothesis, step: Step, others: tuple[Effect, ...]) -> list[Hypothesis]:
    """Explanations with another effect in the place of one, refitted beside the others, that do as well."""
    ids = {e.id for e in chosen.effects}
    names = {name for e in others for name in e.parameters}
    kept = {name: value for name, value in chosen.numbers.items() if name in names}
    hopeless = 40.0 + (0.5 * abs(step.gain) if others else 0.0)
    out = []
    for trial in step.trials:
        rival = trial.effects[-1]
        if rival.id in ids or step.best.log_evidence - trial.log_evidence > hopeless:
            continue
        refitted = problem.fit((*others, rival), kept) if others else trial
        if chosen.log_evidence - refitted.log_evidence < TIE:
            out.append(refitted)
    return out


def _alternatives(steps: Sequence[Step], chosen: Hypothesis) -> dict[str, float]:
    """Weights of what was not accepted: in the first step if something was, else in the last."""
    if not steps:
        return {}
    accepted = {effect.id for effect in chosen.effects}
    source = steps[0 if chosen.effects else -1].weights()
    return {name: w for name, w in source.items() if name not in accepted and name != "none" and w > 1e-4}


def _bump_region(bump: Bump) -> Region:
    return Region(
        bump.channel,
        bump.region,
        bump.amplitude,
        float(np.sign(bump.amplitude) * np.sqrt(2.0 * max(bump.gain, 0.0))),
    )


def _corrected(tyre: Tyre, chosen: Hypothesis) -> Tyre:
    """The property file with the tyre effects as coefficients and their reason in the comments."""
    changes, status = {}, {}
    for effect in chosen.effects:
        for name in effect.parameters:
            if name in BY_NAME:
                changes[name] = chosen.numbers[name]
                error = chosen.stderr.get(name, 0.0)
                status[name] = wording.status(effect.id, float(tyre[name]), error)
    return tyre.replace(**changes).annotate(status=status) if changes else tyre
