"""What a fit leaves of the readings, as one linear model per channel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.least_squares import inverse, root
from mffit.linearised import constants
from mffit.linearised.components import Components, beside, most_probable, own_columns, variances
from mffit.linearised.inputs import along, inputs_of, settings_of
from mffit.linearised.mixed import Mixed, Posterior, Predicted, Variances
from mffit.linearised.smooth import Smooth
from mffit.points import Points
from mffit.rig import Simulation
from mffit.scatter import rms


@dataclass(frozen=True, eq=False)
class LinearisedChannel:
    """Residuals of one channel: what the formula misses, what differs from run to run, noise."""

    name: str
    rows: np.ndarray  #: (n,) of the points that are looked at
    stride: int  #: readings for each of them
    unit: np.ndarray  #: (n,) their noise as stated, or usual [N], [Nm], [m]
    smooth: Smooth
    components: Components
    model: Mixed
    """Of residuals, measured less model, over ``unit``; its common numbers are the weights of ``smooth``, then changes of the
    numbers of the fit."""
    variances: Variances  #: of these
    missed: (
        np.ndarray
    )  #: (m,) weights of the functions with the numbers of the fit as they are [unit of the channel]
    turn: np.ndarray  #: (k, k) changes of the numbers of the fit by these
    sweeps: np.ndarray  #: number of the sweep of every group of ``model``

    @cached_property
    def posterior(self) -> Posterior:
        """Of the common numbers."""
        return self.model.posterior(self.variances)

    def of_readings(self, columns: np.ndarray) -> np.ndarray:
        """Covariance (k, k) of ``columns.T`` @ readings, columns (n, k), by what differs from run to run and by noise.

        Readings of a run are not independent, so that runs count and not readings; what the formula misses is no chance.
        """
        own, stride = np.exp(0.5 * self.variances.own), self.stride
        scaled = columns * self.unit[:, None]
        out = stride * self.components.noise**2 * scaled.T @ scaled
        for group in self.model.groups:
            through = stride * scaled[group].T @ (self.model.own[group] * own)
            out += through @ through.T
        return np.asarray(out)

    @property
    def noise(self) -> float:
        """Standard deviation of a usual reading of a run."""
        return self.components.noise * float(np.median(self.unit))

    @property
    def size(self) -> float:
        """Root mean square of what the formula misses at the readings."""
        return rms(self.missed_at_readings)

    @property
    def missed_at_readings(self) -> np.ndarray:
        """What the formula misses (n,), measured less model, as all sweeps show it."""
        return np.asarray(self.unit * (self.model.common[:, : len(self.missed)] @ self.missed))

    @property
    def misfit(self) -> float:
        """Root mean square of the residuals over their stated noise."""
        return rms(self.model.residual)

    def left_out(self, groups: Sequence[np.ndarray] | None = None) -> list[Predicted]:
        """Each sweep, or each set of groups, as all others predict it; rows count those of ``rows``."""
        which = [np.array([k]) for k in range(len(self.sweeps))] if groups is None else groups
        return [self._in_its_unit(one) for one in self.model.left_out(self.variances, which)]

    def by_the_others(self, group: int) -> Predicted:
        """A group as the others predict it, which alone say where the numbers of the fit are and what is usual beside it.

        A run that is far off would otherwise bend the fit, widen what counts as usual, and hide in it. Between the settings of
        a condition that no run sweeps, such as the load, few runs say how fast the miss changes: it may change from one to the
        next.
        """
        rest = [rows for k, rows in enumerate(self.model.groups) if k != group]
        others = Mixed(self.model.residual, self.model.common, self.model.own, rest)
        found = _found(others, self.smooth, self.unit, constants.FITTED_ANEW)
        lengths = tuple(
            min(length, one.spacing) if one.is_held else length
            for one, length in zip(self.smooth.inputs, found.lengths, strict=True)
        )
        given, _, _ = variances(replace(found, lengths=lengths).logarithms, self.smooth)
        common = beside(given.common, self.model, constants.FITTED_ANEW)
        (one,) = self.model.left_out(given._replace(common=common), [np.array([group])])
        return self._in_its_unit(one)

    def gain(self, change: np.ndarray) -> float:
        """Gain of log evidence by a known change (n,) of the readings that takes the place of what the formula misses."""
        without = self._alone(self.model.residual - change / self.unit)
        found = _found(without, self.smooth, self.unit)
        before, after = (
            alone.evidence(variances(of.logarithms, self.smooth)[0]).value
            for alone, of in ((self._alone(self.model.residual), self.components), (without, found))
        )
        return self.stride * (after - before)

    def _alone(self, residual: np.ndarray) -> Mixed:
        """The model of some residuals (n,) with the numbers of the fit as they are."""
        return Mixed(residual, self.model.common[:, : len(self.missed)], self.model.own, self.model.groups)

    def _in_its_unit(self, one: Predicted) -> Predicted:
        unit = self.unit[one.rows]
        return Predicted(one.rows, one.error * unit, one.covariance * np.outer(unit, unit))


class Uncertain(NamedTuple):
    """A number of the fit that may change, with the standard deviation of its prior."""

    name: str
    spread: float


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
    """The components are found with the numbers of the fit as they are: free ones would take up what the formula misses."""
    every = np.flatnonzero(used)
    stride = max(1, -(-len(every) // int(constants.POINTS_EXAMINED)))
    rows = every[::stride]
    part, at_tyre = (p.select(rows, with_table=False) for p in (sight.points, sight.felt))
    residual = part.channel(name) - model[rows]
    stated = part.u(name)
    usual = float(np.median(sigma[rows]))
    unit = np.where(np.isfinite(stated) & (stated > 0.0), stated, usual)
    inputs = inputs_of(at_tyre)
    smooth = Smooth.over(inputs)
    groups = [np.flatnonzero(part.sweep == k) for k in np.unique(part.sweep)]
    own = own_columns(model[rows], along(at_tyre, inputs))
    missed = smooth.columns(settings_of(at_tyre, inputs)) / unit[:, None]
    alone = Mixed(residual / unit, missed, own / unit[:, None], groups)
    components = _found(alone, smooth, unit)
    names, spread = zip(*sight.numbers, strict=True) if sight.numbers else ((), ())
    found = np.asarray(sight.simulation.sensitivities(part, names, [name])[1][name])
    weighted = found / sigma[rows][:, None]
    turn = root(
        inverse(
            np.diag(np.array(spread) ** -2.0) + stride * weighted.T @ weighted / constants.WIDER_THAN_THE_FIT
        )
    )
    joint = Mixed(alone.residual, np.hstack([missed, found @ turn / unit[:, None]]), alone.own, groups)
    of_functions, _, _ = variances(components.logarithms, smooth)
    prior = of_functions._replace(common=np.append(of_functions.common, np.zeros(turn.shape[1])))
    return LinearisedChannel(
        name,
        rows,
        stride,
        unit,
        smooth,
        components,
        joint,
        prior,
        alone.posterior(of_functions).mean,
        turn,
        np.unique(part.sweep),
    )


def _found(model: Mixed, smooth: Smooth, unit: np.ndarray, others: float = 1.0) -> Components:
    """The components of residuals over ``unit`` (n,); ``others`` is the variance of further shared numbers."""
    rows = np.concatenate(list(model.groups))
    size = max(rms((model.residual * unit)[rows]), 1e-12)
    return most_probable(model, smooth, Components.guess(smooth, size), size, others)
