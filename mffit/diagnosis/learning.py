"""The scatter of the readings, learned beside everything that could explain their misfit."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.bumps import bump_scan
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.scatter import ExplainingColumns, learned
from mffit.effects import Effect
from mffit.points import Points
from mffit.rig import Simulation
from mffit.scatter import robust


def learned_noise(
    stated: Noise,
    before: Noise,
    points: Points,
    state: Simulation,
    candidates: Sequence[Effect],
    inexact: Inexactness,
    basis: np.ndarray,
    *,
    without_offsets: bool = False,
) -> Noise:
    """The noise with the scatter that stays when every candidate, coefficient and structure may explain the misfit.

    The search starts at the noise ``before``, as found in the last round. ``without_offsets``: no run is offset.
    """
    problem = DiagnosisProblem(points, state, stated.alone())
    predicted = np.nan_to_num(problem.predict(state))
    residual = problem.measured - predicted
    nothing = np.zeros((len(predicted), 0))
    # The slope of each effect, and the first finite step of a number without slope at zero.
    columns = {e: groups[:2] for e, groups in problem.columns(state, candidates).items()}
    runs = {e.id: g[0] for e, g in columns.items() if e.differs_by_run}
    others = [g for e, groups in columns.items() if not e.differs_by_run for g in groups]
    generous = constants.GENEROUS_EFFECT_SIZE
    named = np.column_stack(
        [nothing, *(generous * g for g in others), inexact.columns(points, state, problem.channels)]
    )
    named = _with_bumps(problem, residual, named, basis)
    explained = ExplainingColumns(named=named, runs=runs, smooth=basis, withdrawn=without_offsets)
    start = replace(stated, scatter=before.scatter)
    found = learned(start, residual, explained, predicted)
    if len(points.campaigns) > 1:
        allowed = found.sharing(named, constants.ASSUMED_SMOOTH_AMPLITUDE * basis, *runs.values())
        factors = factors_of_campaigns(allowed, np.nan_to_num(residual), points.campaign)
        if np.any(factors != 1.0):
            own = replace(start, u=factors * start.u, stated=factors * start.stated)
            found = learned(own, residual, explained, predicted)
    return found.alone()


def factors_of_campaigns(noise: Noise, residual: np.ndarray, campaign: np.ndarray) -> np.ndarray:
    """Factors (c n,) by which the uncertainties of each campaign (n,) differ from those of its channel; 1 where chance may do it.

    Rigs differ in their noise, and one scale for all would trust the readings of one campaign too much. The logarithms of the
    factors have a mean of 0 over the readings of a channel: the scale of the whole channel is that of its scatter.
    """
    logs = np.zeros(len(noise.u))
    z = np.full(len(noise.u), np.nan)
    z[noise.used] = noise.whiten(residual)
    for rows in noise.by_channel(np.arange(len(z))).values():
        known = rows[np.isfinite(z[rows])]
        of = campaign[known - rows[0]]
        apart = False
        for k in np.unique(of):
            own, others = known[of == k], known[of != k]
            if not len(others):
                continue
            logs[own] = math.log(max(robust(z[own]), 1e-9))
            chance = math.sqrt(constants.VARIANCE_OF_LOG_ROBUST * (1.0 / len(own) + 1.0 / len(others)))
            ratio = math.log(max(robust(z[own]), 1e-9) / max(robust(z[others]), 1e-9))
            apart = apart or abs(ratio) > constants.CAMPAIGNS_APART * chance
        logs[rows] = logs[rows] - np.mean(logs[known]) if apart else 0.0
    return np.exp(logs)


def _with_bumps(
    problem: DiagnosisProblem, residual: np.ndarray, named: np.ndarray, basis: np.ndarray
) -> np.ndarray:
    """What could explain the misfit (c n, k), with the bumps that are found beside it."""
    points = problem.points
    for _ in range(constants.MOST_BUMPS_SET_ASIDE):
        allowed = problem.noise.sharing(named, constants.ASSUMED_SMOOTH_AMPLITUDE * basis)
        white = allowed.whiten(np.nan_to_num(residual))
        channel = allowed.used // len(points)
        for k in range(len(problem.channels)):
            rows = channel == k
            white[rows] /= max(robust(white[rows]), 1e-9) if rows.any() else 1.0
        scan = bump_scan(points, allowed)
        bump = scan.best(replace(problem.null, residual=white), constants.BUMP_RESIDUAL_CLIP)
        if not bump.found:
            break
        named = np.column_stack([named, constants.GENEROUS_EFFECT_SIZE * scan.plausible(bump)])
    return named


def beyond_memory(noise: Noise, candidates: Sequence[Effect]) -> list[Effect]:
    """The candidates without offsets of runs that errors with a memory explain as well.

    Offsets that exceed the memory get the spread that was found with the memory beside them.
    """
    kept = []
    for effect in candidates:
        offsets = noise.offsets.get(effect.id)
        if offsets is None:
            kept.append(effect)
        elif effect.id in noise.offset:
            wider = max(offsets.size, 1.0)
            kept.append(replace(effect, free=tuple(replace(f, spread=wider * f.spread) for f in effect.free)))
    return kept


def settled(before: Noise, after: Noise) -> bool:
    """Whether the scatter changed so little that the effects need not be judged again."""
    used = after.used
    change = np.abs(np.log(after.u[used] / before.u[used]))
    memory = [abs(after.scatter[c].memory - before.scatter[c].memory) for c in after.channels]
    spans = [after.scatter[c].span is before.scatter[c].span for c in after.channels]
    return not (
        not all(spans)
        or np.median(change) > constants.SCATTER_SETTLED
        or np.quantile(change, 0.95) > constants.SCATTER_SETTLED_TAIL
        or max(memory) > constants.SCATTER_SETTLED
    )
