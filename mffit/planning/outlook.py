"""The uncertainty of a goal after any list of runs."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from mffit.config import Config
from mffit.constants import COVERAGE_FACTOR_95
from mffit.diagnosis.constants import SEPARATING_CHI2
from mffit.effects import CATALOG, Effect
from mffit.fit import FitResult, Posterior
from mffit.fit.posterior import spread_through
from mffit.fit.ranges import tested_ranges
from mffit.measured import Measured
from mffit.planning import constants
from mffit.planning.apart import FittedApart
from mffit.planning.goals import BANDS, CARCASS, EPSILON, FILE, JOINT, TIE, Goal, effect_named
from mffit.planning.identified import tied_pairs
from mffit.planning.knowledge import PECP1, Knowledge
from mffit.planning.runs import PlannedRun, largest_slip, swept
from mffit.points import Points, main_pressure, make_points
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
        self._near = points
        if config.rig.on_disc:
            outliers = np.isin(np.arange(len(points)), [o.row for o in found.outliers])
            self._near = points.select(self._decides_epsilon(points) & ~outliers)
        self._tested = tested_ranges(swept(points))
        self.draws = 0
        self._direct, self._cache = direct, dict[tuple[str, ...], DirectU | None]()
        self._curves = self._band_slopes((goal.name,)) if goal.kind == BANDS else None
        self._file = self._every_band() if goal.kind == FILE else None
        apart = goal.kind == FILE or goal.name in CARCASS
        self.apart = FittedApart(config, found, self._tested) if apart else None

    def u(self, runs: Sequence[PlannedRun]) -> float:
        """Uncertainty of the goal in its unit; infinite if the goal is not measured at all."""
        kind = self.goal.kind
        if kind == EPSILON:
            return _or_infinite(self.direct(runs))
        if kind == JOINT:
            return _or_infinite(self.joint(runs))
        if self.effect is not None:
            return self.knowledge.u_of_effect(runs, self.effect, _rivals(self.effect))
        posterior = self.knowledge.posterior(runs, self._u_pecp1(runs))
        if self.apart is not None and self.goal.name:
            return self.apart.u_carcass(self.goal.name, runs, posterior)
        if self._file is not None and self.apart is not None:
            names, by_channel = self._file
            parts = [_spread(posterior, names, slopes) for slopes in by_channel]
            parts += [*self.apart.u_relaxation(runs), self.apart.u_loaded_radius(runs)]
            return COVERAGE_FACTOR_95 * rms(np.array(parts))
        if self._curves is None:
            return _or_infinite(posterior.stderr.get(self.goal.name))
        names, (slopes,) = self._curves
        return COVERAGE_FACTOR_95 * _spread(posterior, names, slopes)

    @property
    def told_below(self) -> float | None:
        """Uncertainty of a tie's effect below which the tie is resolved; None for other goals."""
        return (
            None
            if self.effect is None
            else self.knowledge.usual_size(self.effect) / math.sqrt(SEPARATING_CHI2)
        )

    def epsilons(self, runs: Sequence[PlannedRun]) -> tuple[float | None, float | None]:
        """u(eps_gamma) of the direct method and of the joint fit."""
        return (self.direct(runs), self.joint(runs)) if self.config.rig.on_disc else (None, None)

    def joint(self, runs: Sequence[PlannedRun]) -> float | None:
        """u(PECP1) as a free coefficient of the joint fit of tyre and rig; None if held by hand, or without a measured force."""
        if not self.knowledge.rig or PECP1 in self.knowledge.hand.held:
            return None
        return self.knowledge.posterior(runs, None).stderr[PECP1]

    def direct(self, runs: Sequence[PlannedRun]) -> float | None:
        """u(eps_gamma) that a build would state for the direct method."""
        found = self._directly(runs)
        return None if found is None else found.stated

    def add_noise(self) -> None:
        """Add noise to the predicted readings from now on: the budget of the direct method depends a little on it."""
        self.draws = constants.PLAN_NOISE_DRAWS
        self._cache.clear()

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
            new = [run for run in relevant if run.points is not None]
            draws = [np.random.default_rng(k) for k in range(self.draws)] if new and self.draws else [None]
            self._cache[key] = _rms_of_draws(
                [
                    self._direct(
                        config,
                        concatenate([self._near, *(self.knowledge.with_readings(run, draw) for run in new)]),
                    )
                    for draw in draws
                ]
            )
        return self._cache[key]

    def _u_pecp1(self, runs: Sequence[PlannedRun]) -> float | None:
        """Uncertainty of a PECP1 that the file takes from the direct method; None if the joint fit determines it."""
        if not self.config.rig.on_disc:
            return 0.0
        found = self._directly(runs)
        if self.config.spin.pecp1 == "model":
            return None
        return 0.0 if found is None else found.held

    def _decides_epsilon(self, points: Points) -> np.ndarray:
        """Mask (n,) of the points from which the direct method reads eps_gamma at the nominal load."""
        near = np.abs(points.Fz / self.nominal - 1.0) < constants.PLAN_NOMINAL_LOAD_TOLERANCE
        pressure = np.median(self.points.p[main_pressure(self.points)])
        main = np.abs(points.p - pressure) < constants.PLAN_PRESSURE_TOLERANCE
        deciding: np.ndarray = near & main & (points.mount > 0) & ~points.continuous
        return deciding

    def _every_band(self) -> tuple[list[str], list[np.ndarray]]:
        """Slopes of all forces over their largest values, those of Fx also where none was measured."""
        channels = [c for c in ("Fx", "Fy", "Mx", "Mz") if c in ("Fx", *self.knowledge.problem.channels)]
        names, slopes = self._band_slopes(channels)
        tyre = Simulation.of(self.found.tyre, turn_slip=False)
        sizes = tyre.readings(self._band_conditions(slip=True), channels)
        return names, [
            slope / max(float(np.max(np.abs(sizes[c]))), 1e-9)
            for c, slope in zip(channels, slopes, strict=True)
        ]

    def _band_slopes(self, channels: Sequence[str]) -> tuple[list[str], list[np.ndarray]]:
        """Slopes of the curves by each coefficient: over sideslip and camber, at three loads on a straight path.

        Where slip was run, or all forces count, they are over longitudinal slip as well, without and with sideslip.
        """
        slip = self.goal.kind == FILE or "Fx" in channels or not np.all(self.points.free_rolling)
        where = self._band_conditions(slip=slip)
        names = [n for n in self.knowledge.names if error_of(n) is None]
        tyre = Simulation.of(self.found.tyre, turn_slip=self.config.rig.on_disc)
        found = tyre.sensitivities(where, names, channels)[1]
        return names, [found[channel] for channel in channels]

    def _band_conditions(self, *, slip: bool) -> Points:
        """Operating conditions of the bands."""
        tested = self._tested
        loads = [tested["FZMIN"], float(self.found.tyre["FNOMIN"]), tested["FZMAX"]]
        n = int(constants.PLAN_BAND_ANGLES)
        steer, camber = (np.linspace(-tested[end], tested[end], n) for end in ("ALPMAX", "CAMMAX"))
        drive = np.linspace(-1.0, 1.0, n) * largest_slip(self.points)
        none = np.zeros(n)
        lines = [(steer, none, none), (none, camber, none)]
        if slip:
            lines += [(none, none, drive), (none + 0.5 * tested["ALPMAX"], none, drive)]
        alpha, gamma, kappa = (np.concatenate(part) for part in zip(*lines, strict=True))
        return make_points(
            np.tile(alpha, len(loads)),
            np.tile(gamma, len(loads)),
            np.repeat(loads, len(alpha)),
            kappa=np.tile(kappa, len(loads)),
            p=float(self.found.tyre["NOMPRES"]),
            V=constants.PLAN_BAND_SPEED,
            phi_t=0.0,
        )


def _spread(posterior: Posterior, names: Sequence[str], slopes: np.ndarray) -> float:
    """Standard uncertainty, rms, of curves with slopes (m, k) by the named coefficients."""
    rows = [posterior.names.index(n) for n in names if n in posterior.names]
    columns = [k for k, n in enumerate(names) if n in posterior.names]
    return rms(spread_through(slopes[:, columns], posterior.covariance[np.ix_(rows, rows)]))


def _rivals(effect: Effect) -> list[Effect]:
    return [e for e in CATALOG if e.id in effect.confusable_with and len(e.free) == 1]


def _rms_of_draws(found: Sequence[DirectU | None]) -> DirectU | None:
    """The root mean square over noise draws; None if the method failed on one of them."""
    known = [u for u in found if u is not None]
    if len(known) < len(found):
        return None
    stated, held = np.array(known).T
    return DirectU(stated=rms(stated), held=rms(held))


def _or_infinite(u: float | None) -> float:
    return math.inf if u is None or not math.isfinite(u) else u
