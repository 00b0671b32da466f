"""What a fit leaves of the readings, as one linear model per channel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.least_squares import inverse, root
from mffit.linearised import constants
from mffit.linearised.components import Components, most_probable, own_columns, variances, with_further
from mffit.linearised.inputs import along, inputs_of, settings_of
from mffit.linearised.mixed import LeftOutReadings, Mixed, MixedPosterior, Variances
from mffit.linearised.smooth import SmoothFunctions
from mffit.points import Points
from mffit.points.noise import stating
from mffit.rig import Simulation
from mffit.rig_errors import error_of
from mffit.scatter import rms


@dataclass(frozen=True, eq=False)
class LinearisedChannel:
    """Residuals of one channel: what the formula misses, what differs from run to run, noise."""

    name: str
    rows: np.ndarray  #: (n,) of the points that are looked at
    unit: np.ndarray  #: (n,) their noise as stated, or usual [N], [Nm], [m]
    smooth: SmoothFunctions
    components: Components
    model: Mixed
    """Of residuals, measured less model, over ``unit``; its common numbers are the weights of ``smooth``, then changes of the
    numbers of the fit."""
    variances: Variances  #: of these
    missed: np.ndarray
    """(m,) weights of the functions beside the errors of the rig, the coefficients as they are [unit of the channel]."""
    turn: np.ndarray  #: (k, k) changes of the numbers of the fit by these
    sweeps: np.ndarray  #: number of the sweep of every group of ``model``

    @cached_property
    def posterior(self) -> MixedPosterior:
        """Of the common numbers."""
        return self.model.posterior(self.variances)

    @property
    def noise(self) -> float:
        """Standard deviation of a usual reading of a run."""
        return self.components.noise * float(np.median(self.unit))

    @property
    def size(self) -> float:
        """Root mean square of what the formula misses at the readings."""
        return rms(self.unit * (self.model.common[:, : len(self.missed)] @ self.missed))

    def left_out(self, groups: Sequence[np.ndarray] | None = None) -> list[LeftOutReadings]:
        """Each sweep, or each set of groups, as all others predict it; rows count those of ``rows``."""
        which = [np.array([k]) for k in range(len(self.sweeps))] if groups is None else groups
        found = self.model.left_out(self.variances, which)
        return [
            LeftOutReadings(
                one.rows,
                one.error * self.unit[one.rows],
                one.covariance * np.outer(self.unit[one.rows], self.unit[one.rows]),
            )
            for one in found
        ]


class Uncertain(NamedTuple):
    """A number of the fit that may change, with its prior as the change from its value."""

    name: str
    expected: float
    spread: float  #: standard deviation


@dataclass(frozen=True, eq=False)
class LinearisedFit:
    """The channels of a fit at its solution."""

    numbers: tuple[Uncertain, ...]  #: (k,) coefficients and rig errors
    channels: Mapping[str, LinearisedChannel]


def linearised(
    points: Points,
    simulation: Simulation,
    sigma: Mapping[str, np.ndarray],
    numbers: Sequence[Uncertain],
    only: Iterable[str] | None = None,
) -> LinearisedFit:
    """The linear model of what a simulation leaves of the points.

    Parameters
    ----------
    points : (n,)
    simulation : the fitted tyre on its rig
    sigma : by channel, uncertainty (n,) that the fit used; inf where a reading has no weight
    numbers : of the fit, each with a prior
    only : channels to look at; all that were fitted if None
    """
    readings = simulation.readings(points, sigma)
    felt = simulation.felt(points)
    found = {}
    for name in sigma if only is None else only:
        used = np.isfinite(sigma[name]) & np.isfinite(points.channel(name))
        if np.any(used):
            sight = _Sight(points, felt, simulation, numbers)
            found[name] = _channel(name, sight, readings[name], sigma[name], used)
    return LinearisedFit(tuple(numbers), found)


class _Sight(NamedTuple):
    """What all channels share."""

    points: Points
    felt: Points
    simulation: Simulation
    numbers: Sequence[Uncertain]


def _channel(
    name: str, sight: _Sight, model: np.ndarray, sigma: np.ndarray, used: np.ndarray
) -> LinearisedChannel:
    """The components are found with the coefficients as they are, since free ones would take up what the formula misses.

    The errors of the rig are free: none of them is to take up what the formula misses, beyond what was declared.
    """
    every = np.flatnonzero(used)
    stride = max(1, -(-len(every) // int(constants.POINTS_EXAMINED)))
    rows = every[::stride]
    part, at_tyre = (p.select(rows, with_table=False) for p in (sight.points, sight.felt))
    residual = part.channel(name) - model[rows]
    stated = part.u(name)
    usual = float(np.median(sigma[rows]))
    unit = np.where(stating(stated), stated, usual)
    inputs = inputs_of(at_tyre)
    smooth = SmoothFunctions.over(inputs)
    groups = [np.flatnonzero(part.sweep == k) for k in np.unique(part.sweep)]
    own = own_columns(model[rows], along(at_tyre, inputs))
    missed = smooth.columns(settings_of(at_tyre, inputs)) / unit[:, None]
    slopes = sight.simulation.sensitivities(part, [number.name for number in sight.numbers], [name])[1][name]
    of_rig = [i for i, number in enumerate(sight.numbers) if error_of(number.name) is not None]
    rig = slopes[:, of_rig] / unit[:, None]
    declared = np.log([sight.numbers[i].spread ** 2 for i in of_rig])
    alone = Mixed(
        residual=residual / unit - rig @ np.array([sight.numbers[i].expected for i in of_rig]),
        common=np.hstack([missed, rig]),
        own=own / unit[:, None],
        groups=groups,
    )
    misfit = max(rms(residual), 1e-12)
    components = most_probable(alone, smooth, Components.guess(smooth, misfit), misfit, declared)
    turn = _turn(sight.numbers, slopes / sigma[rows][:, None], stride)
    of_functions, _, _ = variances(components.logarithms, smooth)
    return LinearisedChannel(
        name=name,
        rows=rows,
        unit=unit,
        smooth=smooth,
        components=components,
        model=Mixed(residual / unit, np.hstack([missed, slopes @ turn / unit[:, None]]), alone.own, groups),
        variances=with_further(of_functions, np.zeros(turn.shape[1])),
        missed=alone.posterior(with_further(of_functions, declared)).mean[: missed.shape[1]],
        turn=turn,
        sweeps=np.unique(part.sweep),
    )


def _turn(numbers: Sequence[Uncertain], weighted: np.ndarray, stride: int) -> np.ndarray:
    """Changes (k, k) of the numbers of the fit that are independent, each of variance 1, before what is missed is known.

    ``weighted`` (n, k) are derivatives over the uncertainty that the fit used.
    """
    prior = np.array([number.spread for number in numbers]) ** -2.0
    return root(inverse(np.diag(prior) + stride * weighted.T @ weighted / constants.WIDER_THAN_THE_FIT))
