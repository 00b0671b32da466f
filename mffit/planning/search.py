"""The shortest list of runs towards a goal: one after the other, each the one that brings most."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Sequence
from itertools import combinations
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.diagnosis.constants import SEPARATING_CHI2
from mffit.effects import CATALOG, Effect
from mffit.fit import FitResult
from mffit.fit.posterior import COVERING, spread_through
from mffit.measured import Measured
from mffit.planning.goals import BANDS, EPSILON, JOINT, TIE, Goal, effect_named
from mffit.planning.identified import identified, tied_pairs
from mffit.planning.knowledge import PECP1, Knowledge
from mffit.planning.record import Plan, Step, Trial
from mffit.planning.runs import Kind, Run, candidates
from mffit.points import Points, main_pressure, make_points
from mffit.points.points import concatenate
from mffit.progress import Progress, silent
from mffit.rig import FAULT_NAMES, Simulation
from mffit.scatter import rms

WORTH = 0.05
"""Relative fall of the uncertainty that makes one more run worth its while."""
AS_GOOD = 0.02
"""Runs whose outcomes differ by less than this are equally good, and the one with fewer points is taken."""
AT_LOAD = 0.06
"""Relative distance within which a load is the nominal one."""
DRAWS = 8
"""Draws of the noise of new points, over which a promise of the direct method is the root mean square."""
STEPS = 21
"""Angles of a curve whose band is judged."""


class DirectU(NamedTuple):
    """u(eps_gamma) of the direct method."""

    stated: float  #: as a build states it
    held: float  #: with which the fit holds PECP1


Direct = Callable[[Config, Points], DirectU | None]
"""What the direct method states of these points; None where it fails."""


def plan(
    config: Config,
    points: Points,
    measured: Measured,
    found: FitResult,
    goal: Goal,
    direct: Direct,
    *,
    most: int = 3,
    without: Collection[Kind] = (),
    progress: Progress = silent,
) -> Plan:
    """What these points identify, and the runs that would bring the goal nearest.

    Parameters
    ----------
    config : what is declared of tyre and rig
    points : the programme so far, with readings
    measured, found : what a build made of it
    goal : the number whose uncertainty is to fall
    direct : the direct method's own u(eps_gamma), as a build would state it
    most : runs of the list at most
    without : kinds of runs that this rig cannot make
    progress : called with a sentence before each step
    """
    outlook = _Outlook(config, points, measured, found, goal, direct)
    r_e = float(found.tyre.state(config.tyre.nominal_load).Re) if config.rig.on_disc else None
    possible = [run for run in candidates(config, points, r_e) if most and run.kind not in without]
    progress(f"trying {len(possible)} runs one by one")
    trials = sorted((Trial(run, outlook.u([run])) for run in possible), key=lambda trial: trial.u)
    chosen: list[Run] = []
    while len(chosen) < most:
        progress(f"looking for run {len(chosen) + 1}")
        more = _best(outlook, chosen, [[run] for run in possible if run not in chosen])
        if not more and len(chosen) + 1 < most:  # two that help only together, as pressures at two loads
            more = _best(outlook, chosen, _pairs([run for run in possible if run not in chosen]))
        if not more:
            break
        chosen += more
    chosen = _shortened(outlook, chosen)
    outlook.with_noise()
    steps = [
        Step(run, outlook.u(chosen[:k]), outlook.u(chosen[: k + 1]), *outlook.epsilons(chosen[: k + 1]))
        for k, run in enumerate(chosen)
    ]
    return Plan(
        config, goal, identified(outlook.knowledge, found, measured), outlook.u([]), *outlook.epsilons([]),
        tuple(steps), tuple(trials), outlook.told_below,
    )  # fmt: skip


def _best(outlook: _Outlook, chosen: Sequence[Run], possible: Sequence[Sequence[Run]]) -> Sequence[Run]:
    """What to add next, one run or several; empty if nothing is worth its while."""
    if not possible:
        return ()
    after = [outlook.u([*chosen, *more]) for more in possible]
    least = min(after)
    if not least < (1.0 - WORTH) * outlook.u(chosen):
        return ()
    near = [(sum(run.cost for run in more), u, k) for k, (more, u) in enumerate(zip(possible, after, strict=True))
            if u <= (1.0 + AS_GOOD) * least]  # fmt: skip
    return possible[min(near)[2]]


def _pairs(possible: Sequence[Run]) -> list[tuple[Run, Run]]:
    """Two runs of one kind at different loads."""
    return [(a, b) for a, b in combinations(possible, 2) if a.kind is b.kind and a.load != b.load]


def _shortened(outlook: _Outlook, chosen: Sequence[Run]) -> list[Run]:
    """The list without runs that later ones made superfluous."""
    kept = list(chosen)
    for run in chosen:
        fewer = [other for other in kept if other is not run]
        if len(kept) > 1 and outlook.u(fewer) <= (1.0 + AS_GOOD) * outlook.u(kept):
            kept = fewer
    return kept


class _Outlook:
    """The goal's uncertainty after any list of runs."""

    def __init__(self, config, points, measured, found, goal: Goal, direct: Direct) -> None:
        self.config, self.points, self.found, self.goal = config, points, found, goal
        self.effect: Effect | None = effect_named(goal.name) if goal.kind == TIE else None
        effects = {e.id: e for pair in tied_pairs(points) for e in pair}
        if self.effect is not None:
            effects |= {e.id: e for e in (self.effect, *_rivals(self.effect))}
        self.knowledge = Knowledge(config, points, measured, found, list(effects.values()))
        self.nominal = measured.nominal.load if measured.nominal else config.tyre.nominal_load
        self._near = (
            points.select(self._counts(points) & _sound(points, found)) if config.rig.on_disc else points
        )
        self.draws = 0
        self._direct, self._known = direct, dict[tuple[str, ...], DirectU | None]()
        self._curves = self._band_slopes() if goal.kind == BANDS else None

    def u(self, runs: Sequence[Run]) -> float:
        """In the goal's unit; infinite where the goal is not measured at all."""
        kind = self.goal.kind
        if kind == EPSILON:
            return _finite(self.direct(runs))
        if kind == JOINT:
            return _finite(self.joint(runs))
        if self.effect is not None:
            return self.knowledge.told(runs, self.effect, _rivals(self.effect))
        posterior = self.knowledge.posterior(runs, self._pecp1(runs))
        if kind == BANDS:
            assert self._curves is not None
            names, slopes = self._curves
            rows = [posterior.names.index(n) for n in names if n in posterior.names]
            columns = [k for k, n in enumerate(names) if n in posterior.names]
            C, G = posterior.covariance[np.ix_(rows, rows)], slopes[:, columns]
            return COVERING * rms(spread_through(G, C))
        return _finite(posterior.stderr.get(self.goal.name))

    @property
    def told_below(self) -> float | None:
        """Uncertainty of a tie's effect from which on it is told apart; None for other goals."""
        return (
            None
            if self.effect is None
            else self.knowledge.usual_size(self.effect) / math.sqrt(SEPARATING_CHI2)
        )

    def epsilons(self, runs: Sequence[Run]) -> tuple[float | None, float | None]:
        """u(eps_gamma) of the direct method and of the joint fit."""
        return (self.direct(runs), self.joint(runs)) if self.config.rig.on_disc else (None, None)

    def joint(self, runs: Sequence[Run]) -> float | None:
        """u(PECP1) were it free in the joint fit of tyre and rig; None where no turn-slip force was measured for it."""
        if not self.knowledge.rig:
            return None
        return self.knowledge.posterior(runs, None).stderr[PECP1]

    def direct(self, runs: Sequence[Run]) -> float | None:
        """What a build would state of the direct method."""
        found = self._directly(runs)
        return None if found is None else found.stated

    def _directly(self, runs: Sequence[Run]) -> DirectU | None:
        """The direct method on these points and what the rig would read in the new ones."""
        if not self.config.rig.on_disc:
            return None
        felt = [r for r in runs if r.points is None or np.any(self._counts(r.points))]
        key = tuple(sorted(run.name for run in felt))
        if key not in self._known:
            config = self.config
            for run in felt:
                config = run.declared(config)
            new = [run for run in felt if run.points is not None]
            chances = [np.random.default_rng(k) for k in range(self.draws)] if new and self.draws else [None]
            self._known[key] = _common(
                [
                    self._direct(
                        config,
                        concatenate([self._near, *(self.knowledge.with_readings(run, c) for run in new)]),
                    )
                    for c in chances
                ]
            )
        return self._known[key]

    def with_noise(self) -> None:
        """From now on let the new points scatter: what the direct method states depends a little on how they fall."""
        self.draws = DRAWS
        self._known.clear()

    def _pecp1(self, runs: Sequence[Run]) -> float | None:
        """Uncertainty of a PECP1 that the file takes from the direct method; None where the joint fit decides it."""
        if not self.config.rig.on_disc:
            return 0.0
        found = self._directly(runs)
        return None if self.config.spin.pecp1 == "model" else found.held if found is not None else 0.0

    def _counts(self, points: Points) -> np.ndarray:
        """Mask (n,) of the points that the direct method reads eps_gamma at the nominal load from."""
        near = np.abs(points.Fz / self.nominal - 1.0) < AT_LOAD
        main = np.abs(points.p - np.median(self.points.p[main_pressure(self.points)])) < 5e3
        return near & main & (points.mount > 0) & ~points.continuous

    def _band_slopes(self) -> tuple[list[str], np.ndarray]:
        """Slopes of the curves by every coefficient: over sideslip and over camber, three loads, a straight path."""
        assert self.found.files is not None
        tested = self.found.files.tested
        loads = [tested["FZMIN"], float(self.found.tyre["FNOMIN"]), tested["FZMAX"]]
        slip, lean = (np.linspace(-tested[end], tested[end], STEPS) for end in ("ALPMAX", "CAMMAX"))
        zero = np.zeros(STEPS)
        alpha, gamma = np.tile(np.r_[slip, zero], len(loads)), np.tile(np.r_[zero, lean], len(loads))
        where = make_points(
            alpha, gamma, np.repeat(loads, 2 * STEPS), p=float(self.found.tyre["NOMPRES"]), V=10.0, phi_t=0.0
        )
        names = [n for n in self.knowledge.names if n not in FAULT_NAMES]
        tyre = Simulation.of(self.found.tyre, turn_slip=self.config.rig.on_disc)
        return names, getattr(tyre.sensitivities(where, names)[1], self.goal.name)


def _rivals(effect: Effect) -> list[Effect]:
    return [e for e in CATALOG if e.id in effect.confusable_with and len(e.free) == 1]


def _sound(points: Points, found: FitResult) -> np.ndarray:
    """Mask (n,) of the points of which the fit uses all readings."""
    return ~np.isin(np.arange(len(points)), [o.row for o in found.outliers])


def _common(found: Sequence[DirectU | None]) -> DirectU | None:
    """The root mean square of several draws; None if the method failed in one."""
    known = [u for u in found if u is not None]
    if len(known) < len(found):
        return None
    stated, held = np.array(known).T
    return DirectU(rms(stated), rms(held))


def _finite(u: float | None) -> float:
    return math.inf if u is None or not math.isfinite(u) else u
