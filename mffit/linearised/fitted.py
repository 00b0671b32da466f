"""The residuals of a fit as one linear mixed model per channel."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.least_squares import inverse, root
from mffit.linearised import constants
from mffit.linearised.components import CERTAIN_EVIDENCE, LIKELY_EVIDENCE, Components, Terms, own_columns
from mffit.linearised.gaussian import Informed
from mffit.linearised.inputs import Input, along, inputs_of, settings_of, turned
from mffit.linearised.mixed import FurtherColumns, LeftOutReadings, Mixed, MixedPosterior, Variances
from mffit.linearised.smooth import SmoothFunctions
from mffit.points import Points
from mffit.points.noise import stating
from mffit.quantities import REVERSED_BY_A_MIRROR
from mffit.rig import Simulation
from mffit.rig_errors import ZEROS, Place, error_of
from mffit.scatter import rms, robust
from tir.frozen import ReadOnlyArrays


@dataclass(frozen=True, eq=False)
class LinearisedChannel(ReadOnlyArrays):
    """Linear model of the residuals of one channel: model error, random effects of the runs, and noise."""

    name: str
    rows: np.ndarray  #: (n,) indices of the points in the model
    stride: int  #: thinning factor: readings represented by each of these points
    unit: np.ndarray  #: (n,) standard uncertainty as stated, or the usual one [N], [Nm], [m]
    components: Components
    model: Mixed
    """Model of the residuals (measured less model, over ``unit``). Common numbers: the weights of ``smooth``, then independent
    changes of the fit's numbers."""
    variances: Variances  #: prior variances of ``model``
    alone: Terms
    """The terms with fixed coefficients; the further numbers are rig errors with declared priors."""
    missed: np.ndarray
    """(m,) estimated weights of ``smooth`` with fixed coefficients and rig zeros [unit of the channel]."""
    turn: np.ndarray  #: (k, k) changes of the fit's numbers by the independent changes in ``model``
    sweeps: np.ndarray  #: index of the sweep of every group of ``model``
    seen: _LookedAt  #: conditions of the readings

    @property
    def smooth(self) -> SmoothFunctions:
        """The functions of the model error."""
        return self.alone.smooth

    @cached_property
    def slopes(self) -> np.ndarray:
        """Derivatives (n, k) of the readings by the fit's numbers, over ``unit``."""
        return np.asarray(self.model.common[:, len(self.missed) :] @ np.linalg.inv(self.turn))

    @cached_property
    def posterior(self) -> MixedPosterior:
        """Posterior of the common numbers."""
        return self.model.posterior(self.variances)

    @property
    def noise(self) -> float:
        """Standard deviation of the noise of a typical reading."""
        return self.components.noise * float(np.median(self.unit))

    @property
    def size(self) -> float:
        """Root mean square of the estimated model error at the readings."""
        return rms(self.missed_at_readings)

    @property
    def missed_at_readings(self) -> np.ndarray:
        """The estimated model error (n,), measured less model, from all sweeps."""
        return np.asarray(self.unit * (self.model.common[:, : len(self.missed)] @ self.missed))

    @property
    def misfit(self) -> float:
        """Root mean square of the residuals in units of their stated uncertainty."""
        return rms(self.model.residual)

    @property
    def own_effects(self) -> np.ndarray:
        """Changes (n, q) of the readings by one standard deviation of each random effect of their run."""
        return np.asarray(self.model.own * self.unit[:, None] * np.exp(0.5 * self.variances.own))

    def foreseen(self, points: Points, force: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Model error (n,) and ``own_effects`` (n, q) of a further run at its set-points; ``force`` (n,) is that of the model."""
        own = own_columns(force, along(points, self.smooth.inputs)) * np.exp(0.5 * self.variances.own)
        return self.functions_at(points)[1] @ self.missed, own * float(np.any(self.model.own))

    def functions_at(self, points: Points) -> tuple[np.ndarray, np.ndarray]:
        """As :meth:`SmoothFunctions.faded` at further points; unstated conditions are in the middle of the tested range."""
        inputs = self.smooth.inputs
        settings, middle = settings_of(points, inputs), [0.5 * (one.lower + one.upper) for one in inputs]
        settings = np.where(np.isfinite(settings), settings, middle)
        beyond, functions = self.smooth.faded(settings, np.array(self.components.lengths))
        return beyond, turned(points, self.name)[:, None] * functions

    def told_beside(self, model: Mixed, columns: np.ndarray) -> FurtherColumns:
        """What the residuals of a ``model`` tell of ``columns`` (n, j), which replace its numbers other than the model error."""
        m = len(self.missed)
        given = self.variances._replace(common=self.variances.common[:m])
        return replace(model, common=model.common[:, :m]).further(given, columns)

    def without_runs(self, rows: Sequence[np.ndarray], *, missed: bool) -> list[LeftOutReadings]:
        """Prediction of each set of ``rows`` from all other readings in a model without random effects of the runs.

        With ``missed`` False the model has no model error either, and the noise covers the core of the residuals.
        """
        functions = len(self.missed)
        noise = self.components.noise if missed else robust(self.model.residual)
        given = self.model.alike(self.variances.common, 2.0 * float(np.log(max(noise, 1.0))))
        if missed:
            return self._left_out(self.model, given, rows)
        plain = replace(self.model, common=self.model.common[:, functions:])
        return self._left_out(plain, given._replace(common=given.common[functions:]), rows)

    def by_others(self, rows: np.ndarray) -> LeftOutReadings:
        """Prediction of a run's ``rows`` from other runs, for a model whose fit and components exclude that run.

        Few runs determine how fast the model error changes over a condition that no run sweeps, such as the load. Its length is
        therefore limited to the spacing of the settings.
        """
        lengths = tuple(
            min(length, one.spacing) if one.is_held else length
            for one, length in zip(self.smooth.inputs, self.components.lengths, strict=True)
        )
        smooth = SmoothFunctions.over(self.smooth.inputs, self.seen.sign)
        model = self._with(smooth, self.model)
        terms = Terms(model, smooth, np.zeros(self.turn.shape[1]))
        given = terms.variances(replace(self.components, lengths=lengths))
        (found,) = self._left_out(model, given, [rows])
        return found

    @cached_property
    def proof_of_noise(self) -> float:
        """Gain of log evidence by a noise beyond the stated one.

        Few readings cannot tell noise from model error that bends between them, which the best model at the stated noise has
        in its place. Nor is it noise what all sweeps have in common in finer steps: a tyre bends fast where it begins to slide.
        """
        others = (
            terms.evidence(terms.most_probable(self.unit, self.components, most_noise=1.0))
            for terms in (self.alone, self._finer)
        )
        return self.stride * (self._evidence - max(others))

    @property
    def _finer(self) -> Terms:
        """The terms with functions in finer steps along what the sweeps move."""
        inputs = tuple(
            one if one.is_held else replace(one, spacing=one.spacing / constants.FINER)
            for one in self.smooth.inputs
        )
        known = zip(inputs, self.components.lengths, strict=True)
        lengths = [length if one.is_held else 0.0 for one, length in known]
        smooth = SmoothFunctions.over(inputs, self.seen.sign, lengths)
        return replace(self.alone, model=self._with(smooth, self.alone.model), smooth=smooth)

    def _with(self, smooth: SmoothFunctions, model: Mixed) -> Mixed:
        """A ``model`` of this channel with other functions of the model error."""
        others = replace(model, common=model.common[:, len(self.missed) :])
        return self.seen.with_functions(others, self.name, smooth, self.unit)

    @cached_property
    def proof(self) -> float:
        """Gain of log evidence by the model error, over a constant alone."""
        return self.stride * (self._evidence - self._without)

    @property
    def is_proven(self) -> bool:
        """Whether neither noise nor random effects of the runs can explain the model error."""
        return self.proof > CERTAIN_EVIDENCE

    @property
    def proven_over(self) -> list[str]:
        """Names of the inputs over which the model error changes significantly, the clearest first."""
        return [name for name, gain in self.missed_over.items() if gain > CERTAIN_EVIDENCE]

    @cached_property
    def missed_over(self) -> dict[str, float]:
        """By name of an input, the gain of log evidence because the model error changes over it; largest first."""
        found = {}
        for i, one in enumerate(self.smooth.inputs):
            lengths = list(self.components.lengths)
            lengths[i] = constants.LONGEST_LENGTH * one.width
            without = self.alone.evidence(replace(self.components, lengths=tuple(lengths)))
            found[one.name] = self.stride * (self._evidence - without)
        return dict(sorted(found.items(), key=lambda item: -item[1]))

    @cached_property
    def _evidence(self) -> float:
        """Log evidence of the model with fixed coefficients."""
        return self.alone.evidence(self.components)

    @cached_property
    def _without(self) -> float:
        """Log evidence if the model error is only a constant."""
        rig = self.alone.model.common[:, len(self.missed) :]
        model = replace(self.alone.model, common=np.hstack([1.0 / self.unit[:, None], rig]))
        terms = replace(self.alone, model=model, smooth=SmoothFunctions.over(()))
        return terms.evidence(terms.most_probable(self.unit))

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
        """Gain of log evidence by adding a known ``change`` (n,) to the model, and :attr:`proof` of the remaining model error."""
        model = self.alone.model.of(self.alone.model.residual - change / self.unit)
        terms = replace(self.alone, model=model)
        found = terms.most_probable(self.unit, self.components)
        beside = replace(self, alone=terms, components=found)
        return self.stride * (beside._evidence - self._evidence), beside.proof


class Uncertain(NamedTuple):
    """A number of the fit with its prior, relative to the fitted value."""

    name: str
    expected: float  #: prior mean less fitted value
    spread: float  #: standard deviation
    held: bool = False  #: whether the fit took it as exact


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
        {} if near is None else {n: own.components for n, own in near.channels.items()},
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
    near: Mapping[str, Components]  #: by channel
    looked_at: dict[tuple[bytes, int], _LookedAt]  #: cache by the rows, which are equal for most channels

    def at(self, rows: np.ndarray, channel: str) -> _LookedAt:
        """The points of some rows (n,) with the smooth functions of a channel, cached."""
        mirrored = -1 if channel in REVERSED_BY_A_MIRROR else 1
        key = (rows.tobytes(), mirrored)
        known = self.looked_at.get(key)
        if known is None:
            part, at_tyre = (p.select(rows, with_table=False) for p in (self.points, self.felt))
            inputs = inputs_of(at_tyre)
            settings = settings_of(at_tyre, inputs)
            known = _LookedAt(part, inputs, mirrored, settings, along(at_tyre, inputs))
            self.looked_at[key] = known
        return known


class _LookedAt(NamedTuple):
    """Points (n,) of a channel, and the conditions over which the model error varies there."""

    points: Points
    inputs: tuple[Input, ...]  #: (d,)
    sign: int  #: by which a mirror multiplies the channel
    settings: np.ndarray  #: (n, d) the conditions
    along: np.ndarray  #: (n,) as :func:`mffit.linearised.inputs.along`

    def with_functions(self, model: Mixed, name: str, smooth: SmoothFunctions, unit: np.ndarray) -> Mixed:
        """A ``model`` of readings of a channel over ``unit`` (n,) with the weights of the functions before its common numbers."""
        functions = (turned(self.points, name) / unit)[:, None] * smooth.columns(self.settings)
        return replace(model, common=np.hstack([functions, model.common]))


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
    groups = [np.flatnonzero(part.sweep == k) for k in np.unique(part.sweep)]
    own = own_columns(model[rows], seen.along)
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
    missed = terms.model.common[:, : len(terms.smooth.orders)]
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
    seen: _LookedAt,
    name: str,
    unit: np.ndarray,
    near: Components | None,
) -> tuple[Terms, Components]:
    """The terms with the smooth functions that matter at the likely lengths, and the components of the largest evidence.

    ``alone`` has no smooth functions; its residuals are over ``unit`` (n,). Without ``near``, the linear model of a similar
    fit, the functions of the shortest lengths find the lengths: a model error that hardly changes over some conditions leaves
    more functions to the others.
    """

    def over(lengths: Sequence[float] | None) -> Terms:
        smooth = SmoothFunctions.over(seen.inputs, seen.sign, lengths)
        return Terms(seen.with_functions(alone, name, smooth, unit), smooth, declared)

    if near is not None and len(near.lengths) != len(seen.inputs):
        near = None  # one of both fits rejects every reading in which a condition varies
    begin = over(None).most_probable(unit) if near is None else near
    terms = over(begin.lengths)
    return terms, terms.most_probable(unit, begin)


def _missed(terms: Terms, rig: Sequence[Uncertain], components: Components) -> np.ndarray:
    """Posterior mean (m,) of the functions' weights, with free rig errors except zeros and held ones, which keep their values.

    A zero cannot be separated from a constant model error, so the result must go together with the stated zeros.
    """
    functions = len(terms.smooth.orders)
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
