"""The band of the road after further runs, by the linear models of the residuals from which ``predict`` takes its uncertainty."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from mffit.additions import PlannedRun
from mffit.constants import COVERAGE_FACTOR_95
from mffit.fit import FitResult
from mffit.linearised import LinearisedChannel
from mffit.linearised.gaussian import Directions, Informed
from mffit.points import Points
from mffit.points.points import concatenate
from mffit.prediction.predictor import root_with_held
from mffit.prediction.road import conditions, postures
from mffit.quantities import SIDEWAYS
from mffit.rig_errors import OF_RUN, error_of
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, slots=True, eq=False)
class _ChannelOnRoad(ReadOnlyArrays):
    """The uncertain force of one channel on the road (n,), in r independent errors of unit variance."""

    linear: LinearisedChannel
    root: np.ndarray  #: (m + k, r) of the functions' weights and the numbers that the readings inform
    held: Mapping[str, np.ndarray]
    """By number that keeps its uncertainty, the force (n,) by one standard deviation of it."""
    road: np.ndarray  #: (n, r)
    unlike: np.ndarray  #: (n,) variance of the model error that nothing tested tells
    largest: float  #: force of the upright wheel [unit of the channel]

    def told(self, run: Points, force: np.ndarray, slopes: np.ndarray, own_zeros: np.ndarray) -> np.ndarray:
        """Information (r, r) of a run on the errors; ``own_zeros`` (n, j) are changes by zeros that no other run has."""
        untold, functions = self.linear.functions_at(run)
        seen = np.hstack([functions, slopes]) @ self.root
        _, own = self.linear.foreseen(run, force)
        missed = np.sqrt(untold) * self.linear.components.missed
        shared = Directions.of(np.column_stack([own, own_zeros, missed]) / self.linear.noise)
        white = shared.less(seen / self.linear.noise)
        return np.asarray(white.T @ white)

    def band(self, information: np.ndarray, held: Mapping[str, float]) -> float:
        """Rms half width of the 95 % band over the largest force; ``held`` multiplies the uncertainty of held numbers."""
        free = np.sum((self.road @ Informed.by(information, np.zeros(len(information))).root) ** 2, axis=1)
        by_held = sum((held.get(name, 1.0) * force) ** 2 for name, force in self.held.items())
        return COVERAGE_FACTOR_95 * rms(np.sqrt(free + by_held + self.unlike)) / self.largest


class RoadBand:
    """The 95 % bands of Fy and Mz on the road, upright and leaned, over their largest values."""

    def __init__(self, found: FitResult, new_zeros: Mapping[str, float]) -> None:
        assert found.search is not None
        assert found.left_by_file is not None
        assert found.prediction is not None
        self._simulation, self._numbers = found.search.problem.simulation, found.left_by_file.numbers
        self._names = [number.name for number in self._numbers]
        self._new_zeros = new_zeros
        self._told: dict[str, dict[str, np.ndarray]] = {}
        at = postures(found.tyre)
        self._channels: dict[str, _ChannelOnRoad] = {}
        if at is None:
            return
        cambers = dict.fromkeys((0.0, at[1]))
        parts = [found.prediction.points(found.tyre, conditions(found.tyre, one, at[0])) for one in cambers]
        road = concatenate(parts)
        for name in SIDEWAYS:
            if name in found.left_by_file.channels:
                self._channels[name] = self._on_road(name, found.left_by_file.channels[name], road)

    def _on_road(self, name: str, linear: LinearisedChannel, road: Points) -> _ChannelOnRoad:
        spread = {i: number.spread for i, number in enumerate(self._numbers) if number.held}
        whole = root_with_held(linear, range(len(self._names)), spread)
        free = whole.shape[1] - len(spread)
        of_tyre = np.array([error_of(own) is None for own in self._names])
        tyre = self._simulation.faultless
        untold, functions = linear.functions_at(road)
        slopes = np.nan_to_num(tyre.sensitivities(road, self._names, [name])[1][name]) * of_tyre
        forces = np.hstack([functions, slopes]) @ whole
        return _ChannelOnRoad(
            linear=linear,
            root=whole[:, :free],
            held={self._names[i]: forces[:, free + k] for k, i in enumerate(spread)},
            road=forces[:, :free],
            unlike=untold * linear.components.missed**2,
            largest=float(np.max(np.abs(tyre.readings(road, [name])[name][road.gamma == 0.0]))),
        )

    def after(self, runs: Sequence[PlannedRun], new: Sequence[str], held: Mapping[str, float]) -> float:
        """The bands after runs, rms of both channels; ``new`` are the zeros of their new set-ups."""
        of_channels = [
            one.band(
                sum((self._of(run, new)[name] for run in runs), np.zeros((one.road.shape[1],) * 2)), held
            )
            for name, one in self._channels.items()
        ]
        return rms(np.array(of_channels)) if of_channels else np.inf

    def _of(self, run: PlannedRun, new: Sequence[str]) -> dict[str, np.ndarray]:
        """By channel, what a run tells; one of a new set-up has zeros of its own instead of the common ones."""
        if run.name in self._told:
            return self._told[run.name]
        own = [name for name in new if name.partition(OF_RUN)[2] in run.points.used_setups]
        common = {name.partition(OF_RUN)[0] for name in own}
        moving = np.array([name not in common for name in self._names])
        forces, found = self._simulation.sensitivities(run.points, [*self._names, *own], [*self._channels])
        spread = np.array([self._new_zeros[name] for name in own])
        told = {}
        for name, one in self._channels.items():
            slopes, zeros = np.split(np.nan_to_num(found[name]), [len(moving)], axis=1)
            told[name] = one.told(run.points, forces[name], slopes * moving, zeros * spread)
        self._told[run.name] = told
        return told
