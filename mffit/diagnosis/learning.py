"""The scatter of the readings, estimated while everything that could explain their misfit is free."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.scatter import ExplainingColumns, learned
from mffit.diagnosis.search import Search
from mffit.effects import Effect
from mffit.rig import Simulation


def learned_noise(search: Search, state: Simulation, *, without_offsets: bool = False) -> Noise:
    """The noise with the scatter around ``state`` that remains if all candidates, coefficients and structure may explain it.

    ``without_offsets``: runs have no offsets.
    """
    points = search.points
    stated = search.stated.without(state.floats(points))
    problem = DiagnosisProblem(points, state, stated)
    predicted = np.nan_to_num(problem.predict(state))
    residual = problem.measured - predicted
    nothing = np.zeros((len(predicted), 0))
    # The derivative by each effect, and its first finite step for numbers whose derivative vanishes at zero.
    columns = {e: groups[:2] for e, groups in problem.columns(state, search.candidates).items()}
    runs = {e.id: g[0] for e, g in columns.items() if e.differs_by_run}
    others = [g for e, groups in columns.items() if not e.differs_by_run for g in groups]
    generous = constants.GENEROUS_EFFECT_SIZE
    named = np.column_stack(
        [nothing, *(generous * g for g in others), search.inexact.columns(points, state, problem.channels)]
    )
    explained = ExplainingColumns(named=named, runs=runs, smooth=search.coarse, withdrawn=without_offsets)
    return learned(stated, residual, explained, predicted)


def beyond_memory(noise: Noise, candidates: Sequence[Effect]) -> list[Effect]:
    """The candidates without offsets of runs that autocorrelated errors explain as well.

    Offsets that are significant beyond the autocorrelation get the size that was estimated together with it as spread.
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
