"""The residuals of a fit as one linear mixed model per channel."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.least_squares import inverse, root
from mffit.linearised import constants
from mffit.linearised.channel import LinearisedChannel, LookedAt, Uncertain
from mffit.linearised.combined import Combinations
from mffit.linearised.components import LIKELY_EVIDENCE, Components, Terms, own_columns
from mffit.linearised.ends import growths
from mffit.linearised.gaussian import Informed
from mffit.linearised.inputs import along, inputs_of, settings_of, steadied
from mffit.linearised.mixed import Mixed
from mffit.linearised.smooth import SmoothFunctions
from mffit.points import Points
from mffit.points.noise import stating
from mffit.quantities import REVERSED_BY_A_MIRROR
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS, Place, error_of


@dataclass(frozen=True, eq=False)
class LinearisedFit:
    """The linear models of all channels of a fit at its solution."""

    numbers: tuple[Uncertain, ...]  #: (k,) coefficients and rig errors
    channels: Mapping[str, LinearisedChannel]

    @property
    def is_exact(self) -> bool:
        """Whether no channel has a likely model error.

        Numbers that the data tell only if the formula is exact are not told by them where noise may hide what it misses.
        """
        return all(channel.proof < LIKELY_EVIDENCE for channel in self.channels.values())

    @cached_property
    def growths(self) -> dict[str, np.ndarray]:
        """By channel, how fast errors grow beyond the tested ranges, as :func:`mffit.linearised.ends.growths`."""
        return {name: growths(channel, self.numbers) for name, channel in self.channels.items()}

    @cached_property
    def combinations(self) -> dict[str, Combinations]:
        """By channel, how far combinations of conditions lie from the tested ones."""
        return {
            name: Combinations.of(channel.seen.inputs, channel.seen.settings, self.growths[name], name)
            for name, channel in self.channels.items()
        }

    @property
    def zeros(self) -> dict[str, tuple[float, float]]:
        """By name, change and standard uncertainty of the fitted zeros of forces, estimated together with the model error.

        All other numbers with a prior that the fit did not hold are free: fixed coefficients keep what they took up of the model
        error, such as a difference of driving and braking, and a zero would make up for it. Zeros of angles are excluded,
        because they shift the curves as the coefficients do.
        """
        free = [i for i in self._with_prior if not self.numbers[i].held]
        information, pull = self._told(free)
        covariance = inverse(information + np.diag([self.numbers[i].spread ** -2.0 for i in free]))
        change = np.array([self.numbers[i].expected for i in free]) + covariance @ pull
        u = np.sqrt(np.diag(covariance))
        return {
            self.numbers[i].name: (float(x), float(own))
            for i, x, own in zip(free, change, u, strict=True)
            if _is_of_force(self.numbers[i])
        }

    def evidence_of(self, names: Collection[str]) -> float:
        """Gain of log evidence by the named numbers within their priors, beside the model error and all others with a prior."""
        known = self._with_prior
        spread, (information, pull) = np.array([self.numbers[i].spread for i in known]), self._told(known)
        pull, information = spread * pull, information * np.outer(spread, spread)
        others = [k for k, i in enumerate(known) if self.numbers[i].name not in names]
        without = Informed.by(information[np.ix_(others, others)], pull[others])
        return Informed.by(information, pull).gain - without.gain

    def told_of(self, simulation: Simulation, spread: Mapping[str, float]) -> Informed:
        """What the readings tell of further numbers, if coefficients, model error and differences of runs may change too.

        ``spread`` has, by name, the prior standard deviations around the values in ``simulation``; the result counts in them.
        """
        information, pull = np.zeros((len(spread), len(spread))), np.zeros(len(spread))
        for name, channel in self.channels.items():
            slopes = simulation.sensitivities(channel.seen.points, [*spread], [name])[1][name]
            columns = slopes / channel.unit[:, None] * [*spread.values()]
            found = channel.model.further(channel.variances, columns)
            information = information + channel.stride * found.information
            pull = pull + channel.stride * found.pull
        return Informed.by(information, pull)

    @property
    def _with_prior(self) -> list[int]:
        """Indices of the numbers with a prior."""
        return [i for i, number in enumerate(self.numbers) if np.isfinite(number.spread)]

    def _told(self, which: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
        """Information (j, j) of all channels about some numbers beside the model error, and score (j,) at the prior means."""
        expected = np.array([self.numbers[i].expected for i in which])
        information, pull = np.zeros((len(which), len(which))), np.zeros(len(which))
        for channel in self.channels.values():
            found = channel.told_beside(channel.model, channel.slopes[:, which])
            information, pull = information + found.information, pull + found.pull
        return information, pull - information @ expected


def linearised(
    points: Points,
    simulation: Simulation,
    sigma: Mapping[str, np.ndarray],
    numbers: Sequence[Uncertain],
    without: np.ndarray | None = None,
    near: LinearisedFit | None = None,
) -> LinearisedFit:
    """The linear model of a simulation's residuals at the points.

    ``sigma`` (n,) is the uncertainty that the fit used, by channel, inf where a reading has no weight. Points ``without`` do not
    enter the estimation of the components; those of ``near``, a linear model of a similar fit, are the starting values.
    """
    readings = simulation.readings(points, sigma)
    sight = _Sight(
        points,
        simulation.felt(points),
        simulation,
        numbers,
        np.zeros(0, int) if without is None else without,
        {} if near is None else near.channels,
        {},
    )
    found = {}
    for name in sigma:
        used = np.isfinite(sigma[name]) & np.isfinite(points.channel(name))
        if np.any(used):
            found[name] = _channel(name, sight, readings[name], sigma[name], used)
    return LinearisedFit(tuple(numbers), found)


class _Sight(NamedTuple):
    """Inputs that all channels share."""

    points: Points
    felt: Points
    simulation: Simulation
    numbers: Sequence[Uncertain]
    without: np.ndarray
    near: Mapping[str, LinearisedChannel]  #: of a similar fit
    looked_at: dict[tuple[bytes, int], LookedAt]  #: cache by the rows, which are equal for most channels

    def at(self, rows: np.ndarray, channel: str) -> LookedAt:
        """The points of some rows (n,) with the smooth functions of a channel, cached."""
        mirrored = -1 if channel in REVERSED_BY_A_MIRROR else 1
        key = (rows.tobytes(), mirrored)
        known = self.looked_at.get(key)
        if known is None:
            part, at_tyre = (p.select(rows, with_table=False) for p in (self.points, self.felt))
            inputs = inputs_of(at_tyre)
            settings = settings_of(at_tyre, inputs)
            known = LookedAt(part, inputs, mirrored, settings, along(at_tyre, inputs))
            self.looked_at[key] = known
        return known


def unit_of(points: Points, channel: str, sigma: np.ndarray) -> np.ndarray:
    """Unit (n,) of the residuals of a channel: the stated uncertainty, else the usual one of those that the fit used (m,)."""
    stated = points.u(channel)
    return np.where(stating(stated), stated, float(np.median(sigma)))


def _channel(
    name: str, sight: _Sight, model: np.ndarray, sigma: np.ndarray, used: np.ndarray
) -> LinearisedChannel:
    """The linear model of one channel.

    The components are estimated with fixed coefficients, because free ones would absorb the model error. Rig errors are free
    within their declared priors. Influences without a prior, such as temperature terms, are fixed too: free ones could absorb
    any model error.
    """
    every = np.flatnonzero(used)
    stride = max(1, -(-len(every) // int(constants.POINTS_EXAMINED)))
    rows = every[::stride]
    seen = sight.at(rows, name)
    part = seen.points
    unit = unit_of(part, name, sigma[rows])
    groups = [*part.rows_of_sweeps.values()]
    steady = sight.simulation.readings(steadied(part, seen.inputs), [name])
    own = own_columns(steady[name], seen.along)
    if len(groups) == 1:  # random effects are not identifiable, and would absorb the model error
        own = np.zeros_like(own)
    slopes = sight.simulation.sensitivities(part, [number.name for number in sight.numbers], [name])[1][name]
    of_rig = [i for i, number in enumerate(sight.numbers) if _of_rig(number)]
    rig = slopes[:, of_rig] / unit[:, None]
    declared = np.log([sight.numbers[i].spread ** 2 for i in of_rig])
    known = ~np.isin(rows, sight.without)
    residual = (part.channel(name) - model[rows]) / unit
    alone = Mixed(
        residual=residual - rig @ np.array([sight.numbers[i].expected for i in of_rig]),
        common=rig,
        own=own / unit[:, None],
        groups=[own for own in (g[known[g]] for g in groups) if len(own)],
    )
    terms, components = _likely(alone, declared, seen, name, unit, sight.near.get(name))
    missed = terms.model.common[:, : len(terms.smooth.nodes)]
    turn = _turn(sight.numbers, (slopes / sigma[rows][:, None])[known], stride)
    return LinearisedChannel(
        name=name,
        rows=rows,
        stride=stride,
        unit=unit,
        components=components,
        model=Mixed(residual, np.hstack([missed, slopes @ turn / unit[:, None]]), alone.own, groups),
        variances=replace(terms, further=np.zeros(turn.shape[1])).variances(components),
        alone=terms,
        missed=_missed(terms, [sight.numbers[i] for i in of_rig], components),
        turn=turn,
        sweeps=np.unique(part.sweep),
        seen=seen,
    )


def _likely(
    alone: Mixed,
    declared: np.ndarray,
    seen: LookedAt,
    name: str,
    unit: np.ndarray,
    near: LinearisedChannel | None,
) -> tuple[Terms, Components]:
    """The terms with smooth functions of the likely lengths, and the components of the largest evidence.

    ``alone`` has no smooth functions; its residuals are over ``unit`` (n,). Without ``near``, the channel of a similar fit,
    some readings find the lengths, each of them a node.
    """

    def of(smooth: SmoothFunctions) -> Terms:
        return Terms(seen.with_functions(alone, name, smooth, unit), smooth, declared)

    if near is not None and len(near.seen.inputs) == len(seen.inputs):
        begin = near.components
    else:  # nothing is near, or one of both fits rejects every reading in which a condition varies
        rows = np.concatenate(list(alone.groups))
        some = rows[np.unique(np.linspace(0, len(rows) - 1, int(constants.READINGS_AT_FIRST)).astype(int))]
        part, usual = seen.only(some), [one.usual_length for one in seen.inputs]
        every = SmoothFunctions.with_all(seen.inputs, part.settings, usual, seen.sign)
        terms = Terms(part.with_functions(alone.only(some), name, every, unit[some]), every, declared)
        begin = terms.most_probable(unit[some])
    if near is not None and np.array_equal(near.seen.settings, seen.settings):
        terms = of(near.chosen_anew)
    else:
        terms = of(
            SmoothFunctions.over(seen.inputs, seen.settings, begin.lengths, seen.sign, begin.enough(unit))
        )
    found = terms.most_probable(unit, begin)
    return of(replace(terms.smooth, lengths=np.array(found.lengths))), found


def _missed(terms: Terms, rig: Sequence[Uncertain], components: Components) -> np.ndarray:
    """Posterior mean (m,) of the functions' weights, with free rig errors except zeros and held ones, which keep their values.

    A zero cannot be separated from a constant model error, so the result must go together with the stated zeros.
    """
    functions = len(terms.smooth.nodes)
    stays = np.array([number.held or error_of(number.name) in ZEROS for number in rig], dtype=bool)
    free = Terms(_beside(terms.model, rig, functions, ~stays), terms.smooth, terms.further[~stays])
    return np.asarray(free.model.posterior(free.variances(components)).mean[:functions])


def _is_of_force(number: Uncertain) -> bool:
    """Whether a number is the zero of a force or moment."""
    error = error_of(number.name)
    return error in ZEROS and error.place is Place.FORCE


def _of_rig(number: Uncertain) -> bool:
    """Whether a number is a rig error with a prior."""
    error = error_of(number.name)
    return error is not None and error.has_prior


def _beside(alone: Mixed, rig: Sequence[Uncertain], functions: int, free: np.ndarray) -> Mixed:
    """The model with fixed coefficients and only the rig errors of the mask ``free`` (k,) free; the others keep fitted values."""
    columns = alone.common[:, functions:]
    fitted = np.array([number.expected for number in rig])[~free]
    return replace(
        alone,
        residual=alone.residual + columns[:, ~free] @ fitted,
        common=np.hstack([alone.common[:, :functions], columns[:, free]]),
    )


def _turn(numbers: Sequence[Uncertain], weighted: np.ndarray, stride: int) -> np.ndarray:
    """Matrix (k, k) that maps independent numbers of unit variance to changes of the fit's numbers.

    Their covariance is that of the fit, widened because the model error is still unknown. ``weighted`` (n, k) are derivatives of
    the readings over the uncertainty that the fit used.
    """
    prior = np.array([number.spread for number in numbers]) ** -2.0
    return root(inverse(np.diag(prior) + stride * (weighted.T @ weighted) / constants.WIDER_THAN_THE_FIT))
