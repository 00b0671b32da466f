"""Information of a measuring programme about every number of tyre and rig; the information of runs adds up."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace

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
        self.spread = {n.name: n.spread for n in search.numbers} | {**search.held, **search.held_rig}
        self._held_rig = search.held_rig.keys()
        self._unseen = self._spread_of_unseen(found)
        self.spread = self._unseen | self.spread
        self.rig = tuple(n.name for n in search.numbers if error_of(n.name))
        staged = {name for row in found.coverage for name in (*row.free, *row.held)}
        shown = {name for row in coverage(points, config.tyre.side, self.hand.held) for name in row.free}
        self.put_back = shown & search.held.keys()  #: the points push them to a bound for nothing
        self.extra = tuple(n.name for n in search.numbers if n.name not in staged and n.name not in self.rig)
        self.new_zeros = self._zeros_of_new_setups()
        self.usual = {e.free[0].name: self._usual(e) for e in effects}  # 1 sigma
        self.names = tuple(dict.fromkeys([*self.spread, PECP1, *self.usual, *self.new_zeros]))
        self._row = {name: k for k, name in enumerate(self.names)}
        self._at = np.array([self.simulation.number(n, points) for n in self.names])
        sigma = {channel: _median_or_infinite(s) for channel, s in search.problem.sigma.items()}
        if self._unseen:  # nothing is known of the noise of Fx: forces usually scatter alike
            sigma = {"Fx": sigma["Fy"], **sigma}
        self._sigma = sigma
        self._base = self._information(self.problem.free(self.names).linear(self._at).slope)
        self._of_run: dict[str, np.ndarray] = {}

    def posterior(self, runs: Sequence[PlannedRun], u_epsilon: float | None) -> Posterior:
        """The posterior of a build with these runs; ``u_epsilon`` is u of a measured PECP1, None if PECP1 is fitted."""
        free, spread = self._free(runs), self._spread(runs)
        if PECP1 in self.hand.held:
            free, spread = [n for n in free if n != PECP1], {**spread, PECP1: 0.0}
        elif u_epsilon is None:
            prior = self.hand.priors.get(PECP1)
            free = list(dict.fromkeys([*free, PECP1]))
            spread = {**spread, PECP1: math.inf if prior is None else prior.spread}
        else:
            free, spread = [n for n in free if n != PECP1], {**spread, PECP1: u_epsilon}
        held = [n for n in spread if n not in free and math.isfinite(spread[n])]
        return self._solved(self._information_of(runs), free, spread, held)

    def u_of_effect(self, runs: Sequence[PlannedRun], effect: Effect, rivals: Iterable[Effect]) -> float:
        """u of an effect's number from the data alone, with the fitted numbers and its rival effects free."""
        name = effect.free[0].name
        partners = {e.free[0].name for e in rivals}
        declared = self._spread(runs)
        free = list(dict.fromkeys([*self._free(runs), PECP1, *partners, name]))
        spread = {n: declared.get(n, self.usual.get(n, math.inf)) for n in free}
        spread[PECP1] = math.inf
        spread |= {n: self.usual[n] for n in partners if n not in self.rig}
        spread[name] = math.inf
        return self._solved(self._information_of(runs), free, spread, []).stderr[name]

    def usual_size(self, effect: Effect) -> float:
        """Usual size of an effect's number, 1 sigma."""
        return self.usual[effect.free[0].name]

    def with_readings(self, run: PlannedRun, draw: np.random.Generator | None = None) -> Points:
        """The set-points of a run with the readings that the fitted rig would give; with noise if ``draw`` is given."""
        assert run.points is not None
        read = self.simulation.readings(run.points, self.channels_of(run))
        if draw is None:
            return run.points.replace(**read)
        noise = {name: sigma if math.isfinite(sigma) else 0.0 for name, sigma in self._sigma.items()}
        n = len(run.points)
        return run.points.replace(
            **{name: values + noise[name] * draw.standard_normal(n) for name, values in read.items()}
        )

    def channels_of(self, run: PlannedRun) -> tuple[str, ...]:
        """Channels that a run measures: those of the programme, and what it adds."""
        added = run.addition.measures
        return tuple(c for c in self._sigma if c in self.problem.channels or c in added)

    def _spread_of_unseen(self, found: FitResult) -> dict[str, float]:
        """Standard deviation of the coefficients that only a run of longitudinal slip would free; empty once one was made."""
        if self.config.rig.on_disc or "Fx" in self.problem.channels:
            return {}
        runs = [run for run in candidates(self.config, self.points) if run.points is not None]
        known = found.tyre.values
        return {
            name: row.stderr
            or scatter(name, float(known[name]), from_base=row.status == "base", curved=False)
            for name, row in found.coefficients.items()
            if name in self._freed_by(runs) and name not in self.spread
        }

    def _freed_by(self, runs: Sequence[PlannedRun]) -> set[str]:
        """Coefficients that a build with some runs frees."""
        new = [_as_measured(run) for run in runs if run.points is not None]
        points = concatenate([self.points, *new]) if new else self.points
        cover = coverage(points, self.config.tyre.side, self.hand.held)
        return {name for row in cover for name in row.free}

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
        return [name for name in self.new_zeros if name.partition(OF_RUN)[2] in used]

    def _usual(self, effect: Effect) -> float:
        number = effect.free[0]
        size = abs(self.simulation.number(number.name, self.points)) if number.relative else 1.0
        return number.spread * size

    def _free(self, runs: Sequence[PlannedRun]) -> list[str]:
        new = [_as_measured(run) for run in runs if run.points is not None]
        points = concatenate([self.points, *new]) if new else self.points
        cover = coverage(points, self.config.tyre.side, self.hand.held)
        named = [*(name for row in cover for name in row.free), *self.extra, *self.rig, *self._new_of(runs)]
        return [name for name in dict.fromkeys(named) if name not in self.put_back]

    def _spread(self, runs: Sequence[PlannedRun]) -> dict[str, float]:
        """Prior spread of each number once the rig has been measured as the runs demand."""
        better = [run for run in runs if run.rig]
        row = self.measured.nominal
        new = {name: self.new_zeros[name] for name in self._new_of(runs)}
        if not better or row is None:
            return {**self.spread, **new}
        config = self.config
        for run in better:
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
        return {
            **{name: u for name, u in self.spread.items() if name not in separated},
            **new,
            **{name: u for name, u in found.items() if name in (*self.spread, *new)},
        }

    def _information_of(self, runs: Sequence[PlannedRun]) -> np.ndarray:
        return self._base + sum((self._added(run) for run in runs), np.zeros_like(self._base))

    def _added(self, run: PlannedRun) -> np.ndarray:
        if run.points is None:
            return np.zeros_like(self._base)
        if run.name not in self._of_run:
            n = len(run.points)
            sigma = {channel: np.full(n, self._sigma[channel]) for channel in self.channels_of(run)}
            seen = replace(self.problem, points=self.with_readings(run), sigma=sigma, envelope=None, radii=())
            slope = seen.free(self.names).linear(self._at).slope
            if self._new_of([run]):  # zeros of its own instead of those without a set-up
                own = [self._row[e.name] for e in ZEROS if e.name in self.rig]
                slope[:, own] = 0.0
            self._of_run[run.name] = self._information(slope)
        return self._of_run[run.name]

    @staticmethod
    def _information(slope: np.ndarray) -> np.ndarray:
        slope = np.nan_to_num(slope)
        return slope.T @ slope

    def _solved(
        self, information: np.ndarray, free: Sequence[str], spread: Mapping[str, float], held: Sequence[str]
    ) -> Posterior:
        """Like :func:`mffit.fit.posterior.joint`, computed from the information matrix."""
        f, h = ([self._row[n] for n in names] for names in (free, held))
        prior = np.diag([spread.get(n, math.inf) ** -2.0 for n in free])
        covariance = inverse(information[np.ix_(f, f)] + prior)
        return beside_held(free, covariance, {n: spread[n] for n in held}, information[np.ix_(f, h)])


def _as_measured(run: PlannedRun) -> Points:
    """The set-points of a run, with readings of 0 in the channels that it adds: coverage asks only whether they are there."""
    assert run.points is not None
    return run.points.replace(**dict.fromkeys(run.addition.measures, 0.0))


def _median_or_infinite(sigma: np.ndarray) -> float:
    known = sigma[np.isfinite(sigma)]
    return float(np.median(known)) if len(known) else math.inf
