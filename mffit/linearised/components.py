"""The variance components of a channel: model error, random effects of the runs, and noise."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace

import numpy as np

from mffit.constants import CERTAIN_SIGMA, FALSE_ALARM
from mffit.linearised import constants
from mffit.linearised.mixed import Mixed, Variances
from mffit.linearised.search import Scored, Scoring, SearchedParameter, flat, normal
from mffit.linearised.smooth import SmoothFunctions
from mffit.scatter import rms
from tir.frozen import ReadOnlyArrays

CERTAIN_EVIDENCE = 0.5 * CERTAIN_SIGMA**2
"""Log evidence that proves a model error, and a condition over which it changes."""
LIKELY_EVIDENCE = -math.log(FALSE_ALARM)
"""Log evidence of a model error that chance hardly gives a channel whose formula is exact."""


@dataclass(frozen=True, slots=True)
class Components:
    """Standard deviations and lengths of the variance components, in the unit of the channel unless stated otherwise."""

    missed: float  #: standard deviation of the model error over the slightly widened tested range, a constant included
    lengths: tuple[float, ...]  #: length scales of the model error along every input [unit of the input]
    offset: float  #: standard deviation of the runs' offsets
    scale: float  #: standard deviation of the runs' relative scales [-]
    shape: float  #: standard deviation of the runs' smooth deviations along the swept setting
    shape_length: float  #: length scale of these deviations, over the tested range [-]
    noise: float  #: standard deviation of the noise over the stated one [-]

    def over_one_input(self, smooth: SmoothFunctions) -> Iterator[Components]:
        """Variants in which the model error changes over one input only, and over the curvature of a path as it is."""
        longest = [
            length if one.name == "phi_t" else constants.LONGEST_LENGTH * one.width
            for one, length in zip(smooth.inputs, self.lengths, strict=True)
        ]
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

    def run_variance(self, force: np.ndarray) -> np.ndarray:
        """Variance (n,) of a new run around the mean of all runs, at points with the given force (n,)."""
        of_scale: np.ndarray = (self.scale * force) ** 2
        return self.offset**2 + of_scale + self.shape**2


def own_columns(force: np.ndarray, along: np.ndarray) -> np.ndarray:
    """Columns (n, q) of each run's random effects: constant, force, and cosines along the swept setting (0 to 1)."""
    order = np.arange(1, constants.FUNCTIONS_OF_A_RUN + 1)
    waves = np.sqrt(2.0) * np.cos(np.pi * order * along[:, None])
    return np.column_stack([np.ones(len(force)), force, waves])


def variances(x: np.ndarray, smooth: SmoothFunctions) -> tuple[Variances, np.ndarray, np.ndarray]:
    """Log variances of all numbers, and the derivatives of the common and the group-specific ones by the log components ``x``."""
    d, q = len(smooth.inputs), int(constants.FUNCTIONS_OF_A_RUN)
    share, by_length = smooth.log_variance(np.exp(x[1 : 1 + d]))
    by_common = np.zeros((len(share), len(x)))
    by_common[:, 0] = 2.0
    by_common[:, 1 : 1 + d] = by_length
    exponent = -0.5 * (np.pi * np.arange(1, q + 1) * np.exp(x[-2])) ** 2
    total = float(np.log(np.sum(np.exp(exponent))))
    own = np.concatenate([2.0 * x[-5:-3], 2.0 * x[-3] + exponent - total])
    by_own = np.zeros((len(own), len(x)))
    by_own[0, -5] = by_own[1, -4] = 2.0
    by_own[2:, -3] = 2.0
    by_own[2:, -2] = 2.0 * (exponent - np.exp(exponent - total) @ exponent)
    return Variances(2.0 * x[0] + share, own, 2.0 * float(x[-1])), by_common, by_own


@dataclass(frozen=True, eq=False)
class Terms(ReadOnlyArrays):
    """The terms of the residuals of a channel, as functions of the variance components.

    The common numbers of ``model`` are the weights of ``smooth``, then further numbers with variances of their own.
    """

    model: Mixed
    smooth: SmoothFunctions
    further: np.ndarray  #: log variances of the further numbers

    def variances(self, of: Components) -> Variances:
        """The prior variances."""
        return self._with_slopes(of.logarithms)[0]

    def evidence(self, of: Components) -> float:
        """Log evidence of components."""
        return self.model.evidence(self.variances(of)).value

    def _with_slopes(self, x: np.ndarray) -> tuple[Variances, np.ndarray, np.ndarray]:
        given, by_common, by_own = variances(x, self.smooth)
        return given._replace(common=np.append(given.common, self.further)), by_common, by_own

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
        given, by_common, by_own = self._with_slopes(x)
        found, m = self.model.evidence(given), len(by_common)
        slope = found.common[:m] @ by_common + found.own @ by_own
        information = by_common.T @ found.of_common[:m, :m] @ by_common + by_own.T @ found.of_own @ by_own
        slope[-1] += 2.0 * found.noise
        information[-1, -1] += 4.0 * found.of_noise
        return Scored(found.value, slope, information)


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

    lengths = (
        around(2.0 * one.spacing, one.spacing, constants.LONGEST_LENGTH * one.width) for one in smooth.inputs
    )
    return [
        around(misfit, tiny, 3.0 * misfit, known=False),  # missed
        *lengths,
        around(misfit / 3.0, tiny, misfit),  # offset
        around(most / 10.0, 1e-6, most),  # scale
        around(misfit / 3.0, tiny, misfit),  # shape
        around(0.3, 0.05, 1.0),  # shape_length
        around(1.0, 1e-3, most_noise, known=False),  # noise
    ]
