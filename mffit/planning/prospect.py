"""The posterior of a build with further runs added, from one linear model of all numbers of tyre and rig."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, TypeVar

import numpy as np

from mffit.additions import PlannedRun, candidates, largest_slip, new_setups, swept
from mffit.config import Config
from mffit.constants import ANGLES_OF_A_CURVE, COVERAGE_FACTOR_95
from mffit.fit import FitResult
from mffit.fit.coverage import coverage
from mffit.fit.fitted import left_by, priors_of
from mffit.fit.priors import scatter
from mffit.fit.ranges import tested_ranges
from mffit.fit.rig.rig_numbers import rig_numbers
from mffit.fit.told import Told, numbers_told, told_by_curves, told_by_run
from mffit.measured import Measured, unspun
from mffit.numbers import Numbers
from mffit.planning.goals import BANDS, EPSILON, FILE, JOINT, ROAD, Goal
from mffit.planning.road import RoadBand
from mffit.points import Points, levels, main_pressure, make_points
from mffit.points.points import concatenate
from mffit.rig import Simulation
from mffit.rig_errors import OF_RUN, ZEROS, error_of
from mffit.scatter import rms

PECP1 = "PECP1"
Found = TypeVar("Found")


class DirectU(NamedTuple):
    """u(eps_gamma) of the direct method."""

    stated: float  #: standard uncertainty that a build states
    held: float  #: standard uncertainty with which the fit holds PECP1


Direct = Callable[[Points], DirectU | None]
"""Applies the direct method to points; None if it fails."""


class DirectProspect:
    """The direct method applied to the present points and the predicted readings of further runs; cached."""

    def __init__(
        self,
        points: Points,
        nominal: float,
        predicted: Callable[[PlannedRun], Points],
        direct: Direct,
        outliers: Sequence[int] = (),
    ) -> None:
        self._nominal = nominal  #: load [N] at which eps_gamma is read
        self._pressure = float(np.median(points.p[main_pressure(points)]))
        self._near = points.select(self._decides(points) & ~np.isin(np.arange(len(points)), outliers))
        self._stated = _once(lambda runs: direct(concatenate([self._near, *map(predicted, runs)])))

    def __call__(self, runs: Sequence[PlannedRun]) -> DirectU | None:
        """What a build with these runs would state; None where the method fails."""
        return self._stated([run for run in runs if np.any(self._decides(run.points))])

    def u(self, runs: Sequence[PlannedRun]) -> float:
        """The stated uncertainty; infinite where the method fails."""
        found = self(runs)
        return math.inf if found is None else found.stated

    def _decides(self, points: Points) -> np.ndarray:
        """Mask (n,) of the points from which the direct method determines eps_gamma at the nominal load."""
        near = np.abs(np.log(points.Fz / self._nominal)) < levels.LOAD.tolerance
        main = np.abs(points.p - self._pressure) < levels.PRESSURE.tolerance
        return np.asarray(near & main & (points.mount > 0) & ~points.continuous)


class Prospect:
    """Uncertainties that a build of a longer programme would state, linearised at the present solution.

    The longer build is assumed to free the coefficients that its coverage allows, with the priors and weights of this build.
    """

    def __init__(
        self, config: Config, points: Points, measured: Measured, found: FitResult, direct: Direct
    ) -> None:
        assert found.search is not None
        search = found.search
        self.config, self.points, self.measured, self.found = config, points, measured, found
        self.problem, self.hand = search.problem, search.hand
        self.simulation, self.unspun = search.problem.simulation, unspun(points, measured)
        self.rig = tuple(n.name for n in search.numbers if error_of(n.name))
        self._fitted = priors_of(search)
        self._shown_now = self._shown([])
        self._unseen = self._spread_of_unseen()
        self._new_zeros = self._zeros_of_new_setups()
        self.names = tuple(dict.fromkeys([*self._fitted.names, *self._unseen, PECP1, *self._new_zeros]))
        self._row = {name: k for k, name in enumerate(self.names)}
        self._sigma = {channel: _usual(s) for channel, s in search.problem.sigma.items()}
        if self._unseen:  # the noise of Fx is unknown and assumed equal to that of Fy
            self._sigma = {"Fx": self._sigma["Fy"], **self._sigma}
        self._left, self._at_bound = found.left_by_file or left_by(search), search.at_own_bound
        self._told = told_by_curves(self.problem, self._left, self.names)
        self._of_run: dict[str, Told] = {}
        self._direct = DirectProspect(
            points,
            nominal_load(config, measured),
            self._with_readings,
            direct,
            [outlier.row for outlier in found.outliers],
        )

    def posterior(
        self,
        runs: Sequence[PlannedRun],
        free: Mapping[str, float] | None = None,
        held: Mapping[str, float] | None = None,
    ) -> Numbers:
        """The numbers of a build with these runs.

        ``free`` and ``held`` give prior standard deviations of numbers that the longer build, unlike this one, would fit or would
        hold without learning from the points.
        """
        free, held, own = free or {}, held or {}, self._fitted
        new = {name: self._new_zeros[name] for name in self._new_of(runs)}
        fitted = dict(zip(own.names, own.spread.tolist(), strict=True))
        spread = fitted | self._unseen | new | dict(free) | dict(held)
        beyond = self._shown(runs).keys() - self._shown_now.keys()
        unmoved = (own.held | self._unseen.keys()) - beyond - free.keys() | held.keys()
        expected = dict(zip(own.names, own.expected.tolist(), strict=True))
        values = np.array([self.simulation.number(name, self.points) for name in spread])
        priors = Numbers.beforehand(
            names=tuple(spread),
            values=values,
            expected=np.array([expected.get(n, x) for n, x in zip(spread, values.tolist(), strict=True)]),
            spread=np.array([*spread.values()]),
            held=frozenset(unmoved),
        )
        rows = [self._row[name] for name in spread]
        told = [one.only(rows) for one in (*self._told, *(self._told_by(run) for run in runs))]
        return numbers_told(told, priors).given(self._at_bound)

    def u_of(self, goal: Goal) -> Callable[[Sequence[PlannedRun]], float]:
        """A function that returns the uncertainty of a goal, in its unit, after given runs; infinite if it is not measured."""
        curves = self._curves_of(goal) if goal.kind in (BANDS, FILE) else None
        road = RoadBand(self.found, self._new_zeros) if goal.kind == ROAD else None

        def u(runs: Sequence[PlannedRun]) -> float:
            found: float | None
            if road is not None:
                found = road.after(runs, self._new_of(runs), self._narrower(runs))
            elif goal.kind in (EPSILON, JOINT):
                found = self.direct(runs) if goal.kind == EPSILON else self.joint(runs)
            else:
                posterior = self.as_built(runs)
                found = curves.band(posterior) if curves else posterior.stderr.get(goal.name)
            return math.inf if found is None or not math.isfinite(found) else found

        return _once(u)

    def joint(self, runs: Sequence[PlannedRun]) -> float | None:
        """u(PECP1) as a free coefficient of the joint fit of tyre and rig; None if held by hand, or without a measured force."""
        if not self.config.rig.on_disc or not self.rig or PECP1 in self.hand.held:
            return None
        return self._with_free_epsilon(runs).stderr[PECP1]

    def direct(self, runs: Sequence[PlannedRun]) -> float | None:
        """u(eps_gamma) that a build would state for the direct method."""
        found = self._direct(runs) if self.config.rig.on_disc else None
        return None if found is None else found.stated

    def _narrower(self, runs: Sequence[PlannedRun]) -> dict[str, float]:
        """By how much runs narrow the uncertainty with which the fit holds PECP1, if it is held."""
        now, then = self._direct([]), self._direct(runs)
        if PECP1 in self.hand.held or now is None or then is None or not now.held:
            return {}
        return {PECP1: then.held / now.held}

    def as_built(self, runs: Sequence[PlannedRun]) -> Numbers:
        """The numbers with PECP1 from the source that the file uses: held by hand, direct method, or joint fit."""
        by_hand = PECP1 in self.hand.held
        if self.config.spin.pecp1 == "model" and self.config.rig.on_disc and not by_hand:
            return self._with_free_epsilon(runs)
        direct = None if by_hand or not self.config.rig.on_disc else self._direct(runs)
        return self.posterior(runs, held={PECP1: 0.0 if direct is None else direct.held})

    def _with_free_epsilon(self, runs: Sequence[PlannedRun]) -> Numbers:
        prior = self.hand.priors.get(PECP1)
        return self.posterior(runs, free={PECP1: math.inf if prior is None else prior.spread})

    def _channels_of(self, run: PlannedRun) -> tuple[str, ...]:
        """Channels that a run measures: those of the programme and those of the addition."""
        return tuple(c for c in self._sigma if c in (*self.problem.channels, *run.addition.measures))

    def _with_readings(self, run: PlannedRun) -> Points:
        """The set-points of a run with readings simulated by the fitted tyre and rig."""
        return run.points.replace(**self.simulation.readings(run.points, self._channels_of(run)))

    def _spread_of_unseen(self) -> dict[str, float]:
        """Prior standard deviation of the coefficients that only longitudinal slip would free; empty if slip was run already."""
        if self.config.rig.on_disc or "Fx" in self.problem.channels:
            return {}
        values, shown = self.found.tyre.values, self._shown(candidates(self.config, self.points, self.unspun))
        return {
            name: row.stderr
            or scatter(name, float(values[name]), from_base=row.status == "base", curved=False)
            for name, row in self.found.coefficients.items()
            if name in shown and name not in self._fitted.names
        }

    def _shown(self, runs: Sequence[PlannedRun]) -> dict[str, None]:
        """Coefficients that the coverage of the programme with further runs allows to free, as keys."""
        # Coverage depends on whether there are readings, not on their values.
        new = [run.points.replace(**dict.fromkeys(run.addition.measures, 0.0)) for run in runs]
        cover = coverage(concatenate([self.points, *new]), self.config.tyre.side, self.hand.held)
        return dict.fromkeys(name for row in cover for name in row.free)

    def _zeros_of_new_setups(self) -> dict[str, float]:
        """By number, prior standard deviation of the zeros of set-ups that runs may add."""
        present, new = self.points.used_setups, new_setups(self.config, self.points)
        if not self.rig or not new:
            return {}
        numbers = rig_numbers(self.config, self.measured, (*present, *new), self.problem.channels)
        return {n.name: n.spread for n in numbers if n.name.partition(OF_RUN)[2] in new}

    def _new_of(self, runs: Sequence[PlannedRun]) -> list[str]:
        """Names of the zeros of the new set-ups that these runs use."""
        used = {name for run in runs for name in run.points.used_setups}
        return [name for name in self._new_zeros if name.partition(OF_RUN)[2] in used]

    def _told_by(self, run: PlannedRun) -> Told:
        """Expected information of a run; one of a new set-up has its own zeros instead of the common ones."""
        if run.name not in self._of_run:
            sigma = {channel: self._sigma[channel] for channel in self._channels_of(run)}
            still = [e.name for e in ZEROS if e.name in self.rig] if self._new_of([run]) else []
            points = self._with_readings(run)
            self._of_run[run.name] = told_by_run(self.problem, self._left, self.names, points, sigma, still)
        return self._of_run[run.name]

    def _curves_of(self, goal: Goal) -> _Curves:
        """Curves over sideslip and camber at three loads on a straight path, and over longitudinal slip if relevant."""
        names = [n for n in self.names if error_of(n) is None]
        tyre = Simulation.of(self.found.tyre, turn_slip=self.config.rig.on_disc)
        channels = [goal.name]
        if goal.kind == FILE:
            belt = () if self.config.rig.on_disc else ("Fx",)
            channels = [c for c in ("Fx", "Fy", "Mx", "Mz") if c in (*belt, *self.problem.channels)]
        driven = goal.kind == FILE or goal.name == "Fx" or not np.all(self.points.free_rolling)
        forces, slopes = tyre.sensitivities(self._on_curves(driven=driven), names, channels)
        size = {c: np.max(np.abs(forces[c])) if goal.kind == FILE else 1.0 for c in channels}
        return _Curves(names, [slopes[c] / size[c] for c in channels])

    def _on_curves(self, *, driven: bool) -> Points:
        """Conditions of the curves; with ``driven`` also over longitudinal slip, without and with sideslip."""
        tyre, tested = self.found.tyre, tested_ranges(swept(self.points))
        loads = [tested["FZMIN"], float(tyre["FNOMIN"]), tested["FZMAX"]]
        n = int(ANGLES_OF_A_CURVE)
        steer, camber = (np.linspace(-tested[end], tested[end], n) for end in ("ALPMAX", "CAMMAX"))
        none = np.zeros(n)
        lines = [(steer, none, none), (none, camber, none)]
        if driven:
            drive = np.linspace(-1.0, 1.0, n) * largest_slip(self.points)
            lines += [(none, none, drive), (none + 0.5 * tested["ALPMAX"], none, drive)]
        alpha, gamma, kappa = (np.tile(np.concatenate(part), len(loads)) for part in zip(*lines, strict=True))
        Fz = np.repeat(loads, len(lines) * n)
        p, V = float(tyre["NOMPRES"]), float(tyre["LONGVL"])
        return make_points(alpha, gamma, Fz, kappa=kappa, p=p, V=V, phi_t=0.0)


class _Curves(NamedTuple):
    """Curves of the tyre whose band is the goal."""

    names: Sequence[str]  #: (k,) coefficients
    slopes: Sequence[np.ndarray]  #: per channel, derivatives (n, k); for FILE, over the largest force

    def band(self, known: Numbers) -> float:
        """Rms half width of the 95 % band."""
        spread = [rms(known.spread_of(slopes, self.names)) for slopes in self.slopes]
        return COVERAGE_FACTOR_95 * rms(np.array(spread))


def nominal_load(config: Config, measured: Measured) -> float:
    """Load [N] at which eps_gamma is read."""
    return measured.nominal.load if measured.nominal else config.tyre.nominal_load


def _once(of: Callable[[Sequence[PlannedRun]], Found]) -> Callable[[Sequence[PlannedRun]], Found]:
    """The function, which computes only once for the same runs in any order."""
    known: dict[tuple[str, ...], Found] = {}

    def found(runs: Sequence[PlannedRun]) -> Found:
        key = tuple(sorted(run.name for run in runs))
        if key not in known:
            known[key] = of(runs)
        return known[key]

    return found


def _usual(sigma: np.ndarray) -> float:
    known = sigma[np.isfinite(sigma)]
    return float(np.median(known)) if len(known) else math.inf
