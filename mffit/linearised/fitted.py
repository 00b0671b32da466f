"""What a fit leaves of the readings, as one linear model per channel."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.least_squares import inverse, root
from mffit.linearised import constants
from mffit.linearised.components import Components, most_probable, own_columns, variances, with_further
from mffit.linearised.inputs import along, inputs_of, settings_of
from mffit.linearised.mixed import FurtherColumns, LeftOutReadings, Mixed, MixedPosterior, Variances
from mffit.linearised.smooth import SmoothFunctions
from mffit.points import Points
from mffit.points.noise import stating
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS, Place, error_of
from mffit.scatter import rms, robust


@dataclass(frozen=True, eq=False)
class LinearisedChannel:
    """Residuals of one channel: what the formula misses, what differs from run to run, noise."""

    name: str
    rows: np.ndarray  #: (n,) of the points that are looked at
    stride: int  #: readings for each of them
    unit: np.ndarray  #: (n,) their noise as stated, or usual [N], [Nm], [m]
    smooth: SmoothFunctions
    components: Components
    model: Mixed
    """Of residuals, measured less model, over ``unit``; its common numbers are the weights of ``smooth``, then changes of the
    numbers of the fit."""
    variances: Variances  #: of these
    alone: Mixed
    """The same with the coefficients as they are; its common numbers are the weights, then errors of the rig as declared."""
    declared: np.ndarray  #: logarithms of the variances of these errors
    missed: np.ndarray
    """(m,) weights of the functions with the coefficients and the zeros of the rig as they are [unit of the channel]."""
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
        return rms(self.missed_at_readings)

    @property
    def missed_at_readings(self) -> np.ndarray:
        """What the formula misses (n,), measured less model, as all sweeps show it."""
        return np.asarray(self.unit * (self.model.common[:, : len(self.missed)] @ self.missed))

    @property
    def misfit(self) -> float:
        """Root mean square of the residuals over their stated noise."""
        return rms(self.model.residual)

    def told_of(self, slopes: np.ndarray) -> FurtherColumns:
        """Information and pull of all readings on some numbers, where the miss, runs and noise are unknown, too.

        ``slopes`` (n, k) are derivatives of the readings of :attr:`rows` by the numbers.
        """
        functions, given = len(self.missed), self.variances
        plain = replace(self.model, common=self.model.common[:, :functions])
        of_all = given._replace(
            common=given.common[:functions], noise=given.noise - float(np.log(self.stride))
        )
        return plain.further(of_all, slopes / self.unit[:, None])

    def left_out(self, rows: Sequence[np.ndarray] | None = None) -> list[LeftOutReadings]:
        """Each sweep, or each set of ``rows`` counted as those of :attr:`rows`, as all other readings predict it."""
        return self._left_out(self.model, self.variances, self.model.groups if rows is None else rows)

    def without_runs(self, rows: Sequence[np.ndarray], *, missed: bool) -> list[LeftOutReadings]:
        """The same if runs did not differ but by noise; without what is ``missed``, all that usual readings miss is noise."""
        functions = len(self.missed)
        noise = self.components.noise if missed else robust(self.model.residual)
        given = self.variances._replace(own=self._alike, noise=2.0 * float(np.log(max(noise, 1.0))))
        if missed:
            return self._left_out(self.model, given, rows)
        plain = replace(self.model, common=self.model.common[:, functions:])
        return self._left_out(plain, given._replace(common=given.common[functions:]), rows)

    def by_others(self, rows: np.ndarray) -> LeftOutReadings:
        """The rows of a run that others shall predict, if the fit and the components are those of the others.

        Between the settings of a condition that no run sweeps, such as the load, few runs say how fast the miss changes: it may
        change from one to the next.
        """
        lengths = tuple(
            min(length, one.spacing) if one.is_held else length
            for one, length in zip(self.smooth.inputs, self.components.lengths, strict=True)
        )
        given, _, _ = variances(replace(self.components, lengths=lengths).logarithms, self.smooth)
        (found,) = self._left_out(self.model, with_further(given, np.zeros(self.turn.shape[1])), [rows])
        return found

    @property
    def _alike(self) -> np.ndarray:
        """Logarithms of the variances of the numbers of each run, if runs do not differ."""
        return np.full(len(self.variances.own), 2.0 * np.log(1e-6 * float(np.median(self.unit))))

    @cached_property
    def proof(self) -> float:
        """Gain of log evidence by what the formula misses, over a constant alone."""
        return self.stride * (self._evidence - self._without)

    @property
    def is_proven(self) -> bool:
        """Whether neither noise nor differences of runs look like what the formula misses."""
        return self.proof > constants.CERTAIN_EVIDENCE

    @property
    def proven_over(self) -> list[str]:
        """Names of the inputs over which it changes for certain, the clearest first."""
        return [name for name, gain in self.missed_over.items() if gain > constants.CERTAIN_EVIDENCE]

    @cached_property
    def missed_over(self) -> dict[str, float]:
        """Gain of log evidence because what the formula misses changes over an input, by its name, largest first."""
        found = {}
        for i, one in enumerate(self.smooth.inputs):
            lengths = list(self.components.lengths)
            lengths[i] = constants.LONGEST_LENGTH * one.width
            constant = replace(self.components, lengths=tuple(lengths))
            without = _evidence(self.alone, constant, self.smooth, self.declared)
            found[one.name] = self.stride * (self._evidence - without)
        return dict(sorted(found.items(), key=lambda item: -item[1]))

    @cached_property
    def _evidence(self) -> float:
        """Log evidence of the model with the coefficients as they are."""
        return _evidence(self.alone, self.components, self.smooth, self.declared)

    @cached_property
    def _without(self) -> float:
        """Log evidence if the formula misses only a constant."""
        constant = SmoothFunctions.over(())
        model = replace(
            self.alone,
            common=np.hstack([1.0 / self.unit[:, None], self.alone.common[:, len(self.missed) :]]),
        )
        found = _found(model, constant, self.unit, self.declared)
        return _evidence(model, found, constant, self.declared)

    def _left_out(self, model: Mixed, given: Variances, rows: Sequence[np.ndarray]) -> list[LeftOutReadings]:
        return [
            LeftOutReadings(
                one.rows,
                one.error * self.unit[one.rows],
                one.covariance * np.outer(self.unit[one.rows], self.unit[one.rows]),
            )
            for one in model.left_out(given, rows)
        ]

    def gain(self, change: np.ndarray) -> tuple[float, float]:
        """Gain of log evidence by a known change (n,) of the readings that takes the place of what the formula misses, and the
        :attr:`proof` of what it misses beside that."""
        without = replace(self.alone, residual=self.alone.residual - change / self.unit)
        found = _found(without, self.smooth, self.unit, self.declared, self.components)
        beside = replace(self, alone=without, components=found)
        return self.stride * (beside._evidence - self._evidence), beside.proof


class Uncertain(NamedTuple):
    """A number of the fit that may change, with its prior as the change from its value."""

    name: str
    expected: float
    spread: float  #: standard deviation
    held: bool = False  #: whether the fit took it as exact


@dataclass(frozen=True, eq=False)
class LinearisedFit:
    """The channels of a fit at its solution."""

    numbers: tuple[Uncertain, ...]  #: (k,) coefficients and rig errors
    channels: Mapping[str, LinearisedChannel]

    @property
    def zeros(self) -> dict[str, tuple[float, float]]:
        """The fitted zeros of the rig beside what the formula misses: changes of their values, and standard uncertainties.

        The coefficients are as they are. A constant that the formula may miss belongs to a zero only as far as its declared
        uncertainty exceeds the size of such constants; all channels together say how far. Only zeros of forces: that of an angle
        moves along the curves, as coefficients do that are held here.
        """
        rig = [number for number in self.numbers if _of_rig(number)]
        free = np.array([_is_of_force(number) and not number.held for number in rig], dtype=bool)
        zeros = [number for number, own in zip(rig, free, strict=True) if own]
        information, pull = np.diag([number.spread**-2.0 for number in zeros]), np.zeros(len(zeros))
        for channel in self.channels.values():
            m = len(channel.missed)
            model = _beside(channel.alone, rig, m, free)
            given = channel.variances._replace(common=channel.variances.common[:m])
            found = replace(model, common=model.common[:, :m]).further(given, model.common[:, m:])
            information, pull = information + found.information, pull + found.pull
        covariance = inverse(information)
        change = np.array([number.expected for number in zeros]) + covariance @ pull
        u = np.sqrt(np.diag(covariance))
        return dict(zip([n.name for n in zeros], zip(change.tolist(), u.tolist(), strict=True), strict=True))


def linearised(
    points: Points,
    simulation: Simulation,
    sigma: Mapping[str, np.ndarray],
    numbers: Sequence[Uncertain],
    only: Iterable[str] | None = None,
    without: np.ndarray | None = None,
    near: LinearisedFit | None = None,
) -> LinearisedFit:
    """The linear model of what a simulation leaves of the points.

    Parameters
    ----------
    points : (n,)
    simulation : the fitted tyre on its rig
    sigma : by channel, uncertainty (n,) that the fit used; inf where a reading has no weight
    numbers : of the fit, each with a prior
    only : channels to look at; all that were fitted if None
    without : rows of the points that the simulation was not fitted to, and that do not say what is usual
    near : the same of a similar fit to these points, from which the search for the components begins
    """
    readings = simulation.readings(points, sigma)
    sight = _Sight(
        points,
        simulation.felt(points),
        simulation,
        numbers,
        np.zeros(0, int) if without is None else without,
        {} if near is None else {n: own.components for n, own in near.channels.items()},
        {},
    )
    found = {}
    for name in sigma if only is None else only:
        used = np.isfinite(sigma[name]) & np.isfinite(points.channel(name))
        if np.any(used):
            found[name] = _channel(name, sight, readings[name], sigma[name], used)
    return LinearisedFit(tuple(numbers), found)


class _Sight(NamedTuple):
    """What all channels share."""

    points: Points
    felt: Points
    simulation: Simulation
    numbers: Sequence[Uncertain]
    without: np.ndarray
    near: Mapping[str, Components]  #: by channel
    looked_at: dict[bytes, _LookedAt]  #: by the rows, which most channels have in common

    def at(self, rows: np.ndarray) -> _LookedAt:
        """The readings of some rows (n,)."""
        known = self.looked_at.get(rows.tobytes())
        if known is None:
            part, at_tyre = (p.select(rows, with_table=False) for p in (self.points, self.felt))
            inputs = inputs_of(at_tyre)
            smooth = SmoothFunctions.over(inputs)
            columns = smooth.columns(settings_of(at_tyre, inputs))
            known = _LookedAt(part, smooth, columns, along(at_tyre, inputs))
            self.looked_at[rows.tobytes()] = known
        return known


class _LookedAt(NamedTuple):
    """Readings (n,), and what may be missed there."""

    points: Points
    smooth: SmoothFunctions
    columns: np.ndarray  #: (n, m) of these
    along: np.ndarray  #: (n,) as :func:`mffit.linearised.inputs.along`


def _channel(
    name: str, sight: _Sight, model: np.ndarray, sigma: np.ndarray, used: np.ndarray
) -> LinearisedChannel:
    """The components are found with the coefficients as they are, since free ones would take up what the formula misses.

    The errors of the rig are free: none of them is to take up what the formula misses, beyond what was declared. Influences that
    the fit found, such as that of temperature, are as they are: nothing limits what a free one would take up.
    """
    every = np.flatnonzero(used)
    stride = max(1, -(-len(every) // int(constants.POINTS_EXAMINED)))
    rows = every[::stride]
    part, smooth, functions, place = sight.at(rows)
    residual = part.channel(name) - model[rows]
    stated = part.u(name)
    usual = float(np.median(sigma[rows]))
    unit = np.where(stating(stated), stated, usual)
    groups = [np.flatnonzero(part.sweep == k) for k in np.unique(part.sweep)]
    own = own_columns(model[rows], place)
    if len(groups) == 1:  # how runs differ is not seen, and one run would take up what the formula misses
        own = np.zeros_like(own)
    missed = functions / unit[:, None]
    slopes = sight.simulation.sensitivities(part, [number.name for number in sight.numbers], [name])[1][name]
    of_rig = [i for i, number in enumerate(sight.numbers) if _of_rig(number)]
    rig = slopes[:, of_rig] / unit[:, None]
    declared = np.log([sight.numbers[i].spread ** 2 for i in of_rig])
    known = ~np.isin(rows, sight.without)
    alone = Mixed(
        residual=residual / unit - rig @ np.array([sight.numbers[i].expected for i in of_rig]),
        common=np.hstack([missed, rig]),
        own=own / unit[:, None],
        groups=[own for own in (g[known[g]] for g in groups) if len(own)],
    )
    components = _found(alone, smooth, unit, declared, sight.near.get(name))
    turn = _turn(sight.numbers, (slopes / sigma[rows][:, None])[known], stride)
    of_functions, _, _ = variances(components.logarithms, smooth)
    return LinearisedChannel(
        name=name,
        rows=rows,
        stride=stride,
        unit=unit,
        smooth=smooth,
        components=components,
        model=Mixed(residual / unit, np.hstack([missed, slopes @ turn / unit[:, None]]), alone.own, groups),
        variances=with_further(of_functions, np.zeros(turn.shape[1])),
        alone=alone,
        declared=declared,
        missed=_missed(alone, [sight.numbers[i] for i in of_rig], declared, of_functions),
        turn=turn,
        sweeps=np.unique(part.sweep),
    )


def _missed(alone: Mixed, rig: Sequence[Uncertain], declared: np.ndarray, given: Variances) -> np.ndarray:
    """Weights (m,) of the functions beside the errors of the rig, of which the zeros and what the fit took as exact stay.

    No reading tells a zero from a constant that the formula misses: readings are then foretold with the zeros that are stated.
    """
    functions = len(given.common)
    stays = np.array([number.held or error_of(number.name) in ZEROS for number in rig], dtype=bool)
    model = _beside(alone, rig, functions, ~stays)
    found = model.posterior(with_further(given, declared[~stays]))
    return np.asarray(found.mean[:functions])


def _is_of_force(number: Uncertain) -> bool:
    """Whether a number is the zero of a force or moment."""
    error = error_of(number.name)
    return error in ZEROS and error.place is Place.FORCE


def _of_rig(number: Uncertain) -> bool:
    """Whether a number is an error of the rig that a prior limits."""
    error = error_of(number.name)
    return error is not None and error.has_prior


def _beside(alone: Mixed, rig: Sequence[Uncertain], functions: int, free: np.ndarray) -> Mixed:
    """The model with the coefficients as they are and only some (k,) errors of the rig free; all others are as fitted."""
    columns = alone.common[:, functions:]
    fitted = np.array([number.expected for number in rig])[~free]
    return replace(
        alone,
        residual=alone.residual + columns[:, ~free] @ fitted,
        common=np.hstack([alone.common[:, :functions], columns[:, free]]),
    )


def _turn(numbers: Sequence[Uncertain], weighted: np.ndarray, stride: int) -> np.ndarray:
    """Changes (k, k) of the numbers of the fit that are independent, each of variance 1, before what is missed is known.

    ``weighted`` (n, k) are derivatives over the uncertainty that the fit used.
    """
    prior = np.array([number.spread for number in numbers]) ** -2.0
    return root(inverse(np.diag(prior) + stride * weighted.T @ weighted / constants.WIDER_THAN_THE_FIT))


def _evidence(model: Mixed, of: Components, smooth: SmoothFunctions, further: np.ndarray) -> float:
    """Log evidence of components; ``further`` are logarithms of the variances of further common numbers."""
    given, _, _ = variances(of.logarithms, smooth)
    return model.evidence(with_further(given, further)).value


def _found(
    model: Mixed,
    smooth: SmoothFunctions,
    unit: np.ndarray,
    further: np.ndarray,
    near: Components | None = None,
) -> Components:
    """The components of residuals over ``unit`` (n,); ``further`` are logarithms of the variances of further common numbers."""
    rows = np.concatenate(list(model.groups))
    misfit = max(rms((model.residual * unit)[rows]), 1e-12)
    return most_probable(model, smooth, near, misfit, further)
