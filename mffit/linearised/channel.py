"""The linear mixed model of the residuals of one channel of a fit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from mffit.linearised import constants
from mffit.linearised.components import CERTAIN_EVIDENCE, Components, Terms, own_columns
from mffit.linearised.inputs import Input, along, settings_of, turned
from mffit.linearised.mixed import FurtherColumns, LeftOutReadings, Mixed, MixedPosterior, Variances
from mffit.linearised.smooth import CONSTANT, SmoothFunctions
from mffit.points import Points
from mffit.scatter import rms, robust
from tir.frozen import ReadOnlyArrays


class Uncertain(NamedTuple):
    """A number of the fit with its prior, relative to the fitted value."""

    name: str
    expected: float  #: prior mean less fitted value
    spread: float  #: standard deviation
    held: bool = False  #: whether the fit took it as exact


class LookedAt(NamedTuple):
    """Points (n,) of a channel, and the conditions over which the model error varies there."""

    points: Points
    inputs: tuple[Input, ...]  #: (d,)
    sign: int  #: by which a mirror multiplies the channel
    settings: np.ndarray  #: (n, d) the conditions
    along: np.ndarray  #: (n,) as :func:`mffit.linearised.inputs.along`

    def only(self, rows: np.ndarray) -> LookedAt:
        """The same of some ``rows`` (k,)."""
        return self._replace(
            points=self.points.select(rows, with_table=False),
            settings=self.settings[rows],
            along=self.along[rows],
        )

    def with_functions(self, model: Mixed, name: str, smooth: SmoothFunctions, unit: np.ndarray) -> Mixed:
        """A ``model`` of readings of a channel over ``unit`` (n,) with the weights of the functions before its common numbers."""
        functions = (turned(self.points, name) / unit)[:, None] * smooth.columns(self.settings)
        return replace(model, common=np.hstack([functions, model.common]))


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
    seen: LookedAt  #: conditions of the readings

    @property
    def smooth(self) -> SmoothFunctions:
        """The functions of the model error."""
        return self.alone.smooth

    @cached_property
    def chosen_anew(self) -> SmoothFunctions:
        """The functions whose nodes are the best for the lengths that were found with those of :attr:`smooth`."""
        seen, enough = self.seen, self.components.enough(self.unit)
        return SmoothFunctions.over(seen.inputs, seen.settings, self.components.lengths, seen.sign, enough)

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
        untold, functions = self.smooth.faded(settings)
        return untold, turned(points, self.name)[:, None] * functions

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

    def by_others(self, rows: np.ndarray, alike: Sequence[np.ndarray] = ()) -> list[LeftOutReadings]:
        """Prediction of a run's ``rows`` from other runs, for a model whose fit and components exclude that run; then of each run
        ``alike``, from the runs other than both.

        Few runs determine how fast the model error changes over a condition that no run sweeps, such as the load. Its length is
        therefore limited to the spacing of the settings.
        """
        lengths = tuple(
            min(length, one.spacing) if one.is_held else length
            for one, length in zip(self.smooth.inputs, self.components.lengths, strict=True)
        )
        known = self.components.enough(self.unit)
        smooth = SmoothFunctions.over(self.smooth.inputs, self.seen.settings, lengths, self.seen.sign, known)
        model = self._with(smooth, self.model)
        given = Terms(model, smooth, np.zeros(self.turn.shape[1])).variances(self.components)
        own, *both = self._left_out(model, given, [rows, *(np.append(rows, one) for one in alike)])
        return [own, *(found.only(one) for found, one in zip(both, alike, strict=True))]

    @cached_property
    def proof_of_noise(self) -> float:
        """Gain of log evidence by a noise beyond the stated one.

        Few readings cannot tell noise from model error that bends between them, which the best model at the stated noise has
        in its place.
        """
        stated = self.alone.most_probable(self.unit, self.components, most_noise=1.0)
        return self.stride * (self._evidence - self.alone.evidence(stated))

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
        terms = replace(self.alone, model=model, smooth=CONSTANT)
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
