"""Noise, effects, inexact coefficients and structure without a name, found in turn until they agree."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from mffit.diagnosis.candidates import Hypothesis, Problem
from mffit.diagnosis.inexact import Inexactness
from mffit.diagnosis.leaving_out import Judged, Prediction, chosen_by_prediction, judged
from mffit.diagnosis.noise import Noise
from mffit.diagnosis.scatter import Explained, learned
from mffit.diagnosis.selection import Step, ids, select
from mffit.diagnosis.smooth import NO_SMOOTH, Smooth, amplified, smooth_basis, smooth_scan
from mffit.diagnosis.unknown import Bump, BumpScan, bump_scan
from mffit.effects import Effect
from mffit.points import Points
from mffit.quantities import CHANNELS
from mffit.rig import Simulation
from mffit.scatter import robust

ROUNDS = 3
GENEROUS = 3.0
"""How much larger than usual effects are allowed for while the scatter is learned."""
USUAL_SMOOTH = 0.03
"""Smooth structure that is allowed for before the scatter is known, relative to the channel."""
CLIPPED = 3.0
"""Standard deviations beyond which a reading counts no more in the search for bumps."""
MOST_BUMPS = 2
PROVEN = 2.0
"""Standard errors from nothing at which a number is left."""
CERTAIN = 0.5
"""Certainty below which nothing is named beside smooth structure without a name."""
EXPLAINS = 0.9
"""The same, less the share that stays unexplained, for a model that was not fitted to these points."""
SETTLED = 0.1
"""Change of the uncertainties, relative, below which the scatter is settled."""


@dataclass(frozen=True, slots=True)
class Explanation:
    """What was found."""

    problem: Problem  #: as it was judged: readings, model and covariance with everything inexact in it
    chosen: Hypothesis
    steps: list[Step]
    bump: Bump  #: best local structure that is left
    smooth: Smooth  #: smooth structure that is left, in the covariance if found
    bumps: BumpScan
    basis: np.ndarray  #: (2n, k) of the smooth structure
    refined: Hypothesis  #: the chosen effects with the coefficients of the model estimated beside them
    coefficients: Mapping[str, tuple[float, float]]  #: these: name -> (value, standard error)
    unaided: Mapping[str, float] = field(
        default_factory=dict
    )  #: gain of each effect alone, nothing smooth allowed for
    predicted: Mapping[str, Judged] = field(
        default_factory=dict
    )  #: what left-out sweeps say of each effect, where they were chosen by them

    @property
    def scatter(self) -> Noise:
        """The scatter of the readings alone."""
        return self.problem.noise.alone()

    @property
    def plain(self) -> Problem:
        """The problem in which coefficients are fitted rather than integrated out.

        Structure without a name is not allowed for here: a model predicts best that follows the readings as far as it can.
        Then its memory along sweeps is structure too.
        """
        noise = self.scatter
        if self.smooth.found:
            noise = replace(noise, scatter={c: replace(s, memory=0.0) for c, s in noise.scatter.items()})
        return Problem(self.problem.points, self.problem.start, noise, self.problem.declared)

    def certainty(self, effect: Effect, *, counted: bool = True) -> float:
        """Weight of an effect against its absence with structure without a name in its place.

        ``counted``: less what is left unexplained.
        """
        if effect.id in self.predicted:
            return self.predicted[effect.id].confidence
        problem, chosen = self.problem, self.chosen
        others = tuple(e for e in chosen.effects if e.id != effect.id)
        numbers = {n: chosen.numbers[n] for e in others for n in e.parameters}
        without = problem.fit(others, numbers) if others else problem.null
        gain, left = chosen.log_evidence - without.log_evidence, self.left(chosen)
        against = gain + left - self.left(without) - math.log(max(len(self.steps[0].trials), 1))
        open_ = left + (self.smooth.gain if self.smooth.found else 0.0) if counted else 0.0
        explains = max(gain, self.unaided.get(effect.id, 0.0), 0.0)
        share = explains / (explains + open_) if open_ else 1.0
        return float(share / (1.0 + math.exp(-float(np.clip(against, -500.0, 500.0)))))

    def left(self, hypothesis: Hypothesis) -> float:
        """Log evidence of the best structure without a name beside a hypothesis; 0 where there is none."""
        smooth = smooth_scan(self.basis, self.problem.noise).best(hypothesis)
        return max(self.bumps.best(hypothesis).gain, smooth.gain, 0.0)


def explain(
    points: Points,
    start: Simulation,
    noise: Noise,
    candidates: Sequence[Effect],
    inexact: Inexactness,
    declared: Mapping[str, tuple[float, float]],
    *,
    seen: bool = False,
) -> Explanation:
    """Find what explains the readings.

    Parameters
    ----------
    points : with uncertainties
    start : the simulation as given
    noise : as stated
    candidates : effects that the data can show
    inexact : prior of the model's coefficients
    declared : what is known of the rig's errors: name -> (value, standard uncertainty)
    seen : whether the model was fitted to these points: what its formulae cannot follow then stays as smooth structure, which
        says nothing against an effect beside it
    """
    basis, found, at = smooth_basis(points, start.predict(points)), None, start
    stated = noise
    for _ in range(ROUNDS):
        before = noise
        state = found.chosen.state if found else start
        noise = _learned(stated, noise, points, state, candidates, inexact, basis, start)
        if found is not None and not _moved(before, noise) and not (inexact and at is start):
            break
        offset = None
        if found is not None and inexact:
            # What an inexact coefficient does depends on the rest of the model: ask again at the one that was found.
            at = start.with_numbers({n: v for n, (v, _) in found.coefficients.items()})
            offset = inexact.moved(points, found.refined.state, at)
        columns = inexact.columns(points, found.refined.state if found else start)
        problem = Problem(points, at, noise.sharing(columns), declared, offset)
        # Before that, what the coefficients do elsewhere would look like structure without a name.
        latest = _explained(problem, columns, candidates, basis, rivals=not inexact or found is not None)
        if latest.smooth.found:
            latest = _certain(latest, counted=not seen)
        same = found is not None and ids(latest.chosen) == ids(found.chosen)
        found = _refined(latest, inexact)
        if same:
            break
    assert found is not None
    return _predicted(found, candidates, inexact) if seen and found.smooth.found else found


def _predicted(found: Explanation, candidates: Sequence[Effect], inexact: Inexactness) -> Explanation:
    """With the effects that predict left-out sweeps, where the model's formulae leave smooth structure in any case.

    Beside structure that may be anything, evidence decides little: what a cause is worth is what it says of other sweeps.
    """
    prediction = Prediction(found.plain, inexact)
    chosen = chosen_by_prediction(prediction, candidates)
    said = {e.id: judged(prediction, chosen, e, candidates) for e in chosen.effects}
    bump = found.bumps.best(chosen)
    return _of_some_size(_refined(replace(found, chosen=chosen, bump=bump, predicted=said), inexact), inexact)


def _of_some_size(found: Explanation, inexact: Inexactness) -> Explanation:
    """Without effects of which nothing is left once the model's coefficients are estimated beside them."""
    problem, refined = found.problem, found.refined

    def left(effect: Effect) -> bool:
        return any(
            abs(refined.numbers[n] - problem.start.number(n, problem.points))
            > PROVEN * refined.stderr.get(n, 0.0)
            for n in effect.parameters
        )

    kept = tuple(effect for effect in found.chosen.effects if left(effect))
    if len(kept) == len(found.chosen.effects):
        return found
    numbers = {n: found.chosen.numbers[n] for e in kept for n in e.parameters}
    chosen = problem.fit(kept, numbers) if kept else problem.null
    return _of_some_size(
        _refined(replace(found, chosen=chosen, bump=found.bumps.best(chosen)), inexact), inexact
    )


def only_first(found: Explanation, inexact: Inexactness) -> Explanation:
    """The explanation with nothing but the effect that explains most."""
    first = found.steps[0].best.effects[:1]
    chosen = found.problem.fit(first)
    bump = found.bumps.best(chosen)
    return _refined(replace(found, chosen=chosen, bump=bump, steps=found.steps[:2]), inexact)


def _refined(found: Explanation, inexact: Inexactness) -> Explanation:
    """With the model's coefficients estimated beside the effects."""
    refined, coefficients = found.plain.refine(found.chosen, inexact)
    return replace(found, refined=refined, coefficients=coefficients)


def _explained(
    problem: Problem, columns: np.ndarray, candidates: Sequence[Effect], basis: np.ndarray, rivals: bool
) -> Explanation:
    """Select effects; structure without a name takes their place, or stands beside them, where it explains more."""
    bumps = bump_scan(problem.points, problem.noise)
    chosen, steps = select(problem, candidates) if candidates else (problem.null, [])
    if not rivals:
        return Explanation(problem, chosen, steps, bumps.best(chosen), NO_SMOOTH, bumps, basis, chosen, {})
    rival = bumps.best(problem.null)
    # Any one effect is as likely beforehand as its share of the library; structure without a name, as the whole library.
    choice = math.log(max(len(candidates), 1))
    gained = chosen.log_evidence - problem.null.log_evidence - len(chosen.effects) * choice
    scan = smooth_scan(basis, problem.noise)
    alone, beside = scan.best(problem.null), scan.best(chosen)
    if rival.found and rival.gain > max(gained, alone.gain):
        return Explanation(problem, problem.null, steps[:1], rival, NO_SMOOTH, bumps, basis, problem.null, {})
    bump = bumps.best(chosen)
    smooth = beside if beside.found else alone if alone.found and alone.gain > gained else NO_SMOOTH
    if not smooth.found or (bump.found and bump.gain > smooth.gain):
        return Explanation(problem, chosen, steps, bump, NO_SMOOTH, bumps, basis, chosen, {})
    # Effects are now judged against the smooth structure: what they explain it must not.
    noise = problem.noise.sharing(columns, amplified(basis, smooth))
    problem = problem.seen_through(noise)
    unaided = {
        t.effects[-1].id: float(t.log_evidence - s.before.log_evidence) for s in steps[:1] for t in s.trials
    }
    chosen, steps = select(problem, candidates) if candidates else (problem.null, [])
    bumps = bump_scan(problem.points, noise)
    bump = bumps.best(chosen)
    return Explanation(problem, chosen, steps, bump, smooth, bumps, basis, chosen, {}, unaided)


def _certain(found: Explanation, *, counted: bool) -> Explanation:
    """Without effects that the structure beside them may as well explain, the least certain first."""
    while found.chosen.effects:
        certain = {e: found.certainty(e, counted=counted) for e in found.chosen.effects}
        least = min(certain, key=lambda e: certain[e])
        if certain[least] >= (EXPLAINS if counted else CERTAIN):
            break
        rest = tuple(e for e in found.chosen.effects if e is not least)
        numbers = {n: found.chosen.numbers[n] for e in rest for n in e.parameters}
        chosen = found.problem.fit(rest, numbers) if rest else found.problem.null
        found = replace(found, chosen=chosen, refined=chosen, bump=found.bumps.best(chosen))
    return found


def _learned(
    stated: Noise,
    noise: Noise,
    points: Points,
    state: Simulation,
    candidates: Sequence[Effect],
    inexact: Inexactness,
    basis: np.ndarray,
    start: Simulation,
) -> Noise:
    """The scatter that is left when everything that could explain something may do so."""
    problem = Problem(points, state, stated.alone())
    nothing = np.zeros((2 * len(points), 0))
    columns = {e: groups[:2] for e, groups in problem.columns(state, candidates).items()}
    runs = np.column_stack([nothing, *(g[0] for e, g in columns.items() if e.differs_by_run)])
    others = [GENEROUS * g for e, groups in columns.items() if not e.differs_by_run for g in groups]
    named = np.column_stack([nothing, *others, inexact.columns(points, state)])
    predicted = np.nan_to_num(state.predict(points))
    residual = problem.measured - predicted
    for _ in range(MOST_BUMPS):
        allowed = stated.alone().sharing(named, USUAL_SMOOTH * basis)
        white = allowed.whiten(np.nan_to_num(residual))
        first = allowed.used < len(points)
        for rows in (first, ~first):
            white[rows] /= max(robust(white[rows]), 1e-9) if rows.any() else 1.0
        scan = bump_scan(points, allowed)
        bump = scan.best(replace(problem.null, residual=white), CLIPPED)
        if not bump.found:
            break
        named = np.column_stack([named, GENEROUS * scan.plausible(bump)])
    return learned(
        replace(stated, scatter=noise.scatter), residual, Explained(named, GENEROUS * runs, basis), predicted
    ).alone()


def _moved(before: Noise, after: Noise) -> bool:
    """Whether the scatter changed so much that the effects have to be judged again."""
    used = after.used
    change = np.abs(np.log(after.u[used] / before.u[used]))
    memory = [abs(after.scatter[c].memory - before.scatter[c].memory) for c in CHANNELS]
    return bool(
        np.median(change) > SETTLED or np.quantile(change, 0.95) > 5.0 * SETTLED or max(memory) > SETTLED
    )
