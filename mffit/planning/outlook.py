"""The uncertainty of a goal after any list of runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.constants import ANGLES_OF_A_CURVE, COVERAGE_FACTOR_95
from mffit.diagnosis.constants import SEPARATING_CHI2
from mffit.effects import CATALOG, Effect
from mffit.fit import FitResult, Posterior
from mffit.fit.posterior import spread_through
from mffit.fit.ranges import tested_ranges
from mffit.measured import Measured
from mffit.planning.goals import BANDS, EPSILON, FILE, JOINT, TIE, Goal, effect_named
from mffit.planning.identified import tied_pairs
from mffit.planning.knowledge import PECP1, Knowledge
from mffit.planning.runs import PlannedRun, largest_slip, swept
from mffit.points import Points, levels, main_pressure, make_points
from mffit.points.points import concatenate
from mffit.rig import Simulation
from mffit.rig_errors import error_of
from mffit.scatter import rms


class DirectU(NamedTuple):
    """u(eps_gamma) of the direct method."""

    stated: float  #: as a build states it
    held: float  #: with which the fit holds PECP1


Direct = Callable[[Config, Points], DirectU | None]
"""The direct method on some points; None where it fails."""


class Curves(NamedTuple):
    """Curves of the tyre whose band is the goal."""

    names: Sequence[str]  #: (k,) coefficients
    slopes: Sequence[
        np.ndarray
    ]  #: (n, k) by these, per channel; of several channels over their largest forces

    def band(self, posterior: Posterior) -> float:
        """Half width of the 95 % band, rms."""
        rows = [posterior.names.index(n) for n in self.names if n in posterior.names]
        columns = [k for k, n in enumerate(self.names) if n in posterior.names]
        covariance = posterior.covariance[np.ix_(rows, rows)]
        spread = [rms(spread_through(slopes[:, columns], covariance)) for slopes in self.slopes]
        return COVERAGE_FACTOR_95 * rms(np.array(spread))


class Outlook:
    """Predicts what a build of a longer programme would state."""

    def __init__(
        self, config: Config, points: Points, measured: Measured, found: FitResult, goal: Goal, direct: Direct
    ) -> None:
        self.config, self.points, self.found, self.goal = config, points, found, goal
        self.effect: Effect | None = effect_named(goal.name) if goal.kind == TIE else None
        effects = {e.id: e for pair in tied_pairs(points) for e in pair}
        if self.effect is not None:
            effects |= {e.id: e for e in (self.effect, *_rivals(self.effect))}
        self.knowledge = Knowledge(config, points, measured, found, list(effects.values()))
        self.nominal = measured.nominal.load if measured.nominal else config.tyre.nominal_load
        self._pressure = float(np.median(points.p[main_pressure(points)]))
        outliers = np.isin(np.arange(len(points)), [o.row for o in found.outliers])
        self._near = points.select(self._decides_epsilon(points) & ~outliers)
        self._direct, self._cache = direct, dict[tuple[str, ...], DirectU | None]()
        self._known = dict[tuple[str, ...], float]()
        self._curves = self._curves_of_goal() if goal.kind in (BANDS, FILE) else None

    def u(self, runs: Sequence[PlannedRun]) -> float:
        """Uncertainty of the goal in its unit; infinite if the goal is not measured at all."""
        key = tuple(sorted(run.name for run in runs))
        if key not in self._known:
            self._known[key] = self._u(runs)
        return self._known[key]

    def _u(self, runs: Sequence[PlannedRun]) -> float:
        if self.effect is not None:
            return self.knowledge.u_of_effect(runs, self.effect, _rivals(self.effect))
        if self.goal.kind in (EPSILON, JOINT):
            found = self.direct(runs) if self.goal.kind == EPSILON else self.joint(runs)
        else:
            posterior = self._posterior(runs)
            found = self._curves.band(posterior) if self._curves else posterior.stderr.get(self.goal.name)
        return math.inf if found is None or not math.isfinite(found) else found

    @property
    def told_below(self) -> float | None:
        """Uncertainty of a tie's effect below which the tie is resolved; None for other goals."""
        if self.effect is None:
            return None
        return self.knowledge.usual_size(self.effect) / math.sqrt(SEPARATING_CHI2)

    def epsilons(self, runs: Sequence[PlannedRun]) -> tuple[float | None, float | None]:
        """u(eps_gamma) of the direct method and of the joint fit."""
        return (self.direct(runs), self.joint(runs)) if self.config.rig.on_disc else (None, None)

    def joint(self, runs: Sequence[PlannedRun]) -> float | None:
        """u(PECP1) as a free coefficient of the joint fit of tyre and rig; None if held by hand, or without a measured force."""
        if not self.knowledge.rig or PECP1 in self.knowledge.hand.held:
            return None
        return self._with_free_epsilon(runs).stderr[PECP1]

    def direct(self, runs: Sequence[PlannedRun]) -> float | None:
        """u(eps_gamma) that a build would state for the direct method."""
        found = self._directly(runs)
        return None if found is None else found.stated

    def _directly(self, runs: Sequence[PlannedRun]) -> DirectU | None:
        """The direct method on the present points and the predicted readings of the new ones; cached."""
        if not self.config.rig.on_disc:
            return None
        relevant = [r for r in runs if r.points is None or np.any(self._decides_epsilon(r.points))]
        key = tuple(sorted(run.name for run in relevant))
        if key not in self._cache:
            config = self.config
            for run in relevant:
                config = run.declared(config)
            new = [self.knowledge.with_readings(run) for run in relevant if run.points is not None]
            self._cache[key] = self._direct(config, concatenate([self._near, *new]))
        return self._cache[key]

    def _decides_epsilon(self, points: Points) -> np.ndarray:
        """Mask (n,) of the points from which the direct method reads eps_gamma at the nominal load."""
        near = np.abs(np.log(points.Fz / self.nominal)) < levels.LOAD.tolerance
        main = np.abs(points.p - self._pressure) < levels.PRESSURE.tolerance
        deciding: np.ndarray = near & main & (points.mount > 0) & ~points.continuous
        return deciding

    def _posterior(self, runs: Sequence[PlannedRun]) -> Posterior:
        """The posterior with PECP1 as the file takes it: held by hand, from the direct method, or from the joint fit."""
        by_hand = PECP1 in self.knowledge.hand.held
        if self.config.spin.pecp1 == "model" and self.config.rig.on_disc and not by_hand:
            return self._with_free_epsilon(runs)
        direct = None if by_hand else self._directly(runs)
        return self.knowledge.posterior(runs, held={PECP1: 0.0 if direct is None else direct.held})

    def _with_free_epsilon(self, runs: Sequence[PlannedRun]) -> Posterior:
        prior = self.knowledge.hand.priors.get(PECP1)
        return self.knowledge.posterior(runs, free={PECP1: math.inf if prior is None else prior.spread})

    def _curves_of_goal(self) -> Curves:
        """Curves over sideslip and camber at three loads on a straight path, and over slip where it counts."""
        where = self._conditions_of_curves()
        names = [n for n in self.knowledge.names if error_of(n) is None]
        tyre = Simulation.of(self.found.tyre, turn_slip=self.config.rig.on_disc)
        channels = [self.goal.name]
        if self.goal.kind == FILE:
            belt = () if self.config.rig.on_disc else ("Fx",)
            channels = [c for c in ("Fx", "Fy", "Mx", "Mz") if c in (*belt, *self.knowledge.problem.channels)]
        forces, slopes = tyre.sensitivities(where, names, channels)
        size = {c: np.max(np.abs(forces[c])) if self.goal.kind == FILE else 1.0 for c in channels}
        return Curves(names, [slopes[c] / size[c] for c in channels])

    def _conditions_of_curves(self) -> Points:
        tyre, tested = self.found.tyre, tested_ranges(swept(self.points))
        loads = [tested["FZMIN"], float(tyre["FNOMIN"]), tested["FZMAX"]]
        n = int(ANGLES_OF_A_CURVE)
        steer, camber = (np.linspace(-tested[end], tested[end], n) for end in ("ALPMAX", "CAMMAX"))
        none = np.zeros(n)
        lines = [(steer, none, none), (none, camber, none)]
        if self.goal.kind == FILE or self.goal.name == "Fx" or not np.all(self.points.free_rolling):
            drive = np.linspace(-1.0, 1.0, n) * largest_slip(self.points)
            lines += [(none, none, drive), (none + 0.5 * tested["ALPMAX"], none, drive)]
        alpha, gamma, kappa = (np.tile(np.concatenate(part), len(loads)) for part in zip(*lines, strict=True))
        Fz = np.repeat(loads, len(lines) * n)
        p, V = float(tyre["NOMPRES"]), float(tyre["LONGVL"])
        return make_points(alpha, gamma, Fz, kappa=kappa, p=p, V=V, phi_t=0.0)


def _rivals(effect: Effect) -> list[Effect]:
    return [e for e in CATALOG if e.id in effect.confusable_with and len(e.free) == 1]
