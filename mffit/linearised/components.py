"""The variance components of a channel: model error, random effects of the runs, and noise."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from mffit.constants import CERTAIN_SIGMA, FALSE_ALARM
from mffit.linearised import constants
from mffit.linearised.gaussian import lower_inverse, lower_root, times_lower, within_lower
from mffit.linearised.mixed import Mixed, Variances
from mffit.linearised.search import Scored, Scoring, SearchedParameter, flat, normal
from mffit.linearised.smooth import SINGULAR, SmoothFunctions
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

CERTAIN_EVIDENCE = 0.5 * CERTAIN_SIGMA**2
"""Log evidence that proves a model error, and a condition over which it changes."""
LIKELY_EVIDENCE = -math.log(FALSE_ALARM)
"""Log evidence of a model error that chance hardly gives a channel whose formula is exact."""


@dataclass(frozen=True, slots=True)
class Components:
    """Standard deviations and lengths of the variance components, in the unit of the channel unless stated otherwise."""

    missed: float  #: standard deviation of the model error at the middle load, a constant included
    lengths: tuple[float, ...]  #: length scales of the model error along every input [unit of the input]
    offset: float  #: standard deviation of the runs' offsets
    scale: float  #: standard deviation of the runs' relative scales [-]
    shape: float  #: standard deviation of the runs' smooth deviations along the swept setting
    shape_length: float  #: length scale of these deviations, over the tested range [-]
    noise: float  #: standard deviation of the noise over the stated one [-]

    def over_one_input(self, smooth: SmoothFunctions) -> Iterator[Components]:
        """Variants in which the model error changes over one input only, and over the curvature of a path."""
        longest = [one.longest for one in smooth.inputs]
        for i, length in enumerate(self.lengths):
            yield replace(self, lengths=(*longest[:i], length, *longest[i + 1 :]))

    @property
    def logarithms(self) -> np.ndarray:
        """Logarithms (d + 6,) of all components."""
        return np.log(
            [self.missed, *self.lengths, self.offset, self.scale, self.shape, self.shape_length, self.noise]
        )

    @classmethod
    def of_logarithms(cls, x: Iterable[float]) -> Components:
        """The components from their logarithms."""
        size = [math.exp(one) for one in x]
        return cls(size[0], tuple(size[1:-5]), *size[-5:])

    def enough(self, unit: np.ndarray) -> float:
        """Share of the variance that functions of the model error need not tell; ``unit`` (n,) is the stated noise."""
        return (constants.LEFT_OUT * self.noise * float(np.median(unit)) / self.missed) ** 2

    def run_variance(self, force: np.ndarray) -> np.ndarray:
        """Variance (n,) of a new run around the mean of all runs, at points with the given force (n,)."""
        of_scale: np.ndarray = (self.scale * force) ** 2
        return self.offset**2 + of_scale + self.shape**2


def own_columns(force: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Columns (n, q) of each run's random effects: constant, force, and cosines along the swept setting (0 to 1).

    The ``force`` (n,) is that of the formula at the run's mean settings, where the model error holds too. A tyre follows a
    wandering load less than the formula; with the force at the settings as read, large scales and an opposite model error
    would describe that together.
    """
    order = np.arange(1, constants.FUNCTIONS_OF_A_RUN + 1)
    waves = np.sqrt(2.0) * np.cos(np.pi * order * along[:, None])
    return np.column_stack([np.ones(len(force)), force, waves])


def own_variances(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Log variances (q,) of the random effects of a run, and their derivatives (q, k) by the log components ``x`` (k,)."""
    order = np.arange(1, constants.FUNCTIONS_OF_A_RUN + 1)
    exponent = -0.5 * (np.pi * order * np.exp(x[-2])) ** 2
    total = float(np.log(np.sum(np.exp(exponent))))
    own = np.concatenate([2.0 * x[-5:-3], 2.0 * x[-3] + exponent - total])
    by_own = np.zeros((len(own), len(x)))
    by_own[0, -5] = by_own[1, -4] = 2.0
    by_own[2:, -3] = 2.0
    by_own[2:, -2] = 2.0 * (exponent - np.exp(exponent - total) @ exponent)
    return own, by_own


@dataclass(frozen=True, eq=False)
class Terms(ReadOnlyArrays):
    """The terms of the residuals of a channel, as functions of the variance components.

    The common numbers of ``model`` are the weights of ``smooth``, then further numbers with variances of their own.
    """

    model: Mixed
    smooth: SmoothFunctions
    further: np.ndarray  #: log variances of the further numbers

    def variances(self, of: Components) -> Variances:
        """The prior variances; they hold for the lengths of ``smooth``."""
        x, m = of.logarithms, len(self.smooth.nodes)
        return Variances(
            np.append(np.full(m, 2.0 * x[0]), self.further), own_variances(x)[0], 2.0 * float(x[-1])
        )

    def evidence(self, of: Components) -> float:
        """Log evidence of components."""
        root = lower_root(self.smooth.at_nodes(np.array(of.lengths))[0])
        return self.model.evidence(self.variances(of), self._turn(root)).value

    def _turn(self, root: np.ndarray) -> np.ndarray:
        """Matrix that turns the columns into those of functions with another ``root`` (m, m) of their values at the nodes."""
        turn = np.eye(len(root) + len(self.further))
        turn[: len(root), : len(root)] = times_lower(self.smooth.back, root)
        return turn

    def most_probable(
        self, unit: np.ndarray, near: Components | None = None, most_noise: float = 1e3
    ) -> Components:
        """The components of the largest evidence, around their first guess; the residuals of ``model`` are over ``unit`` (n,).

        The noise is at most ``most_noise`` times the stated one. The search starts at ``near``, the components of a similar
        fit, if given; else at a model error that changes over all inputs. Random effects of the runs can absorb model error over
        a condition that runs hold. If they are larger than the model error, a second search starts with model error over a
        single input; its result must be clearly more probable.
        """
        rows = np.concatenate(list(self.model.groups))
        misfit = max(rms((self.model.residual * unit)[rows]), 1e-12)
        search = Scoring(_parameters(self.smooth, misfit, most_noise), self._scored)
        first = Components.of_logarithms(one.start for one in search.parameters)

        def best(begin: Components) -> Components:
            return Components.of_logarithms(search.most_probable(begin.logarithms.tolist()))

        def density(at: Components) -> float:
            return search.density(at.logarithms).value

        found = best(near or first)
        if near is None and found.offset > found.missed and self.smooth.inputs:
            other = best(max(first.over_one_input(self.smooth), key=density))
            if density(other) > density(found) + CERTAIN_EVIDENCE:
                return other
        return found

    def _scored(self, x: np.ndarray) -> Scored:
        """Log evidence at the log components (k,)."""
        at, (_, by_own), m = Components.of_logarithms(x), own_variances(x), len(self.smooth.nodes)
        alike, by_lengths = self.smooth.at_nodes(np.array(at.lengths))
        root = lower_root(alike)
        found = self.model.evidence(self.variances(at), self._turn(root))
        back = lower_inverse(root)
        pull = within_lower(found.common[:m, :m], back)
        told = lower_root(found.told[:m, :m] + SINGULAR * np.eye(m))
        probes = told @ _signs(m)
        aside, moved, slope = back.T @ probes, np.zeros((len(x), probes.size)), found.own @ by_own
        moved[0], slope[0] = (2.0 * told.T @ probes).ravel(), 2.0 * np.trace(found.common[:m, :m])
        for i, one in enumerate(by_lengths, start=1):
            moved[i], slope[i] = (told.T @ (back @ (one @ aside))).ravel(), np.sum(pull * one)
        information = by_own.T @ found.of_own @ by_own + 0.5 / probes.shape[1] * moved @ moved.T
        slope[-1] += 2.0 * found.noise
        information[-1, -1] += 4.0 * found.of_noise
        return Scored(found.value, slope, information)


def _signs(m: int) -> np.ndarray:
    """Signs (m, k) drawn at random, of which products have the trace of a matrix (m, m) as their mean."""
    return np.sign(np.random.default_rng(0).standard_normal((m, int(constants.PROBES))))


def _parameters(smooth: SmoothFunctions, misfit: float, most_noise: float) -> list[SearchedParameter]:
    """The components on the scale of the search, in the order of :attr:`Components.logarithms`.

    The search starts at a model error as large as the ``misfit``, the size of the residuals, and differences of runs of a third
    of it. Runs differ by at most the misfit, and no length is below the spacing of the settings. The data alone determine model
    error and noise.
    """
    tiny, most = 1e-4 * misfit, float(constants.LARGEST_RUN_SCALE)

    def around(start: float, lower: float, upper: float, *, known: bool = True) -> SearchedParameter:
        at = math.log(start)
        prior = normal(at, math.log(constants.USUAL_RATIO)) if known else flat
        return SearchedParameter(at, math.log(lower), math.log(upper), prior)

    lengths = (around(one.usual_length, one.shortest, one.longest) for one in smooth.inputs)
    return [
        around(misfit, tiny, 3.0 * misfit, known=False),  # missed
        *lengths,
        around(misfit / 3.0, tiny, misfit),  # offset
        around(most / 10.0, 1e-6, most),  # scale
        around(misfit / 3.0, tiny, misfit),  # shape
        around(0.3, 0.05, 1.0),  # shape_length
        around(1.0, 1e-3, most_noise, known=False),  # noise
    ]
