"""The posterior of a build's fit with the rows of further runs added: one linear model of every number of tyre and rig."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from types import MappingProxyType

import numpy as np

from mffit.config import Config
from mffit.effects import Effect
from mffit.fit import FitResult, Posterior
from mffit.fit.coverage import coverage
from mffit.fit.posterior import beside_held
from mffit.fit.priors import scatter
from mffit.fit.rig.rig_numbers import held_rig, rig_numbers
from mffit.least_squares import inverse
from mffit.measured import Measured, alignment_verdict, measured_path_radius
from mffit.planning.runs import PlannedRun, candidates, new_setups
from mffit.points import Points
from mffit.points.points import concatenate
from mffit.rig_errors import OF_RUN, ZEROS, error_of
from tir import Quantity

PECP1 = "PECP1"
NO_SPREAD: Mapping[str, float] = MappingProxyType({})


class Knowledge:
    """The fit's posterior for any list of further runs, linearised at the present solution.

    The build of a longer programme is assumed to free what its coverage allows, with the priors and weights of this build.
    """

    def __init__(
        self,
        config: Config,
        points: Points,
        measured: Measured,
        found: FitResult,
        effects: Sequence[Effect] = (),
    ) -> None:
        assert found.search is not None
        search = found.search
        self.config, self.points, self.measured = config, points, measured
        self.problem, self.hand = search.problem, search.hand
        self.simulation = search.problem.simulation
        self.rig = tuple(n.name for n in search.numbers if error_of(n.name))
        self._held_rig = search.held_rig.keys()
        known = {n.name: n.spread for n in search.numbers} | {**search.held, **search.held_rig}
        unseen = self._spread_of_unseen(found, known)
        self.spread = unseen | known
        staged = {name for row in found.coverage for name in (*row.free, *row.held)}
        # What the points show and the build holds all the same: they push it to a bound for nothing.
        self._put_back = self._shown([]) & search.held.keys()
        self._extra = [n.name for n in search.numbers if n.name not in staged and n.name not in self.rig]
        self._new_zeros = self._zeros_of_new_setups()
        self._usual = {e.free[0].name: self.usual_size(e) for e in effects}
        self.names = tuple(dict.fromkeys([*self.spread, PECP1, *self._usual, *self._new_zeros]))
        self._row = {name: k for k, name in enumerate(self.names)}
        self._at = np.array([self.simulation.number(n, points) for n in self.names])
        self._sigma = {channel: _usual(s) for channel, s in search.problem.sigma.items()}
        if unseen:  # nothing is known of the noise of Fx: forces usually scatter alike
            self._sigma = {"Fx": self._sigma["Fy"], **self._sigma}
        self._base = _information(self.problem.free(self.names).linear(self._at).slope)
        self._of_run: dict[str, np.ndarray] = {}

    def posterior(
        self,
        runs: Sequence[PlannedRun],
        free: Mapping[str, float] = NO_SPREAD,
        held: Mapping[str, float] = NO_SPREAD,
    ) -> Posterior:
        """The posterior of a build with these runs.

        ``free`` and ``held`` are spreads of numbers that the build would fit, or hold without letting the points inform them,
        other than this build does.
        """
        spread = {**self._spread(runs), **free, **held}
        names = [n for n in dict.fromkeys([*self._free(runs), *free]) if n not in held]
        beside = {n: u for n, u in spread.items() if n not in names and math.isfinite(u)}
        return self._solved(runs, names, spread, beside)

    def u_of_effect(self, runs: Sequence[PlannedRun], effect: Effect, rivals: Iterable[Effect]) -> float:
        """u of an effect's number from the data alone, with the fitted numbers and its rival effects free."""
        name = effect.free[0].name
        partners = {e.free[0].name for e in rivals}
        spread = self._usual | self._spread(runs)
        spread |= {n: self._usual[n] for n in partners if n not in self.rig}
        spread |= {PECP1: math.inf, name: math.inf}
        names = list(dict.fromkeys([*self._free(runs), PECP1, *partners, name]))
        return self._solved(runs, names, spread, {}).stderr[name]

    def usual_size(self, effect: Effect) -> float:
        """Usual size of an effect's number, 1 sigma."""
        number = effect.free[0]
        size = abs(self.simulation.number(number.name, self.points)) if number.relative else 1.0
        return number.spread * size

    def with_readings(self, run: PlannedRun) -> Points:
        """The set-points of a run with the readings that the fitted rig would give."""
        assert run.points is not None
        return run.points.replace(**self.simulation.readings(run.points, self.channels_of(run)))

    def channels_of(self, run: PlannedRun) -> tuple[str, ...]:
        """Channels that a run measures: those of the programme, and what it adds."""
        added = run.addition.measures
        return tuple(c for c in self._sigma if c in self.problem.channels or c in added)

    def _spread_of_unseen(self, found: FitResult, known: Mapping[str, float]) -> dict[str, float]:
        """Standard deviation of the coefficients that only a run of longitudinal slip would free; empty once one was made."""
        if self.config.rig.on_disc or "Fx" in self.problem.channels:
            return {}
        values = found.tyre.values
        shown = self._shown([run for run in candidates(self.config, self.points) if run.points is not None])
        return {
            name: row.stderr
            or scatter(name, float(values[name]), from_base=row.status == "base", curved=False)
            for name, row in found.coefficients.items()
            if name in shown and name not in known
        }

    def _shown(self, runs: Sequence[PlannedRun]) -> dict[str, None]:
        """Coefficients that the coverage of a programme with some more runs allows to free, as keys."""
        # Coverage asks only whether there are readings, not which.
        new = [
            run.points.replace(**dict.fromkeys(run.addition.measures, 0.0))
            for run in runs
            if run.points is not None
        ]
        points = concatenate([self.points, *new]) if new else self.points
        cover = coverage(points, self.config.tyre.side, self.hand.held)
        return dict.fromkeys(name for row in cover for name in row.free)

    def _free(self, runs: Sequence[PlannedRun]) -> list[str]:
        named = [*self._shown(runs), *self._extra, *self.rig, *self._new_of(runs)]
        return [name for name in dict.fromkeys(named) if name not in self._put_back]

    def _zeros_of_new_setups(self) -> dict[str, float]:
        """Prior spread of the zeros of set-ups that runs may add, by number."""
        present, new = self.points.used_setups, new_setups(self.config, self.points)
        if not self.rig or not new:
            return {}
        numbers = rig_numbers(self.config, self.measured, (*present, *new), self.problem.channels)
        return {n.name: n.spread for n in numbers if n.name.partition(OF_RUN)[2] in new}

    def _new_of(self, runs: Sequence[PlannedRun]) -> list[str]:
        """Numbers of the zeros of the new set-ups that some runs are in."""
        used = {name for run in runs if run.points is not None for name in run.points.used_setups}
        return [name for name in self._new_zeros if name.partition(OF_RUN)[2] in used]

    def _spread(self, runs: Sequence[PlannedRun]) -> dict[str, float]:
        """Prior spread of each number once the rig has been measured as the runs demand."""
        row = self.measured.nominal
        new = {name: self._new_zeros[name] for name in self._new_of(runs)}
        if row is None or not any(run.rig for run in runs):
            return {**self.spread, **new}
        config = self.config
        for run in runs:
            config = run.declared(config)
        R = measured_path_radius(config)
        if R is not None:
            row = replace(row, R=Quantity(R.nominal_value, R.std_dev, "m"))
        # With a smaller declared uncertainty the measured zero may exceed it, because ply-steer looks like misalignment.
        misaligned = alignment_verdict(config, row).beyond
        setups = tuple(dict.fromkeys([*self.points.used_setups, *(n.partition(OF_RUN)[2] for n in new)]))
        mounts = [self.points.mount, *(run.points.mount for run in runs if run.points is not None)]
        turned = len(np.unique(np.concatenate(mounts))) > 1
        measured = replace(self.measured, nominal=row, misaligned=misaligned)
        numbers = rig_numbers(config, measured, setups, self.problem.channels, turned=turned)
        held = held_rig(config, setups, turned=turned)
        found = {n.name: n.spread for n in numbers} | held
        separated = self._held_rig - held.keys()
        known = {name: u for name, u in self.spread.items() if name not in separated} | new
        return known | {name: u for name, u in found.items() if name in (*self.spread, *new)}

    def _added(self, run: PlannedRun) -> np.ndarray:
        """Information of the rows of one run."""
        if run.points is None:
            return np.zeros_like(self._base)
        if run.name not in self._of_run:
            sigma = {c: np.full(run.cost, self._sigma[c]) for c in self.channels_of(run)}
            seen = replace(self.problem, points=self.with_readings(run), sigma=sigma, envelope=None, radii=())
            slope = seen.free(self.names).linear(self._at).slope
            if self._new_of([run]):  # zeros of its own instead of those without a set-up
                slope[:, [self._row[e.name] for e in ZEROS if e.name in self.rig]] = 0.0
            self._of_run[run.name] = _information(slope)
        return self._of_run[run.name]

    def _solved(
        self,
        runs: Sequence[PlannedRun],
        free: Sequence[str],
        spread: Mapping[str, float],
        held: Mapping[str, float],
    ) -> Posterior:
        """Like :func:`mffit.fit.posterior.joint`, computed from the information matrix."""
        information = self._base + sum((self._added(run) for run in runs), np.zeros_like(self._base))
        f, h = ([self._row[n] for n in names] for names in (free, held))
        prior = np.diag([spread.get(n, math.inf) ** -2.0 for n in free])
        covariance = inverse(information[np.ix_(f, f)] + prior)
        return beside_held(free, covariance, held, information[np.ix_(f, h)])


def _information(slope: np.ndarray) -> np.ndarray:
    slope = np.nan_to_num(slope)
    information: np.ndarray = slope.T @ slope
    return information


def _usual(sigma: np.ndarray) -> float:
    known = sigma[np.isfinite(sigma)]
    return float(np.median(known)) if len(known) else math.inf
