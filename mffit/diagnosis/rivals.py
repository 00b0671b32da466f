"""Effects selected in competition with structure without a name."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from mffit.diagnosis import constants
from mffit.diagnosis.bumps import Bump, BumpScan, bump_scan
from mffit.diagnosis.explanation import Explanation
from mffit.diagnosis.hypothesis import Hypothesis
from mffit.diagnosis.problem import DiagnosisProblem
from mffit.diagnosis.selection import ForwardStep, forward_step, select
from mffit.diagnosis.smooth import NO_SMOOTH, Smooth, amplified, smooth_scan
from mffit.effects import Effect


def selected(problem: DiagnosisProblem, candidates: Sequence[Effect], basis: np.ndarray) -> Explanation:
    """The effects that explain most, structure without a name not considered."""
    bumps = bump_scan(problem.points, problem.noise)
    chosen, steps = select(problem, candidates)
    return _explanation(problem, chosen, steps, bumps, basis)


def competed(
    problem: DiagnosisProblem, columns: np.ndarray, candidates: Sequence[Effect], basis: np.ndarray
) -> Explanation:
    """The effects that explain most, and structure without a name in their place or beside them if it explains more.

    The covariance of ``problem`` contains the ``columns`` (c n, k) of the inexact coefficients; ``basis`` (c n, k) holds the
    smooth structure.
    """
    found = selected(problem, candidates, basis)
    chosen, null, scan = found.chosen, problem.null, smooth_scan(basis, problem.noise)
    # Any one effect is as likely beforehand as its share of the library; structure without a name, as the whole library.
    choice = math.log(max(len(candidates), 1))
    gained = chosen.log_evidence - null.log_evidence - len(chosen.effects) * choice
    rival, alone, beside = found.bumps.best(null), scan.best(null), scan.best(chosen)
    if rival.found and rival.gain > max(gained, alone.gain):
        return _explanation(problem, null, found.steps[:1], found.bumps, basis, bump=rival)
    replaces = alone.found and alone.gain > gained + constants.TIED_EVIDENCE
    smooth = beside if beside.found else alone if replaces else NO_SMOOTH
    if not smooth.found or (found.bump.found and found.bump.gain > smooth.gain):
        return found
    # Effects are judged again with the smooth structure in the covariance: they must explain what it cannot.
    problem = problem.seen_through(problem.noise.sharing(columns, amplified(basis, smooth, problem.channels)))
    unaided = {
        trial.effects[-1].id: float(trial.log_evidence - step.before.log_evidence)
        for step in found.steps[:1]
        for trial in step.trials
    }
    chosen, steps = select(problem, candidates)
    bumps = bump_scan(problem.points, problem.noise)
    return _explanation(problem, chosen, steps, bumps, basis, smooth=smooth, unaided=unaided)


def structured(
    problem: DiagnosisProblem, columns: np.ndarray, candidates: Sequence[Effect], basis: np.ndarray
) -> Explanation | None:
    """Smooth structure and no effect, if that structure is left beside the best effect too; else None."""
    step = forward_step(problem, problem.null, candidates)
    scan = smooth_scan(basis, problem.noise)
    if not scan.best(step.best).found:
        return None
    smooth = scan.best(problem.null)
    problem = problem.seen_through(problem.noise.sharing(columns, amplified(basis, smooth, problem.channels)))
    bumps = bump_scan(problem.points, problem.noise)
    return _explanation(problem, problem.null, [step], bumps, basis, smooth=smooth)


def certain(found: Explanation, *, counted: bool) -> Explanation:
    """The explanation without effects that smooth structure may as well explain, the least certain dropped first.

    If ``counted``, misfit that stays unexplained lowers the certainty of an effect.
    """
    needed = constants.LEAST_CERTAINTY if counted else constants.LIKELY_ANSWER
    while found.chosen.effects:
        certainty = {effect: found.certainty(effect, counted=counted) for effect in found.chosen.effects}
        least = min(certainty, key=lambda effect: certainty[effect])
        if certainty[least] >= needed:
            break
        found = found.only(found.chosen.others(least))
    return found


def _explanation(
    problem: DiagnosisProblem,
    chosen: Hypothesis,
    steps: list[ForwardStep],
    bumps: BumpScan,
    basis: np.ndarray,
    bump: Bump | None = None,
    smooth: Smooth = NO_SMOOTH,
    unaided: dict[str, float] | None = None,
) -> Explanation:
    return Explanation(
        problem=problem,
        chosen=chosen,
        steps=steps,
        bump=bump or bumps.best(chosen),
        smooth=smooth,
        bumps=bumps,
        basis=basis,
        refined=chosen,
        unaided=unaided or {},
    )
